"""Which way: follows the mission, and leads round what the safety filter alone cannot pass.

The safety programme looks a few seconds ahead; a wall across the path, or a pole met slowly, leaves it standing before
the obstacle, safe but stuck. Then a way round is searched on the map as it is known now, flown, and the mission taken
up again behind the obstacle. Where there is no way the reason is kept for whoever has to decide.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from idc_controller.geometry.free_space import Formation, Room, first_conflict
from idc_controller.geometry.shapes import PredictedObstacle
from idc_controller.guidance.detour import find_detour
from idc_controller.trajectory.paths import Leg
from idc_controller.trajectory.trajectory import Limits, Trajectory
from idc_controller.trajectory.waypoints import WaypointTrajectory

Array = NDArray[np.float64]


@dataclass(frozen=True)
class NavigatorSettings:
    """When a way round is searched, and how it is flown."""

    limits: Limits = Limits(1.5, 1.5, 2.0, 6.0)  # noqa: RUF009 (frozen)
    margin: float = 0.5
    """Room between hull and obstacles (m)."""
    spare: float = 0.2
    """More than the margin, so that the safety filter need not touch the detour (m)."""
    held_up_rate: float = 0.5
    """The mission is held up while its clock runs slower than this."""
    patience: float = 0.5
    """How long it may be held up before a way round is searched (s)."""
    search_interval: float = 1.0
    """Time between searches (s)."""
    give_up: float = 15.0
    """How long it may be held up, with no way found, before that is said (s)."""
    look_ahead: float = 60.0
    """How far along the mission its continuation is searched (s)."""
    sample: float = 0.25
    """Spacing of that search (s)."""
    behind: float = 6.0
    """How far back a waypoint may lie that was not reached (s)."""
    lowest: float = 0.35
    """Lowest altitude of a detour (m)."""
    climb: float = 8.0
    """How far above the mission a detour may lead (m)."""


class Navigator:
    """Chooses between mission and detour; keeps the clock of whichever is followed."""

    def __init__(self, formation: Formation, settings: NavigatorSettings) -> None:
        self.formation, self.settings = formation, settings
        self._detour: WaypointTrajectory | None = None
        self._resume = 0.0
        self._held_since: float | None = None
        self._last_search = -np.inf
        self._interval = settings.search_interval
        self._stuck_since: float | None = None
        self.detours = 0
        """Ways round taken so far."""
        self.reason = ""
        """Why there is no way on, as the last search found; empty: there is one."""

    def followed(self, mission: Trajectory) -> Trajectory:
        """The mission or the detour."""
        return self._detour or mission

    def mission_time(self, clock: float) -> float:
        """The mission's time when the followed trajectory's clock shows ``clock`` (s)."""
        return clock if self._detour is None else self._resume

    def blocked(self, time: float) -> str:
        """Why the mission cannot go on, once that has been so for long; empty: it can."""
        if self._stuck_since is None or time - self._stuck_since < self.settings.give_up:
            return ""
        return self.reason

    def forget(self) -> None:
        """Follow whatever mission is given next from its own clock."""
        self._detour, self._held_since, self._stuck_since, self.reason = None, None, None, ""

    def advance(self, clock: float) -> float:
        """The clock to go on with: back to the mission's when the detour is done."""
        if self._detour is not None and clock >= self._detour.end - 0.3:
            self._detour = None
            return self._resume
        return clock

    def watch(
        self,
        time: float,
        clock: float,
        rate: float,
        mission: Trajectory,
        position: Array,
        obstacles: list[PredictedObstacle],
    ) -> float:
        """Search a way round if one is needed; ``position`` (3,) is where the trajectory is. Returns the clock."""
        s = self.settings
        if rate >= s.held_up_rate:
            self._held_since = None
            if rate > 0.9:
                self._stuck_since, self.reason, self._interval = None, "", s.search_interval
            return clock
        if self._held_since is None:
            self._held_since = time
        if time - self._held_since < s.patience or time - self._last_search < self._interval:
            return clock
        self._last_search = time
        # A search that found nothing is repeated ever more rarely: the map must change first.
        self._interval = min(2.0 * self._interval, 8.0 * s.search_interval)
        found = self._search(self.mission_time(clock), mission, position, obstacles)
        if found is None:
            if self._stuck_since is None:
                self._stuck_since = time
            return clock
        self._stuck_since, self.reason, self._held_since = None, "", None
        self._interval = s.search_interval
        waypoints, self._resume = found
        legs = [Leg(waypoint, s.limits.speed) for waypoint in waypoints[1:]]
        self._detour = WaypointTrajectory(position, legs, s.limits, corner=0.1)
        self.detours += 1
        return 0.0

    def _search(
        self, clock: float, mission: Trajectory, position: Array, obstacles: list[PredictedObstacle]
    ) -> tuple[Array, float] | None:
        """Waypoints of a way round, and the mission's time where it leads."""
        s = self.settings
        now = [PredictedObstacle(o.name, o.shape, o.positions[:1], o.growth[:1]) for o in obstacles]
        ahead = clock + np.arange(0.0, s.look_ahead, s.sample)
        path = mission.derivatives(ahead, 0)[0]
        keep = s.margin + s.spare
        conflicts = np.array([first_conflict(p[None], now, self.formation, keep) is not None for p in path])
        bodies = [(o.shape, o.positions[0]) for o in now]
        growth = [float(o.growth[0]) for o in now]
        names = [o.name for o in now]
        highest = float(-path[:, 2].min()) + s.climb
        begin = int(np.argmax(conflicts)) if conflicts.any() else 0
        free = np.flatnonzero(~conflicts[begin:]) + begin
        until = ahead[int(free[0])] if len(free) else ahead[-1]
        standing = [now[i] for i, o in enumerate(obstacles) if np.linalg.norm(o.positions[-1] - o.positions[0]) < 0.2]
        # The mission's clock is ahead of the payload when it is held up.
        for waypoint in mission.waypoints(clock - s.behind, until):
            for obstacle in standing:
                if first_conflict(waypoint[None], [obstacle], self.formation, 0.0) is not None:
                    north, east, down = waypoint
                    self.reason = f"{obstacle.name} stands at the waypoint {north:.1f} m north, {east:.1f} m east, "
                    self.reason += f"{-down:.1f} m high"
                    return None
        goals = [int(free[0]), int(free[min(8, len(free) - 1)])] if len(free) else [len(path) - 1]
        for goal in goals:
            detour = find_detour(
                bodies, position, path[goal], self.formation, keep, lowest=s.lowest, highest=highest,
                growth=growth, names=names,
            )  # fmt: skip
            if detour.waypoints is not None:
                return detour.waypoints, float(ahead[goal])
        # By its surface: a long wall's centre may be far.
        room = Room(bodies, self.formation, keep, s.lowest, highest, growth=growth)
        self.reason = "there is no way on"
        if bodies:
            self.reason = f"the way on is blocked by {names[int(np.argmin(room.clearance(position[None])[0]))]}"
        if detour.reason.startswith("the formation at the goal"):
            self.reason += f": {detour.reason}"
        return None
