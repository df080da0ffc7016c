"""Motions that bring an obstacle to a given place at a given time."""

import math
from collections.abc import Callable

import numpy as np

from gcs.mission.motion import AnyMotion, CircleMotion, HarmonicMotion, LinearMotion, RandomWalkMotion, WaypointsMotion
from idc_controller.arrays import Array

Random = np.random.Generator

SLOWEST = 0.4  # m/s
STOP_AND_GO_SPEEDS, STOP_AND_GO_ACCELERATIONS, STOP_AND_GO_HOLDS = (1.5, 3.0), (2.0, 5.0), (0.2, 1.2)
"""Of what stops and goes: m/s, m/s2, s."""
FLIGHT = np.arange(0.0, 120.0, 0.05)
"""Times (s) at which a motion is sampled."""


def motion_for(kind: str, random: Random, time: float, travel: Array, fastest: float) -> AnyMotion:
    """Return a motion of ``kind`` at up to ``fastest`` (m/s) that is under way at ``time`` (s).

    ``travel`` (3,) is the direction in which the payload goes then: half of what moves straight confronts it head-on
    within 30 degrees, the rest comes from anywhere.
    """
    return _MAKERS[kind](random, time, travel, fastest)


def displacement(motion: AnyMotion, times: Array) -> Array:
    """Return the displacement (K, 3) (m) at ``times`` (K,) (s)."""
    move = motion.mover()
    return np.array([move(time) for time in times.tolist()])


def top_speed(motion: AnyMotion) -> float:
    """Return the highest speed of a motion over a flight (m/s)."""
    step = float(FLIGHT[1])
    return float(np.linalg.norm(np.diff(displacement(motion, FLIGHT), axis=0), axis=1).max()) / step


def _against(random: Random, travel: Array) -> tuple[float, float, float]:
    """Return a level direction to move in."""
    if random.random() < 0.5 and np.hypot(*travel[:2]) > 0.1:
        angle = math.atan2(-travel[1], -travel[0]) + math.radians(random.uniform(-30.0, 30.0))
    else:
        angle = random.uniform(-math.pi, math.pi)
    return math.cos(angle), math.sin(angle), 0.0


def _linear(random: Random, time: float, travel: Array, fastest: float) -> AnyMotion:
    speed = _speed(random, fastest)
    x, y, _ = _against(random, travel)
    return LinearMotion(_rounded(speed * x, speed * y, 0.0))


def _harmonic(random: Random, time: float, travel: Array, fastest: float) -> AnyMotion:
    """Return a harmonic motion that is at its mean position, and fastest, at the time."""
    speed, length = _speed(random, fastest), random.uniform(0.8, 2.5)
    x, y, z = _against(random, travel)
    if random.random() < 0.2:
        x, y, z = 0.0, 0.0, 1.0
    rate = round(speed / length, 4)
    phase = math.remainder(-rate * time, math.tau)
    return HarmonicMotion(_rounded(length * x, length * y, length * z), rate, round(phase, 4))


def _circle(random: Random, time: float, travel: Array, fastest: float) -> AnyMotion:
    speed, radius = _speed(random, fastest), round(random.uniform(0.8, 2.5), 3)
    phase = round(random.uniform(0.0, math.tau), 4)
    return CircleMotion(radius, _below(speed / radius), phase, bool(random.random() < 0.5))


def _waypoints(random: Random, time: float, travel: Array, fastest: float) -> AnyMotion:
    """Return a motion to and fro with stops, at high accelerations."""
    speed = _below(_speed(random, fastest))
    acceleration = max(0.8, random.uniform(0.2, 0.5) * fastest**2)  # so that it does reach its speed
    corners = [_rounded(x, y, 0.0) for x, y in random.uniform(-2.5, 2.5, (random.integers(2, 5), 2)).tolist()]
    return WaypointsMotion(
        tuple(corners), speed, round(random.uniform(0.0, 2.0), 2), round(acceleration, 2), repeat=True
    )


def stop_and_go(random: Random, time: float, travel: Array) -> WaypointsMotion:
    """Return a motion to and fro across ``travel`` that starts and stops hard, at full speed near the origin then."""
    speed, acceleration = random.uniform(*STOP_AND_GO_SPEEDS), random.uniform(*STOP_AND_GO_ACCELERATIONS)
    x, y, _ = _against(random, travel)
    # Long enough for the speed to be reached.
    length = speed**2 / acceleration + random.uniform(0.3, 2.5)
    corners = [(-0.5 * length, 0.0), (0.5 * length, 0.0)]
    if random.random() < 0.5:
        corners.append((random.uniform(-0.5, 0.5) * length, random.uniform(1.5, 3.0)))
    points = tuple(_rounded(u * x - v * y, u * y + v * x, 0.0) for u, v in corners)
    hold = round(random.uniform(*STOP_AND_GO_HOLDS), 2)
    return WaypointsMotion(points, round(speed, 3), hold, round(acceleration, 2), repeat=True)


def _random_walk(random: Random, time: float, travel: Array, fastest: float) -> AnyMotion:
    seed, bandwidth = int(random.integers(2**31)), round(random.uniform(0.8, 2.0), 3)
    shares = random.uniform(0.3, 1.0, 3) * [1.0, 1.0, 0.4]
    trial = RandomWalkMotion(seed, _rounded(*shares), bandwidth)
    # Scaled to the speed that it shall reach in the flight.
    scale = _speed(random, fastest) / top_speed(trial)
    x, y, z = (_below(scale * share) for share in trial.speed)
    return RandomWalkMotion(seed, (x, y, z), bandwidth)


def _speed(random: Random, fastest: float) -> float:
    return float(random.uniform(SLOWEST, 0.999 * fastest))  # rounding must not take it beyond


def _rounded(x: float, y: float, z: float) -> tuple[float, float, float]:
    return round(float(x), 4), round(float(y), 4), round(float(z), 4)


def _below(value: float) -> float:
    """Rounded down."""
    return math.floor(value * 1e4) / 1e4


_MAKERS: dict[str, Callable[[Random, float, Array, float], AnyMotion]] = {
    "linear": _linear,
    "harmonic": _harmonic,
    "circle": _circle,
    "waypoints": _waypoints,
    "random_walk": _random_walk,
}
MOTIONS = tuple(_MAKERS)
