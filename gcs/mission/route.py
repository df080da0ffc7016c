"""A route: a small program of steps, run leg by leg.

Jumps make a route a program rather than a list: it may be endless, and a position that is not given depends on the
steps before. :meth:`Route.legs` runs it lazily.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import islice

from gcs.mission.commands import GripperAction
from gcs.mission.steps import (
    Climb,
    Descend,
    Go,
    Grip,
    Jump,
    Place,
    PlacePayload,
    Return,
    RouteError,
    Speed,
    Stay,
    Step,
    Turn,
    Wait,
)

Position = tuple[float, float, float]

TRIED_LEGS = 20_000
"""So many legs are tried before the flight. Legs repeat after a lap; a file has at most 10 000 items."""
END = "end of mission"
"""Source of what follows a mission that does not say how it ends."""


@dataclass(frozen=True)
class TakeOff:
    """Straight up from where the payload stands to ``position`` (NED, m), after ``delay`` seconds on the pad."""

    position: Position
    source: str
    delay: float = 0.0


@dataclass(frozen=True)
class FlyTo:
    """Straight to ``position`` (NED, m) at ``speed`` (m/s); there hold for ``hold`` seconds (0: fly on).

    ``spline``: the file wants a smooth curve through this point.
    """

    position: Position
    speed: float
    source: str
    hold: float = 0.0
    spline: bool = False


@dataclass(frozen=True)
class Circle:
    """``turns`` around ``centre`` (NED, m) at ``radius`` (m) and ``speed`` (m/s), from where the leg before ended.

    ``clockwise`` as seen from above.
    """

    centre: Position
    radius: float
    turns: float
    clockwise: bool
    speed: float
    source: str

    def end(self, start: Position) -> Position:
        """Return the end of the circle that begins at ``start``."""
        angle = math.atan2(start[1] - self.centre[1], start[0] - self.centre[0])
        angle += math.fmod(self.turns, 1.0) * math.tau * (1.0 if self.clockwise else -1.0)
        north, east, down = self.centre
        return (north + self.radius * math.cos(angle), east + self.radius * math.sin(angle), down)


@dataclass(frozen=True)
class HoldForever:
    """Hold at ``position`` (NED, m) until stopped; the last leg."""

    position: Position
    source: str


@dataclass(frozen=True)
class Land:
    """Straight down to the ground below ``position``, the payload's resting place (NED, m)."""

    position: Position
    source: str


@dataclass(frozen=True)
class Stand:
    """Stand on the ground at ``position`` (NED, m), disarmed, for ``seconds``."""

    position: Position
    seconds: float
    source: str


@dataclass(frozen=True)
class Gripper:
    """Release or grab what ``gripper`` holds (0: every gripper), on the ground at ``position`` (NED, m)."""

    position: Position
    action: GripperAction
    gripper: int
    source: str


GroundLeg = Stand | Gripper
Leg = TakeOff | FlyTo | Circle | HoldForever | Land | GroundLeg


@dataclass(frozen=True)
class Route:
    """Steps to be flown at ``speed`` (m/s) where they do not say; the payload rests at ``resting_altitude`` (m)."""

    steps: tuple[Step, ...]
    speed: float
    resting_altitude: float
    holds_at_end: bool = False
    """Whether a route without a landing ends with a hold, as in PX4, and not with a landing at home."""

    @property
    def fastest(self) -> float:
        """Return the speed that no leg exceeds (m/s)."""
        return max([self.speed, *(step.speed for step in self.steps if isinstance(step, Speed) and step.speed)])

    def legs(self, start: Position | None = None) -> Iterator[Leg]:
        """Yield the legs in the order of flight, lazily: a route may be endless.

        A :class:`TakeOff` begins each flight, a :class:`Land` ends it; between a landing and the next take-off, before
        the first and after the last, there may be legs on the ground, :class:`Stand` and :class:`Gripper`. The last
        that is flown, if there is one, is a :class:`Land` or :class:`HoldForever`. A route that ends in the air is
        continued by a landing at home, or by a hold. Jumps keep their count for the whole mission.

        ``start``: in the air there (NED, m), where it does not begin with a take-off; None: on the pad.

        Raises :class:`RouteError` for a step that cannot be flown; a :class:`Mission`'s route has been tried.
        """
        flight = _Flight(self, start)
        index, taken, lap_at = 0, dict[int, int](), dict[int, int]()
        while index < len(self.steps):
            step = self.steps[index]
            index += 1
            if isinstance(step, Jump):
                here, count = index - 1, taken.get(index - 1, 0)
                if step.repeats is not None and count >= step.repeats:
                    continue
                if lap_at.get(here) == flight.progress:  # the lap moved nothing and took no time
                    if step.repeats is None:
                        yield from flight.stop(step.source)
                        return
                    continue
                taken[here], lap_at[here], index = count + 1, flight.progress, step.target
                continue
            yield from flight.fly(step)
            if flight.ended:
                return
        if self.holds_at_end and flight.altitude is not None:
            yield from flight.stop(END)
        else:
            yield from flight.fly(Return(END))

    def beginning_at(self, source: str) -> Route:
        """Return the route that begins with the first step of ``source``; without one, with what follows the last."""
        first = next((index for index, step in enumerate(self.steps) if step.source == source), len(self.steps))
        moved = (replace(s, target=s.target + 1) if isinstance(s, Jump) else s for s in self.steps)
        return replace(self, steps=(Jump(source, first + 1, None), *moved))

    def problem(self, start: Position | None = None) -> str | None:
        """Return why it cannot be flown from ``start``, as :meth:`legs` has it; None: it can."""
        try:
            for _ in islice(self.legs(start), TRIED_LEGS):
                pass
        except RouteError as error:
            return f"{error.source}: {error.field}: {error.reason}"
        return None

    def first_lap(self, limit: int) -> list[Leg]:
        """Return up to ``limit`` legs; of an endless route those before an item is flown for the second time."""
        legs = list(islice(self.legs(), limit))
        if len(legs) < limit:
            return legs
        seen = set[str]()
        for index, leg in enumerate(legs):
            if leg.source in seen and leg.source != legs[index - 1].source:
                return legs[:index]
            seen.add(leg.source)
        return legs


class _Flight:
    """State of a route that is run: position, speed, whether it flies."""

    def __init__(self, route: Route, start: Position | None = None) -> None:
        self.route = route
        self.horizontal = (0.0, 0.0) if start is None else start[:2]
        self.altitude = None if start is None else -start[2]  # None: on the ground
        self.speed = route.speed
        self.delay = 0.0
        self.progress = 0
        self.ended = False
        self._landed_by: Step | None = None  # None: on the pad still
        self._standing: list[Stand] = []  # until it is known that something follows

    def airborne(self, source: str) -> Position:
        """Return the present position; an error on the ground."""
        if self.altitude is None:
            place = "still on the pad" if self._landed_by is None else "on the ground"
            raise RouteError(source, "altitude", f"the payload is {place}, and no altitude is given to take off to")
        return (*self.horizontal, -self.altitude)

    def stop(self, source: str) -> Iterator[Leg]:
        """Yield the hold until stopped, and end; after a landing the payload stands already."""
        self.ended = True
        if self.altitude is not None or self._landed_by is None:
            yield HoldForever(self.airborne(source), source)

    def fly(self, step: Step) -> Iterator[Leg]:
        """Yield the legs of one step."""
        source = step.source
        if self.altitude is None and ends_on_ground(step, self._landed_by):
            self.ended = True
            return
        match step:
            case Speed(speed=speed):
                self.speed = self.route.speed if speed is None else speed
            case Wait(seconds=seconds) if self.altitude is None:
                if self._landed_by is None:
                    self.delay += seconds
                else:
                    self._standing.append(Stand(self._resting, seconds, source))
            case Wait(seconds=seconds):
                yield from self._go(Place(), source, hold=seconds)
            case Grip(action=action, gripper=gripper):
                yield from self._grip(action, gripper, source)
            case Climb(place=place):
                yield from self._go(Place(None, place.altitude), source)
                if place.horizontal is not None and math.dist(place.horizontal, self.horizontal) > 0.05:
                    yield from self._go(Place(place.horizontal), source)
            case Go(place=place, hold=hold, spline=spline):
                yield from self._go(place, source, hold=hold, spline=spline)
            case Turn(place=place):
                yield from self._turn(step)
            case Stay(place=place):
                yield from self._go(place, source)
                yield from self.stop(source)
            case PlacePayload():
                yield from self._place_payload(step)
            case Descend() | Return():
                self.airborne(source)
                target = step.place.horizontal if isinstance(step, Descend) else (0.0, 0.0)
                yield from self._land(target, step)

    @property
    def _resting(self) -> Position:
        return (*self.horizontal, -self.route.resting_altitude)

    def _land(self, target: tuple[float, float] | None, step: Step) -> Iterator[Leg]:
        if target is not None and target != self.horizontal:
            yield from self._go(Place(target), step.source)
        self.altitude, self._landed_by = None, step
        yield Land(self._resting, step.source)

    def _grip(self, action: GripperAction, gripper: int, source: str) -> Iterator[Leg]:
        if self.altitude is not None:
            what = "unloading" if action is GripperAction.RELEASE else "loading"
            raise RouteError(source, "command", f"{what} in the air: the payload must land before it (NAV_LAND)")
        yield from self._standing
        self._standing = []
        yield Gripper(self._resting, action, gripper, source)

    def _place_payload(self, step: PlacePayload) -> Iterator[Leg]:
        source, deepest = step.source, step.descent_max
        if step.place.altitude is not None or self.altitude is None:
            yield from self._go(step.place, source)
        *_, down = self.airborne(source)
        if deepest is not None and -down - self.route.resting_altitude > deepest:
            reason = f"the ground is {-down - self.route.resting_altitude:.2f} m below (limit {deepest:g} m)"
            raise RouteError(source, "param 1 (maximum descent)", reason)
        yield from self._land(step.place.horizontal, step)
        if step.releases:
            yield from self._grip(GripperAction.RELEASE, 0, source)
        if step.seconds > 0.0:
            yield Stand(self._resting, step.seconds, source)
        yield from self._go(Place(None, -down), source)

    def _go(self, place: Place, source: str, *, hold: float = 0.0, spline: bool = False) -> Iterator[Leg]:
        if self.altitude is None:
            if place.altitude is None:
                self.airborne(source)
            self.altitude = place.altitude
            self.progress += 1
            yield from self._standing
            delay, self.delay, self._standing = self.delay, 0.0, []
            yield TakeOff(self.airborne(source), source, delay)
            if hold == 0.0 and place.horizontal in (None, self.horizontal):
                return
        before = self.airborne(source)
        self.horizontal = place.horizontal or self.horizontal
        self.altitude = self.altitude if place.altitude is None else place.altitude
        position = self.airborne(source)
        if hold > 0.0 or math.dist(before, position) > 1e-3:
            self.progress += 1
        yield FlyTo(position, self.speed, source, hold, spline)

    def _turn(self, step: Turn) -> Iterator[Leg]:
        north, east = step.place.horizontal or self.horizontal
        away = (self.horizontal[0] - north, self.horizontal[1] - east)
        distance = math.hypot(*away)
        toward = (away[0] / distance, away[1] / distance) if distance > 1e-6 else (1.0, 0.0)
        entry = (north + step.radius * toward[0], east + step.radius * toward[1])
        yield from self._go(Place(entry, step.place.altitude), step.source)
        centre = (north, east, self.airborne(step.source)[2])
        circle = Circle(centre, step.radius, step.turns, step.clockwise, self.speed, step.source)
        self.horizontal = circle.end(self.airborne(step.source))[:2]
        self.progress += 1
        yield circle


def ends_on_ground(step: Step, landed_by: Step | None) -> bool:
    """Return whether a route ends at ``step``, where the payload stands since ``landed_by`` (None: on the pad).

    It is not landed again, nor held where it stands; after a return only a take-off begins another flight.
    """
    if landed_by is None:
        return False
    if isinstance(step, Stay) and step.place.altitude is None:
        return True
    if isinstance(landed_by, Return):
        return isinstance(step, Go | Turn | Stay | Descend | Return | PlacePayload)
    return isinstance(step, Descend | Return)
