"""What the estimator tells: the state at one moment, and how well measurements have agreed with it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Estimate:
    """The state at one moment. ``x`` (12 + 11 N,) in the linear model's coordinates, absolute."""

    time: float
    x: Array
    force: Array
    """Steady force on the payload (3,) (N, NED)."""
    uav_force: Array
    """Steady level force on each of the UAVs (N, 3) (N, NED)."""
    mass_excess: float
    """Payload mass less nominal (kg)."""
    covariance: Array
    """Of x, forces (3 + 2 N) and mass excess (12 + 13 N + 4,) squared."""


@dataclass(frozen=True, eq=False)
class InnovationRecord:
    """How well the measurements of one moment agreed with the prediction."""

    time: float
    normalised_squared: float
    """y' S^-1 y of what was accepted; on average ``degrees_of_freedom``."""
    degrees_of_freedom: int
    rejected: tuple[tuple[int, str], ...]
    """Source and kind of what the gate kept out."""
    surprised: bool = False
    """Most sources disagreed at once, and the prediction was given up for them."""
    keys: tuple[tuple[int, type], ...] = ()
    """Source and kind of all that was measured (K,)."""
    white: tuple[Array, ...] = ()
    """The innovation of each with variance 1 (m,)."""
