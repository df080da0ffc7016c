"""The place where a team without set-points comes to rest and sets its load down, clear of obstacles on the map.

Vehicles without set-points detect nothing. Where their motion would take them to rest, an obstacle may be beside
them, or below, or swing to and fro. So the stop plan is deflected beforehand: it takes longer or less long, or ends
aside.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.interpolate import BPoly

from idc_controller.arrays import Array, Indices
from idc_controller.geometry.free_space import FlightArea
from idc_controller.geometry.obstacles import Bodies, ObstacleSource, PredictedObstacle, Region
from idc_controller.geometry.shape import Shape
from idc_controller.guidance.resting_place_kernels import least_distances
from idc_controller.guidance.settings import RestingPlaceSettings
from idc_controller.parameters import SystemParameters
from idc_controller.trajectory.settings import BrakingSettings
from idc_controller.trajectory.stop_plan import Braking
from idc_controller.trajectory.stop_plan_kernels import control_points

_AXIS = 9
"""Points on the formation's upright axis on its path."""
_STEP = 0.4  # m, between points below the place of rest
_ROUNDING = 1e-6  # m, more than the rounding of a distance
_USUAL = 0
"""Index of the usual stop among the choices."""


class RestingPlace:
    """Chooses :class:`~idc_controller.trajectory.stop_plan.Braking`, step by step."""

    def __init__(
        self,
        parameters: SystemParameters,
        obstacles: ObstacleSource,
        settings: RestingPlaceSettings = RestingPlaceSettings(),
        braking: BrakingSettings = BrakingSettings(),
        area: FlightArea | None = None,
    ) -> None:
        """``area``: that must not be left, its edges among the ``obstacles``; None: everywhere."""
        self.settings, self._obstacles, self._area = settings, obstacles, area
        self._braking = braking
        beside = np.hypot(parameters.p[:, 0], parameters.p[:, 1]) + parameters.disc_radius
        self._radius = float(max(beside.max(), parameters.payload.horizontal_reach))
        self._axis = np.linspace(-float((parameters.l - parameters.p[:, 2]).max()), parameters.payload.below, _AXIS)
        self._elapsed = np.linspace(0.0, settings.look_ahead, settings.samples)
        usual = Braking(settings=braking)
        self._choices = _Choices([usual, *_deflected(usual, settings)], settings)
        self._last = _USUAL

    def set_margin(self, margin: float) -> None:
        """Keep another clearance (m) from obstacles, from the next stop on."""
        self.settings = replace(self.settings, margin=margin)

    def __call__(self, time: float, state: Array) -> Braking:
        """Return the stop from ``state`` (3, 3) at ``time`` (s).

        These are position, velocity and acceleration of a payload that hangs at rest below the UAVs, which
        brake. The usual stop, if that is clear; else the last one that was chosen, while it is; else the best of many.
        """
        usual_duration = self._braking.usual_duration(state[1])
        region = Region(state[0], self._farthest(state, usual_duration))
        obstacles = self._obstacles.predict(time + self._elapsed, region)
        self._last = self._chosen(obstacles, state, usual_duration) if obstacles else _USUAL
        return self._choices.stops[self._last]

    def _chosen(self, obstacles: Sequence[PredictedObstacle], state: Array, usual_duration: float) -> int:
        """Return the index of the stop chosen."""
        least, choices = self.settings.clearance, self._choices
        bodies = Bodies([obstacle.shape for obstacle in obstacles])
        for known in (_USUAL, self._last) if self._last != _USUAL else (_USUAL,):
            if self._clearances(obstacles, bodies, state, usual_duration, np.array([known]))[0] >= least:
                return known
        # Of equally good ones the last that was chosen, unless it is the usual one.
        order = np.array([_USUAL, self._last, *range(1, len(choices.stops))])
        clearances = self._clearances(obstacles, bodies, state, usual_duration, order)
        return int(order[np.argmax(np.minimum(clearances, least) - choices.costs[order])])

    def _farthest(self, state: Array, usual_duration: float) -> float:
        """Return how far (m) from where it is now an obstacle can be that matters, for the slowest stop."""
        s = self.settings
        duration = self._choices.largest_share * usual_duration
        speed, acceleration = math.sqrt(state[1] @ state[1]), math.sqrt(state[2] @ state[2])
        # The control points of a path hold it.
        length = duration / 2.0 * speed + duration**2 / 12.0 * acceleration + max(s.aside, default=0.0)
        return length + self._radius + s.clearance + s.growth_max + _ROUNDING

    def _clearances(
        self, obstacles: Sequence[PredictedObstacle], bodies: Bodies, state: Array, usual_duration: float,
        which: Indices,
    ) -> Array:  # fmt: skip
        """Return the least distance (m) of the formation's upright hull on its path to rest, and down from there.

        For the choices of the indices ``which`` (C,); those beyond the clearance that is asked for are not
        distinguished. Minus infinity for those that end outside the area. ``bodies``: of the ``obstacles``.
        """
        durations = self._choices.shares[which] * usual_duration
        control = control_points(state[None], durations, self._choices.asides[which])
        limit = self._radius + self.settings.clearance + _ROUNDING
        centres = np.array([obstacle.positions for obstacle in obstacles])  # (O, K, 3)
        growth = np.minimum(np.array([obstacle.growth for obstacle in obstacles]), self.settings.growth_max)  # (O, K)
        reach = bodies.reach
        if bodies.others:
            reach = reach.copy()
            reach[[i for i, _ in bodies.others]] = -np.inf  # never near: the kernel passes them over
        least = least_distances(
            control, durations, self._elapsed, self._axis, _STEP, bodies.rows, reach, centres, growth, limit
        )
        for i, shape in bodies.others:
            for c, (points, duration) in enumerate(zip(control, durations, strict=True)):
                places = BPoly(points[:, None], [0.0, duration])(np.minimum(self._elapsed, duration))
                least[c] = least_distance(shape, places, self._axis, centres[i], growth[i], least[c])
        if self._area is not None:
            least[~self._area.contains(control[:, -1])] = -math.inf
        return np.asarray(least - self._radius)


class _Choices:
    """The stops to choose from, the usual one first."""

    def __init__(self, stops: Sequence[Braking], settings: RestingPlaceSettings) -> None:
        self.stops = stops
        self.shares = np.array([stop.share for stop in stops])
        self.asides = np.array([stop.aside for stop in stops])
        self.largest_share = float(self.shares.max())
        effort = [math.hypot(*stop.aside) + settings.duration_cost * abs(stop.share - 1.0) for stop in stops]
        self.costs = settings.cost * np.array(effort)
        """What each is worse for being unusual (m)."""


def _deflected(usual: Braking, s: RestingPlaceSettings) -> list[Braking]:
    """Return the stops that take longer or less long than the usual one, or end aside."""
    choices = [usual._replace(share=share) for share in s.durations]
    for aside in s.aside:
        for bearing in np.linspace(0.0, 2.0 * np.pi, s.bearings, endpoint=False):
            offset = (aside * float(np.cos(bearing)), aside * float(np.sin(bearing)), 0.0)
            choices.append(usual._replace(aside=offset))
    return choices


def least_distance(shape: Shape, places: Array, axis: Array, centres: Array, growth: Array, limit: float) -> float:
    """Return what :func:`~idc_controller.guidance.resting_place_kernels.least_distances` does, for any shape.

    For one path, by its ``places`` (K, 3) at the moments, and one obstacle, by its ``centres`` (K, 3) and ``growth``
    (K,) (m).
    """
    on_path = places[:, None] + np.column_stack([np.zeros((len(axis), 2)), axis])
    rest = places[-1]
    heights = np.arange(min(rest[2] + axis[0], 0.0), 0.0, _STEP)
    below = np.column_stack([np.tile(rest[:2], (len(heights), 1)), heights])
    points = np.concatenate([on_path, np.broadcast_to(below, (len(places), *below.shape))], axis=1) - centres[:, None]
    near = np.linalg.norm(points, axis=2) - shape.reach - growth[:, None] < limit
    distance = Bodies([shape]).from_offsets(points[near][None])[0] - np.broadcast_to(growth[:, None], near.shape)[near]
    return float(distance.min(initial=limit))
