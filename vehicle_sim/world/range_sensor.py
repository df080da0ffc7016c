"""The range sensor of a vehicle: a lidar that measures, on each ray of a known pattern, the first surface.

It reports points, not which obstacle they belong to. Obstacles hide what is behind them; the vehicles, payload and
links of the team neither hide anything nor are measured: returns of its own bodies are masked, and rays that meet them
are few. The vehicle leaves out what is low above the ground by its own estimate of its pose, be that right or wrong.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from gcs.config import RangeSensorConfig
from idc_controller.arrays import Array, Indices
from idc_controller.geometry.shape import ROW, Shape
from idc_controller.perception.range_sensors import RayPattern, scan_index
from idc_controller.rotations_float import Quaternion, Vector
from vehicle_sim.world.ray_cast_kernels import first_hits, measured_returns
from vehicle_sim.world.sensors import Measurement


class RayBodies(NamedTuple):
    """Arrays as :func:`vehicle_sim.world.ray_cast_kernels.first_hits` takes them."""

    centres: Array
    """NED (B, 3) (m)."""
    rows: Array
    """:attr:`idc_controller.geometry.shape.Shape.row` of each (B, 14)."""
    bounds: Array
    """Radius of the ball, and of the upright cylinder, that holds each (B, 2) (m)."""
    planes: Array
    """Faces of bodies without a row: outward normals in world axes, distances from the centre (P, 4) (m)."""
    starts: Indices
    """Row of the first plane of each body, then P (B + 1,)."""

    @classmethod
    def of(cls, bodies: Iterable[tuple[Shape, Vector]]) -> RayBodies:
        """Return shapes with their centres (NED, m)."""
        none = cls(np.empty((0, 3)), np.empty((0, ROW)), np.empty((0, 2)), np.empty((0, 4)), np.zeros(1, np.int64))
        for shape, centre in bodies:
            none = none.and_body(shape, centre)
        return none

    def and_body(self, shape: Shape, centre: Vector) -> RayBodies:
        """Return these bodies and one more at ``centre`` (NED, m)."""
        planes = np.empty((0, 4))
        if shape.rounded_box is None:
            normals, distances = shape.planes
            planes = np.column_stack([normals @ shape.rotation.T, distances])
        return RayBodies(
            np.vstack([self.centres, centre]),
            np.vstack([self.rows, shape.row]),
            np.vstack([self.bounds, (shape.reach, shape.horizontal_reach)]),
            np.vstack([self.planes, planes]),
            np.append(self.starts, self.starts[-1] + len(planes)),
        )


#: Distinguishes these generators from the navigation sensors'.
_STREAM = 1_000_003
_NO_POSE = np.full(7, math.nan)


class RangeSample(NamedTuple):
    """All returns of one scan at ``time`` (s); the sensor's largest and least distance (m).

    And whether the sensor works, as far as the vehicle knows, and has sent the scan.
    """

    time: float
    reach: float
    points: Array
    """Places in the body frame, forward-right-down (n, 3) (m), in the order of the rays."""
    works: bool = True
    range_min: float = RangeSensorConfig.range_min
    is_sent: bool = True


class RangeSensor:
    """The same seed and id give the same noise, whatever is in view; different ids independent noise."""

    def __init__(self, settings: RangeSensorConfig, seed: int, system_id: int) -> None:
        self._settings = s = settings
        self._generator = np.random.default_rng([seed, _STREAM, system_id])
        self._pattern = RayPattern(s.rays, math.radians(s.elevation_min_deg), math.radians(s.elevation_max_deg))
        self._limits = np.array([s.range_min, s.missed_share, s.ground_height])

    def scan(
        self,
        now: float,
        stamp: int,
        position: Sequence[float],
        attitude: Quaternion,
        estimate: Measurement | None,
        bodies: RayBodies,
    ) -> RangeSample:
        """Return the scan at ``now`` (s).

        Args:
            now: time (s).
            stamp: the same by the clock of the vehicle (ms), which says which rays there are.
            position, attitude: true pose of the sensor (NED, m; body to world).
            estimate: of the vehicle's pose, its own, by which the ground is left out; None: it has none yet.
            bodies: all that can be hit beside the ground.
        """
        s, generator = self._settings, self._generator
        directions = self._pattern.directions(scan_index(stamp, s.rate))
        errors, chances = s.noise * generator.standard_normal(s.rays), generator.random(s.rays)
        distances = first_hits(directions, np.array([*position, *attitude], dtype=float), s.range, *bodies)
        own = _NO_POSE if estimate is None else np.array([*estimate.position, *estimate.attitude], dtype=float)
        points = measured_returns(directions, distances, errors, chances, own, self._limits)
        return RangeSample(now, s.range, points, range_min=s.range_min)
