"""Consistency of poses with their own motion: positions with velocities, attitudes with body rates.

The innovation test goes by what most sources measure. Positions that are wrong for one common reason (a base station
that drifts, say) agree with each other and would bias the estimate. So would the payload's only unit, which is right
when it persists after a blow. Yet each of them contradicts its own motion, whatever the others measure.
"""

from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from idc_controller.estimation.health.dead_reckoning_kernels import drift_ratio
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Measurement, Position, SensorGroup, SensorKey
from idc_controller.estimation.settings import DeadReckoningSettings
from idc_controller.rotations_float import Quaternion, Vector, turned


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
        self._path: Vector = (0.0, 0.0, 0.0)

    def advance(self, duration: float, motion: Vector) -> None:
        """Integrate a ``motion`` over a ``duration`` (s)."""
        (x, y, z), (u, v, w) = self._path, motion
        self._path = x + duration * u, y + duration * v, z + duration * w

    def difference(self, pose: Sequence[float]) -> Vector:
        """Return ``pose`` less the integral, which is constant but for noise."""
        (x, y, z), (a, b, c) = self._path, pose
        return a - x, b - y, c - z


class _IntegratedRates:
    """Attitude by body rates from the quaternion ``begin``."""

    def __init__(self, begin: Quaternion) -> None:
        self._attitude = begin

    def advance(self, duration: float, motion: Vector) -> None:
        self._attitude = turned(self._attitude, motion, duration)

    def difference(self, pose: Sequence[float]) -> Vector:
        """Return a rotation vector in the world (rad), as long as it is small."""
        (w, x, y, z), (a, b, c, d) = self._attitude, pose
        twice = 2.0 if a * w + b * x + c * y + d * z >= 0.0 else -2.0
        return (
            twice * (b * w - a * x - c * z + d * y),
            twice * (c * w - a * y - d * x + b * z),
            twice * (d * w - a * z - b * y + c * x),
        )


class _Sample(NamedTuple):
    time: float
    pose: list[float]
    motion: list[float]


class _SourceCheck:
    """Pose of one source less its integrated motion, over the window."""

    def __init__(self, first: Measurement, settings: DeadReckoningSettings) -> None:
        self.test_ratio = 0.0
        """Difference of pose and integrated motion over what is allowed."""
        self._settings = s = settings
        is_position = isinstance(first, Position)
        self._integral = _IntegratedVelocity() if is_position else _IntegratedRates(tuple(first.pose.tolist()))
        self._error = s.position_error if is_position else s.attitude_error
        self._inconsistent = 0
        self._recent: deque[_Sample] = deque(maxlen=s.smoothed)
        self._motion: Vector | None = None
        self._differences: deque[tuple[float, Vector]] = deque()
        self._untested = 0

    def add(self, measurement: Measurement) -> None:
        """Take a measurement that has pose and motion."""
        recent, s = self._recent, self._settings
        sample = _Sample(measurement.time, measurement.pose.tolist(), measurement.motion.tolist())
        if recent and (sample.time <= recent[-1].time or sample[1:] == recent[-1][1:]):
            return  # a relay of the same sample by a vehicle whose clock is off brings nothing new
        if recent and sample.time - recent[-1].time > s.gap:
            recent.clear()
            self._differences.clear()
            self._motion = None
        recent.append(sample)
        if len(recent) == s.smoothed:
            self._integrate(recent[s.smoothed // 2 - 1].time, recent[s.smoothed // 2])
        while self._differences and sample.time - self._differences[0][0] > s.window:
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

    def _integrate(self, before: float, sample: _Sample) -> None:
        """Continue the integral from the time ``before`` to that of ``sample``."""
        u, v, w = (_median(axis) for axis in zip(*(near.motion for near in self._recent), strict=True))
        if self._motion is not None:
            a, b, c = self._motion
            self._integral.advance(sample.time - before, (0.5 * (a + u), 0.5 * (b + v), 0.5 * (c + w)))
        self._motion = u, v, w
        self._differences.append((sample.time, self._integral.difference(sample.pose)))

    def _ratio(self) -> float:
        s, differences = self._settings, np.array([difference for _, difference in self._differences])
        return drift_ratio(differences, s.samples, self._error, s.sigmas)


def _median(values: Sequence[float]) -> float:
    """Return the median of finite ``values``."""
    ordered, half = sorted(values), len(values) // 2
    return ordered[half] if len(values) % 2 else (ordered[half - 1] + ordered[half]) / 2.0
