"""The true states from what the engine gives, and the loads that make its motion one of second order."""

import struct
from collections.abc import Sequence

import numpy as np

from idc_controller.parameters import SystemParameters
from idc_controller.rotations_float import Vector
from vehicle_sim.world.ground import Pose
from vehicle_sim.world.link_force_kernels import link_tensions
from vehicle_sim.world.multibody import Multibody
from vehicle_sim.world.state_kernels import (
    AXIS,
    LOAD_COLUMNS,
    MEMORY_COLUMNS,
    PART_COLUMNS,
    READING_COLUMNS,
    STATE_COLUMNS,
    states_from_engine,
)
from vehicle_sim.world.world_state import flipped, rotated, upward_axis

Uavs = Sequence[tuple[tuple[float, ...], ...]]
"""States of the UAVs: position, attitude, four that are not used, velocity, angular velocity."""


class VelocityCorrection:
    """What the engine gave after the last two steps: its velocities are half a step older than its poses.

    Attributes:
        states: the true states (N + 1, 13) as in :mod:`.state_kernels`, of the last reading.
        loads: on payload and UAVs (N + 1, 6), as :mod:`.state_kernels` writes them, for the step after it.
    """

    def __init__(self, system: Multibody, parameters: SystemParameters, physics_step: float) -> None:
        """Take the constants of the system; ``physics_step`` in s."""
        rows = len(system.uavs) + 1
        self._physics_step, self._free_steps = physics_step, 0
        self._payload_in_axes, self._gravity = np.array(system.payload_in_axes), parameters.g
        self._now, self._before = np.zeros((rows, READING_COLUMNS)), np.zeros((rows, READING_COLUMNS))
        self._parts, self._memory = np.zeros((rows, PART_COLUMNS)), np.zeros((rows, MEMORY_COLUMNS))
        self.set_payload_moments(system.payload_moments)
        for i, (J_i, m_i, p_i) in enumerate(zip(parameters.J, parameters.m, parameters.p, strict=True), start=1):
            self._parts[i] = *np.diag(J_i), m_i, *rotated(system.payload_in_axes, flipped(p_i))
        # A third of the time that an assignment of lists takes.
        self._pack = struct.Struct(f"{self._now.size}d").pack_into
        self.loads = np.empty((rows, LOAD_COLUMNS))

    def set_payload_moments(self, moments: Sequence[float]) -> None:
        """Set the payload's principal moments of inertia (3,) (kg m2), from the next reading on."""
        self._parts[0, :3] = moments

    def take(self, payload: Pose, velocity: tuple[Vector, Vector], uavs: Uavs) -> None:
        """Take what the engine gives after a step: the payload's pose and velocity, and the UAVs'."""
        self._now, self._before = self._before, self._now
        position, attitude = payload
        numbers = [*position, *attitude, *velocity[0], *velocity[1]]
        for place, turn, _, _, _, _, v, w in uavs:
            numbers += (*place, *turn, *v, *w)
        self._pack(self._now.data, 0, *numbers)
        self._free_steps += 1
        self._evaluate()

    def restart(self, links: Uavs) -> None:
        """Take the velocities of the last reading as they are: what changed them is no acceleration that goes on.

        ``links``: the links' states as the engine gives them.
        """
        self._free_steps = 0
        for row, (_, turn, _, _, _, _, _, w) in zip(self._memory[1:], links, strict=True):
            axis = upward_axis(turn)
            row[AXIS:] = *axis, np.dot(axis, w)
        self._evaluate()

    def velocity_changes(self) -> list[list[float]]:
        """Return by how much the velocities of payload and UAVs (N + 1) changed in the last step (m/s, z up)."""
        changes: list[list[float]] = (self._now[:, 7:10] - self._before[:, 7:10]).tolist()
        return changes

    def link_tensions(self, thrusts: Sequence[float], external: Sequence[Sequence[float]] | None) -> list[float]:
        """Return the tension of each link in the last step (N) (N), see :mod:`.link_force_kernels`.

        ``thrusts`` N numbers (N) and ``external`` N triples (N, NED; None: none) of that step.
        """
        n = len(thrusts)
        forces = np.zeros((n, 3)) if external is None else np.array(external, dtype=float)
        tensions: list[float] = link_tensions(
            self._now, self._before, self._parts, np.array(thrusts, dtype=float), forces, self._gravity,
            self._physics_step,
        ).tolist()  # fmt: skip
        return tensions

    def _evaluate(self) -> None:
        self.states = np.empty((len(self._now), STATE_COLUMNS))
        states_from_engine(
            self._now, self._parts, self._payload_in_axes, self._physics_step, self._free_steps,
            self._memory, self.states, self.loads,
        )  # fmt: skip
