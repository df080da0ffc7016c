"""Orders of a team in flight and before its take-off: the mission, its speed, go-to, hold and landing."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain
from typing import TYPE_CHECKING, NamedTuple, Protocol

from gcs.flight.flight import Flight
from gcs.flight.mission_legs import MissionLeg
from gcs.flight.phase import IN_AIR, STANDING, Phase
from gcs.mavlink import px4
from gcs.mission.model import Lissajous, Mission
from gcs.mission.route import Circle, FlyTo, HoldForever, Land, Leg, Position, Route
from gcs.mission.steps import Climb, Place, Stay
from gcs.serve.flight_speed import FlightSpeed, LegSpeeds

if TYPE_CHECKING:
    from gcs.config import SystemConfig


def take_off_route(
    system: SystemConfig, pad: tuple[float, float], altitude: float, speed: float | None = None
) -> Route:
    """Return the route straight up to ``altitude`` (m above home) over a ``pad`` (north, east), and a hold there."""
    here = Place(pad, altitude)
    steps = (Climb("take-off", here), Stay("take-off", here))
    return Route(steps, system.motion.speed, system.resting_altitude)


class _LeftMission(NamedTuple):
    """What remains of a mission that was left: its legs, and their speeds."""

    legs: Iterator[MissionLeg]
    speeds: LegSpeeds

    def with_speed(self, wanted: float) -> _LeftMission:
        """Return it with the speed ``wanted`` (m/s), if that is faster, of the legs whose mission names none."""
        planned, fastest = self.speeds
        if wanted <= planned:
            return self
        legs = (
            replace(leg, speed=wanted) if isinstance(leg, FlyTo | Circle) and leg.speed == planned else leg
            for leg in self.legs
        )
        return _LeftMission(legs, LegSpeeds(wanted, max(wanted, fastest)))


class Ordered(Protocol):
    """Whose flight is ordered."""

    changes: int
    """Rises with every change that is to be reported."""
    world: Mission
    """System, home and obstacles."""
    pad: tuple[float, float]
    """Where the payload stood when it was armed last, north and east (m)."""

    @property
    def flight(self) -> Flight:
        """The flight."""

    @property
    def in_air(self) -> bool:
        """True from spool-up until the rotors have stopped."""

    @property
    def is_armed(self) -> bool:
        """True while vehicles are armed, or about to be."""

    def enter(self, mode: int) -> None:
        """Report a custom mode from now on."""


class Orders:
    """What a session's flight is ordered to do. Positions are NED (m)."""

    def __init__(self, session: Ordered) -> None:
        self._session = session
        self.mission: Mission | None = None
        """The mission that was uploaded; None: there is none."""
        self.first = ""
        """Source of the item at which the mission is begun, or goes on; empty: its beginning."""
        self._left: _LeftMission | None = None
        """What remains of the mission that was left, to go on with; None: it is begun at :attr:`first`."""
        self._speed = FlightSpeed()
        self._flies_mission = False

    @property
    def _flight(self) -> Flight:
        return self._session.flight

    @property
    def _world(self) -> Mission:
        return self._session.world

    @property
    def may_order(self) -> bool:
        """True while the payload can be ordered elsewhere: in the air, before its landing, without a failsafe."""
        return self._flight.phase in IN_AIR - {Phase.LAND} and not self._flight.reason

    @property
    def may_begin(self) -> bool:
        """True while a take-off can be ordered: armed, or about to be, and none was ordered yet."""
        return self._session.is_armed and not (
            self._session.in_air or self._flight.may_take_off or self._flight.stands_down
        )

    @property
    def is_at_stop(self) -> bool:
        """True while a mission stands on the ground, and is to go on by itself."""
        flight = self._flight
        goes_on = self._flies_mission and flight.may_take_off and not flight.reason and self._session.is_armed
        return goes_on and flight.phase in STANDING and (not flight.flown.legs.ended or flight.phase is Phase.ON_GROUND)

    @property
    def may_begin_elsewhere(self) -> bool:
        """True while a mission was begun of which nothing has been done yet: it may begin at another item."""
        flight = self._flight
        waits = flight.phase in (Phase.CONNECT, Phase.CHECK, Phase.ARM) and not flight.reason
        return (
            self._flies_mission
            and waits
            and self._session.is_armed
            and not flight.landings
            and flight.ground_legs is None
        )

    @property
    def is_paused(self) -> bool:
        """True while what was flown is paused on its way."""
        return self._flight.flown.is_held

    @property
    def is_settled(self) -> bool:
        """True while the payload holds at the end of the last order, or is paused at rest."""
        flight = self._flight
        if flight.phase not in IN_AIR:
            return not self._session.is_armed
        return flight.is_at_rest and (self.is_paused or flight.next_source is None)

    @property
    def flies_mission(self) -> bool:
        """True while the mission is flown, be it paused."""
        return self._flies_mission

    @property
    def position(self) -> Position:
        """Where the payload is planned to be now."""
        return self._flight.flown.position(self._flight.time)

    @property
    def lowest(self) -> float:
        """Least height (m above home) at which the payload is flown to a place."""
        system = self._world.system
        return system.resting_altitude + system.guidance.navigator.ground_clearance

    @property
    def is_mission_done(self) -> bool:
        """True if the whole mission was flown, and at its end landed or held for good."""
        flight = self._flight
        if not self._flies_mission:
            return False
        if flight.phase in IN_AIR:
            return flight.phase is Phase.HOLD and flight.next_source is None
        return flight.flown.legs.ended and flight.landings > 0 and not flight.reason

    def why_unflyable(self) -> str | None:
        """Return why the mission cannot be begun as it was chosen, or gone on with, from here; None: it can."""
        goes_on = self._session.in_air and (self._left is not None or (self._flies_mission and self.is_paused))
        return None if goes_on else self.why_not_at(self.first)

    def why_not_at(self, first: str) -> str | None:
        """Return why the mission cannot be begun at an item, or its beginning (empty), from here; None: it can."""
        assert self.mission is not None
        if not isinstance(route := self.mission.reference, Route):
            return "a curve begins on the ground" if self._session.in_air else None
        route = route.beginning_at(first) if first else route
        return route.problem(self._above_ground if self._session.in_air else None)

    # Orders

    def take_off(self, altitude: float) -> None:
        """Take off to ``altitude`` (m above home), and hold there."""
        route = take_off_route(self._world.system, self._session.pad, altitude)
        self._begin(self._world, replace(route, speed=self._cruise_speed))
        self._session.enter(px4.MODE_TAKEOFF)

    def choose(self, first: str) -> None:
        """Begin the mission at an item, or at its beginning (empty), when it is flown next."""
        self.first, self._left = first, None

    def fly_mission(self) -> None:
        """Fly the mission: take off for it, go on with it where it was left, or begin it at the item that was chosen.

        In the air it is begun from where the payload is.
        """
        assert self.mission is not None
        paused, left = self._flies_mission and self.is_paused, self._left
        self._flies_mission, self._left = True, None
        wanted = self._speed.of_mission(self.mission)
        if not self._session.in_air:
            self._begin(self.mission, self._route())
        elif paused and wanted <= self._speed.legs.planned:
            self._flight.flown.resume(self._flight.time, self._speed.plan(self._speed.legs, wanted))
        elif paused or left is not None:
            left = (left or _LeftMission(self._flight.flown.remaining(), self._speed.legs)).with_speed(wanted)
            self._fly(left.legs, left.speeds, wanted)
        else:
            self._begin_in_air(None)
        self._limit_speed()
        self._session.enter(px4.MODE_MISSION)

    def fly_item(self) -> None:
        """Leave the item of the mission that is flown to, or begun at, for the one that was chosen."""
        if self._session.in_air:
            self._begin_in_air(None)
            self._session.enter(px4.MODE_MISSION)
        else:
            self.fly_mission()

    def _begin_in_air(self, first: str | None) -> None:
        """Begin the mission from where it is at an item; None: at the one that was chosen."""
        self.first = first or self.first
        route = self._route()
        assert isinstance(route, Route)
        self._fly(route.legs(self._above_ground), self._speeds_of(route), route.speed)

    def _route(self) -> Route | Lissajous:
        """Return the mission's route from the chosen item on, with the speed that was ordered."""
        assert self.mission is not None
        route = self.mission.reference
        if isinstance(route, Route):
            route = route.beginning_at(self.first) if self.first else route
            route = replace(route, speed=self._speed.of_mission(self.mission))
        return route

    def hold(self) -> None:
        """Come to rest on the way, and hold."""
        self._flight.flown.hold(self._flight.time)
        self._session.enter(px4.MODE_HOLD)

    def go_to(self, place: Position, speed: float | None) -> None:
        """Fly to a place, and hold there."""
        legs: list[Leg] = [FlyTo(place, speed or self._cruise_speed, "go to"), HoldForever(place, "go to")]
        self._leave_mission(legs)
        self._session.enter(px4.MODE_HOLD)

    def land(self, over: tuple[float, float] | None = None) -> None:
        """Land ``over`` a place (north, east), after a flight at the present altitude; None: where it is."""
        legs: list[Leg] = []
        if over is not None:
            legs.append(FlyTo((*over, self._above_ground[2]), self._cruise_speed, "return"))
        self._leave_mission([*legs, Land((0.0, 0.0, 0.0), "land")])
        self._session.enter(px4.MODE_LAND if over is None else px4.MODE_RETURN)

    def change_speed(self, speed: float) -> None:
        """Fly with another ``speed`` (m/s) from now on; faster than planned, from the next rest on."""
        self._speed.ordered = speed
        self._have_speed()

    def configure(self, cruise_before: float) -> None:
        """Fly with the settings that the session's world has now; before, its speed (m/s) was ``cruise_before``."""
        system = self._world.system
        if self.mission is not None:
            route = self.mission.reference
            if isinstance(route, Route) and route.speed == cruise_before:  # it names none
                route = replace(route, speed=system.motion.speed)
            self.mission = replace(self.mission, system=system, reference=route)
        if self._speed.ordered is None and system.motion.speed != cruise_before:
            self._have_speed()

    def reset(self) -> None:
        """Forget what a flight that is over was ordered, not the mission."""
        self.choose("")
        self._speed, self._flies_mission = FlightSpeed(), False

    def forget_mission(self) -> None:
        """Leave a paused mission for good, and stay where it was paused."""
        self._flies_mission = False

    def _begin(self, mission: Mission, route: Route | Lissajous) -> None:
        self._speed.plan(self._speeds_of(route), self._speed.of_mission(mission))
        self._flight.begin(replace(mission, reference=route))

    def _speeds_of(self, route: Route | Lissajous) -> LegSpeeds:
        return LegSpeeds.of(route, self._world.system.motion.speed)

    def _leave_mission(self, legs: list[Leg]) -> None:
        if self._flies_mission:
            self.first = self._flight.next_source or ""
            if self.first:
                self._flight.flown.hold(self._flight.time)
                self._left = _LeftMission(self._flight.flown.remaining(), self._speed.legs)
            self._flies_mission = False
        speed = max([self._cruise_speed, *(leg.speed for leg in legs if isinstance(leg, FlyTo))])
        self._fly(iter(legs), LegSpeeds(speed, speed), speed)

    @property
    def _above_ground(self) -> Position:
        """Where the payload is, or, lower than it may be flown, above that."""
        north, east, down = self.position
        return north, east, min(down, -self.lowest)

    def _fly(self, legs: Iterator[MissionLeg], speeds: LegSpeeds, wanted: float) -> None:
        """Fly ``legs`` with the speed ``wanted`` (m/s); from too low for a level flight first straight up."""
        first, up = next(legs), list[Leg]()
        if self._above_ground != self.position and not isinstance(first, Land):
            up.append(FlyTo(self._above_ground, self._world.system.motion.climb_speed, first.source))
        self._flight.flown.fly(self._flight.time, chain(up, (first,), legs), self._speed.plan(speeds, wanted))
        self._session.changes += 1

    def _have_speed(self) -> None:
        """Fly with the wanted speed: a slower one at once, a faster one, or beside the mission's own, on new legs."""
        if not self.may_order or self.is_paused:
            return
        next_source = self._flight.next_source
        if self._flies_mission and next_source and self.mission and self._speed.needs_new_legs(self.mission):
            self._begin_in_air(next_source)
        else:
            self._limit_speed()

    def _limit_speed(self) -> None:
        of_mission = self._speed.of_mission(self.mission) if self._flies_mission and self.mission else None
        wanted = self._cruise_speed if of_mission is None else of_mission
        self._flight.system.guidance.speed_limit = self._speed.limit(wanted)

    @property
    def _cruise_speed(self) -> float:
        return self._speed.cruise(self._world)
