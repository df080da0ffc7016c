"""The team between flights and in flight: which ground station flies now, and what it was ordered to do."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import chain
from typing import TYPE_CHECKING, NamedTuple, Protocol

from gcs.flight.alarms import Alarm
from gcs.flight.failsafe import Failsafe
from gcs.flight.flight import Flight
from gcs.flight.ground_station import GroundStation
from gcs.flight.mission_legs import MissionLeg
from gcs.flight.phase import CONTROLLED, IN_AIR, STANDING, Phase
from gcs.flight.reconfiguration import reconfigure
from gcs.mavlink import px4
from gcs.mission.model import Lissajous, Mission
from gcs.mission.route import FlyTo, HoldForever, Land, Leg, Position, Route
from gcs.mission.steps import Climb, Place, Stay
from gcs.serve.flight_speed import FlightSpeed, LegSpeeds

if TYPE_CHECKING:
    from gcs.config import SystemConfig

PREFLIGHT_DISARM = 10.0
"""s for which armed vehicles wait for a take-off, as COM_DISARM_PRFLT of PX4."""
_RUN_DOWN = 2.0
"""s after disarming, for rotors and load to come to rest before the records of the flight are closed."""
WAITING_ALTITUDE = 3.0
"""m; of the take-off that a flight has until one is ordered. It is not flown."""


class OpenFlight(Protocol):
    """A ground station with its records."""

    @property
    def station(self) -> GroundStation:
        """The ground station."""

    def close(self) -> str:
        """Close the records; return what is to be said of them, empty: there are none."""


class _LeftMission(NamedTuple):
    """What remains of a mission that was left: its legs, and their speeds."""

    legs: Iterator[MissionLeg]
    speeds: LegSpeeds


class TeamSession:
    """One ground station after the other: one that waits, then one for each flight, from arming to disarming.

    Times are the ground's (s), positions NED (m).
    """

    def __init__(self, world: Mission, open_flight: Callable[[Mission, bool], OpenFlight]) -> None:
        """``open_flight`` opens a flight of a mission, with records or without."""
        steps = (Climb("take-off", Place((0.0, 0.0), WAITING_ALTITUDE)), Stay("take-off", Place()))
        resting = world.system.resting_altitude
        self.world = replace(world, reference=Route(steps, world.system.motion.speed, resting))
        """System, home and obstacles of every flight, and the fence of the plans that were uploaded."""
        self._open_flight = open_flight
        self._opened = open_flight(world, False)
        self._wait()
        self.mode = px4.MODE_HOLD
        """The custom mode that was ordered last."""
        self.mission: Mission | None = None
        """The mission that was uploaded; None: there is none."""
        self.first = ""
        """Source of the item at which the mission is begun, or goes on; empty: its beginning."""
        self._left: _LeftMission | None = None
        """What remains of the mission that was left, to go on with; None: it is begun at :attr:`first`."""
        self._speed = FlightSpeed()
        self.pad = 0.0, 0.0
        """Where the payload stood when it was armed last, north and east."""
        self.changes = 0
        """Rises with every change that is to be reported."""
        self.notices: list[str] = []
        """What is to be said to operators, not sent yet."""
        self._alarms = 0
        self._cleared_until = math.inf
        self._flies_mission = False
        self._phase = Phase.CONNECT
        self._now = 0.0
        self.run_down = -math.inf
        """Time until which the records of a flight that has ended remain open (s); -inf: none has."""
        self.closing = False
        """True if no further flight is to begin."""
        self.is_interrupted = False
        """True if it was closed in flight."""
        self.last_reason = ""
        """Why the last flight did not begin; empty: it did, or none was tried."""

    @property
    def station(self) -> GroundStation:
        """The ground station that is connected with the vehicles now."""
        return self._opened.station

    @property
    def flight(self) -> Flight:
        """Its flight."""
        return self.station.flight

    @property
    def in_air(self) -> bool:
        """True from spool-up until the rotors have stopped."""
        return self.flight.phase in CONTROLLED or self.flight.phase is Phase.AUTONOMOUS_LANDING

    @property
    def is_armed(self) -> bool:
        """True while vehicles are armed, or about to be."""
        return self.flight.may_arm and not self.flight.ended

    @property
    def may_order(self) -> bool:
        """True while the payload can be ordered elsewhere: in the air, before its landing, without a failsafe."""
        return self.flight.phase in IN_AIR - {Phase.LAND} and not self.flight.reason

    @property
    def may_begin(self) -> bool:
        """True while a take-off can be ordered: armed, or about to be, and none was ordered yet."""
        return self.is_armed and not (self.in_air or self.flight.may_take_off or self.flight.stands_down)

    @property
    def is_at_stop(self) -> bool:
        """True while a mission stands on the ground, and is to go on by itself."""
        flight = self.flight
        goes_on = self._flies_mission and flight.may_take_off and not flight.reason and self.is_armed
        return goes_on and flight.phase in STANDING and (not flight.legs.ended or flight.phase is Phase.ON_GROUND)

    @property
    def may_begin_elsewhere(self) -> bool:
        """True while a mission was begun of which nothing has been done yet: it may begin at another item."""
        flight = self.flight
        waits = flight.phase in (Phase.CONNECT, Phase.CHECK, Phase.ARM) and not flight.reason
        return self._flies_mission and waits and self.is_armed and not flight.landings and flight.ground_legs is None

    @property
    def is_paused(self) -> bool:
        """True while what was flown is paused on its way."""
        return self.flight.is_held

    @property
    def is_settled(self) -> bool:
        """True while the payload holds at the end of the last order, or is paused at rest."""
        flight = self.flight
        if flight.phase not in IN_AIR:
            return not self.is_armed
        return flight.is_at_rest and (self.is_paused or flight.next_source is None)

    @property
    def flies_mission(self) -> bool:
        """True while the mission is flown, be it paused."""
        return self._flies_mission

    @property
    def ended(self) -> bool:
        """True if it is closing and the payload is on the ground."""
        return self.closing and not self.is_armed and not self._now < self.run_down

    @property
    def position(self) -> Position:
        """Where the payload is planned to be now."""
        flight = self.flight
        assert flight.mission_trajectory is not None
        progress = flight.system.guidance.progress(flight.time)
        north, east, down = flight.mission_trajectory.trajectory.position(progress).tolist()
        return north, east, down

    @property
    def lowest(self) -> float:
        """Least height (m above home) at which the payload is flown to a place."""
        system = self.world.system
        return system.resting_altitude + system.guidance.navigator.ground_clearance

    @property
    def is_mission_done(self) -> bool:
        """True if the whole mission was flown, and at its end landed or held for good."""
        flight = self.flight
        if not self._flies_mission:
            return False
        if flight.phase in IN_AIR:
            return flight.phase is Phase.HOLD and flight.next_source is None
        return flight.legs.ended and flight.landings > 0 and not flight.reason

    def why_unflyable(self) -> str | None:
        """Return why the mission cannot be begun as it was chosen, or gone on with, from here; None: it can."""
        goes_on = self.in_air and (self._left is not None or (self._flies_mission and self.is_paused))
        return None if goes_on else self.why_not_at(self.first)

    def why_not_at(self, first: str) -> str | None:
        """Return why the mission cannot be begun at an item, or its beginning (empty), from here; None: it can."""
        assert self.mission is not None
        if not isinstance(route := self.mission.reference, Route):
            return "a curve begins on the ground" if self.in_air else None
        route = route.beginning_at(first) if first else route
        return route.problem(self._above_ground if self.in_air else None)

    # Orders

    def arm(self) -> None:
        """Begin a flight: connect anew, check, arm, and wait for a take-off. Only when the flight before is ready."""
        north, east, _ = self.flight.system.preflight.payload.tolist()
        self.pad = north, east
        self._opened.close()
        self._open(recorded=True)
        self.flight.may_take_off = False
        self._alarms, self._cleared_until = 0, math.inf
        self.changes += 1

    def take_off(self, altitude: float) -> None:
        """Take off to ``altitude`` (m above home), and hold there."""
        here = Place(self.pad, altitude)
        steps = (Climb("take-off", here), Stay("take-off", here))
        self._begin(self.world, Route(steps, self._cruise_speed, self.world.system.resting_altitude))
        self._set_mode(px4.MODE_TAKEOFF)

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
        if not self.in_air:
            self._begin(self.mission, self._route())
        elif paused and wanted <= self._speed.legs.planned:
            self.flight.resume(self._speed.plan(self._speed.legs, wanted))
        elif left is not None and wanted <= left.speeds.planned:
            self._fly(left.legs, left.speeds, wanted)
        else:
            self._begin_in_air(self.flight.next_source if paused else None)
        self._limit_speed()
        self._set_mode(px4.MODE_MISSION)

    def fly_item(self) -> None:
        """Leave the item of the mission that is flown to, or begun at, for the one that was chosen."""
        if self.in_air:
            self._begin_in_air(None)
            self._set_mode(px4.MODE_MISSION)
        else:
            self.fly_mission()

    def _begin_in_air(self, first: str | None) -> None:
        """Begin the mission from where it is at an item; None: at the one that was chosen."""
        self.first = first or self.first
        route = self._route()
        assert isinstance(route, Route)
        self._fly(route.legs(self._above_ground), LegSpeeds.of(route), route.speed)

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
        self.flight.hold()
        self._set_mode(px4.MODE_HOLD)

    def go_to(self, place: Position, speed: float | None) -> None:
        """Fly to a place, and hold there."""
        legs: list[Leg] = [FlyTo(place, speed or self._cruise_speed, "go to"), HoldForever(place, "go to")]
        self._leave_mission(legs)
        self._set_mode(px4.MODE_HOLD)

    def land(self, over: tuple[float, float] | None = None) -> None:
        """Land ``over`` a place (north, east), after a flight at the present altitude; None: where it is."""
        legs: list[Leg] = []
        if over is not None:
            legs.append(FlyTo((*over, self._above_ground[2]), self._cruise_speed, "return"))
        self._leave_mission([*legs, Land((0.0, 0.0, 0.0), "land")])
        self._set_mode(px4.MODE_LAND if over is None else px4.MODE_RETURN)

    def change_speed(self, speed: float) -> None:
        """Fly with another ``speed`` (m/s) from now on; faster than planned, from the next rest on."""
        self._speed.ordered = speed
        self._have_speed()

    def configure(self, system: SystemConfig) -> None:
        """Have other settings: at once, or from the next legs on, or from the next arming; as the flight takes them."""
        before, cruise = self.world.system.motion.speed, system.motion.speed
        self.world = replace(self.world, system=system)
        if self.mission is not None:
            route = self.mission.reference
            if isinstance(route, Route) and route.speed == before:  # it names none
                route = replace(route, speed=cruise)
            self.mission = replace(self.mission, system=system, reference=route)
        reconfigure(self.flight, system)
        if self._speed.ordered is None and cruise != before:
            self._have_speed()

    def forget_mission(self) -> None:
        """Leave a paused mission for good, and stay where it was paused."""
        self._flies_mission = False

    def disarm(self) -> None:
        """Stay on the ground, with stopped rotors; a mission ends there."""
        if self.is_at_stop:
            self._flies_mission = False
            self.notices.append("Mission ended on the ground")
        self.flight.stand_down()

    def raise_failsafe(self, now: float, failsafe: Failsafe, reason: str) -> None:
        """Land what is in the air, and begin no flight any more."""
        self.closing = True
        if self.is_armed:
            self.is_interrupted = True
            self.station.raise_failsafe(now, failsafe, reason)

    def _begin(self, mission: Mission, route: Route | Lissajous) -> None:
        self._speed.plan(LegSpeeds.of(route), self._speed.of_mission(mission))
        self.flight.begin(replace(mission, reference=route))

    def _leave_mission(self, legs: list[Leg]) -> None:
        if self._flies_mission:
            self.first = self.flight.next_source or ""
            if self.first:
                self.flight.hold()
                self._left = _LeftMission(self.flight.remaining(), self._speed.legs)
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
            up.append(FlyTo(self._above_ground, self.world.system.motion.climb_speed, first.source))
        self.flight.fly(chain(up, (first,), legs), self._speed.plan(speeds, wanted))
        self.changes += 1

    def _have_speed(self) -> None:
        """Fly with the wanted speed: a slower one at once, a faster one, or beside the mission's own, on new legs."""
        if not self.may_order or self.is_paused:
            return
        next_source = self.flight.next_source
        if self._flies_mission and next_source and self.mission and self._speed.needs_new_legs(self.mission):
            self._begin_in_air(next_source)
        else:
            self._limit_speed()

    def _limit_speed(self) -> None:
        of_mission = self._speed.of_mission(self.mission) if self._flies_mission and self.mission else None
        wanted = self._cruise_speed if of_mission is None else of_mission
        self.flight.system.guidance.speed_limit = self._speed.limit(wanted)

    @property
    def _cruise_speed(self) -> float:
        return self._speed.cruise(self.world)

    def _set_mode(self, mode: int) -> None:
        self.mode = mode
        self.changes += 1

    def _reset(self) -> None:
        self.choose("")
        self._speed, self._alarms = FlightSpeed(), 0
        self._flies_mission = False

    def _open(self, *, recorded: bool) -> None:
        """Open a flight of the team as the one before has left it: its cargo, and where it stands."""
        before = self.flight
        self._opened = self._open_flight(self.world, recorded)
        self.flight.cargo = before.cargo
        self.flight.system.preflight.landed = before.system.preflight.landed or not math.isnan(before.takeoff_time)

    def _wait(self) -> None:
        self.flight.may_arm = self.flight.may_take_off = False

    # Time

    def step(self, now: float) -> None:
        """Follow the ground station: report alarms, end what has ended, disarm what waits for too long."""
        flight, self._now = self.flight, now
        self._take_alarms(flight)
        if flight.phase is not self._phase:
            self._phase = flight.phase
            self.changes += 1
        if flight.phase is Phase.ARM and not flight.may_take_off and flight.system.team.armed:
            if self._cleared_until == math.inf:
                self._cleared_until = now + PREFLIGHT_DISARM
            elif now > self._cleared_until:
                self.notices.append(f"Disarmed: no take-off for {PREFLIGHT_DISARM:g} s")
                flight.stand_down()
        if self.mode == px4.MODE_TAKEOFF and flight.phase is Phase.HOLD:
            self._set_mode(px4.MODE_HOLD)
        if flight.ended and flight.may_arm and self.run_down == -math.inf:
            self.run_down = now + _RUN_DOWN
        if flight.ended and not self.closing and now >= self.run_down:
            self._end(flight)

    def _take_alarms(self, flight: Flight) -> None:
        alarms: list[Alarm] = flight.failsafes.alarms.alarms
        for alarm in alarms[self._alarms :]:
            if flight.may_arm:
                self.notices.append(f"{alarm.source}: {alarm.text or alarm.code.code}")
        self._alarms = len(alarms)

    def _end(self, flight: Flight) -> None:
        """Close the records of a flight that has ended, and wait for the next one."""
        said = self._opened.close()
        if flight.may_arm:
            self.notices.append(said or "Flight ended")
        self.last_reason, self.run_down = flight.reason, -math.inf
        self._open(recorded=False)
        self._wait()
        self._reset()
        self._set_mode(px4.MODE_HOLD)

    def close(self) -> str:
        """Close the records."""
        return self._opened.close()
