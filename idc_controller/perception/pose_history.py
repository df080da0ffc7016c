"""Poses of the vehicles over the last second, measured and estimated, by which their scans are placed."""

from collections import defaultdict, deque
from typing import TypeVar

import numpy as np

from idc_controller.arrays import Array
from idc_controller.estimation.measurements import Attitude, Measurement, Position, SensorKey, VehicleStates
from idc_controller.perception.settings import ScanSettings
from idc_controller.rotations_float import turned

Timed = TypeVar("Timed", Measurement, VehicleStates)


class PoseHistory:
    """Positions and attitudes of the vehicles. Times are the team's (s)."""

    def __init__(self, settings: ScanSettings) -> None:
        self._gap = settings.pose_gap
        self._measured = defaultdict[SensorKey, deque[Measurement]](lambda: deque(maxlen=settings.poses))
        self._estimated = deque[VehicleStates](maxlen=settings.poses)

    def add_measured(self, sample: Measurement) -> None:
        """Add a measured position or attitude of a vehicle; those of the payload are passed over."""
        if sample.source >= 0 and sample.has_pose:
            self._measured[sample.source, type(sample)].append(sample)

    def add_estimated(self, states: VehicleStates) -> None:
        """Add the estimated states of all vehicles."""
        self._estimated.append(states)

    @property
    def uavs(self) -> tuple[int, ...]:
        """Vehicles (0 .. N-1) with a measured position."""
        return tuple(source for source, kind in self._measured if kind is Position)

    def has_since(self, uav: int, time: float, count: int) -> bool:
        """Return whether the last ``count`` measured positions of a vehicle, or attitudes, are later than ``time`` (s).

        Not more are kept than :attr:`~idc_controller.perception.settings.ScanSettings.poses`.
        """
        histories = [self._measured.get((uav, kind), ()) for kind in (Position, Attitude)]
        return any(len(history) >= count and history[-count].time > time for history in histories)

    def last_pose(self, uav: int, time: float, within: float) -> tuple[Array, Array] | None:
        """Return the last measured position (3,) (NED, m) and quaternion (4,).

        None if one of them is not ``within`` that time of ``time`` (s).
        """
        histories = [self._measured.get((uav, kind)) for kind in (Position, Attitude)]
        last = [history[-1] for history in histories if history and abs(time - history[-1].time) <= within]
        return (last[0].pose, last[1].pose) if len(last) == len(histories) else None

    def pose(
        self, uav: int, time: float, estimated_position: bool, estimated_attitude: bool
    ) -> tuple[Array, Array] | None:
        """Return position (3,) (NED, m) and quaternion (4,) at ``time``, from the samples next to it.

        ``estimated_position`` and ``estimated_attitude``: take the estimated ones instead of the measured ones.
        """
        attitude = self._sample(uav, Attitude, time, estimated_attitude)
        position = self._sample(uav, Position, time, estimated_position)
        if attitude is None or position is None:
            return None
        turning = attitude if attitude.has_motion else self._sample(uav, Attitude, time, True)
        moving = position if position.has_motion else self._sample(uav, Position, time, True)
        quaternion, place = attitude.pose, position.pose
        if turning is not None and abs(dt := time - attitude.time) > 1e-4:
            (w, x, y, z), (p, q, r) = quaternion.tolist(), turning.motion.tolist()
            quaternion = np.array(turned((w, x, y, z), (p, q, r), dt))
        if moving is not None:
            place = place + (time - position.time) * moving.motion
        return place, quaternion

    def _sample(self, uav: int, kind: type[Measurement], time: float, estimated: bool) -> Measurement | None:
        if not estimated:
            return self._nearest(self._measured.get((uav, kind)), time)
        states = self._nearest(self._estimated, time)
        return None if states is None else states.sample(uav, kind)

    def _nearest(self, history: deque[Timed] | None, time: float) -> Timed | None:
        if not history:
            return None
        found = history[-1]
        for sample in reversed(history):
            if abs(sample.time - time) > abs(found.time - time):
                break
            found = sample
        return found if abs(found.time - time) <= self._gap else None
