"""The legs of a mission as a flight takes them: those on the ground, those up to the next landing, and so on."""

from collections.abc import Iterator
from typing import Self

from gcs.mission.model import Mission
from gcs.mission.route import GroundLeg, HoldForever, Land, Leg, Route


class MissionLegs:
    """Legs that are still to come; an endless mission has no end."""

    def __init__(self, legs: Iterator[Leg], *, curve: bool = False) -> None:
        """``curve``: a take-off to a curve, which has no legs, is still to come."""
        self._legs = legs
        self._next: Leg | None = next(self._legs, None)
        self._curve = curve

    @classmethod
    def of(cls, mission: Mission) -> Self:
        """Return the legs of a mission."""
        route = mission.reference
        return cls(route.legs()) if isinstance(route, Route) else cls(iter(()), curve=True)

    @property
    def ended(self) -> bool:
        """True if there is nothing more to do, in the air or on the ground."""
        return self._next is None and not self._curve

    @property
    def takes_off(self) -> bool:
        """True if the next leg is a take-off, also that to a curve."""
        return self._curve or not (self._next is None or isinstance(self._next, GroundLeg))

    @property
    def next_source(self) -> str | None:
        """Source of the next leg; None: there is none, or a curve."""
        return None if self._next is None else self._next.source

    def on_ground(self) -> Iterator[GroundLeg]:
        """Yield the legs on the ground before the next take-off."""
        while isinstance(leg := self._next, GroundLeg):
            self._next = next(self._legs, None)
            yield leg

    def flight(self) -> Iterator[Leg]:
        """Return the legs from the next take-off to the landing that follows it; none of a curve."""
        self._curve = False  # at once: the legs of a curve are never read
        return self._to_landing()

    def _to_landing(self) -> Iterator[Leg]:
        while (leg := self._next) is not None:
            self._next = None if isinstance(leg, HoldForever) else next(self._legs, None)
            yield leg
            if isinstance(leg, Land):
                return
