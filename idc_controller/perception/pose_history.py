"""Poses of the vehicles over the last second, measured and estimated, by which their scans are placed."""

from collections import deque
from typing import TypeVar

import numpy as np

from idc_controller.arrays import Array
from idc_controller.estimation.measurements import Attitude, Measurement, Position
from idc_controller.perception.settings import ScanSettings
from idc_controller.rotations import quaternion_product

_Pose = TypeVar("_Pose", Attitude, Position)


class _Samples:
    def __init__(self, length: int) -> None:
        self._length = length
        self.attitudes: dict[int, deque[Attitude]] = {}
        self.positions: dict[int, deque[Position]] = {}

    def add(self, sample: Measurement) -> None:
        if isinstance(sample, Attitude):
            self.attitudes.setdefault(sample.source, deque(maxlen=self._length)).append(sample)
        else:
            self.positions.setdefault(sample.source, deque(maxlen=self._length)).append(sample)


class PoseHistory:
    """Positions and attitudes of the vehicles. Times are the team's (s)."""

    def __init__(self, settings: ScanSettings) -> None:
        self._gap = settings.pose_gap
        self._measured, self._estimated = _Samples(settings.poses), _Samples(settings.poses)

    def add_measured(self, sample: Measurement) -> None:
        """Add a measured position or attitude of a vehicle; those of the payload are passed over."""
        if sample.source >= 0 and sample.has_pose:
            self._measured.add(sample)

    def add_estimated(self, sample: Measurement) -> None:
        """Add an estimated position or attitude of a vehicle."""
        self._estimated.add(sample)

    @property
    def uavs(self) -> tuple[int, ...]:
        """Vehicles (0 .. N-1) with a measured position."""
        return tuple(self._measured.positions)

    def position(self, uav: int, time: float, within: float) -> Array | None:
        """Return the last measured position (3,) (NED, m), None if it is not ``within`` that time of ``time`` (s)."""
        history = self._measured.positions.get(uav)
        if not history or not abs(time - history[-1].time) <= within:
            return None
        return history[-1].position

    def pose(
        self, uav: int, time: float, estimated_position: bool, estimated_attitude: bool
    ) -> tuple[Array, Array] | None:
        """Return position (3,) (NED, m) and quaternion (4,) at ``time``, from the samples next to it.

        ``estimated_position`` and ``estimated_attitude``: take the estimated ones instead of the measured ones.
        """
        measured, estimated = self._measured, self._estimated
        attitudes, positions = estimated.attitudes.get(uav), estimated.positions.get(uav)
        attitude = self._nearest(attitudes if estimated_attitude else measured.attitudes.get(uav), time)
        position = self._nearest(positions if estimated_position else measured.positions.get(uav), time)
        if attitude is None or position is None:
            return None
        turning = attitude if attitude.has_motion else self._nearest(attitudes, time)
        moving = position if position.has_motion else self._nearest(positions, time)
        quaternion, place = attitude.quaternion, position.position
        if turning is not None and abs(dt := time - attitude.time) > 1e-4:
            quaternion = quaternion_product(quaternion, np.append(1.0, 0.5 * dt * turning.rates))
            quaternion = quaternion / np.linalg.norm(quaternion)
        if moving is not None:
            place = place + (time - position.time) * moving.velocity
        return place, quaternion

    def _nearest(self, history: deque[_Pose] | None, time: float) -> _Pose | None:
        if not history:
            return None
        found = history[-1]
        for sample in reversed(history):
            if abs(sample.time - time) > abs(found.time - time):
                break
            found = sample
        return found if abs(found.time - time) <= self._gap else None
