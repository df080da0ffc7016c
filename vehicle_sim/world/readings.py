"""What the engine says after each step, and the true states that follow from it."""

import struct
from collections.abc import Sequence

import numpy as np
import pybullet

from idc_controller.arrays import Array
from idc_controller.rotations_float import Vector
from vehicle_sim.world.ground import Pose
from vehicle_sim.world.multibody import Multibody
from vehicle_sim.world.state_kernels import READING_COLUMNS, STATE_COLUMNS, states_from_engine

Uavs = Sequence[tuple[tuple[float, ...], ...]]
"""States of the UAVs: position, attitude, four that are not used, velocity, angular velocity."""
_Velocity = tuple[Vector, Vector]


class Readings:
    """What the engine gives after a step, in its own frames, and its velocities of the step before."""

    def __init__(self, client: int, system: Multibody) -> None:
        self._body, self._links, self._client = system.body, system.uavs, client
        rows = len(system.uavs) + 1
        self._payload_in_axes = np.array(system.payload_in_axes)
        self._rows = np.empty((rows, READING_COLUMNS))
        # A third of the time that an assignment of lists takes.
        self._pack = struct.Struct(f"{self._rows.size}d").pack_into
        self.uavs: Uavs = ()
        self._velocity: _Velocity = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        self._before: tuple[_Velocity, Uavs] = self._velocity, self.uavs
        self._payload: Pose | None = None
        self._states: Array | None = None
        self.update()
        self._before = self._velocity, self.uavs

    def update(self) -> None:
        """Read the state after a step.

        Forward kinematics is requested: without it links are one step behind the payload, and so are the frames in
        which the engine takes the next forces. Hence after every step, whether the state is read or not.
        """
        self._before = self._velocity, self.uavs
        self.uavs = pybullet.getLinkStates(self._body, self._links, 1, 1, self._client)
        self._velocity = pybullet.getBaseVelocity(self._body, self._client)
        self._payload = self._states = None

    @property
    def payload(self) -> Pose:
        """Pose of the payload's principal axes, read where it is needed."""
        if self._payload is None:
            self._payload = pybullet.getBasePositionAndOrientation(self._body, self._client)
        return self._payload

    def velocity_changes(self) -> list[Vector]:
        """Return by how much the velocities of payload and UAVs (N + 1) changed in the last step (m/s, z up)."""
        (velocity, _), uavs = self._before
        now: list[Sequence[float]] = [self._velocity[0], *(uav[6] for uav in self.uavs)]
        before: list[Sequence[float]] = [velocity, *(uav[6] for uav in uavs)]
        return [(a - d, b - e, c - f) for (a, b, c), (d, e, f) in zip(now, before, strict=True)]

    def states(self) -> Array:
        """Return the true states of payload and UAVs now, (N + 1, 13) as in :mod:`.state_kernels`, to be read only."""
        if self._states is not None:
            return self._states
        position, attitude = self.payload
        (velocity, rates), ((velocity_before, rates_before), uavs_before) = self._velocity, self._before
        numbers = [*position, *attitude, *velocity, *rates, *velocity_before, *rates_before]
        for i, (place, turn, _, _, _, _, v, w) in enumerate(self.uavs):
            _, _, _, _, _, _, v_before, w_before = uavs_before[i]
            numbers += (*place, *turn, *v, *w, *v_before, *w_before)
        self._pack(self._rows.data, 0, *numbers)
        self._states = states = np.empty((len(self._rows), STATE_COLUMNS))
        states_from_engine(self._rows, self._payload_in_axes, states)
        return states
