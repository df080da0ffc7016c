"""Where a moving obstacle is: displacement from its position as a function of time since take-off."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable
from itertools import accumulate, pairwise

import numpy as np

from gcs.mission.model import (
    AnyMotion,
    CircleMotion,
    HarmonicMotion,
    LinearMotion,
    RandomWalkMotion,
    WaypointsMotion,
)

Displacement = tuple[float, float, float]

COMPONENTS = 12
"""Sines on each axis of a random walk."""
LOWEST = 0.2
"""Lowest angular frequency of a random walk over its bandwidth."""


def mover(motion: AnyMotion) -> Callable[[float], Displacement]:
    """Displacement (NED, m) at a time (s since the motion began), as a function made to be called often."""
    match motion:
        case HarmonicMotion():
            return _harmonic(motion)
        case LinearMotion():
            x, y, z = motion.velocity
            return lambda time: (x * time, y * time, z * time)
        case CircleMotion():
            return _circle(motion)
        case WaypointsMotion():
            return _waypoints(motion)
        case RandomWalkMotion():
            return _random_walk(motion)


def moves_vertically(motion: AnyMotion) -> bool:
    """Whether the obstacle ever leaves the level it begins at."""
    match motion:
        case HarmonicMotion(amplitude=vector) | LinearMotion(velocity=vector) | RandomWalkMotion(speed=vector):
            return vector[2] != 0.0
        case WaypointsMotion(points=points):
            return any(z != 0.0 for _, _, z in points)
    return False


def _harmonic(motion: HarmonicMotion) -> Callable[[float], Displacement]:
    x, y, z = motion.amplitude

    def displacement(time: float) -> Displacement:
        factor = math.sin(motion.angular_frequency * time + motion.phase)
        return factor * x, factor * y, factor * z

    return displacement


def _circle(motion: CircleMotion) -> Callable[[float], Displacement]:
    rate = motion.angular_frequency if motion.clockwise else -motion.angular_frequency

    def displacement(time: float) -> Displacement:
        angle = rate * time + motion.phase
        return motion.radius * math.cos(angle), motion.radius * math.sin(angle), 0.0

    return displacement


def _waypoints(motion: WaypointsMotion) -> Callable[[float], Displacement]:
    points = [*motion.points, motion.points[0]] if motion.repeat else list(motion.points)
    legs = list(pairwise(points))
    lengths = [math.dist(a, b) for a, b in legs]
    ends = list(accumulate(motion.hold + _duration(length, motion) for length in lengths))

    def displacement(time: float) -> Displacement:
        if motion.repeat:
            time %= ends[-1]
        number = bisect_right(ends, time)
        if number == len(legs):
            return points[-1]
        begun = ends[number - 1] if number else 0.0
        (x, y, z), (u, v, w) = legs[number]
        share = _travelled(max(time - begun - motion.hold, 0.0), lengths[number], motion) / lengths[number]
        return x + share * (u - x), y + share * (v - y), z + share * (w - z)

    return displacement


def _duration(length: float, motion: WaypointsMotion) -> float:
    if motion.acceleration is None:
        return length / motion.speed
    if length * motion.acceleration < motion.speed**2:
        return 2.0 * math.sqrt(length / motion.acceleration)
    return length / motion.speed + motion.speed / motion.acceleration


def _travelled(time: float, length: float, motion: WaypointsMotion) -> float:
    """m of a leg after ``time`` s on it."""
    duration = _duration(length, motion)
    if time >= duration:
        return length
    if motion.acceleration is None:
        return motion.speed * time
    ramp = min(motion.speed / motion.acceleration, duration / 2.0)
    if time < ramp:
        return motion.acceleration * time**2 / 2.0
    if time > duration - ramp:
        return length - motion.acceleration * (duration - time) ** 2 / 2.0
    return motion.acceleration * ramp * (time - ramp / 2.0)


def _random_walk(motion: RandomWalkMotion) -> Callable[[float], Displacement]:
    random = np.random.default_rng(motion.seed)
    frequencies = motion.bandwidth * random.uniform(LOWEST, 1.0, (3, COMPONENTS))
    phases = random.uniform(0.0, 2.0 * math.pi, (3, COMPONENTS))
    # A sine of velocity amplitude a has the variance a^2 / 2.
    amplitudes = np.array(motion.speed)[:, None] * math.sqrt(2.0 / COMPONENTS) / frequencies

    def displacement(time: float) -> Displacement:
        x, y, z = np.einsum("ij,ij->i", amplitudes, np.sin(frequencies * time + phases)).tolist()
        return x, y, z

    return displacement
