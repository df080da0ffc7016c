"""Navigation sensors of vehicles and payload: the truth with white noise on every channel."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from vehicle_sim.world.errors import SimulationError

#: The payload's navigation unit draws from the generator of this id; vehicles count from 1.
PAYLOAD_UNIT = 0

_BLOCK = 4096
_FAR = 1e6
_FLOAT32 = 3e38


class Measurement(NamedTuple):
    """One sample of a navigation sensor.

    ``time`` of the measurement (s); ``attitude`` unit quaternion body to world, w first; ``rates`` in the body frame
    (rad/s); ``position`` (m) and ``velocity`` (m/s) in the world, north-east-down from home's ground point.
    """

    time: float
    attitude: tuple[float, float, float, float]
    rates: tuple[float, float, float]
    position: tuple[float, float, float]
    velocity: tuple[float, float, float]

    def is_usable(self) -> bool:
        """Return True if every number is finite and of a size that could be sent."""
        total = sum(self.attitude) + sum(self.rates) + sum(self.position) + sum(self.velocity)
        return _is_number(total) and math.isfinite(self.time)

    def is_encodable(self) -> bool:
        """Return whether every number fits a float of 32 bits: usable or not, NaN and infinity included."""
        if -_FAR < sum(self.attitude) + sum(self.rates) + sum(self.position) + sum(self.velocity) < _FAR:
            return True
        numbers = (*self.attitude, *self.rates, *self.position, *self.velocity)
        return all(abs(x) < _FLOAT32 or x != x or math.isinf(x) for x in numbers)


def _is_number(total: float) -> bool:
    return -_FAR < total < _FAR


class ReportedState(NamedTuple):
    """The state that a vehicle reports: attitude and rates of one measurement, position and velocity of another.

    None: not reported.
    """

    attitude: Measurement | None
    position: Measurement | None


@dataclass(frozen=True)
class SensorNoise:
    """Standard deviations of the white noise on each axis: m, rad, m/s, rad/s. Zero is allowed."""

    position: float = 0.0
    attitude: float = 0.0
    velocity: float = 0.0
    rates: float = 0.0

    def __post_init__(self) -> None:
        for name in ("position", "attitude", "velocity", "rates"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                raise SimulationError(f"noise of {name} must be zero or more, got {value}")


class NavigationSensor:
    """Adds noise to the truth; the same seed and id give the same noise, different ids independent noise."""

    def __init__(self, noise: SensorNoise, seed: int, sensor_id: int) -> None:
        """``sensor_id``: the vehicle's system id, or :data:`PAYLOAD_UNIT`."""
        self._noise = noise
        self._normals = _normals(np.random.default_rng([seed, sensor_id]))

    def measure(
        self,
        now: float,
        attitude: Sequence[float],
        rates: Sequence[float],
        position: Sequence[float],
        velocity: Sequence[float],
    ) -> Measurement:
        """Return a sample of the truth at ``now`` (s); arguments as in :class:`Measurement`, numpy rows or tuples."""
        n = self._normals
        noise = self._noise
        w, x, y, z = attitude
        half = 0.5 * noise.attitude
        # A small rotation in the body frame, on the right of the attitude.
        a, b, c = half * next(n), half * next(n), half * next(n)
        scale = 1.0 / math.sqrt((1.0 + a * a + b * b + c * c) * (w * w + x * x + y * y + z * z))
        s = noise.rates
        p = noise.position
        v = noise.velocity
        # float(): the rows may come from numpy, whose scalars would make everything after them slow.
        return Measurement(
            now,
            (
                float(scale * (w - x * a - y * b - z * c)),
                float(scale * (x + w * a + y * c - z * b)),
                float(scale * (y + w * b + z * a - x * c)),
                float(scale * (z + w * c + x * b - y * a)),
            ),
            (float(rates[0] + s * next(n)), float(rates[1] + s * next(n)), float(rates[2] + s * next(n))),
            (
                float(position[0] + p * next(n)),
                float(position[1] + p * next(n)),
                float(position[2] + p * next(n)),
            ),
            (
                float(velocity[0] + v * next(n)),
                float(velocity[1] + v * next(n)),
                float(velocity[2] + v * next(n)),
            ),
        )


def _normals(generator: np.random.Generator) -> Iterator[float]:
    """Standard normal numbers as plain floats. Drawn in blocks: a call for each would cost more than its use."""
    while True:
        yield from generator.standard_normal(_BLOCK).tolist()
