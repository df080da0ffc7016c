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
from vehicle_sim.world.state_kernels import STATE_COLUMNS, states_from_engine


class Reading(NamedTuple):
    """State of the engine after a step, in its own frames: pose and velocities of the payload, states of the UAVs.

    The payload's attitude is that of its principal axes.
    """

    payload: Pose
    payload_velocity: tuple[Vector, Vector]
    uavs: Sequence[tuple[tuple[float, ...], ...]]

    def velocities(self) -> list[float]:
        """Return velocities and angular velocities of payload and UAVs, six numbers each."""
        velocity, rates = self.payload_velocity
        numbers = [*velocity, *rates]
        for _, _, _, _, _, _, uav_velocity, uav_rates in self.uavs:
            numbers += uav_velocity
            numbers += uav_rates
        return numbers

    def poses_and_velocities(self) -> list[float]:
        """Return positions, attitudes, velocities and angular velocities of payload and UAVs, thirteen numbers each."""
        (position, attitude), (velocity, rates) = self.payload, self.payload_velocity
        numbers = [*position, *attitude, *velocity, *rates]
        for uav_position, uav_attitude, _, _, _, _, uav_velocity, uav_rates in self.uavs:
            numbers += uav_position
            numbers += uav_attitude
            numbers += uav_velocity
            numbers += uav_rates
        return numbers


class Readings:
    """The readings after the last two steps, ``before`` and ``now``."""

    def __init__(self, client: int, system: Multibody) -> None:
        self._client = client
        self._system = system
        rows = len(system.uavs) + 1
        self._payload_in_axes = np.array(system.payload_in_axes)
        self._poses_and_velocities, self._velocities = np.empty((rows, STATE_COLUMNS)), np.empty((rows, 6))
        # A third of the time that an assignment of lists takes.
        self._pack_poses_and_velocities = struct.Struct(f"{self._poses_and_velocities.size}d").pack_into
        self._pack_velocities = struct.Struct(f"{self._velocities.size}d").pack_into
        self.restart()

    def restart(self) -> None:
        """Take the engine's state to be the first."""
        self.now = self.before = self._read()

    def update(self) -> None:
        """Read the state after a step."""
        self.before, self.now = self.now, self._read()

    def states(self) -> Array:
        """Return the true states of payload and UAVs now, (N + 1, 13) as in :mod:`.state_kernels`."""
        self._pack_poses_and_velocities(self._poses_and_velocities.data, 0, *self.now.poses_and_velocities())
        self._pack_velocities(self._velocities.data, 0, *self.before.velocities())
        states = np.empty_like(self._poses_and_velocities)
        states_from_engine(self._poses_and_velocities, self._velocities, self._payload_in_axes, states)
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
