"""The true states from what the engine gives, and the loads that make its motion one of second order."""

import struct
from collections.abc import Sequence

import numpy as np

from idc_controller.arrays import Array
from idc_controller.parameters import SystemParameters
from idc_controller.rotations_float import Vector
from vehicle_sim.world.ground import Pose
from vehicle_sim.world.multibody import Multibody
from vehicle_sim.world.state_kernels import (
    LOAD_COLUMNS,
    PART_COLUMNS,
    READING_COLUMNS,
    STATE_COLUMNS,
    states_from_engine,
)
from vehicle_sim.world.world_state import flipped, rotated

Uavs = Sequence[tuple[tuple[float, ...], ...]]
"""States of the UAVs: position, attitude, four that are not used, velocity, angular velocity."""
Velocity = tuple[Vector, Vector]


class VelocityCorrection:
    """Evaluates the engine's velocities, which are half a step older than its poses.

    Attributes:
        loads: on payload and UAVs (N + 1, 6), as :mod:`.state_kernels` writes them, of the last evaluation.
    """

    def __init__(self, system: Multibody, parameters: SystemParameters, physics_step: float) -> None:
        """Take the constants of the system; ``physics_step`` in s."""
        self._physics_step = physics_step
        rows = len(system.uavs) + 1
        self._payload_in_axes = np.array(system.payload_in_axes)
        self._rows, self._parts = np.empty((rows, READING_COLUMNS)), np.zeros((rows, PART_COLUMNS))
        self.set_payload_moments(system.payload_moments)
        for i, (J_i, m_i, p_i) in enumerate(zip(parameters.J, parameters.m, parameters.p, strict=True), start=1):
            self._parts[i] = *np.diag(J_i), m_i, *rotated(system.payload_in_axes, flipped(p_i))
        # A third of the time that an assignment of lists takes.
        self._pack = struct.Struct(f"{self._rows.size}d").pack_into
        self.loads = np.empty((rows, LOAD_COLUMNS))

    def set_payload_moments(self, moments: Sequence[float]) -> None:
        """Set the payload's principal moments of inertia (3,) (kg m2)."""
        self._parts[0, :3] = moments

    def evaluate(
        self, payload: Pose, velocity: Velocity, uavs: Uavs, before: tuple[Velocity, Uavs], was_stepped: bool
    ) -> Array:
        """Return the true states (N + 1, 13) as in :mod:`.state_kernels`, and write :attr:`loads`.

        ``payload``, its ``velocity`` and ``uavs`` as the engine gives them; ``before``: the velocities one step
        earlier. Without a step that led here the velocities are taken as they are, and no load is missing.
        """
        position, attitude = payload
        v_0, w_0 = velocity
        (v_0_before, w_0_before), uavs_before = before
        numbers = [*position, *attitude, *v_0, *w_0, *v_0_before, *w_0_before]
        for i, (place, turn, _, _, _, _, v, w) in enumerate(uavs):
            _, _, _, _, _, _, v_before, w_before = uavs_before[i]
            numbers += (*place, *turn, *v, *w, *v_before, *w_before)
        self._pack(self._rows.data, 0, *numbers)
        states = np.empty((len(self._rows), STATE_COLUMNS))
        step = self._physics_step if was_stepped else 0.0
        states_from_engine(self._rows, self._parts, self._payload_in_axes, step, states, self.loads)
        return states
