"""The place where a team without set-points comes to rest and sets its load down, clear of obstacles on the map.

Vehicles without set-points detect nothing. Where their motion would take them to rest, an obstacle may be beside
them, or below, or swing to and fro. So the stop plan is deflected beforehand: it takes longer or less long, or ends
aside.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.obstacles import Bodies, ObstacleSource, PredictedObstacle
from idc_controller.guidance.settings import RestingPlaceSettings
from idc_controller.parameters import SystemParameters
from idc_controller.trajectory.settings import BrakingSettings
from idc_controller.trajectory.stop_plan import Braking

_AXIS = 9
"""Points on the formation's upright axis on its path."""
_STEP = 0.4  # m, between points below the place of rest


class RestingPlace:
    """Chooses :class:`~idc_controller.trajectory.stop_plan.Braking`, step by step."""

    def __init__(
        self,
        parameters: SystemParameters,
        obstacles: ObstacleSource,
        settings: RestingPlaceSettings = RestingPlaceSettings(),
        braking: BrakingSettings = BrakingSettings(),
    ) -> None:
        self.settings, self._obstacles = settings, obstacles
        self._usual = Braking(settings=braking)
        beside = np.hypot(parameters.p[:, 0], parameters.p[:, 1]) + parameters.disc_radius
        self._radius = float(max(beside.max(), parameters.payload.horizontal_reach))
        self._top = float((parameters.l - parameters.p[:, 2]).max())
        self._bottom = parameters.payload.below
        self._last = self._usual

    def __call__(self, time: float, state: Array) -> Braking:
        """Return the stop from ``state`` (3, 3) at ``time`` (s).

        These are position, velocity and acceleration of a payload that hangs at rest below the UAVs, which
        brake. The usual stop, if that is clear; else the last one that was chosen, while it is; else the best of many.
        """
        times = time + np.linspace(0.0, self.settings.look_ahead, self.settings.samples)
        obstacles = self._obstacles.predict(times)
        if not obstacles:
            return self._usual
        near = _Near(obstacles, self.settings.growth_max)
        for known in dict.fromkeys((self._usual, self._last)):
            if self._clearance(near, state, known) >= self.settings.clearance:
                self._last = known
                return known
        self._last = max(self._choices(state), key=lambda choice: self._merit(near, state, choice))
        return self._last

    def _choices(self, state: Array) -> list[Braking]:
        s, usual = self.settings, self._usual
        choices = [usual, self._last, *(usual._replace(share=share) for share in s.durations)]
        for aside in s.aside:
            for bearing in np.linspace(0.0, 2.0 * np.pi, s.bearings, endpoint=False):
                offset = (aside * float(np.cos(bearing)), aside * float(np.sin(bearing)), 0.0)
                choices.append(usual._replace(aside=offset))
        return choices

    def _merit(self, near: _Near, state: Array, choice: Braking) -> float:
        s = self.settings
        effort = float(np.linalg.norm(choice.aside)) + s.duration_cost * abs(choice.share - 1.0)
        return min(self._clearance(near, state, choice), s.clearance) - s.cost * effort

    def _clearance(self, near: _Near, state: Array, choice: Braking) -> float:
        """Least distance (m) of the formation's upright hull on its path to rest, and down from there."""
        path = choice.path(state)
        elapsed = np.linspace(0.0, self.settings.look_ahead, self.settings.samples)
        centres = path(np.minimum(elapsed, path.x[-1]))
        axis = np.zeros((_AXIS, 3))
        axis[:, 2] = np.linspace(-self._top, self._bottom, _AXIS)
        on_path = near.at_their_time(centres[:, None, :] + axis)
        rest = centres[-1]
        heights = np.arange(min(rest[2] - self._top, 0.0), 0.0, _STEP)
        below = np.column_stack([np.tile(rest[:2], (len(heights), 1)), heights])
        return min(on_path, near.at_any_time(below)) - self._radius


class _Near:
    """Distances to obstacles over the moments at which they are predicted."""

    def __init__(self, obstacles: Sequence[PredictedObstacle], growth_max: float) -> None:
        self._bodies = Bodies([obstacle.shape for obstacle in obstacles])
        self._centres = np.stack([obstacle.positions for obstacle in obstacles])  # (O, K, 3)
        self._growth = np.minimum(np.stack([obstacle.growth for obstacle in obstacles]), growth_max)  # (O, K)

    def at_their_time(self, points: Array) -> float:
        """Return the least distance (m) of points (K, n, 3), each at its own moment."""
        return self._least(points[None] - self._centres[:, :, None])

    def at_any_time(self, points: Array) -> float:
        """Return the least distance (m) of points (n, 3) at all moments."""
        return self._least(points - self._centres[:, :, None])

    def _least(self, apart: Array) -> float:
        """Return the least distance (m) of points relative to the centres (O, K, n, 3)."""
        if not apart.size:
            return np.inf
        distance = self._bodies.from_offsets(apart.reshape(len(apart), -1, 3)).reshape(apart.shape[:3])
        return float((distance - self._growth[:, :, None]).min())
