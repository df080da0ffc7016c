"""Mission trajectory: one trajectory of the payload from ground to ground, made of take-off, mission and landing."""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import dropwhile

import numpy as np

from gcs.config import MotionConfig
from gcs.flight.flown_legs import FlownLegs
from gcs.flight.mission_legs import MissionLeg, legs_of
from gcs.mission.model import Mission
from gcs.mission.route import GroundLeg, Position, Route, TakeOff
from idc_controller.arrays import Array
from idc_controller.trajectory import paths
from idc_controller.trajectory.trajectory import RestTrajectory, Trajectory
from idc_controller.trajectory.waypoints import WaypointTrajectory

_BACK, _BACK_STEP = 60.0, 0.1
"""s; how far back a place is looked for from which the landing place is seen, and in which steps."""
_REST_STEP = 0.01
"""s; between the times at which it is looked for where on its path a trajectory comes to rest."""
_ON_PATH = 0.02
"""m; a rest that is nearer to where a path of its length ends is on it: more than lengths differ by their steps."""
_SAME = 1e-3
"""m; a shorter way is none: a place of rest is reached before it is left."""


class MissionTrajectory:
    """Trajectory of the payload from take-off to touchdown, from ``position`` on the ground at ``start``.

    Times are the team's (s), positions NED (m). An endless mission has no end.
    """

    def __init__(
        self,
        mission: Mission,
        position: Array,
        start: float,
        legs: Iterator[MissionLeg] | None = None,
        pad: Array | None = None,
    ) -> None:
        """``legs``: up to the landing; None: those of the first flight. ``pad``: None: it stands there."""
        self._settings = mission.system.flight.takeoff_landing
        self._motion = mission.system.motion
        self._ground = -mission.system.parameters().payload.below
        self._pad = position if pad is None else pad
        self.start = start
        self.landing_from = math.inf
        """Time at which the final descent begins (s); inf while that is not known."""
        self.slow_from = math.inf
        """Time at which its slow part, near the ground, begins (s); inf while that is not known."""
        if legs is None:
            legs = dropwhile(lambda leg: isinstance(leg, GroundLeg), legs_of(mission))
        first = next(legs)
        if not isinstance(first, TakeOff):
            raise TypeError(f"a flight begins with a take-off, not with {first}")
        self._take_off: TakeOff | None = first
        up = WaypointTrajectory(position, self._rise(first, position), self._motion.climb_limits, start=start)
        self._climb: Trajectory | None = up
        fastest = mission.reference.fastest if isinstance(mission.reference, Route) else 0.0
        self._legs = FlownLegs(legs, max(self._motion.speed, fastest), self._motion)
        self._above: Trajectory = up.then(lambda time, here: self._legs.trajectory(time, here))
        """Up to the place above the landing."""
        self.trajectory: Trajectory = self._above.then(self._land)
        self._braking = False
        self._held_at = math.inf
        """Progress (s) along what was flown at which it was left for a hold; inf: it is not held."""
        self._rest = position
        """Where it comes to rest then."""

    def set_motion(self, motion: MotionConfig) -> None:
        """Have other limits of what is planned from now on: after the next :meth:`go_on`, and of the landing."""
        self._motion = motion

    def reference(self, times: Array) -> tuple[Array, Array]:
        """Return position and velocity (K, 3) at ``times``: a descent ends on the ground, not below it."""
        position, velocity = self.trajectory.derivatives(times, 1)
        if position[:, 2].max(initial=-math.inf) <= min(self._pad[2], self._ground):
            return position, velocity
        on_pad = np.linalg.norm(position[:, :2] - self._pad[:2], axis=1) < self._settings.pad_radius
        lowest = np.where(on_pad, self._pad[2], self._ground)
        below = position[:, 2] > lowest
        position[below, 2] = lowest[below]
        velocity[below, 2] = 0.0
        return position, velocity

    def phase(self, time: float) -> str:
        """Return the phase at ``time``: climb, fly, hold, land."""
        if time >= self.landing_from:
            return "land"
        # Evaluated at each call: the end of a lazy trajectory is known only when it is reached.
        if not self.is_held and self._climbs(time):
            return "climb"
        speed = math.hypot(*self.trajectory.derivatives(np.array([time]), 1)[1, 0].tolist())
        return "fly" if speed > self._settings.hold_speed else "hold"

    def _climbs(self, time: float) -> bool:
        return self._climb is not None and time < self._climb.end

    @property
    def is_held(self) -> bool:
        """True from :meth:`hold` to :meth:`go_on`."""
        return self._held_at < math.inf

    @property
    def landing(self) -> str:
        """Source of the landing; empty: it was not read yet."""
        return "" if self._legs.landing is None else self._legs.landing.source

    def passed(self, time: float) -> list[str]:
        """Return the sources of the legs flown until ``time``, since take-off or the last :meth:`go_on`."""
        time = min(time, self._held_at)
        climbed = [] if self._take_off is None or self._climbs(time) else [self._take_off.source]
        return [*climbed, *self._legs.passed(time)]

    def next_source(self, time: float) -> str | None:
        """Return the source of the waypoint, or landing, that is flown to at ``time``; None: it holds at the last."""
        time = min(time, self._held_at)
        if self._take_off is not None and self._climbs(time):
            return self._take_off.source
        return self._legs.next_source(time)

    def hold(self, followed: Trajectory, time: float, progress: float) -> None:
        """Come to rest as soon as the limits allow, and stay there until :meth:`go_on`.

        Without effect while braking for a landing. ``progress``: along this trajectory (s); other arguments as of
        :meth:`brake_and_land`.
        """
        if self._braking or self.is_held:
            return
        stop = followed.stop(time)
        end = stop.end  # planned as a whole: it reads no leg any more
        self._rest = stop.position(end)
        # Along this one as far as along its stop, which may be slower: a rest that is not on it is no progress.
        since = np.arange(0.0, max(end - time, 0.0) + _REST_STEP, _REST_STEP)
        ways, stopped = _ways(self.trajectory, progress + since), _ways(stop, time + since)[-1]
        at = progress + float(np.interp(stopped - _SAME, ways, since))
        self._held_at = at if math.dist(self.trajectory.position(at), self._rest) < _ON_PATH else progress
        self.landing_from = self.slow_from = math.inf
        self._above = self.trajectory = stop.then(lambda end, here: RestTrajectory(here, end, math.inf))

    def remaining(self) -> list[MissionLeg]:
        """Return what remains, where it came to rest to hold, of the legs that have been read."""
        take_off, here = self._take_off, _place(self._rest)
        legs = self._legs.remaining(self._held_at, here, _place(self._pad))
        if take_off is None or not self._climbs(self._held_at):
            return legs
        return [replace(take_off, position=(*here[:2], take_off.position[2]), delay=0.0), *legs]

    def go_on(self, followed: Trajectory, time: float, legs: Iterator[MissionLeg], speed: float) -> None:
        """Come to rest as soon as the limits allow, then fly ``legs``, none faster than ``speed`` (m/s), and land.

        Without effect while braking for a landing. Other arguments as of :meth:`brake_and_land`.
        """
        if self._braking:
            return
        self._climb = self._take_off = None
        self._held_at = self.landing_from = self.slow_from = math.inf
        self._legs = flown = FlownLegs(legs, speed, self._motion)
        self._above = followed.stop(time).then(flown.trajectory)
        self.trajectory = self._above.then(self._land)

    def brake_and_land(self, followed: Trajectory, time: float) -> None:
        """Come to rest as soon as the limits allow, then land there; without effect while braking or landing.

        Args:
            followed: the trajectory that is flown, this one or a detour.
            time: where on it; from now on this trajectory goes on at that time.
        """
        if self._braking or (followed is self.trajectory and time >= self.landing_from):
            return
        self._braking = True
        self._climb = None
        self.trajectory = followed.stop(time).then(self._land)

    @property
    def above(self) -> Array:
        """The place above the landing (3,); only once :attr:`landing_from` is known, or while it waits."""
        return self._above.position(self._above.end)

    def is_at_rest(self, time: float) -> bool:
        """Return whether it rests at ``time`` (s)."""
        return not self.trajectory.derivatives(np.array([time]), 4)[1:].any()

    def wait(self, followed: Trajectory, time: float, beside: float = 0.0) -> None:
        """Do not descend until the landing is resumed: rest where it came from, ``beside`` the landing place (m).

        As far beside it as it came level, at least; where it came from below, above it.

        Args:
            followed: the trajectory that is flown, this one or a rest where something is in the way.
            time: where on it; from now on this trajectory goes on at that time.
            beside: level distance from the landing place (m).
        """
        first, place = self._above, self._beside(beside)
        if followed is not self.trajectory or time >= self.landing_from:
            first = followed.stop(time)
        self.landing_from = self.slow_from = math.inf
        limits = self._motion.limits
        aside = first.then(lambda end, here: WaypointTrajectory(here, [self._leg(place)], limits, start=end))
        self.trajectory = aside.then(lambda end, here: RestTrajectory(here, end, math.inf))

    def _beside(self, distance: float) -> Array:
        """Return the place (3,) on the way above the landing that is ``distance`` (m) before it, or the farthest."""
        end = self._above.end
        times = np.append(end, np.arange(end - _BACK_STEP, max(self._above.start, end - _BACK), -_BACK_STEP))
        way, above = self._above.derivatives(times, 0)[0], self.above
        level = np.abs(way[:, 2] - above[2]) < self._settings.slow_margin
        away = np.linalg.norm(way[: np.argmin(np.append(level, False)), :2] - above[:2], axis=1)
        reached = np.flatnonzero(away >= distance)
        north, east, _ = way[reached[0] if len(reached) else np.argmax(away)].tolist()
        return np.array([north, east, above[2]])

    def resume_landing(self, time: float) -> None:
        """Go back above the landing place and land, from the rest at ``time`` (s)."""
        here, above = self.trajectory.position(time), self.above
        self._above = WaypointTrajectory(here, [self._leg(above)], self._motion.limits, start=time)
        self.trajectory = self._above.then(self._land)

    def return_home(self, followed: Trajectory, time: float) -> None:
        """Come to rest as soon as the limits allow, then fly home and land there; not below where it was to land from.

        ``followed`` and ``time`` (s) as of :meth:`brake_and_land`.
        """
        top = self.above[2] if math.isfinite(self._above.end) else math.inf
        self._climb = None
        self.landing_from = self.slow_from = math.inf
        self._above = followed.stop(time).then(lambda end, here: self._home(end, here, min(here[2], top)))
        self.trajectory = self._above.then(self._land)

    def _home(self, time: float, here: Array, top: float) -> Trajectory:
        legs = [self._leg(np.array([*place[:2], top])) for place in (here, self._pad)]
        return WaypointTrajectory(here, legs, self._motion.limits, start=time)

    def _leg(self, place: Array) -> paths.Leg:
        return paths.Leg(place, self._motion.speed)

    def _rise(self, take_off: TakeOff, position: Array) -> list[paths.Leg]:
        top, speed = np.array([position[0], position[1], take_off.position[2]]), self._motion.climb_speed
        delay = [paths.Leg(position, speed, take_off.delay)] if take_off.delay else []
        return [*delay, paths.Leg(top, speed)]

    def _land(self, time: float, here: Array) -> Trajectory:
        self.landing_from = time
        slow = np.array([here[0], here[1], self._ground - self._settings.slow_height])
        touch = np.array([here[0], here[1], self._ground + self._settings.landing_overshoot])
        limits = self._motion.climb_limits
        last = paths.Leg(touch, self._motion.landing_speed)
        if here[2] >= slow[2] - self._settings.slow_margin:
            self.slow_from = time
            return WaypointTrajectory(here, [last], limits, start=time)
        down = WaypointTrajectory(here, [paths.Leg(slow, self._motion.climb_speed)], limits, start=time)
        return down.then(lambda t, low: self._touch(t, low, last))

    def _touch(self, time: float, low: Array, last: paths.Leg) -> Trajectory:
        self.slow_from = time
        return WaypointTrajectory(low, [last], self._motion.climb_limits, start=time)


def _place(position: Array) -> Position:
    north, east, down = position.tolist()
    return north, east, down


def _ways(trajectory: Trajectory, times: Array) -> Array:
    """Return the lengths (K,) (m) of its path up to ``times`` (K,) (s)."""
    steps = np.diff(trajectory.derivatives(times, 0)[0], axis=0)
    return np.append(0.0, np.cumsum(np.linalg.norm(steps, axis=1)))
