"""Choice between mission and detour: leads round what the safety filter alone cannot pass.

The safety QP looks a few seconds ahead; a wall across the path, or a pole met slowly, leaves the payload at rest before
the obstacle, safe but held up. Then a detour is searched on the present map and flown, and the mission is followed
again behind the obstacle. Where there is no detour the reason is kept: the flight ends for it.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.free_space import TOUCHING, BoundingCylinder, FlightArea, FreeSpace
from idc_controller.geometry.obstacles import ObstacleSource, PredictedObstacle
from idc_controller.guidance.detour import find_detour
from idc_controller.guidance.settings import NavigatorSettings
from idc_controller.parameters import SystemParameters
from idc_controller.trajectory.flatness import PayloadTrajectory
from idc_controller.trajectory.paths import Leg
from idc_controller.trajectory.trajectory import Trajectory
from idc_controller.trajectory.waypoints import WaypointTrajectory

_WITHIN_FENCE = 10.0
"""Times as far as else is looked ahead where a fence bars all of that."""


class HoldUp:
    """Timing of the search for detours while the mission is held up, and the reason why there is none."""

    def __init__(self, settings: NavigatorSettings) -> None:
        self._settings = settings
        self._since: float | None = None
        self._last_search = -np.inf
        self._interval = settings.search_interval
        self._blocked_since: float | None = None
        self.reason = ""
        """Reason why the last search found no detour; empty: it found one."""
        self._more: Callable[[], str] | None = None

    def clear(self) -> None:
        """Forget all but the intervals of the search."""
        self._since, self._blocked_since, self.reason, self._more = None, None, "", None

    def found(self) -> None:
        """Note a search that found a detour."""
        self.clear()
        self._interval = self._settings.search_interval

    def not_found(self, time: float, reason: str, more: Callable[[], str] | None = None) -> None:
        """Note a search at ``time`` (s) that found none; ``more`` of the reason is computed where it is reported."""
        self.reason, self._more = reason, more
        if self._blocked_since is None:
            self._blocked_since = time

    def search_is_due(self, time: float, rate: float, speed: float) -> bool:
        """Return whether a detour is to be searched at ``time`` (s), by progress ``rate`` and ``speed`` (m/s).

        A detour begins at rest: not before the payload is about to stop.
        """
        s = self._settings
        if rate >= s.held_up_rate:
            self._since = None
            if rate > s.resumed_rate:
                self.found()
            return False
        if self._since is None:
            self._since = time
        if time - self._since < s.patience or time - self._last_search < self._interval or speed > s.begin_speed:
            return False
        self._last_search = time
        # A search that found nothing is repeated ever more rarely: the map must change first.
        self._interval = min(2.0 * self._interval, s.search_interval_max)
        return True

    def blocked(self, time: float) -> str:
        """Return the reason, once there has been no detour for long; empty: the mission can go on."""
        if self._blocked_since is None or time - self._blocked_since < self._settings.give_up:
            return ""
        if self._more is not None:
            self.reason, self._more = self.reason + self._more(), None
        return self.reason


class _NoPath(NamedTuple):
    """Reason why a search found no detour, and what is computed of it where it is reported."""

    reason: str
    more: Callable[[], str] | None = None


class Navigator:
    """Chooses between mission and detour, and how the progress goes on where they meet."""

    def __init__(
        self,
        parameters: SystemParameters,
        settings: NavigatorSettings,
        obstacles: ObstacleSource,
        stages: Array,
        area: FlightArea | None = None,
    ) -> None:
        """Args: the ``stages`` (K + 1,) (s) over which obstacles are predicted; the ``area`` that must not be left."""
        self.obstacles, self._area, self._parameters = obstacles, area, parameters
        self.set_settings(settings)
        self._usable = len(self.clearances)
        """How many of them are tried: not those at which the formation was held up on this way back to the mission."""
        self._flown = 0
        """Which of them the last detour has."""
        self._stages = stages
        self.hold_up = HoldUp(settings)
        self._detour: WaypointTrajectory | None = None
        self._resume = 0.0
        self.detours = 0
        """Detours taken so far."""

    def set_settings(self, settings: NavigatorSettings) -> None:
        """Have other settings from the next search on; the intervals of searches remain."""
        self.settings = settings
        tilted = BoundingCylinder.of(self._parameters, settings.link_tilt)
        at_rest = BoundingCylinder.of(self._parameters)
        self.clearances = (
            (tilted, settings.margin + settings.spare), (tilted, settings.margin), (at_rest, settings.margin),
        )  # fmt: skip
        """Formations and their clearances (m) on detours, in the order in which they are tried."""
        self.lowest = self.formation.below + settings.ground_clearance
        """Lowest altitude of the payload's centre on a detour (m)."""

    @property
    def formation(self) -> BoundingCylinder:
        """Bounds of the formation on a detour."""
        return self.clearances[0][0]

    def followed(self, mission: Trajectory) -> Trajectory:
        """Return the mission or the detour."""
        return self._detour or mission

    def mission_progress(self, progress: float) -> float:
        """Return the mission's progress when that along the followed trajectory is ``progress`` (s)."""
        return progress if self._detour is None else self._resume

    def reset(self) -> None:
        """Follow whatever mission is given next, by its own progress."""
        self._detour = None
        self._usable = len(self.clearances)
        self.hold_up.clear()

    def advance(self, progress: float) -> float:
        """Return the progress (s) to go on with: back on the mission when the detour is flown."""
        if self._detour is not None and progress >= self._detour.end - self.settings.rejoin:
            self._detour = None
            self._usable = len(self.clearances)
            return self._resume
        return progress

    def watch(
        self, time: float, progress: float, rate: float, mission: Trajectory, tracked: PayloadTrajectory
    ) -> float:
        """Search a detour if one is needed, and return the progress (s) to go on with.

        Args:
            time: now (s).
            progress, rate: along what is followed (s), and its rate.
            mission: what the detour leads back to.
            tracked: the trajectory that is tracked now; the detour begins on it.
        """
        position, velocity = tracked.derivatives(np.array([time]), 1)[:, 0]
        if not self.hold_up.search_is_due(time, rate, math.hypot(*velocity)):
            return progress
        if self._detour is not None and self._flown > 0:
            # The formation did not pass so near to what stands there.
            self._usable = min(self._usable, self._flown)
        obstacles = list(self.obstacles.predict(time + self._stages))
        found, number = self._search(self.mission_progress(progress), mission, position, obstacles)
        if isinstance(found, _NoPath):
            self.hold_up.not_found(time, *found)
            return progress
        self.hold_up.found()
        (waypoints, self._resume), self._flown = found, number
        limits = self.settings.limits
        legs = [Leg(waypoint, limits.speed) for waypoint in waypoints[1:]]
        self._detour = WaypointTrajectory(position, legs, limits, corner=self.settings.corner)
        self.detours += 1
        return 0.0

    def _search(
        self, progress: float, mission: Trajectory, position: Array, obstacles: list[PredictedObstacle]
    ) -> tuple[tuple[Array, float] | _NoPath, int]:
        """Return waypoints of a detour and the mission's progress where it leads, or why there is none; its clearance.

        It has the largest of the clearances for which there is one: as near as the margin, at rest, the safety filter
        leads the formation by itself.
        """
        found: tuple[Array, float] | _NoPath = _NoPath("")
        for number, (formation, keep) in enumerate(self.clearances[: self._usable]):
            found = self._path(progress, mission, position, obstacles, formation, keep)
            if not isinstance(found, _NoPath):
                return found, number
        return found, self._usable

    def _path(
        self,
        progress: float,
        mission: Trajectory,
        position: Array,
        obstacles: list[PredictedObstacle],
        formation: BoundingCylinder,
        keep: float,
    ) -> tuple[Array, float] | _NoPath:
        """Return a detour with a clearance ``keep`` (m) of the ``formation``, or why there is none."""
        s = self.settings
        bodies = [(o.shape, o.positions[0]) for o in obstacles]
        growth = [float(o.growth[0]) for o in obstacles]
        names = [o.name for o in obstacles]
        for look_ahead in (s.look_ahead,) if self._area is None else (s.look_ahead, _WITHIN_FENCE * s.look_ahead):
            ahead = progress + np.arange(0.0, look_ahead, s.sample)
            path = mission.derivatives(ahead, 0)[0]
            highest = float(-path[:, 2].min()) + s.climb
            space = FreeSpace(bodies, formation, keep, self.lowest, highest, growth=growth, area=self._area)
            conflicts = np.asarray(np.any(space.clearance(path) < keep - TOUCHING, axis=1))
            if self._area is not None:
                conflicts |= ~self._area.contains(path)
            begin = int(np.argmax(conflicts)) if conflicts.any() else 0
            free = np.flatnonzero(~conflicts[begin:]) + begin
            if len(free):
                break
        until = ahead[int(free[0])] if len(free) else ahead[-1]
        fixed = [
            i
            for i, o in enumerate(obstacles)
            if not o.may_leave and np.linalg.norm(o.positions[-1] - o.positions[0]) < s.standing
        ]
        # The progress is ahead of the payload when that is held up.
        waypoints = mission.waypoints(progress - s.behind, until)
        for waypoint, clearance in zip(waypoints, space.clearance(waypoints)[:, fixed], strict=True):
            if (clearance < -TOUCHING).any():
                north, east, down = waypoint
                place = f"{north:.1f} m north, {east:.1f} m east, {-down:.1f} m high"
                least = int(np.argmin(clearance))
                lacking = f"{keep - clearance[least]:.2f} m are missing for the margin"
                return _NoPath(f"{names[fixed[least]]} stands at the waypoint {place}: {lacking}")
        goals = (
            [int(free[0]), int(free[min(round(s.goal_spare / s.sample), len(free) - 1)])]
            if len(free)
            else [len(path) - 1]
        )
        if self._area is not None and len(passed := mission.waypoints(ahead[goals[0]], ahead[goals[-1]])):
            # From rest shortly before a waypoint the payload would lag behind the mission there, and cut its corner.
            away = np.linalg.norm(path[goals[0] : goals[-1] + 1] - passed[0], axis=1)
            goals = [goals[0] + int(np.argmin(away)), *goals]
        for goal in goals:
            detour = find_detour(space, position, path[goal], names=names, settings=s.detour)
            if detour.waypoints is not None:
                return detour.waypoints, float(ahead[goal])
        # By its surface: a long wall's centre may be far.
        reason = "there is no path to the rest of the mission"
        if bodies:
            nearest = names[int(np.argmin(space.clearance(position[None])[0]))]
            reason = f"the path to the rest of the mission is blocked by {nearest}"
        if detour.reason.startswith("the formation at the goal"):
            return _NoPath(f"{reason}: {detour.reason}")
        last = path[goals[-1]]
        return _NoPath(reason, lambda: self._narrowest_gap(obstacles, position, last, highest))

    def _narrowest_gap(self, obstacles: list[PredictedObstacle], position: Array, goal: Array, highest: float) -> str:
        """Return the narrowest gap from ``position`` to ``goal`` in words, by estimates, else as the search sees it."""
        # Imports shapely, which takes long and is spent only where there is no path.
        from idc_controller.guidance.narrowest_gap import narrowest_gap

        keep = self.settings.margin
        covers = [(o.shape, o.positions[0]) for o in obstacles]
        estimates = [o.estimate() if o.estimate else cover for o, cover in zip(obstacles, covers, strict=True)]
        for bodies, growth in ((estimates, None), (covers, [float(o.growth[0]) for o in obstacles])):
            space = FreeSpace(bodies, self.formation, keep, self.lowest, highest, growth, self._area)
            gap = narrowest_gap(space, position, goal, names=[o.name for o in obstacles], settings=self.settings.detour)
            # Where estimates leave a way, what they do not know closes it.
            if gap is not None and (gap.clearance < keep or growth is not None):
                needed = gap.width + 2.0 * (keep - gap.clearance)
                if gap.is_height:
                    needed = gap.width + keep - gap.clearance
                return f"; the narrowest gap is {gap}, {needed:.2f} m are needed"
        return ""
