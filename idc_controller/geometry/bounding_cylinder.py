"""The formation's upright bounds about the payload's centre."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from idc_controller.errors import TrajectoryError
from idc_controller.parameters import SystemParameters


@dataclass(frozen=True)
class BoundingCylinder:
    """The upright cylinder that holds payload, links and discs, about the payload's centre (m).

    In plan view they lie within a rectangle with rounded corners as well, its edges north and east.
    """

    radius: float
    above: float
    """Height of the highest disc above the payload's centre."""
    below: float
    """Depth of the payload's lowest point below its centre."""
    core: tuple[float, float] = (0.0, 0.0)
    """Half edges of that rectangle, north and east, without its rounding."""
    rounding: float = math.inf
    """Distance from the core to its edge; infinite: only the cylinder counts."""

    def __post_init__(self) -> None:
        for name in ("radius", "above", "below"):
            if not (math.isfinite(getattr(self, name)) and getattr(self, name) >= 0.0):
                raise TrajectoryError(f"the formation's {name} must be zero or more, not {getattr(self, name)}")

    @classmethod
    def of(cls, parameters: SystemParameters, link_tilt: float = 0.0) -> BoundingCylinder:
        """Return that of the formation at rest, its links tilted together by up to ``link_tilt`` (rad)."""
        swing = parameters.l * math.sin(link_tilt)
        reach = np.linalg.norm(parameters.p[:, :2], axis=1) + swing
        top = parameters.l - parameters.p[:, 2] + parameters.disc_radius * math.sin(link_tilt)
        radius = max(parameters.payload.horizontal_reach, float(reach.max()) + parameters.disc_radius)
        rounding = float(swing.max()) + parameters.disc_radius
        payload = np.abs(parameters.payload.bounds[:, :2]).max(axis=0) - rounding
        north, east = np.maximum(np.abs(parameters.p[:, :2]).max(axis=0), payload).tolist()
        return cls(radius, float(top.max()), parameters.payload.below, (north, east), rounding)
