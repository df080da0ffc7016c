"""Consistency of poses with their own motion: positions with velocities, attitudes with body rates.

The innovation test goes by what most sources measure. Positions that are wrong for one common reason (a base station
that drifts, say) agree with each other and would bias the estimate. So would the payload's only unit, which is right
when it persists after a blow. Yet each of them contradicts its own motion, whatever the others measure.
"""

from collections import deque

import numpy as np

from idc_controller.arrays import Array
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Measurement, Position, SensorGroup, SensorKey
from idc_controller.estimation.settings import DeadReckoningSettings
from idc_controller.rotations import quaternion_product

_MEDIAN_EFFICIENCY = 1.2533  # standard deviation of a median of n, times sqrt(n), over that of one sample
_FROM_STEPS = 1.4826 / 2.0**0.5  # standard deviation of a sample over the median step from one to the next


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


class _IntegratedVelocity:
    """Path (m) by velocities."""

    def __init__(self) -> None:
        self._path = np.zeros(3)

    def advance(self, duration: float, motion: Array) -> None:
        """Integrate a ``motion`` (3,) over a ``duration`` (s)."""
        self._path = self._path + duration * motion

    def difference(self, pose: Array) -> Array:
        """Return ``pose`` less the integral (3,), which is constant but for noise."""
        return np.asarray(pose - self._path)


class _IntegratedRates:
    """Attitude by body rates from the quaternion ``begin`` (4,)."""

    def __init__(self, begin: Array) -> None:
        self._attitude = begin

    def advance(self, duration: float, motion: Array) -> None:
        turned = quaternion_product(self._attitude, np.append(1.0, 0.5 * duration * motion))
        self._attitude = turned / np.linalg.norm(turned)

    def difference(self, pose: Array) -> Array:
        """Return a rotation vector in the world (rad), as long as it is small."""
        rest = quaternion_product(pose, self._attitude * [1.0, -1.0, -1.0, -1.0])
        return np.asarray(2.0 * rest[1:] * (1.0 if rest[0] >= 0.0 else -1.0))


class _SourceCheck:
    """Pose of one source less its integrated motion, over the window."""

    def __init__(self, first: Measurement, settings: DeadReckoningSettings) -> None:
        self.test_ratio = 0.0
        """Difference of pose and integrated motion over what is allowed."""
        self._settings = s = settings
        is_position = isinstance(first, Position)
        self._integral = _IntegratedVelocity() if is_position else _IntegratedRates(first.pose)
        self._error = s.position_error if is_position else s.attitude_error
        self._inconsistent = 0
        self._recent: deque[Measurement] = deque(maxlen=s.smoothed)
        self._motion: Array | None = None
        self._differences: deque[tuple[float, Array]] = deque()
        self._untested = 0

    def add(self, measurement: Measurement) -> None:
        """Take a measurement that has pose and motion."""
        recent, s = self._recent, self._settings
        if recent and (measurement.time <= recent[-1].time or measurement.same_values(recent[-1])):
            return  # a relay of the same sample by a vehicle whose clock is off brings nothing new
        if recent and measurement.time - recent[-1].time > s.gap:
            recent.clear()
            self._differences.clear()
            self._motion = None
        recent.append(measurement)
        if len(recent) == s.smoothed:
            self._integrate(recent[s.smoothed // 2 - 1].time, recent[s.smoothed // 2])
        while self._differences and measurement.time - self._differences[0][0] > s.window:
            self._differences.popleft()
        self._untested += 1
        if self._untested >= s.samples // 2:
            self._untested = 0
            self.test_ratio = self._ratio() if len(self._differences) > 2 * s.samples else 0.0
            self._inconsistent = self._inconsistent + 1 if self.test_ratio > 1.0 else 0

    @property
    def is_inconsistent(self) -> bool:
        """Return whether several tests in a row failed: enough for a source that has no others beside it."""
        return self._inconsistent >= self._settings.consecutive

    def _integrate(self, before: float, measurement: Measurement) -> None:
        """Continue the integral from the time ``before`` to that of ``measurement``."""
        motion = _median(np.array([near.motion for near in self._recent]))
        if self._motion is not None:
            self._integral.advance(measurement.time - before, 0.5 * (self._motion + motion))
        self._motion = motion
        self._differences.append((measurement.time, self._integral.difference(measurement.pose)))

    def _ratio(self) -> float:
        n = self._settings.samples
        values = np.array([value for _, value in self._differences])
        moved = np.abs(_median(values[-n:]) - _median(values[:n]))
        sigma = _FROM_STEPS * _median(np.abs(np.diff(values, axis=0)))
        of_medians = _MEDIAN_EFFICIENCY / n**0.5 * 2.0**0.5
        return float((moved / (self._error + self._settings.sigmas * of_medians * sigma)).max())


def _median(values: Array) -> Array:
    """Return the median over the rows of finite ``values`` (K, n) -> (n,); ``np.median`` takes four times as long."""
    ordered, half = np.sort(values, axis=0), len(values) // 2
    return np.asarray(ordered[half] if len(values) % 2 else (ordered[half - 1] + ordered[half]) / 2.0)
