"""The sphere."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.shape import LENGTH, CollisionGeometry, PlanView, RoundedBox, Shape, UprightBounds, Vector

if TYPE_CHECKING:
    import coal

#: Off-axis positions of a sensor's rays: share of the radius; six of them, turned by a random angle.
_RING = (0.9, 0.6, 0.9, 0.6, 0.9, 0.6)


@dataclass(frozen=True)
class Sphere(Shape):
    """A ball of ``radius`` (m)."""

    radius: float = field(metadata=LENGTH)

    kind: ClassVar[str] = "sphere"
    round_axes: ClassVar[Vector | None] = (1.0, 1.0, 1.0)

    @property
    def dimensions(self) -> str:
        """Sizes in words."""
        return f"radius {self.radius:g} m"

    def geometry(self) -> coal.ShapeBase:
        """Return the shape for distance queries."""
        import coal

        return coal.Sphere(self.radius)

    def collision(self) -> CollisionGeometry:
        """Return the shape for a physics engine."""
        return CollisionGeometry("sphere", {"radius": self.radius})

    def support(self, directions: Array) -> Array:
        """Largest ``direction . y`` over the body, for unit ``directions`` (..., 3) -> (...)."""
        return np.full(directions.shape[:-1], self.radius)

    @property
    def rounded_box(self) -> RoundedBox:
        """The body: a point rounded in all directions."""
        return RoundedBox(0.0, 0.0, 0.0, ball=self.radius)

    @property
    def upright_bounds(self) -> UprightBounds:
        """The body: a point rounded in all directions."""
        return UprightBounds(0.0, 0.0, 0.0, 0.0, self.radius, 1.0, 0.0)

    @property
    def plan_view(self) -> PlanView:
        """A circle."""
        import shapely

        return PlanView(shapely.Point(0.0, 0.0), self.radius)

    def visible_points(self, sensor: Vector, reach: float, turn: float) -> list[Vector]:
        """Points of the surface that a range sensor hits; the ring of rays is turned by ``turn`` (rad)."""
        s, radius = sensor, self.radius
        distance = math.hypot(*s)
        if distance <= radius:
            return []
        e = (-s[0] / distance, -s[1] / distance, -s[2] / distance)
        # Two directions across the line of sight.
        i = min(range(3), key=lambda k: abs(e[k]))
        a = [-e[i] * e[k] for k in range(3)]
        a[i] += 1.0
        norm = math.hypot(*a)
        a = [value / norm for value in a]
        b = (e[1] * a[2] - e[2] * a[1], e[2] * a[0] - e[0] * a[2], e[0] * a[1] - e[1] * a[0])
        points = [_along(s, e, distance - radius)]
        for k, share in enumerate(_RING):
            sine = share * radius / distance
            cosine = math.sqrt(1.0 - sine * sine)
            bearing = turn + k * math.pi / 3.0
            across, up = sine * math.cos(bearing), sine * math.sin(bearing)
            ray = (
                cosine * e[0] + across * a[0] + up * b[0],
                cosine * e[1] + across * a[1] + up * b[1],
                cosine * e[2] + across * a[2] + up * b[2],
            )
            points.append(_along(s, ray, distance * cosine - radius * math.sqrt(1.0 - share * share)))
        return points


def _along(s: Vector, direction: Vector, distance: float) -> Vector:
    return s[0] + distance * direction[0], s[1] + distance * direction[1], s[2] + distance * direction[2]
