"""A route: a small program of steps, run leg by leg.

Jumps make a route a program rather than a list: it may be endless, and a position that is not given depends on the
steps before. :meth:`Route.legs` runs it lazily.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import islice

Position = tuple[float, float, float]

END = "end of mission"
"""Source of what follows a mission that does not say how it ends."""


# What is flown --------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class TakeOff:
    """Straight up from the pad to ``position`` (NED, m), after ``delay`` seconds on the pad."""

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
    """Straight down to the ground below ``position``, the payload's resting place (NED, m); the last leg."""

    position: Position
    source: str


Leg = TakeOff | FlyTo | Circle | HoldForever | Land


# What is written ------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Place:
    """A place in m from home's ground point: (north, east), altitude above it. None: as it is then."""

    horizontal: tuple[float, float] | None = None
    altitude: float | None = None


@dataclass(frozen=True)
class Step:
    """One step of the program; ``source`` names the line or item it comes from."""

    source: str


@dataclass(frozen=True)
class Climb(Step):
    """Take-off: straight up to the altitude, then to the place."""

    place: Place


@dataclass(frozen=True)
class Go(Step):
    """Fly to a place, and hold there (s)."""

    place: Place
    hold: float = 0.0
    spline: bool = False


@dataclass(frozen=True)
class Turn(Step):
    """Around a place (m)."""

    place: Place
    radius: float
    turns: float
    clockwise: bool


@dataclass(frozen=True)
class Stay(Step):
    """Fly to a place, and hold there until stopped."""

    place: Place


@dataclass(frozen=True)
class Wait(Step):
    """Hold here (s)."""

    seconds: float


@dataclass(frozen=True)
class Descend(Step):
    """Fly to above a place, and land."""

    place: Place


@dataclass(frozen=True)
class Return(Step):
    """Fly to above home at the present altitude, and land."""


@dataclass(frozen=True)
class Speed(Step):
    """Speed from here on (m/s); None: the route's own."""

    speed: float | None


@dataclass(frozen=True)
class Jump(Step):
    """Jump to the step of index ``target``, ``repeats`` times (None: always), then go on."""

    target: int
    repeats: int | None


class RouteError(Exception):
    """A step that cannot be flown where the program meets it: ``source`` and the reason."""

    def __init__(self, source: str, reason: str) -> None:
        super().__init__(reason)
        self.source = source
        self.reason = reason


@dataclass(frozen=True)
class Route:
    """Steps to be flown at ``speed`` (m/s) where they do not say; the payload rests at ``resting_altitude`` (m)."""

    steps: tuple[Step, ...]
    speed: float
    resting_altitude: float
    holds_at_end: bool = False
    """Whether a route without a landing ends with a hold, as in PX4, and not with a landing at home."""

    def legs(self, start: Position | None = None) -> Iterator[Leg]:
        """Yield the legs in the order of flight, lazily: a route may be endless.

        The first is a :class:`TakeOff`; the last, if there is one, a :class:`Land` or :class:`HoldForever`. A route
        without a landing ends with one at home, or with a hold. Jumps keep their count for the whole flight.

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
                        yield HoldForever(flight.airborne(step.source), step.source)
                        return
                    continue
                taken[here], lap_at[here], index = count + 1, flight.progress, step.target
                continue
            yield from flight.fly(step)
            if flight.ended:
                return
        yield from flight.fly(Stay(END, Place()) if self.holds_at_end else Return(END))

    def beginning_at(self, source: str) -> Route:
        """Return the route that begins with the first step of ``source``; without one, with what follows the last."""
        first = next((index for index, step in enumerate(self.steps) if step.source == source), len(self.steps))
        moved = (replace(s, target=s.target + 1) if isinstance(s, Jump) else s for s in self.steps)
        return replace(self, steps=(Jump(source, first + 1, None), *moved))

    def first_lap(self, limit: int) -> list[Leg]:
        """Return up to ``limit`` legs; of an endless route those before an item is flown for the second time."""
        legs = list(islice(self.legs(), limit))
        if isinstance(legs[-1], Land | HoldForever):
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
        self.altitude = None if start is None else -start[2]  # None: on the pad
        self.speed = route.speed
        self.delay = 0.0
        self.progress = 0
        self.ended = False

    def airborne(self, source: str) -> Position:
        """Return the present position; an error on the pad."""
        if self.altitude is None:
            raise RouteError(source, "the payload is still on the pad, and no altitude is given to take off to")
        return (*self.horizontal, -self.altitude)

    def fly(self, step: Step) -> Iterator[Leg]:
        """Yield the legs of one step."""
        source = step.source
        match step:
            case Speed(speed=speed):
                self.speed = self.route.speed if speed is None else speed
            case Wait(seconds=seconds) if self.altitude is None:
                self.delay += seconds
            case Wait(seconds=seconds):
                yield from self._go(Place(), source, hold=seconds)
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
                self.ended = True
                yield HoldForever(self.airborne(source), source)
            case Descend() | Return():
                self.airborne(source)
                target = step.place.horizontal if isinstance(step, Descend) else (0.0, 0.0)
                if target is not None and target != self.horizontal:
                    yield from self._go(Place(target), source)
                self.ended = True
                yield Land((*self.horizontal, -self.route.resting_altitude), source)

    def _go(self, place: Place, source: str, *, hold: float = 0.0, spline: bool = False) -> Iterator[Leg]:
        if self.altitude is None:
            if place.altitude is None:
                self.airborne(source)
            self.altitude = place.altitude
            self.progress += 1
            yield TakeOff(self.airborne(source), source, self.delay)
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
