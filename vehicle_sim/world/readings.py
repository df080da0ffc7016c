"""What the engine says after each step, the true states that follow from it, and the loads that its motion lacks."""

import math
import struct
from collections.abc import Sequence

import numpy as np
import pybullet

from idc_controller.arrays import Array
from idc_controller.parameters import SystemParameters
from vehicle_sim.world.link_force_kernels import link_tensions
from vehicle_sim.world.multibody import Multibody
from vehicle_sim.world.sensors import ACCELEROMETER_RANGE
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

Pose = tuple[tuple[float, float, float], tuple[float, float, float, float]]
"""Position and x-first quaternion in the engine's frame."""
Uavs = Sequence[tuple[tuple[float, ...], ...]]
"""States of the UAVs: position, attitude, four that are not used, velocity, angular velocity."""


class Readings:
    """What the engine gave after the last two steps: its velocities are half a step older than its poses.

    Attributes:
        payload: pose of the payload's principal axes, in the engine's frame.
        uavs: states of the UAVs, in the engine's frame.
        states: the true states of payload and UAVs (N + 1, 13) as in :mod:`.state_kernels`; to be read only.
        loads: on payload and UAVs (N + 1, 6) as in :mod:`.state_kernels`, that the next step lacks. They hold while
            nothing but the links acts on a part by contact; to be used at once.
    """

    def __init__(self, client: int, system: Multibody, parameters: SystemParameters, physics_step: float) -> None:
        """Read the state now; ``physics_step`` in s."""
        self._system, self._client = system, client
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
        self.update()
        self.restart()

    def restart(self) -> None:
        """Take the velocities as the engine has them: no step has led here, or one with contact.

        An impact is no acceleration by which velocities could be brought forward.
        """
        self._free_steps = 0
        links = pybullet.getLinkStates(self._system.body, self._system.links, 1, 1, self._client)
        for row, (_, turn, _, _, _, _, _, w) in zip(self._memory[1:], links, strict=True):
            axis = upward_axis(turn)
            row[AXIS:] = *axis, np.dot(axis, w)
        self._evaluate()

    def update(self) -> None:
        """Read the state after a step.

        Forward kinematics is requested: without it links are one step behind the payload, and so are the frames in
        which the engine takes the next forces. Hence after every step, whether the state is read or not.
        """
        body, client = self._system.body, self._client
        self.uavs: Uavs = pybullet.getLinkStates(body, self._system.uavs, 1, 1, client)
        self.payload: Pose = pybullet.getBasePositionAndOrientation(body, client)
        velocity, rates = pybullet.getBaseVelocity(body, client)
        self._now, self._before = self._before, self._now
        position, attitude = self.payload
        numbers = [*position, *attitude, *velocity, *rates]
        for place, turn, _, _, _, _, v, w in self.uavs:
            numbers += (*place, *turn, *v, *w)
        self._pack(self._now.data, 0, *numbers)
        self._free_steps += 1
        self._evaluate()

    def clipped(self) -> list[int]:
        """Return whose specific force exceeded the accelerometer's range in the last step: 0 the payload's, 1 .. N."""
        hz = round(1.0 / self._physics_step)
        changes = (self._now[:, 7:10] - self._before[:, 7:10]).tolist()
        forces = [math.hypot(x * hz, y * hz, z * hz + self._gravity) for x, y, z in changes]
        return [i for i, force in enumerate(forces) if force > ACCELEROMETER_RANGE]

    def link_tensions(self, thrusts: Sequence[float], external: Sequence[Sequence[float]] | None) -> list[float]:
        """Return the tension of each link in the last step (N) (N), see :mod:`.link_force_kernels`.

        ``thrusts`` N numbers (N) and ``external`` N triples (N, NED; None: none) of that step.
        """
        forces = np.zeros((len(thrusts), 3)) if external is None else np.array(external, dtype=float)
        tensions: Array = link_tensions(
            self._now, self._before, self._parts, np.array(thrusts, dtype=float), forces, self._gravity,
            self._physics_step,
        )  # fmt: skip
        return list(tensions.tolist())

    def set_payload_moments(self, moments: Sequence[float]) -> None:
        """Set the payload's principal moments of inertia (3,) (kg m2), from the next reading on."""
        self._parts[0, :3] = moments

    def _evaluate(self) -> None:
        self.states = np.empty((len(self._now), STATE_COLUMNS))
        states_from_engine(
            self._now, self._parts, self._payload_in_axes, self._physics_step, self._free_steps,
            self._memory, self.states, self.loads,
        )  # fmt: skip
