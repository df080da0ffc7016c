"""The legs of a mission as a flight takes them: those on the ground, those up to the next landing, and so on."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Self

from gcs.mission.model import Lissajous, Mission
from gcs.mission.route import Circle, FlyTo, GroundLeg, HoldForever, Land, Leg, Position, Route, TakeOff

_SHORTEST_ARC = 1e-3
"""Turns; what is left of a circle is flown if it is more."""


@dataclass(frozen=True)
class Curve:
    """A mission's ``curve`` from a ``phase`` (rad) on, ``duration`` (s) at its full rate; then back above the pad.

    Without duration only back.
    """

    curve: Lissajous
    duration: float
    phase: float = 0.0
    above: Position | None = None
    """Where it leads back to (NED, m); None: where the flight to it begins."""
    source: str = "curve"


MissionLeg = Leg | Curve


def legs_of(mission: Mission) -> Iterator[MissionLeg]:
    """Return the legs of a mission; of a curve the take-off, and the curve, after which it lands."""
    reference = mission.reference
    if isinstance(reference, Route):
        return reference.legs()
    return iter((TakeOff((0.0, 0.0, -reference.altitude), "take-off"), Curve(reference, reference.duration)))


class MissionLegs:
    """Legs that are still to come; an endless mission has no end."""

    def __init__(self, legs: Iterator[MissionLeg]) -> None:
        self._legs = legs
        self._next: MissionLeg | None = next(self._legs, None)

    @classmethod
    def of(cls, mission: Mission) -> Self:
        """Return the legs of a mission."""
        return cls(legs_of(mission))

    @property
    def ended(self) -> bool:
        """True if there is nothing more to do, in the air or on the ground."""
        return self._next is None

    @property
    def takes_off(self) -> bool:
        """True if the next leg is flown."""
        return not (self._next is None or isinstance(self._next, GroundLeg))

    @property
    def next_source(self) -> str | None:
        """Source of the next leg; None: there is none."""
        return None if self._next is None else self._next.source

    def on_ground(self) -> Iterator[GroundLeg]:
        """Yield the legs on the ground before the next take-off."""
        while isinstance(leg := self._next, GroundLeg):
            self._next = next(self._legs, None)
            yield leg

    def flight(self) -> Iterator[MissionLeg]:
        """Yield the legs from the next take-off to the landing that follows it."""
        for leg in self:
            yield leg
            if isinstance(leg, Land):
                return

    def __iter__(self) -> Iterator[MissionLeg]:
        """Yield all legs."""
        while (leg := self._next) is not None:
            self._next = None if isinstance(leg, HoldForever) else next(self._legs, None)
            yield leg


def remaining_legs(
    legs: Sequence[MissionLeg], passages: Sequence[float], time: float, here: Position, begin: tuple[float, Position]
) -> list[MissionLeg]:
    """Return what remains of ``legs`` at ``time`` (s), also of the one that is flown then.

    Args:
        legs: those that have been read.
        passages: times at which the first of them were passed, or will be (s); of a hold, when it begins.
        time: now.
        here: place then, on the trajectory along the legs (NED, m).
        begin: time and place at which the trajectory begins.
    """
    passed = sum(at <= time for at in passages)
    left = [*legs[passed:]]
    last = legs[passed - 1] if passed else None
    if isinstance(last, HoldForever):
        return [last]
    if isinstance(last, FlyTo) and (rest := passages[passed - 1] + last.hold - time) > 0.0 and last.hold > 0.0:
        return [replace(last, hold=rest), *left]
    if left and isinstance(circle := left[0], Circle) and passed < len(passages):
        since, start = begin if last is None else (passages[passed - 1], _place(last))
        turns = _turns_left(circle, start, here, (time - since) / (passages[passed] - since))
        left[:1] = [replace(circle, turns=turns)] if turns > _SHORTEST_ARC else []
    return left


def _place(leg: MissionLeg) -> Position:
    assert not isinstance(leg, Curve | Circle | HoldForever)  # before a circle its entry is flown to
    return leg.position


def _turns_left(circle: Circle, start: Position, here: Position, share: float) -> float:
    """Return how many turns are left ``here``, where about a ``share`` of those from ``start`` is flown."""
    north, east, _ = circle.centre
    swept = math.atan2(here[1] - east, here[0] - north) - math.atan2(start[1] - east, start[0] - north)
    part = (swept if circle.clockwise else -swept) / math.tau
    flown = part + round(max(share, 0.0) * circle.turns - part)
    return circle.turns - max(flown, 0.0)
