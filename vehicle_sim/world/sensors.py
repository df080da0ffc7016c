"""Navigation sensors of vehicles and payload: the truth with white noise on every channel."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np

from gcs.config.tables import SensorsConfig
from idc_controller.arrays import Array
from vehicle_sim.world.errors import SimulationError
from vehicle_sim.world.state_kernels import STATE_COLUMNS, measure

#: The payload's navigation unit draws from the generator of this id; vehicles count from 1.
PAYLOAD_UNIT = 0

ACCELEROMETER_RANGE = 8.0 * 9.80665
"""m/s2: full scale of the accelerometers of payload and vehicles, one of those that IMUs offer (8 g).

The engine stops a part within one step: a contact of more than about 0.2 m/s exceeds it.
"""

_BLOCK = 256
_CHANNELS = 12
_FAR = 1e6
_FLOAT32 = 3e38
NORM_ERROR_MAX = 0.1
"""Largest difference from 1 of the norm of a quaternion that is taken for an attitude."""


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

    @classmethod
    def of_row(cls, time: float, row: list[float]) -> Self:
        """Return the sample whose numbers stand in a ``row`` of 13, as in :mod:`.state_kernels`."""
        x, y, z, q_w, q_x, q_y, q_z, v_x, v_y, v_z, p, q, r = row
        return cls(time, (q_w, q_x, q_y, q_z), (p, q, r), (x, y, z), (v_x, v_y, v_z))

    def as_row(self) -> list[float]:
        """Return the inverse of :meth:`of_row`."""
        return [*self.position, *self.attitude, *self.velocity, *self.rates]

    def is_usable(self) -> bool:
        """Return True if every number is finite and of a size that could be sent, and the attitude is a rotation."""
        total = sum(self.attitude) + sum(self.rates) + sum(self.position) + sum(self.velocity)
        return _is_number(total) and math.isfinite(self.time) and is_rotation(self.attitude)

    def is_encodable(self) -> bool:
        """Return whether every number fits a float of 32 bits: usable or not, NaN and infinity included."""
        if -_FAR < sum(self.attitude) + sum(self.rates) + sum(self.position) + sum(self.velocity) < _FAR:
            return True
        numbers = (*self.attitude, *self.rates, *self.position, *self.velocity)
        return all(abs(x) < _FLOAT32 or x != x or math.isinf(x) for x in numbers)


def is_rotation(attitude: tuple[float, float, float, float]) -> bool:
    """Return True if a quaternion has about the norm 1: not where it is zero or holds no numbers."""
    return abs(math.hypot(*attitude) - 1.0) < NORM_ERROR_MAX


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


def vehicle_noise(noise: SensorsConfig) -> SensorNoise:
    """Return the noise of the sensors of each vehicle."""
    return SensorNoise(noise.position, math.radians(noise.attitude_deg), noise.uav_velocity, noise.uav_rates)


class NavigationSensors:
    """Add noise to the truth; the same seed and id give the same noise, different ids independent noise.

    ``samples`` (M, 13): the newest, rows of states as in :mod:`.state_kernels`.
    """

    def __init__(self, noises: Sequence[SensorNoise], seed: int, sensor_ids: Sequence[int]) -> None:
        """``sensor_ids``: the vehicles' system ids and :data:`PAYLOAD_UNIT`, one for each of the ``noises``."""
        self._sigmas = np.array([(n.position, n.attitude, n.velocity, n.rates) for n in noises])
        self.samples = np.full((len(noises), STATE_COLUMNS), np.nan)
        self._normals = _normals([np.random.default_rng([seed, sensor_id]) for sensor_id in sensor_ids])

    def measure(self, states: Array) -> Array:
        """Return the ``samples``, now those of the true ``states`` (M, 13)."""
        measure(states, self._sigmas, next(self._normals), self.samples)
        return self.samples


def _normals(generators: Sequence[np.random.Generator]) -> Iterator[Array]:
    """Standard normal numbers (M, 12), a row from each generator. Drawn in blocks: single calls cost more."""
    while True:
        yield from np.stack([generator.standard_normal((_BLOCK, _CHANNELS)) for generator in generators], axis=1)
