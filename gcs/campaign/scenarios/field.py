"""A field of many standing obstacles about a figure eight, none of them in its way."""

import math
from pathlib import Path

import numpy as np

from gcs.campaign.toml_text import mission_text
from gcs.config import SystemConfig
from gcs.errors import GcsError
from gcs.mission.model import Limits, Lissajous, Mission, Obstacle
from gcs.planning.schedule import Schedule
from idc_controller.geometry.free_space import BoundingCylinder, FreeSpace
from idc_controller.geometry.shape import Shape
from idc_controller.geometry.shapes import Pole, Sphere

FIELD = "field"
AMPLITUDE, ANGULAR_FREQUENCY, ALTITUDE = (6.0, 3.0), 0.5, 3.0
"""Of the figure eight (m, rad/s, m)."""
LAP = 2.0 * math.pi / ANGULAR_FREQUENCY
"""s, in which it is flown once."""
AREA = (14.0, 11.0)
"""Half edges north and east (m)."""
CLEARANCE = 1.6
"""Least clearance of the formation along the undisturbed path (m): no obstacle needs to be avoided."""
APART = 0.2
"""m between two obstacles in plan view, at least."""
SPHERES, POLES = (0.2, 0.5), (0.15, 0.45)
"""Radii (m)."""
ALTITUDES, HEIGHTS = (1.0, 6.5), (4.0, 12.0)
"""Of the middles of spheres, and of poles (m)."""
MOST = 300
MOST_REJECTED = 300
"""Places in succession at which an obstacle cannot stand."""


def figure(duration: float) -> Lissajous:
    """Return the figure eight, flown for ``duration`` (s)."""
    return Lissajous(AMPLITUDE, ANGULAR_FREQUENCY, ALTITUDE, duration)


def field(seed: int, count: int, known: bool, system: SystemConfig) -> list[Obstacle]:
    """Return ``count`` obstacles about the figure eight, spheres and poles in turn, all on the map or none.

    Raises :class:`GcsError` where there is no place for as many.
    """
    random = np.random.default_rng([seed, count])
    path = Schedule(Mission("", Path(), 1, system, figure(LAP))).positions[::10]
    formation = BoundingCylinder.of(system.parameters())
    obstacles: list[Obstacle] = []
    taken = np.empty((0, 3))  # north, east, radius
    rejected = 0  # in succession
    while len(obstacles) < count:
        if rejected == MOST_REJECTED:
            raise GcsError(f"{count} obstacles: no place for more than {len(obstacles)}")
        rejected += 1
        kind = len(obstacles) % 2
        shape: Shape
        if kind:
            shape = Pole(_uniform(random, *POLES), _uniform(random, *HEIGHTS))
            altitude = shape.height / 2.0
        else:
            shape, altitude = Sphere(_uniform(random, *SPHERES)), _uniform(random, *ALTITUDES)
        north, east = (_uniform(random, -edge, edge) for edge in AREA)
        apart = np.hypot(taken[:, 0] - north, taken[:, 1] - east) - taken[:, 2] - shape.radius
        place = (north, east, -altitude)
        if apart.min(initial=math.inf) < APART:
            continue
        if not FreeSpace([(shape, place)], formation, CLEARANCE, 0.0, 100.0).is_free(path).all():
            continue
        taken = np.vstack([taken, [north, east, shape.radius]])
        obstacles.append(Obstacle(f"obstacle {len(obstacles) + 1}", place, shape, known))
        rejected = 0
    return obstacles


def _uniform(random: np.random.Generator, low: float, high: float) -> float:
    return round(float(random.uniform(low, high)), 3)


def field_text(seed: int, count: int, known: bool, duration: float, system: SystemConfig) -> str:
    """Return the mission file of a field, past which the figure eight is flown for ``duration`` (s)."""
    return mission_text(FIELD, seed, figure(duration), field(seed, count, known, system), Limits(clearance=1.0))
