"""Consistency of poses with their own motion: positions with velocities, attitudes with body rates.

The innovation test goes by what most sources measure. Positions that are wrong for one common reason (a base station
that drifts, say) agree with each other and would bias the estimate. So would the payload's only unit, which is right
when it persists after a blow. Yet each of them contradicts its own motion, whatever the others measure.
"""

from collections import deque

import numpy as np

from idc_controller.arrays import Array
from idc_controller.estimation.health.dead_reckoning_kernels import drift_ratio, integrate
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Measurement, Position, SensorGroup, SensorKey
from idc_controller.estimation.settings import DeadReckoningSettings


class DeadReckoning:
    """Compares poses and motions of N UAVs and of the payload unit."""

    def __init__(self, number_of_uavs: int, settings: DeadReckoningSettings = DeadReckoningSettings()) -> None:
        self._number_of_uavs, self._settings = number_of_uavs, settings
        self._checks: dict[SensorKey, _SourceCheck] = {}

    def add(self, measurement: Measurement) -> None:
        """Take a pose with its motion; late ones, those that lack either, and vehicles' attitudes are passed over."""
        if isinstance(measurement, Attitude) and measurement.source != PAYLOAD:
            return
        if measurement.has_pose and measurement.has_motion:
            key = measurement.source, type(measurement)
            check = self._checks.get(key)
            if check is None:
                check = self._checks[key] = _SourceCheck(measurement, self._settings)
            check.add(measurement)

    def is_inconsistent(self, uav: int) -> bool:
        """Return whether the position of a UAV contradicts its velocity."""
        check = self._checks.get((uav, Position))
        return check is not None and check.test_ratio > 1.0

    @property
    def inconsistent_groups(self) -> tuple[SensorGroup, ...]:
        """Groups whose poses contradict their motions.

        Most vehicles' positions, while the payload unit's are consistent; or the other way round; or the payload
        unit's attitude.
        """
        ratios = [
            check.test_ratio for (source, kind), check in self._checks.items() if source != PAYLOAD and kind is Position
        ]
        consistent, most = self._settings.consistent_ratio, self._number_of_uavs
        position, attitude = (self._checks.get((PAYLOAD, kind)) for kind in (Position, Attitude))
        found = []
        if position is not None and position.test_ratio <= consistent and 2 * sum(r > 1.0 for r in ratios) > most:
            found.append(SensorGroup(False, Position))
        if position is not None and position.is_inconsistent and 2 * sum(r <= consistent for r in ratios) > most:
            found.append(SensorGroup(True, Position))
        if attitude is not None and attitude.is_inconsistent:
            found.append(SensorGroup(True, Attitude))
        return tuple(found)


class _Window:
    """Differences of poses and integrated motions, in order of time, each after its time (s)."""

    def __init__(self) -> None:
        self._rows, self._begin, self._end = np.empty((256, 4)), 0, 0

    def __len__(self) -> int:
        return self._end - self._begin

    @property
    def rows(self) -> Array:
        """All of them (K, 4)."""
        return self._rows[self._begin : self._end]

    def append(self, time: float) -> Array:
        """Append one of that time and return it (3,), to be filled."""
        if self._end == len(self._rows):
            kept = self.rows.copy()
            if 2 * len(kept) > len(self._rows):
                self._rows = np.empty((2 * len(self._rows), 4))
            self._rows[: len(kept)] = kept
            self._begin, self._end = 0, len(kept)
        row = self._rows[self._end]
        self._end += 1
        row[0] = time
        return np.asarray(row[1:])

    def forget(self, until: float) -> None:
        """Discard those before a time (s)."""
        while self._begin < self._end and self._rows[self._begin, 0] < until:
            self._begin += 1


class _SourceCheck:
    """Pose of one source less its integrated motion, over the window."""

    def __init__(self, first: Measurement, settings: DeadReckoningSettings) -> None:
        self.test_ratio = 0.0
        """Difference of pose and integrated motion over what is allowed."""
        self._settings = s = settings
        is_position = isinstance(first, Position)
        self._integral = np.zeros(3) if is_position else first.pose.copy()
        """Path (3,) (m) by velocities, or attitude (4,) by body rates."""
        self._error = s.position_error if is_position else s.attitude_error
        self._inconsistent = 0
        self._recent: deque[Measurement] = deque(maxlen=s.smoothed)
        self._motion = np.zeros(3)
        """Median of the recent ones."""
        self._window = _Window()
        self._untested = 0

    def add(self, measurement: Measurement) -> None:
        """Take a measurement that has pose and motion."""
        recent, s, time = self._recent, self._settings, measurement.time
        if recent and (time <= recent[-1].time or measurement.same_values(recent[-1])):
            return  # a relay of the same sample by a vehicle whose clock is off brings nothing new
        if recent and time - recent[-1].time > s.gap:
            recent.clear()
            self._window = _Window()
        recent.append(measurement)
        if len(recent) == s.smoothed:
            self._integrate(recent[s.smoothed // 2 - 1].time, recent[s.smoothed // 2])
        self._window.forget(time - s.window)
        self._untested += 1
        if self._untested >= s.samples // 2:
            self._untested = 0
            ratio = drift_ratio(self._window.rows, s.samples, self._error, s.sigmas) if self._is_filled else 0.0
            self.test_ratio = ratio
            self._inconsistent = self._inconsistent + 1 if ratio > 1.0 else 0

    @property
    def is_inconsistent(self) -> bool:
        """Return whether several tests in a row failed: enough for a source that has no others beside it."""
        return self._inconsistent >= self._settings.consecutive

    @property
    def _is_filled(self) -> bool:
        return len(self._window) > 2 * self._settings.samples

    def _integrate(self, before: float, measurement: Measurement) -> None:
        """Continue the integral from the time ``before`` to that of ``measurement``."""
        motions = np.array([near.motion for near in self._recent])
        duration = measurement.time - before if len(self._window) else 0.0
        difference = self._window.append(measurement.time)
        integrate(motions, self._motion, self._integral, duration, measurement.pose, difference)
