"""Measurements of each UAV and of the payload, poses and their motions with a time of validity; the estimate from them.

A pose or a motion that was not measured, or may not be used, is all nan.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np

from idc_controller.arrays import Array, Indices, Mask

PAYLOAD = -1
"""``source`` of measurements of the payload's navigation unit; UAVs are 0 .. N-1."""


@dataclass(eq=False, slots=True)  # not frozen: its __init__ would take three times as long
class _Sample:
    time: float
    """Time of validity (s)."""
    source: int
    """UAV index or :data:`PAYLOAD`."""
    pose: Array
    motion: Array

    @property
    def has_pose(self) -> bool:
        """Return whether the pose was measured."""
        return not math.isnan(self.pose.item(0))

    @property
    def has_motion(self) -> bool:
        """Return whether the motion was measured."""
        return not math.isnan(self.motion.item(0))

    def same_values(self, other: object) -> bool:
        """Return whether ``other`` is of the same kind and has the same values to the digit."""
        return type(other) is type(self) and _same(self.pose, other.pose) and _same(self.motion, other.motion)

    @property
    def finite(self) -> Self:
        """Return it with a pose or a motion that is not finite marked as not measured."""
        pose, motion = sum(self.pose.tolist()), sum(self.motion.tolist())
        if math.isfinite(pose + motion):
            return self
        return self.without(not math.isfinite(pose), not math.isfinite(motion))

    def without(self, pose: bool, motion: bool) -> Self:
        """Return a copy with the ``pose`` or the ``motion`` marked as not measured."""
        return type(self)(self.time, self.source, _masked(pose, self.pose), _masked(motion, self.motion))


class Attitude(_Sample):
    """Attitude and body rates of a UAV or of the payload.

    ``pose``: quaternion body to world, w first (4,); ``motion``: rates in the body frame (3,) (rad/s).
    """

    __slots__ = ()


class Position(_Sample):
    """Position and velocity of a UAV or of the payload's centre.

    ``pose``: position (3,) (m); ``motion``: velocity (3,) (m/s); world, NED.
    """

    __slots__ = ()


Measurement = Attitude | Position
SensorKey = tuple[int, type[Measurement]]
"""Source and kind of a measurement."""


class Channel(NamedTuple):
    """Pose (``part`` 0) or motion (1) of one kind of measurement of one source."""

    source: int
    kind: type[Measurement]
    part: int

    @property
    def name(self) -> str:
        """position, velocity, attitude or rates."""
        return (("position", "velocity") if self.kind is Position else ("attitude", "rates"))[self.part]


class SensorGroup(NamedTuple):
    """One kind of measurement, of the payload unit or of all vehicles."""

    of_payload: bool
    kind: type[Measurement]


class SampleStack(NamedTuple):
    """Measurements of one moment, one after the other."""

    times: Array
    """(K,) (s)"""
    sources: Indices
    """UAV (K,), or :data:`PAYLOAD`."""
    is_position: Mask
    """Whether each is a position; else it is an attitude (K,)."""
    values: Array
    """Poses and motions, each part whole or all nan."""


class VehicleStates(NamedTuple):
    """Estimated states of all UAVs at one time."""

    time: float
    """s"""
    values: Array
    """Position, velocity, quaternion (body to world, w first) and body rates (N, 13), NED, SI."""

    def sample(self, uav: int, kind: type[Measurement]) -> Measurement:
        """Return what a perfect sensor of a ``kind`` would measure on a UAV (0 .. N-1)."""
        state = self.values[uav]
        if kind is Position:
            return Position(self.time, uav, state[0:3], state[3:6])
        return Attitude(self.time, uav, state[6:10], state[10:13])


def median_of(copies: Sequence[Measurement]) -> Measurement:
    """Return the median of relayed copies of one measurement: right where few of them are corrupted."""
    first = copies[0]
    if len(copies) == 1:
        return first
    pose, motion = first.pose.tolist(), first.motion.tolist()
    for copy in copies[1:]:
        if (copy.pose.tolist() != pose or copy.motion.tolist() != motion) and not copy.same_values(first):
            break
    else:
        return first
    whole = [copy for copy in copies if copy.has_pose and copy.has_motion] or copies
    pose, motion = (np.median([getattr(copy, name) for copy in whole], axis=0) for name in ("pose", "motion"))
    return type(first)(first.time, first.source, pose, motion)


def _same(a: Array, b: Array) -> bool:
    """Return whether values are the same, nan where nan."""
    first, second = a.tolist(), b.tolist()
    return first == second or all(x == y or (x != x and y != y) for x, y in zip(first, second, strict=True))


def _masked(masked: bool, values: Array) -> Array:
    return np.full(len(values), np.nan) if masked else values


@dataclass(frozen=True)
class MeasurementNoise:
    """Standard deviations of the white noise on each channel (m, rad, m/s, rad/s)."""

    position: float = 0.02
    attitude: float = float(np.radians(0.2))
    uav_velocity: float = 0.02
    uav_rates: float = 0.005
    payload_velocity: float = 0.008
    payload_rates: float = 0.008


class InnovationRecord(NamedTuple):
    """Innovation test of the measurements of one moment."""

    time: float
    """s"""
    normalised_squared: float
    """y' S^-1 y of the accepted rows; on average ``degrees_of_freedom``."""
    degrees_of_freedom: int
    rejected: tuple[SensorKey, ...]
    """Sources and kinds that failed the test."""
    covariance_reset: bool
    """Most sources disagreed with the prediction, or it was no number: its covariance was reset."""
    keys: tuple[SensorKey, ...]
    """Sources and kinds of all measurements (K,)."""
    sizes: Indices
    """Rows of each (K,); they add up to m."""
    normalised: Array
    """Innovations, one measurement after the other, normalised to variance 1 (m,)."""
    test_ratios: Array
    """Normalised innovations squared of pose and motion over their gates (K, 2); above 1: rejected, nan: not tested."""


class Estimate(NamedTuple):
    """State at one moment. ``x`` (12 + 11 N,) in the linear model's coordinates, absolute."""

    time: float
    """s"""
    x: Array
    force: Array
    """Disturbance force on the payload (3,) (N, NED)."""
    uav_force: Array
    """Level disturbance force on each UAV (N, 3) (N, NED)."""
    mass_excess: float
    """Payload mass less nominal (kg)."""
    force_covariance: Array
    """Of the force on the payload (3, 3) (N2)."""
    predict_covariance: Callable[[], Array]
    """Predicts :attr:`covariance`."""
    innovations: tuple[InnovationRecord, ...] = ()
    """Innovations applied since the last estimate, in order of time; those replayed come again."""
    predict_payload_variances: Callable[[], Array] = lambda: np.full(12, np.nan)
    """Predicts the variances of the payload's position, velocity, attitude (Euler angles) and rates (12,) squared."""
    age: float = 0.0
    """Of the newest measurement at that time (s)."""

    @property
    def covariance(self) -> Array:
        """Covariance of x, forces (3 + 2 N) and mass excess (12 + 13 N + 4,) squared; predicted at each access."""
        return self.predict_covariance()
