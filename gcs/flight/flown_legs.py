"""The legs of one flight, between climb and landing, as a trajectory: which were read and passed, what remains."""

import math
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from gcs.config import MotionConfig
from gcs.flight.mission_legs import Curve, MissionLeg, remaining_legs
from gcs.mission.route import Circle, FlyTo, HoldForever, Land, Position, TakeOff
from idc_controller.arrays import Array
from idc_controller.trajectory import paths
from idc_controller.trajectory.lissajous import LissajousCurve, LissajousTrajectory
from idc_controller.trajectory.trajectory import RestTrajectory, Trajectory
from idc_controller.trajectory.waypoints import WaypointTrajectory


class FlownLegs:
    """Legs up to the landing, read as far as they are planned. Times are the team's (s), positions NED (m)."""

    def __init__(self, legs: Iterator[MissionLeg], speed: float, motion: MotionConfig) -> None:
        """``speed``: none is flown faster (m/s)."""
        self._speed, self._motion = speed, motion
        first = next(legs)
        self._legs = legs
        self._read: list[MissionLeg] = [] if isinstance(first, Land) else [first]
        """Those before the landing that were read: the first at once."""
        self.landing = first if isinstance(first, Land) else None
        """The landing, once it is read."""
        self._waypoints: WaypointTrajectory | None = None
        self._curve: LissajousTrajectory | None = None
        self._begin: tuple[float, Position] = math.inf, (math.nan, math.nan, math.nan)
        """Time and place at which the trajectory begins."""

    def trajectory(self, time: float, here: Array) -> Trajectory:
        """Return the trajectory along them from ``here`` (3,) at ``time``; the others are read when it is evaluated."""
        north, east, down = here.tolist()
        self._begin = time, (north, east, down)
        limits = replace(self._motion.limits, speed=self._speed)
        self._waypoints = WaypointTrajectory(here, self._lines(), limits, start=time, corner=self._motion.corner)
        return self._waypoints.then(self._after_waypoints)

    def passed(self, time: float) -> list[str]:
        """Return the sources of the legs that were flown until ``time``."""
        return [leg.source for leg in self._read[: self._number_passed(time)]]

    def next_source(self, time: float) -> str | None:
        """Return the source of the waypoint, or landing, that is flown to at ``time``; None: it holds at the last."""
        number = self._number_passed(time)
        leg = self._read[number] if number < len(self._read) else self.landing
        return None if leg is None else leg.source

    def remaining(self, time: float, here: Position, pad: Position) -> list[MissionLeg]:
        """Return what remains at ``time``, ``here``, of those that were read; a curve leads back above the ``pad``."""
        passages = [] if self._waypoints is None else self._waypoints.passages
        left = remaining_legs(self._read, passages, time, here, self._begin)
        if left and isinstance(curve := left[-1], Curve):
            return [*left[:-1], _rest_of_curve(curve, self._curve, time, pad)]
        if self.landing is None:
            return left
        above = FlyTo((*self.landing.position[:2], here[2]), self._motion.speed, self.landing.source)
        return [*(left or [above]), self.landing]

    def _number_passed(self, time: float) -> int:
        return 0 if self._waypoints is None else bisect_right(self._waypoints.passages, time)

    def _to_landing(self) -> Iterator[MissionLeg]:
        yield from [*self._read]
        while self.landing is None and (leg := next(self._legs, None)) is not None:
            if isinstance(leg, Land):
                self.landing = leg
            else:
                self._read.append(leg)
                yield leg

    def _lines(self) -> Iterator[paths.Leg | paths.Circle]:
        """Yield the legs up to the landing or a curve."""
        for leg in self._to_landing():
            if isinstance(leg, FlyTo):
                yield paths.Leg(leg.position, leg.speed, leg.hold)
            elif isinstance(leg, Circle):
                yield paths.Circle(leg.centre, leg.radius, leg.turns, leg.speed, leg.clockwise)
            elif isinstance(leg, HoldForever):
                yield paths.Leg(leg.position, self._motion.speed, math.inf)
            elif isinstance(leg, TakeOff):
                yield paths.Leg(leg.position, self._motion.climb_speed, leg.delay)
            elif isinstance(leg, Curve):
                return

    def _after_waypoints(self, time: float, here: Array) -> Trajectory:
        last = self._read[-1] if self._read else None
        return self._figure(last, time, here) if isinstance(last, Curve) else RestTrajectory(here, time)

    def _figure(self, leg: Curve, time: float, here: Array) -> Trajectory:
        """Return the trajectory to the curve, along it, and back above the pad."""
        limits, speed, above = self._motion.limits, self._motion.speed, here if leg.above is None else leg.above
        curve = LissajousCurve(leg.curve.amplitude, down=-leg.curve.altitude)

        def straight(begin: float, start: Array, end: ArrayLike) -> Trajectory:
            return WaypointTrajectory(start, [paths.Leg(end, speed)], limits, start=begin)

        def along(begin: float, _: Array) -> Trajectory:
            rate, limits = leg.curve.angular_frequency, self._motion.curve_limits
            self._curve = LissajousTrajectory(curve, rate, leg.duration, limits, begin, leg.phase)
            return self._curve

        if not leg.duration:
            return straight(time, here, above)
        there = straight(time, here, curve.at(np.array([[leg.phase]]))[0, 0])
        return there.then(along).then(lambda begin, end: straight(begin, end, above))


def _rest_of_curve(leg: Curve, curve: LissajousTrajectory | None, time: float, pad: Position) -> Curve:
    leg = replace(leg, above=(*pad[:2], -leg.curve.altitude))
    if curve is None:
        return leg
    begin, end = curve.full_rate
    return replace(leg, duration=max(min(end - time, end - begin), 0.0), phase=float(curve.phase(time)))
