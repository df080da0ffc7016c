"""The legs of a route as numbers: where each ends, how long it is, and about how long it takes."""

import math
from dataclasses import dataclass
from enum import StrEnum
from itertools import islice

from gcs.config import MotionConfig, SystemConfig
from gcs.mission.cargo import CargoState
from gcs.mission.commands import GripperAction
from gcs.mission.route import (
    Circle,
    FlyTo,
    Gripper,
    GroundLeg,
    HoldForever,
    Land,
    Leg,
    Position,
    Route,
    Stand,
    TakeOff,
)

COUNTED_LEGS = 20_000


class End(StrEnum):
    """How a route ends."""

    LANDING = "landing"
    HOLD = "hold"
    NONE = "none"


@dataclass(frozen=True)
class FlownLeg:
    """One leg: its end from home's ground point (m), ``altitude`` up, its length (m) and time from rest to rest (s)."""

    number: int
    action: str
    north: float
    east: float
    altitude: float
    speed: float | None
    """m/s; None: that of take-off or landing."""
    length: float
    time: float
    source: str


@dataclass(frozen=True)
class FlownLegs:
    """All legs; of an endless route one lap."""

    legs: tuple[FlownLeg, ...]
    end: End

    @property
    def length(self) -> float:
        """Length of all legs (m)."""
        return sum(leg.length for leg in self.legs)

    @property
    def time(self) -> float:
        """About how long all take (s)."""
        return sum(leg.time for leg in self.legs)


def flown_legs(route: Route, system: SystemConfig) -> FlownLegs:
    """Return the legs of a ``route`` in the order of flight, from the pad."""
    start: Position = (0.0, 0.0, -system.resting_altitude)
    legs = route.first_lap(COUNTED_LEGS)
    cargo = CargoState(system)
    flown = []
    for number, leg in enumerate(legs, start=1):
        length, time, start = _measure(leg, start, system.motion)
        north, east, down = start
        speed = leg.speed if isinstance(leg, FlyTo | Circle) else None
        flown.append(FlownLeg(number, _action(leg, cargo), north, east, -down, speed, length, time, leg.source))
        if isinstance(leg, Gripper):
            cargo.carry_out(leg)
    end = End.HOLD if isinstance(legs[-1], HoldForever) else End.LANDING
    if next(islice(route.legs(), len(legs), None), None) is not None:
        end = End.NONE
    return FlownLegs(tuple(flown), end)


def _action(leg: Leg, cargo: CargoState) -> str:
    match leg:
        case TakeOff(delay=delay):
            return f"wait {delay:g} s, take off" if delay else "take off"
        case FlyTo(hold=hold):
            return ("spline to" if leg.spline else "fly to") + (f", hold {hold:g} s" if hold else "")
        case Circle(turns=turns, radius=radius):
            sense = "clockwise" if leg.clockwise else "counter-clockwise"
            return f"circle {turns:g} x {radius:g} m {sense}"
        case HoldForever():
            return "hold until stopped"
        case Stand(seconds=seconds):
            return f"stand {seconds:g} s"
        case Gripper():
            return _grip(leg, cargo)
    return "land"


def _grip(leg: Gripper, cargo: CargoState) -> str:
    """Return ``unload gripper 1 (0.5 kg)``."""
    numbers = sorted(cargo.moved(leg))
    what, lacks = ("unload", "empty") if leg.action is GripperAction.RELEASE else ("load", "full")
    name = ", ".join(map(str, numbers)) or (str(leg.gripper) if leg.gripper else "all")
    return f"{what} gripper {name} " + (f"({cargo.mass_of(leg):g} kg)" if numbers else f"({lacks} already)")


def _measure(leg: Leg, start: Position, motion: MotionConfig) -> tuple[float, float, Position]:
    """Return length (m), time (s) and end of a leg, as an upper estimate: from rest to rest."""
    if isinstance(leg, Circle):
        length = math.tau * leg.radius * leg.turns
        speed = min(leg.speed, math.sqrt(motion.acceleration * leg.radius))
        return length, _time(length, speed, motion), leg.end(start)
    if isinstance(leg, GroundLeg):
        return 0.0, leg.seconds if isinstance(leg, Stand) else 0.0, start
    length = math.dist(start, leg.position)
    if isinstance(leg, FlyTo):
        vertical = abs(start[2] - leg.position[2])
        return length, max(_time(length, leg.speed, motion), vertical / motion.climb_speed) + leg.hold, leg.position
    if isinstance(leg, TakeOff):
        return length, leg.delay + _time(length, motion.climb_speed, motion), leg.position
    return length, length / motion.landing_speed if isinstance(leg, Land) else 0.0, leg.position


def _time(length: float, speed: float, motion: MotionConfig) -> float:
    """Return the time from rest to rest at a bounded acceleration (s)."""
    if length < speed**2 / motion.acceleration:
        return 2.0 * math.sqrt(length / motion.acceleration)
    return length / speed + speed / motion.acceleration
