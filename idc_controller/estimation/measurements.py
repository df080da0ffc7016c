"""Measurements of each UAV and of the payload: a pose and its motion, with their time of validity.

A pose or a motion that was not measured, or may not be used, is all nan.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from idc_controller.arrays import Array

PAYLOAD = -1
"""``source`` of measurements of the payload's navigation unit; UAVs are 0 .. N-1."""


@dataclass(frozen=True, eq=False)
class Attitude:
    """Attitude and body rates of a UAV or of the payload."""

    time: float
    """Time of validity (s)."""
    source: int
    """UAV index or :data:`PAYLOAD`."""
    quaternion: Array
    """Body to world, w first (4,)."""
    rates: Array
    """Body frame (3,) (rad/s)."""

    @property
    def has_pose(self) -> bool:
        """Whether the attitude was measured."""
        return not math.isnan(self.quaternion[0])

    @property
    def has_motion(self) -> bool:
        """Whether the rates were measured."""
        return not math.isnan(self.rates[0])

    @property
    def pose(self) -> Array:
        """:attr:`quaternion`."""
        return self.quaternion

    @property
    def motion(self) -> Array:
        """:attr:`rates`."""
        return self.rates

    def same_values(self, other: object) -> bool:
        """Return whether ``other`` is of the same kind and has the same values to the digit."""
        if not isinstance(other, Attitude):
            return False
        return _same(self.quaternion, other.quaternion) and _same(self.rates, other.rates)

    def without(self, pose: bool, motion: bool) -> Attitude:
        """Return a copy with the attitude (``pose``) or the rates (``motion``) marked as not measured."""
        quaternion, rates = _masked(pose, self.quaternion), _masked(motion, self.rates)
        return Attitude(self.time, self.source, quaternion, rates)


@dataclass(frozen=True, eq=False)
class Position:
    """Position and velocity of a UAV or of the payload's centre."""

    time: float
    """Time of validity (s)."""
    source: int
    """UAV index or :data:`PAYLOAD`."""
    position: Array
    """World, NED (3,) (m)."""
    velocity: Array
    """World, NED (3,) (m/s)."""

    @property
    def has_pose(self) -> bool:
        """Whether the position was measured."""
        return not math.isnan(self.position[0])

    @property
    def has_motion(self) -> bool:
        """Whether the velocity was measured."""
        return not math.isnan(self.velocity[0])

    @property
    def pose(self) -> Array:
        """:attr:`position`."""
        return self.position

    @property
    def motion(self) -> Array:
        """:attr:`velocity`."""
        return self.velocity

    def same_values(self, other: object) -> bool:
        """Return whether ``other`` is of the same kind and has the same values to the digit."""
        if not isinstance(other, Position):
            return False
        return _same(self.position, other.position) and _same(self.velocity, other.velocity)

    def without(self, pose: bool, motion: bool) -> Position:
        """Return a copy with the position (``pose``) or the velocity (``motion``) marked as not measured."""
        return Position(self.time, self.source, _masked(pose, self.position), _masked(motion, self.velocity))


Measurement = Attitude | Position
SensorKey = tuple[int, type[Measurement]]
"""Source and kind of a measurement."""


def median_of(copies: Sequence[Measurement]) -> Measurement:
    """Return the median of relayed copies of one measurement: right where few of them are corrupted."""
    first = copies[0]
    if all(copy.same_values(first) for copy in copies[1:]):
        return first
    whole = [copy for copy in copies if copy.has_pose and copy.has_motion] or copies
    pose, motion = (np.median([getattr(copy, name) for copy in whole], axis=0) for name in ("pose", "motion"))
    return type(first)(first.time, first.source, pose, motion)


def _same(a: Array, b: Array) -> bool:
    return bool((a == b).all()) or bool(np.array_equal(a, b, equal_nan=True))


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
