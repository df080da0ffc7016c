"""The pole: an upright cylinder that stands on the ground."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.shape import LENGTH, CollisionGeometry, PlanView, RoundedBox, Shape, UprightBounds, Vector

if TYPE_CHECKING:
    import coal

#: A sensor's rays at the side: share of the radius to the right; share of the visible length up (1) or down (-1).
_SIDE = ((0.8, 0.0), (-0.8, 0.0), (0.5, 1.0), (-0.5, -1.0), (-0.85, 0.6), (0.85, -0.6), (-0.3, 1.0), (0.3, -1.0))
_RIM = 0.95  # of the radius, for points on the end


@dataclass(frozen=True)
class Pole(Shape):
    """An upright cylinder of ``radius`` and ``height`` (m) about its middle."""

    radius: float = field(metadata=LENGTH)
    height: float = field(metadata=LENGTH)

    kind: ClassVar[str] = "pole"
    round_axes: ClassVar[Vector | None] = (1.0, 1.0, 0.0)
    is_upright: ClassVar[bool] = True
    is_grounded: ClassVar[bool] = True

    @property
    def dimensions(self) -> str:
        """Sizes in words."""
        return f"radius {self.radius:.4g} m, {self.height:g} m high"

    def geometry(self) -> coal.ShapeBase:
        """Return the shape for distance queries."""
        import coal

        return coal.Cylinder(self.radius, self.height)

    def collision(self) -> CollisionGeometry:
        """Return the shape for a physics engine."""
        return CollisionGeometry("cylinder", {"radius": self.radius, "height": self.height})

    def support(self, directions: Array) -> Array:
        """Largest ``direction . y`` over the body, for unit ``directions`` (..., 3) -> (...)."""
        lateral = np.hypot(directions[..., 0], directions[..., 1])
        return np.asarray(self.radius * lateral + self.height / 2.0 * np.abs(directions[..., 2]))

    @property
    def rounded_box(self) -> RoundedBox:
        """The body: a vertical line rounded horizontally."""
        return RoundedBox(0.0, 0.0, self.height / 2.0, radial=self.radius)

    @property
    def upright_bounds(self) -> UprightBounds:
        """The body: a vertical line rounded horizontally."""
        return UprightBounds(0.0, 0.0, self.height / 2.0, self.radius, 0.0, 1.0, 0.0)

    @property
    def plan_view(self) -> PlanView:
        """A circle."""
        import shapely

        return PlanView(shapely.Point(0.0, 0.0), self.radius)

    def visible_points(self, sensor: Vector, reach: float, turn: float) -> list[Vector]:
        """Points of the surface that a range sensor hits: the side up and down, and the end if it faces the sensor."""
        radius, half_height = self.radius, self.height / 2.0
        x, y, z = sensor
        distance = math.hypot(x, y)
        points: list[Vector] = []
        if distance > radius:
            e = (-x / distance, -y / distance)

            def side(share: float, along: float) -> Vector | None:
                sine = share * radius / distance
                cosine = math.sqrt(1.0 - sine * sine)
                flat = distance * cosine - radius * math.sqrt(1.0 - share * share)
                if flat > reach:
                    return None
                extent = math.sqrt(reach * reach - flat * flat)
                top, bottom = max(-half_height, z - extent), min(half_height, z + extent)
                if top > bottom:
                    return None
                nearest = min(max(z, top), bottom)
                level = nearest + along * ((top if along > 0.0 else bottom) - nearest) * math.copysign(1.0, along)
                ray = (cosine * e[0] - sine * e[1], cosine * e[1] + sine * e[0])
                return x + flat * ray[0], y + flat * ray[1], level

            points += [p for p in (side(0.0, 0.0), *(side(*place) for place in _SIDE)) if p is not None]
        if abs(z) > half_height:  # the end is visible, too
            end = math.copysign(half_height, z)
            inward = min(1.0, _RIM * radius / distance) if distance > 0.0 else 0.0
            ends = [(x * inward, y * inward, end)]
            for k in range(4):
                bearing = math.pi / 4.0 + k * math.pi / 2.0
                ends.append((_RIM * radius * math.cos(bearing), _RIM * radius * math.sin(bearing), end))
            points = points + ends if distance > radius else ends
        return points
