"""Obstacles of the mission file as shapes in the world, for the ground that knows them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gcs.mission.model import Pole, Sphere, Wall
from idc_controller.barrier.obstacles import Shape

Array = NDArray[np.float64]


def shape_of(obstacle: Sphere | Pole | Wall) -> Shape:
    """Its shape about its centre."""
    if isinstance(obstacle, Sphere):
        return Shape("sphere", obstacle.radius)
    if isinstance(obstacle, Pole):
        return Shape("pole", obstacle.radius, (0.0, 0.0, obstacle.height))
    return Shape("wall", 0.0, obstacle.size, math.radians(obstacle.yaw_deg))


def centre_of(obstacle: Sphere | Pole | Wall) -> Array:
    """Where the mission file puts its centre (3,) (NED, m)."""
    if isinstance(obstacle, Pole):
        return np.array([*obstacle.position, -obstacle.height / 2.0])
    return np.array(obstacle.position, dtype=float)
