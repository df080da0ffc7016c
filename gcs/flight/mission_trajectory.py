"""Mission trajectory: one trajectory of the payload from ground to ground, made of take-off, mission and landing."""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import chain, dropwhile

import numpy as np

from gcs.config import MotionConfig
from gcs.mission.model import Lissajous, Mission
from gcs.mission.route import Circle, FlyTo, GroundLeg, HoldForever, Land, Leg, TakeOff
from gcs.mission.steps import Speed
from idc_controller.arrays import Array
from idc_controller.trajectory import paths
from idc_controller.trajectory.lissajous import LissajousCurve, LissajousTrajectory
from idc_controller.trajectory.trajectory import RestTrajectory, Trajectory
from idc_controller.trajectory.waypoints import WaypointTrajectory

_BACK, _BACK_STEP = 60.0, 0.1
"""s; how far back a place is looked for from which the landing place is seen, and in which steps."""


class MissionTrajectory:
    """Trajectory of the payload from take-off to touchdown, from ``position`` on the ground at ``start``.

    Times are the team's (s), positions NED (m). An endless mission has no end.
    """

    def __init__(
        self,
        mission: Mission,
        position: Array,
        start: float,
        legs: Iterator[Leg] | None = None,
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
        self._takeoff = ""
        """Source of the take-off."""
        climb, legs = self._split(mission, position, _first_flight(mission) if legs is None else legs)
        up = WaypointTrajectory(position, climb, self._motion.climb_limits, start=start)
        self._climb: Trajectory | None = up
        self._above: Trajectory = up.then(lambda time, here: self._flown(mission, legs, time, here))
        """Up to the place above the landing."""
        self.trajectory: Trajectory = self._above.then(self._land)
        self._braking = False
        self._sources: list[str] = []
        """Sources of the legs to waypoints that :attr:`_waypoints` has read."""
        self._waypoints: WaypointTrajectory | None = None
        self.landing = ""
        """Source of the landing, once it is read."""

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
        if self._climb is not None and time < self._climb.end:
            return "climb"
        speed = math.hypot(*self.trajectory.derivatives(np.array([time]), 1)[1, 0].tolist())
        return "fly" if speed > self._settings.hold_speed else "hold"

    def passed(self, time: float) -> list[str]:
        """Return the sources of the waypoints passed until ``time``, since take-off or the last :meth:`go_on`."""
        climbed = [self._takeoff] if self._takeoff and self.phase(time) != "climb" else []
        reached = [] if self._waypoints is None else [at for at in self._waypoints.passages if at <= time]
        return [*climbed, *self._sources[: len(reached)]]

    def next_source(self, time: float) -> str | None:
        """Return the source of the waypoint, or landing, that is flown to at ``time``; None: it holds at the last."""
        if self._climb is not None and time < self._climb.end:
            return self._takeoff
        passed = 0 if self._waypoints is None else sum(at <= time for at in self._waypoints.passages)
        return self._sources[passed] if passed < len(self._sources) else self.landing or None

    def go_on(self, followed: Trajectory, time: float, legs: Iterator[Leg], speed: float) -> None:
        """Come to rest as soon as the limits allow, then fly ``legs``, none faster than ``speed``, and land there.

        Without effect while braking for a landing. Other arguments as of :meth:`brake_and_land`.
        """
        if self._braking:
            return
        self._climb, self._waypoints = None, None
        self.landing_from = self.slow_from = math.inf
        first = next(legs)
        legs, self._takeoff, self.landing = chain((first,), legs), "", ""
        # Until the rest is reached, and legs are planned from there.
        self._sources = [] if isinstance(first, Land) else [first.source]
        if isinstance(first, Land):
            self.landing = first.source
        self._above = followed.stop(time).then(lambda t, here: self._along(legs, speed, t, here))
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

    def _split(self, mission: Mission, position: Array, legs: Iterator[Leg]) -> tuple[list[paths.Leg], Iterator[Leg]]:
        """Return the climb, and the legs that follow it."""
        if isinstance(mission.reference, Lissajous):
            altitude, delay = mission.reference.altitude, 0.0
        else:
            first = next(legs)
            if not isinstance(first, TakeOff):
                raise TypeError(f"a flight begins with a take-off, not with {first}")
            altitude, delay, self._takeoff = -first.position[2], first.delay, first.source
        top = np.array([position[0], position[1], -altitude])
        speed = self._motion.climb_speed
        climb = [paths.Leg(position, speed, delay), paths.Leg(top, speed)] if delay else [paths.Leg(top, speed)]
        return climb, legs

    def _flown(self, mission: Mission, legs: Iterator[Leg], time: float, here: Array) -> Trajectory:
        if isinstance(mission.reference, Lissajous):
            return self._figure(mission.reference, time, here)
        speeds = [step.speed for step in mission.reference.steps if isinstance(step, Speed) and step.speed]
        return self._along(legs, max([self._motion.speed, mission.reference.speed, *speeds]), time, here)

    def _along(self, legs: Iterator[Leg], speed: float, time: float, here: Array) -> Trajectory:
        """Return the trajectory along legs that are no faster than ``speed`` (m/s)."""
        limits = replace(self._motion.limits, speed=speed)
        self._sources = []
        self._waypoints = WaypointTrajectory(here, self._legs(legs), limits, start=time, corner=self._motion.corner)
        return self._waypoints

    def _figure(self, figure: Lissajous, time: float, here: Array) -> Trajectory:
        """Return the trajectory to the curve's beginning, along it, and back to ``here``."""
        curve = LissajousCurve(figure.amplitude, down=-figure.altitude)
        begin = curve.at(np.zeros((1, 1)))[0, 0]
        limits = self._motion.limits
        there = WaypointTrajectory(here, [paths.Leg(begin, self._motion.speed)], limits, start=time)
        along = there.then(
            lambda t, _: LissajousTrajectory(
                curve, figure.angular_frequency, figure.duration, self._motion.curve_limits, start=t
            )
        )
        return along.then(
            lambda t, end: WaypointTrajectory(end, [paths.Leg(here, self._motion.speed)], limits, start=t)
        )

    def _legs(self, legs: Iterator[Leg]) -> Iterator[paths.Leg | paths.Circle]:
        for leg in legs:
            if not isinstance(leg, Land):
                self._sources.append(leg.source)
            if isinstance(leg, FlyTo):
                yield paths.Leg(leg.position, leg.speed, leg.hold)
            elif isinstance(leg, Circle):
                yield paths.Circle(leg.centre, leg.radius, leg.turns, leg.speed, leg.clockwise)
            elif isinstance(leg, HoldForever):
                yield paths.Leg(leg.position, self._motion.speed, math.inf)
            elif isinstance(leg, TakeOff):
                yield paths.Leg(leg.position, self._motion.climb_speed, leg.delay)
            elif isinstance(leg, Land):
                self.landing = leg.source
                return

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


def _first_flight(mission: Mission) -> Iterator[Leg]:
    if isinstance(mission.reference, Lissajous):
        return iter(())
    return dropwhile(lambda leg: isinstance(leg, GroundLeg), mission.reference.legs())
