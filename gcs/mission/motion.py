"""Motions of obstacles: displacement from the position as a function of the time since take-off."""

import math
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from itertools import accumulate, pairwise
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from gcs.config.tables import Vector
from gcs.config.validate import NotNegative, Positive, strict

Mover = Callable[[float], Vector]
"""Displacement (NED, m) at a time (s since the motion began)."""

COMPONENTS = 12
"""Sines on each axis of a random walk."""
LOWEST = 0.2
"""Lowest angular frequency of a random walk over its bandwidth."""


@strict
@dataclass(frozen=True)
class HarmonicMotion:
    """Displacement ``amplitude * sin(angular_frequency t + phase)`` (m, rad/s, rad)."""

    amplitude: Vector
    angular_frequency: Positive
    phase: float = 0.0
    kind: Literal["harmonic"] = "harmonic"

    @property
    def is_level(self) -> bool:
        """True if the obstacle stays at the altitude of its position."""
        return self.amplitude[2] == 0.0

    def mover(self) -> Mover:
        """Return the motion as a function made to be called often."""
        x, y, z = self.amplitude

        def displacement(time: float) -> Vector:
            factor = math.sin(self.angular_frequency * time + self.phase)
            return factor * x, factor * y, factor * z

        return displacement


@strict
@dataclass(frozen=True)
class LinearMotion:
    """Displacement ``velocity * t`` (m/s)."""

    velocity: Vector
    kind: Literal["linear"] = "linear"

    @property
    def is_level(self) -> bool:
        """See :class:`HarmonicMotion`."""
        return self.velocity[2] == 0.0

    def mover(self) -> Mover:
        """See :class:`HarmonicMotion`."""
        x, y, z = self.velocity
        return lambda time: (x * time, y * time, z * time)


@strict
@dataclass(frozen=True)
class CircleMotion:
    """A level circle about the position: ``radius`` (m), ``angular_frequency`` (rad/s).

    ``phase`` (rad) is the bearing from the position at time 0, from north towards east; ``clockwise`` as seen from
    above.
    """

    radius: Positive
    angular_frequency: Positive
    phase: float = 0.0
    clockwise: bool = True
    kind: Literal["circle"] = "circle"

    is_level = True

    def mover(self) -> Mover:
        """See :class:`HarmonicMotion`."""
        rate = self.angular_frequency if self.clockwise else -self.angular_frequency

        def displacement(time: float) -> Vector:
            angle = rate * time + self.phase
            return self.radius * math.cos(angle), self.radius * math.sin(angle), 0.0

        return displacement


@strict
@dataclass(frozen=True)
class WaypointsMotion:
    """Straight lines between displacements (``points``, m) at ``speed`` (m/s), with a stop of ``hold`` (s) at each.

    ``acceleration`` (m/s2) at every start and stop; None: at once. ``repeat``: from the last point on to the first;
    otherwise the obstacle stays at the last one.
    """

    points: Annotated[tuple[Vector, ...], Field(min_length=2, max_length=1000)]
    speed: Positive
    hold: NotNegative = 0.0
    acceleration: Positive | None = None
    repeat: bool = False
    kind: Literal["waypoints"] = "waypoints"

    @property
    def is_level(self) -> bool:
        """See :class:`HarmonicMotion`."""
        return all(z == 0.0 for _, _, z in self.points)

    @property
    def path(self) -> tuple[Vector, ...]:
        """The points in the order of the motion, the first one again at the end of a lap."""
        return (*self.points, self.points[0]) if self.repeat else self.points

    def mover(self) -> Mover:
        """See :class:`HarmonicMotion`."""
        points = self.path
        legs = list(pairwise(points))
        lengths = [math.dist(a, b) for a, b in legs]
        ends = list(accumulate(self.hold + self._duration(length) for length in lengths))

        def displacement(time: float) -> Vector:
            if self.repeat:
                time %= ends[-1]
            number = bisect_right(ends, time)
            if number == len(legs):
                return points[-1]
            begun = ends[number - 1] if number else 0.0
            (x, y, z), (u, v, w) = legs[number]
            share = self._travelled(max(time - begun - self.hold, 0.0), lengths[number]) / lengths[number]
            return x + share * (u - x), y + share * (v - y), z + share * (w - z)

        return displacement

    def _duration(self, length: float) -> float:
        if self.acceleration is None:
            return length / self.speed
        if length * self.acceleration < self.speed**2:
            return 2.0 * math.sqrt(length / self.acceleration)
        return length / self.speed + self.speed / self.acceleration

    def _travelled(self, time: float, length: float) -> float:
        """Return the distance (m) covered ``time`` s after the start of a leg."""
        duration = self._duration(length)
        if time >= duration:
            return length
        if self.acceleration is None:
            return self.speed * time
        ramp = min(self.speed / self.acceleration, duration / 2.0)
        if time < ramp:
            return self.acceleration * time**2 / 2.0
        if time > duration - ramp:
            return length - self.acceleration * (duration - time) ** 2 / 2.0
        return self.acceleration * ramp * (time - ramp / 2.0)


@strict
@dataclass(frozen=True)
class RandomWalkMotion:
    """Random walk about the position: on each axis band-limited noise of the acceleration, repeatable by ``seed``.

    ``speed`` is the standard deviation of the velocity on each axis (m/s), ``bandwidth`` the highest angular
    frequency (rad/s); the lowest is a fifth of it, which keeps the obstacle about its position.
    """

    seed: Annotated[int, Field(ge=0, lt=2**63)]
    speed: tuple[NotNegative, NotNegative, NotNegative]
    bandwidth: Positive
    kind: Literal["random_walk"] = "random_walk"

    @property
    def is_level(self) -> bool:
        """See :class:`HarmonicMotion`."""
        return self.speed[2] == 0.0

    def mover(self) -> Mover:
        """See :class:`HarmonicMotion`."""
        random = np.random.default_rng(self.seed)
        frequencies = self.bandwidth * random.uniform(LOWEST, 1.0, (3, COMPONENTS))
        phases = random.uniform(0.0, 2.0 * math.pi, (3, COMPONENTS))
        # A sine of velocity amplitude a has the variance a^2 / 2.
        amplitudes = np.array(self.speed)[:, None] * math.sqrt(2.0 / COMPONENTS) / frequencies

        def displacement(time: float) -> Vector:
            x, y, z = np.einsum("ij,ij->i", amplitudes, np.sin(frequencies * time + phases)).tolist()
            return x, y, z

        return displacement


AnyMotion = HarmonicMotion | LinearMotion | CircleMotion | WaypointsMotion | RandomWalkMotion
Motion = Annotated[AnyMotion, Field(discriminator="kind")]
