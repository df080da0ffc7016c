"""Where a team that hears no more may come to rest and set its load down: clear of what is known of obstacles.

Vehicles on their own see nothing. Where the motion alone would take them to rest, an obstacle may stand beside them, or
below, or swing to and fro. So the stop plan is bent beforehand: they take longer or less long to stop, and rest aside.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from idc_controller.geometry.distance import Bodies
from idc_controller.geometry.obstacles import ObstacleSource, PredictedObstacle
from idc_controller.parameters import SystemParameters
from idc_controller.trajectory.stop_plan import BRAKING_LIMIT, Braking

Array = NDArray[np.float64]

CLEAR = 0.8
"""From the formation's upright hull to any obstacle (m), by the plan: vehicles on their own stray from it."""
FORESEEN, SAMPLES = 10.0, 21
"""How far ahead obstacles are looked at (s), and at how many moments: what swings is met wherever it goes."""
GROWTH = 0.5
"""Up to this (m) of what is not known of them counts: more of it is everywhere."""
DURATIONS = (0.7, 1.3, 1.6, 2.0)
"""Of braking, over the usual one."""
ASIDE = (0.8, 1.6, 2.4)
"""How far from where the motion alone would lead (m)."""
COST = 0.1
"""Clearance (m) for which a metre aside, or as much longer or shorter a time, is too much."""
_AXIS = 9
"""Points on the formation's upright axis on its way."""
_STEP = 0.4  # m, between points below the place of rest


class RestingPlace:
    """Chooses :class:`~idc_controller.trajectory.stop_plan.Braking`, step by step."""

    def __init__(self, parameters: SystemParameters, obstacles: ObstacleSource) -> None:
        self._obstacles = obstacles
        beside = np.hypot(parameters.p[:, 0], parameters.p[:, 1]) + parameters.disc_radius
        half = parameters.payload_size / 2.0
        self._radius = float(max(beside.max(), np.hypot(half[0], half[1])))
        self._top = float((parameters.l - parameters.p[:, 2]).max())
        self._bottom = float(half[2])
        self._last = Braking()

    def __call__(self, time: float, state: Array) -> Braking:
        """How to brake from ``state`` (3, 3) at ``time`` (s).

        These are position, velocity and acceleration of a payload that hangs still below the UAVs: it is they that
        brake. The usual way, if that is clear; else the last one that was chosen, while it is; else the best of many.
        """
        times = time + np.linspace(0.0, FORESEEN, SAMPLES)
        obstacles = self._obstacles.predict(times)
        if not obstacles:
            return Braking()
        near = _Near(obstacles)
        for known in dict.fromkeys((Braking(), self._last)):
            if self._clearance(near, state, known) >= CLEAR:
                self._last = known
                return known
        self._last = max(self._choices(state), key=lambda choice: self._merit(near, state, choice))
        return self._last

    def _choices(self, state: Array) -> list[Braking]:
        choices = [Braking(), self._last, *(Braking(share) for share in DURATIONS)]
        for aside in ASIDE:
            for bearing in np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False):
                choices.append(Braking(1.0, (aside * float(np.cos(bearing)), aside * float(np.sin(bearing)), 0.0)))
        return choices

    def _merit(self, near: _Near, state: Array, choice: Braking) -> float:
        effort = float(np.linalg.norm(choice.aside)) + BRAKING_LIMIT * abs(choice.share - 1.0)
        return min(self._clearance(near, state, choice), CLEAR) - COST * effort

    def _clearance(self, near: _Near, state: Array, choice: Braking) -> float:
        """Least distance (m) of the formation's upright hull on its way to rest, and down from there."""
        way = choice.way(state)
        elapsed = np.linspace(0.0, FORESEEN, SAMPLES)
        centres = way(np.minimum(elapsed, way.x[-1]))
        axis = np.zeros((_AXIS, 3))
        axis[:, 2] = np.linspace(-self._top, self._bottom, _AXIS)
        on_way = near.at_their_time(centres[:, None, :] + axis)
        rest = centres[-1]
        heights = np.arange(min(rest[2] - self._top, 0.0), 0.0, _STEP)
        below = np.column_stack([np.tile(rest[:2], (len(heights), 1)), heights])
        return min(on_way, near.at_any_time(below)) - self._radius


class _Near:
    """Distances to obstacles over the moments at which they are foreseen."""

    def __init__(self, obstacles: Sequence[PredictedObstacle]) -> None:
        self._bodies = Bodies([obstacle.shape for obstacle in obstacles])
        self._centres = np.stack([obstacle.positions for obstacle in obstacles])  # (O, K, 3)
        self._growth = np.minimum(np.stack([obstacle.growth for obstacle in obstacles]), GROWTH)  # (O, K)

    def at_their_time(self, points: Array) -> float:
        """Of points (K, n, 3), each at its own moment."""
        return self._least(points[None] - self._centres[:, :, None])

    def at_any_time(self, points: Array) -> float:
        """Of points (n, 3), at all moments."""
        return self._least(points - self._centres[:, :, None])

    def _least(self, apart: Array) -> float:
        """Of points relative to the centres (O, K, n, 3)."""
        if not apart.size:
            return np.inf
        distance = self._bodies.from_offsets(apart.reshape(len(apart), -1, 3)).reshape(apart.shape[:3])
        return float((distance - self._growth[:, :, None]).min())
