"""Obstacles that move before the range sensors of a team that hovers, and what the obstacle map says of them."""

import copy
import math
from dataclasses import dataclass, field
from functools import cache

import numpy as np
from obstacle_scene import HERE, Scene, box, map_of, outside, pole, run, sphere, wall

from idc_controller.geometry.shapes import Pole, Sphere

#: From here on there is the obstacle; before, the space in view is seen free.
BEGIN = 2.0
RANGE = 9.5
HORIZONS = (0.0, 1.0, 2.0)
BEHIND = wall((9.6, 0.0, -6.0), (0.3, 16.0, 8.0), 0.0, "behind")


#: When what stops and goes starts again (s).
SECOND_START = 3.0


def stop_and_go(t):
    """Distance: 1.5 m/s for 1.5 s, standing for 1.5 s, and so on."""
    return 2.25 * (t // SECOND_START) + 1.5 * min(t % SECOND_START, 1.5)


#: Centre (3,) by the time since :data:`BEGIN`.
KINDS = {
    "constant velocity, 1.5 m/s": lambda t: np.array([6.0, 5.0 - 1.5 * t, -6.0]),
    "constant velocity, 3 m/s": lambda t: np.array([6.0, 7.0 - 3.0 * t, -6.0]),
    "head-on, 2 m/s": lambda t: np.array([9.0 - 2.0 * t, 0.8 * t - 3.0, -6.0]),
    "slow, 0.5 m/s": lambda t: np.array([5.0, 2.0 - 0.5 * t, -6.0]),
    "harmonic, 1 rad/s": lambda t: np.array([6.0, 2.0 * math.sin(t), -6.0]),
    "harmonic, 2 rad/s": lambda t: np.array([6.0 + math.sin(2.0 * t), 0.0, -6.0]),
    "circle": lambda t: np.array([6.0 + 1.6 * math.cos(1.25 * t), 1.6 * math.sin(1.25 * t), -6.0]),
    "stop and go": lambda t: np.array([6.0, 5.0 - stop_and_go(t), -6.0]),
}
SHAPES = {
    "sphere": lambda p: sphere(p, 0.5, "body"),
    "pole": lambda p: pole(p[:2], 0.2, 12.0, "body"),
    "box": lambda p: box(p, (0.8, 0.8, 0.8), 0.4, "body"),
}


@cache
def surface_about_centre(shape):
    """Return points all over a shape's surface (n, 3), of a pole in the field of view only."""
    rng = np.random.default_rng(1)
    d = rng.normal(size=(150, 3))
    d /= np.linalg.norm(d, axis=1)[:, None]
    if isinstance(shape, Sphere):
        return shape.radius * d
    if isinstance(shape, Pole):
        level = shape.radius * d[:, :2] / np.linalg.norm(d[:, :2], axis=1)[:, None]
        return np.column_stack([level, rng.uniform(-3.0, 2.0, 150)])
    return np.sign(d) * np.array(shape.size) / 2.0 @ shape.rotation.T


def surface(body):
    """Return points all over a body's surface (n, 3)."""
    return surface_about_centre(body.shape) + np.array(body.position_in_world)


@dataclass
class Watch:
    """Figures of one obstacle over one flight; times from :data:`BEGIN` on (s)."""

    found: float = math.inf
    """When a track that moves was within 1 m of it."""
    outside: dict = field(default_factory=lambda: {horizon: [] for horizon in HORIZONS})
    """How far its surface reached out of the predicted set, each frame from then on (m), by time ahead (s)."""
    velocity: list = field(default_factory=list)
    """Squared errors of the velocity over their variance, mean of the axes, from 1 s after that on."""
    obstacle_map: object = None


@cache
def seen_before(seed, beside):
    """Return the map, and the scene that it has seen, when a body appears."""
    m, scene = map_of(), Scene(seed)
    run(m, lambda t: beside, BEGIN, scene=scene)
    return m, scene


def watch(place, make, seed, until=8.0, each=lambda t, m: None, beside=(BEHIND,), appears=True, until_found=False):
    """Return the :class:`Watch` of a body, ``make(place(t))`` at ``t`` (s) from :data:`BEGIN` on.

    ``appears``: it is not there before; ``until_found``: no longer than until it is found, by half seconds.
    """
    result, begin = Watch(), BEGIN if appears else 0.0
    m, scene = copy.deepcopy(seen_before(seed, beside)) if appears else (map_of(), Scene(seed))
    result.obstacle_map = m

    def step(time):
        t = time - BEGIN
        if t < -1e-6 or round(time * 20) % 2:
            return
        body = make(place(t))
        each(t, m)
        near = [
            track
            for track in m.tracks
            if track.is_obstacle and np.linalg.norm((track.centre(time) - body.position_in_world)[:2]) < 1.0
        ]
        if np.linalg.norm(body.position_in_world[:2] - HERE[:2]) > RANGE:
            return
        if near and result.found == math.inf:
            result.found = t
        if t < result.found:
            return
        for horizon, values in result.outside.items():
            values.append(outside(m, time + horizon, surface(make(place(t + horizon)))).max())
        if near and t > result.found + 1.0:
            true = (place(t + 0.01) - place(t - 0.01)) / 0.02
            variance = near[0].filter.velocity_variance
            result.velocity.append(np.mean(((near[0].velocity - true) ** 2 / variance)[:2]))

    def obstacles(time):
        exists = time >= BEGIN or not appears
        return [*beside, make(place(time - BEGIN))] if exists else beside

    times = np.arange(begin, BEGIN + until, 0.5) if until_found else [begin]
    for start, end in zip(times, [*times[1:], BEGIN + until], strict=True):
        if not until_found or result.found == math.inf:
            run(m, obstacles, end, start, scene, each=step)
    return result
