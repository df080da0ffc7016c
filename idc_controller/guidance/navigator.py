"""Choice between mission and detour: leads round what the safety filter alone cannot pass.

The safety QP looks a few seconds ahead; a wall across the path, or a pole met slowly, leaves the payload at rest before
the obstacle, safe but held up. Then a detour is searched on the present map and flown, and the mission is followed
again behind the obstacle. Where there is no detour the reason is kept: the flight ends for it.
"""

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.formation import BoundingCylinder
from idc_controller.geometry.free_space import FreeSpace, first_conflict
from idc_controller.geometry.obstacles import ObstacleSource, PredictedObstacle
from idc_controller.guidance.detour import find_detour
from idc_controller.guidance.settings import NavigatorSettings
from idc_controller.parameters import SystemParameters
from idc_controller.trajectory.flatness import PayloadTrajectory
from idc_controller.trajectory.paths import Leg
from idc_controller.trajectory.trajectory import Trajectory
from idc_controller.trajectory.waypoints import WaypointTrajectory

REJOIN = 0.3
"""s before the end of a detour, at which the mission is followed again."""
FIXED = 0.2
"""m; an obstacle that moves less over the stages does not leave a waypoint free."""


class Navigator:
    """Chooses between mission and detour, and how the progress goes on where they meet."""

    def __init__(
        self, parameters: SystemParameters, settings: NavigatorSettings, obstacles: ObstacleSource, stages: Array
    ) -> None:
        """Args: the ``stages`` (K + 1,) (s) over which obstacles are predicted."""
        self.formation = BoundingCylinder.of(parameters, settings.link_tilt)
        self.settings, self.obstacles = settings, obstacles
        self._stages = stages
        self.lowest = self.formation.below + settings.ground_clearance
        """Lowest altitude of the payload's centre on a detour (m)."""
        self._detour: WaypointTrajectory | None = None
        self._resume = 0.0
        self._held_since: float | None = None
        self._last_search = -np.inf
        self._interval = settings.search_interval
        self._blocked_since: float | None = None
        self.detours = 0
        """Detours taken so far."""
        self.reason = ""
        """Why the last search found no detour; empty: it found one."""

    def followed(self, mission: Trajectory) -> Trajectory:
        """Return the mission or the detour."""
        return self._detour or mission

    def mission_progress(self, progress: float) -> float:
        """Return the mission's progress when that along the followed trajectory is ``progress`` (s)."""
        return progress if self._detour is None else self._resume

    def blocked(self, time: float) -> str:
        """Return why the mission cannot go on, once that has been so for long; empty: it can."""
        if self._blocked_since is None or time - self._blocked_since < self.settings.give_up:
            return ""
        return self.reason

    def reset(self) -> None:
        """Follow whatever mission is given next, by its own progress."""
        self._detour, self._held_since, self._blocked_since, self.reason = None, None, None, ""

    def advance(self, progress: float) -> float:
        """Return the progress (s) to go on with: back on the mission when the detour is flown."""
        if self._detour is not None and progress >= self._detour.end - REJOIN:
            self._detour = None
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
        s = self.settings
        if rate >= s.held_up_rate:
            self._held_since = None
            if rate > 0.9:
                self._blocked_since, self.reason, self._interval = None, "", s.search_interval
            return progress
        if self._held_since is None:
            self._held_since = time
        if time - self._held_since < s.patience or time - self._last_search < self._interval:
            return progress
        self._last_search = time
        # A search that found nothing is repeated ever more rarely: the map must change first.
        self._interval = min(2.0 * self._interval, s.search_interval_max)
        position = tracked.derivatives(np.array([time]), 0)[0, 0]
        obstacles = list(self.obstacles.predict(time + self._stages))
        found = self._search(self.mission_progress(progress), mission, position, obstacles)
        if found is None:
            if self._blocked_since is None:
                self._blocked_since = time
            return progress
        self._blocked_since, self.reason, self._held_since = None, "", None
        self._interval = s.search_interval
        waypoints, self._resume = found
        legs = [Leg(waypoint, s.limits.speed) for waypoint in waypoints[1:]]
        self._detour = WaypointTrajectory(position, legs, s.limits, corner=s.corner)
        self.detours += 1
        return 0.0

    def _search(
        self, progress: float, mission: Trajectory, position: Array, obstacles: list[PredictedObstacle]
    ) -> tuple[Array, float] | None:
        """Return waypoints of a detour, and the mission's progress where it leads; None: there is no detour."""
        s = self.settings
        now = [PredictedObstacle(o.name, o.shape, o.positions[:1], o.growth[:1]) for o in obstacles]
        ahead = progress + np.arange(0.0, s.look_ahead, s.sample)
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
        fixed = [now[i] for i, o in enumerate(obstacles) if np.linalg.norm(o.positions[-1] - o.positions[0]) < FIXED]
        # The progress is ahead of the payload when that is held up.
        for waypoint in mission.waypoints(progress - s.behind, until):
            for obstacle in fixed:
                if first_conflict(waypoint[None], [obstacle], self.formation, 0.0) is not None:
                    north, east, down = waypoint
                    self.reason = f"{obstacle.name} stands at the waypoint {north:.1f} m north, {east:.1f} m east, "
                    self.reason += f"{-down:.1f} m high"
                    return None
        goals = [int(free[0]), int(free[min(8, len(free) - 1)])] if len(free) else [len(path) - 1]
        for goal in goals:
            detour = find_detour(
                bodies, position, path[goal], self.formation, keep, lowest=self.lowest, highest=highest,
                growth=growth, names=names,
            )  # fmt: skip
            if detour.waypoints is not None:
                return detour.waypoints, float(ahead[goal])
        # By its surface: a long wall's centre may be far.
        space = FreeSpace(bodies, self.formation, keep, self.lowest, highest, growth=growth)
        self.reason = "there is no way on"
        if bodies:
            self.reason = f"the way on is blocked by {names[int(np.argmin(space.clearance(position[None])[0]))]}"
        if detour.reason.startswith("the formation at the goal"):
            self.reason += f": {detour.reason}"
        return None
