"""What the engine says after each step, and the true states that follow from it."""

import struct
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pybullet

from idc_controller.arrays import Array
from idc_controller.rotations_float import Vector
from vehicle_sim.world.ground import Pose
from vehicle_sim.world.multibody import Multibody
from vehicle_sim.world.state_kernels import READING_COLUMNS, STATE_COLUMNS, states_from_engine


class Reading(NamedTuple):
    """State of the engine after a step, in its own frames: pose and velocities of the payload, states of the UAVs.

    The payload's attitude is that of its principal axes.
    """

    payload: Pose
    payload_velocity: tuple[Vector, Vector]
    uavs: Sequence[tuple[tuple[float, ...], ...]]


def _numbers(now: Reading, before: Reading) -> list[float]:
    """Return the rows of payload and UAVs for :func:`.states_from_engine`, one after the other."""
    numbers = [*now.payload[0], *now.payload[1]]
    for numbers_of_payload in (*now.payload_velocity, *before.payload_velocity):
        numbers += numbers_of_payload
    for uav, earlier in zip(now.uavs, before.uavs, strict=True):
        position, attitude, _, _, _, _, velocity, rates = uav
        numbers += position
        numbers += attitude
        numbers += velocity
        numbers += rates
        numbers += earlier[6]
        numbers += earlier[7]
    return numbers


class Readings:
    """The readings after the last two steps, ``before`` and ``now``."""

    def __init__(self, client: int, system: Multibody) -> None:
        self._client = client
        self._system = system
        rows = len(system.uavs) + 1
        self._payload_in_axes = np.array(system.payload_in_axes)
        self._rows = np.empty((rows, READING_COLUMNS))
        # A third of the time that an assignment of lists takes.
        self._pack = struct.Struct(f"{self._rows.size}d").pack_into
        self.now = self.before = self._read()

    def update(self) -> None:
        """Read the state after a step."""
        self.before, self.now = self.now, self._read()

    def states(self) -> Array:
        """Return the true states of payload and UAVs now, (N + 1, 13) as in :mod:`.state_kernels`."""
        self._pack(self._rows.data, 0, *_numbers(self.now, self.before))
        states = np.empty((len(self._rows), STATE_COLUMNS))
        states_from_engine(self._rows, self._payload_in_axes, states)
        return states

    def _read(self) -> Reading:
        """Fetch poses and velocities from the engine.

        Forward kinematics is requested: without it links are one step behind the payload, and so are the frames in
        which the engine takes the next forces. Hence after every step, whether the state is read or not.
        """
        body, client = self._system.body, self._client
        return Reading(
            pybullet.getBasePositionAndOrientation(body, client),
            pybullet.getBaseVelocity(body, client),
            pybullet.getLinkStates(body, self._system.uavs, 1, 1, client),
        )
