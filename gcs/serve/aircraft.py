"""The team as the MAVLink services command it: its session carries an order out, or it is refused with the reason."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gcs.flight.phase import Phase
from gcs.mavlink import px4
from gcs.mavlink.services.aircraft import Orbit, Place, Reposition, Sender, Turn
from gcs.mavlink.services.answer import ACCEPTED, Answer, denied, rejected_for_now
from gcs.mavlink.services.local_frame import LocalFrame
from gcs.mavlink.services.mission_item import MissionItem, PlanType
from gcs.mission.items import FARTHEST
from gcs.mission.model import Mission
from gcs.mission.route import Position, Route
from gcs.serve.parameters import CRUISE_SPEED, SETTINGS
from gcs.serve.plan_file import label, mission_of
from gcs.serve.session import TeamSession

if TYPE_CHECKING:
    from gcs.config import SystemConfig
    from gcs.mavlink.services.parameter_table import ParameterTable

TAKEOFF_ALTITUDE = px4.PARAM_TAKEOFF_ALTITUDE
_NO_MISSION = rejected_for_now("Mission denied: no mission")


class TeamAircraft:
    """Four vehicles and their load as one multicopter, as PX4 flies one; its position is the payload's."""

    modes: Sequence[int] = (px4.MODE_TAKEOFF, px4.MODE_HOLD, px4.MODE_MISSION, px4.MODE_RETURN, px4.MODE_LAND)
    obeys_broadcasts = True

    def __init__(self, session: TeamSession, parameters: ParameterTable) -> None:
        self.session, self.orders, self._parameters = session, session.orders, parameters
        self.base = session.world = replace(session.world, name="team", limits=None, faults=())
        """System, home and obstacles, without what was uploaded."""
        self._frame = LocalFrame(session.world.home)
        self._plans: dict[PlanType, Sequence[MissionItem]] = dict.fromkeys(PlanType, ())
        self._labels: list[str] = []
        self._on_reached: Callable[[int], None] = lambda number: None
        self._reached: list[str] = []
        """Sources of the items that were reported."""
        self._reported_at = math.nan
        """Time of the control step after which that was (s, team time)."""
        self._flight, self._seen = session.flight, 0
        """The flight whose progress was reported, and how much of it."""
        self._finished = False

    def configure(self, system: SystemConfig) -> None:
        """Fly with other settings from now on: see :meth:`.TeamSession.configure`."""
        self.base = replace(self.base, system=system)
        self.session.configure(system)

    # Arming

    def arming_problem(self, now: float) -> str | None:
        """Return why the team cannot be armed; None: it can, or is."""
        session = self.session
        if session.flight.phase in (Phase.SPOOL_DOWN, Phase.DISARM):
            return "the flight before is ending"
        if session.is_armed or (session.flight.is_ready and not session.flight.ended):
            return None
        missing = session.flight.system.preflight.missing
        return missing or session.last_reason or "the checks before take-off are running"

    def arm(self, now: float, force: bool = False) -> Answer:
        """Begin a flight; the vehicles are armed when the checks before take-off, never skipped, have passed."""
        if (problem := self.arming_problem(now)) is not None:
            return rejected_for_now(f"Arming denied: {problem}")
        if self.session.is_armed:
            ends = self.session.flight.stands_down
            return rejected_for_now("Arming denied: it is being disarmed") if ends else ACCEPTED
        self.session.arm()
        if self.session.mode == px4.MODE_MISSION:  # chosen on the ground: arming begins it, as in PX4
            return self._begin_mission()
        return ACCEPTED

    def disarm(self, sender: Sender, now: float, force: bool = False) -> Answer:
        """Disarm on the ground; in the air never: the load would fall."""
        session = self.session
        if not session.is_armed:
            return ACCEPTED
        if session.in_air and not self.orders.is_at_stop:
            return denied("Disarming denied: in the air")
        session.disarm()
        return ACCEPTED

    # Modes and orders

    def enter_mode(self, custom_mode: int, sender: Sender, now: float) -> Answer:
        """Enter one of :attr:`modes`."""
        match custom_mode:
            case px4.MODE_TAKEOFF:
                return self.take_off(math.nan, now)
            case px4.MODE_HOLD:
                return self.pause(now)
            case px4.MODE_MISSION:
                return self.resume(now)
            case px4.MODE_RETURN:
                return self._return()
            case px4.MODE_LAND:
                return self._land()
        return denied(f"Mode denied: the team does not fly {px4.mode_name(custom_mode)}")

    def take_off(self, altitude: float, now: float) -> Answer:
        """Take off to ``altitude`` (m above mean sea level; NaN: the parameter's height above home), and hold there."""
        session = self.session
        if not session.is_armed:
            return rejected_for_now("Takeoff denied: not armed")
        if self.orders.is_at_stop:
            return rejected_for_now("Takeoff denied: the mission takes off by itself")
        if not self.orders.may_begin:
            return rejected_for_now(f"Takeoff denied: {self._begun}")
        height = altitude - self.base.home.altitude
        if math.isnan(height):
            height = self._parameters[TAKEOFF_ALTITUDE]
        if (problem := self._why_not((*session.pad, -height))) is not None:
            return denied(f"Takeoff denied: {problem}", 7)
        self.orders.take_off(max(height, self.orders.lowest))
        return ACCEPTED

    def start_mission(self, first: int, now: float) -> Answer:
        """Fly the mission from item ``first`` on; as PX4 it arms for it."""
        if first:
            if (answer := self.set_current_item(first, now)) != ACCEPTED:
                return answer
        else:
            self.orders.choose("")
        if self.orders.mission is None:
            return _NO_MISSION
        if not self.session.is_armed and (answer := self.arm(now)) != ACCEPTED:
            return answer
        return self._begin_mission()

    def pause(self, now: float) -> Answer:
        """Hold; the mission's current item stays. On the ground the mission ends."""
        session = self.session
        if self.orders.may_order:
            self.orders.hold()
        elif self.orders.is_at_stop:
            session.disarm()
        elif session.is_armed:
            return self._refused("Hold")
        else:
            session.mode = px4.MODE_HOLD
        return ACCEPTED

    def resume(self, now: float) -> Answer:
        """Go on with the mission; on the ground it begins when the team is armed."""
        if not self.session.is_armed and self.orders.mission is not None:
            self.session.mode = px4.MODE_MISSION
            return ACCEPTED
        return self._begin_mission()

    def reposition(self, goal: Reposition, now: float) -> Answer:
        """Fly to a place round what is known, and hold there."""
        if not self.orders.may_order:
            return self._refused("Reposition")
        here = self.orders.position
        place = self._local(Place(*goal[:3]), here)
        if (problem := self._why_not(place)) is not None:
            return denied(f"Reposition denied: {problem}")
        if not math.isnan(goal.speed) and (problem := self._wrong_speed(goal.speed)) is not None:
            return denied(f"Reposition denied: {problem}", 1)
        self.orders.go_to(place, None if math.isnan(goal.speed) else goal.speed)
        return ACCEPTED

    def change_speed(self, speed: float, now: float) -> Answer:
        """Fly with another speed (m/s) from now on."""
        if self.orders.is_at_stop:
            return self._refused("Speed change")
        if (problem := self._wrong_speed(speed)) is not None:
            return denied(f"Speed change denied: {problem}", 2)
        self.orders.change_speed(speed)
        return ACCEPTED

    def turn(self, turn: Turn, now: float) -> Answer:
        """Refuse."""
        return denied("Turn denied: the payload keeps its heading")

    def orbit(self, orbit: Orbit, now: float) -> Answer:
        """Refuse."""
        return denied("Orbit denied: the payload keeps its heading; fly NAV_LOITER_TURNS in a mission")

    def set_home(self, place: Place | None, now: float) -> Answer:
        """Refuse."""
        return denied("Home denied: it is the origin of the vehicles' common local frame")

    def _begin_mission(self) -> Answer:
        session = self.session
        if self.orders.mission is None:
            return _NO_MISSION
        if self.orders.is_at_stop or self.orders.may_begin_elsewhere:
            return ACCEPTED  # it goes on by itself
        if session.in_air and not self.orders.may_order:
            return self._refused("Mission")
        if not (session.in_air or self.orders.may_begin):
            return rejected_for_now(f"Mission denied: {self._begun if session.is_armed else 'not armed'}")
        if (problem := self.orders.why_unflyable()) is not None:
            return denied(f"Mission denied: {problem}")
        if self._finished or not session.in_air:
            self._reached, self._finished = [], False
        self.orders.fly_mission()
        return ACCEPTED

    @property
    def _begun(self) -> str:
        """Why nothing can be begun while armed."""
        return "it is being disarmed" if self.session.flight.stands_down else "it has taken off already"

    def _return(self) -> Answer:
        session = self.session
        if self.orders.is_at_stop:
            session.disarm()
            return ACCEPTED
        if not self.orders.may_order:
            return self._refused("Return")
        north, east, _ = self.orders.position
        rally = (self._frame.local(*point.place, point.z) for point in self._plans[PlanType.RALLY])
        points = [(0.0, 0.0), *(position[:2] for position in rally)]
        self.orders.land(min(points, key=lambda point: math.dist(point, (north, east))))
        return ACCEPTED

    def _land(self) -> Answer:
        if self.orders.is_at_stop:
            self.session.disarm()
            return ACCEPTED
        if not self.orders.may_order:
            return self._refused("Land")
        self.orders.land()
        return ACCEPTED

    def _refused(self, what: str) -> Answer:
        """Return the refusal of an order that the phase of the flight does not allow."""
        session = self.session
        reason = "not in the air"
        if self.orders.is_at_stop:
            reason = "the mission stands on the ground"
        elif session.in_air:
            reason = session.flight.reason or f"in phase {session.flight.phase.value}"
        return rejected_for_now(f"{what} denied: {reason}")

    def _wrong_speed(self, speed: float) -> str | None:
        """Return why a speed (m/s) is not flown: too fast, or so slow that it would not arrive; None: it is."""
        lowest, limit = SETTINGS[CRUISE_SPEED].low, self.base.system.motion.speed_max
        return None if lowest <= speed <= limit else f"{speed:g} m/s is outside {lowest:g} .. {limit:g} m/s"

    def _local(self, place: Place, here: Position) -> Position:
        """Return a place (NED, m); what is not given is as it is ``here``."""
        altitude = self.base.home.altitude - here[2] if math.isnan(place.altitude) else place.altitude
        if not (math.isfinite(place.latitude) and math.isfinite(place.longitude)):
            return here[0], here[1], self.base.home.altitude - altitude
        return self._frame.local(place.latitude, place.longitude, altitude)

    def _why_not(self, place: Position) -> str | None:
        """Return why the payload may not be flown to a place; None: it may."""
        lowest = self.orders.lowest
        if not math.dist(place, (0.0, 0.0, 0.0)) <= FARTHEST:
            return f"farther than {FARTHEST:g} m from home"
        if -place[2] < lowest - 1e-3:
            return f"{-place[2]:.1f} m above home is lower than {lowest:.1f} m"
        area = self.session.world.area
        return None if area is None or area.contains(np.array([place]))[0] else "outside the fence"

    @property
    def plans(self) -> dict[PlanType, Sequence[MissionItem]]:
        """The plans that are in effect."""
        return self._plans

    def take_mission(self, items: Sequence[MissionItem], current: int, on_reached: Callable[[int], None]) -> Answer:
        """Have another mission, of which ``current`` is flown first; ``on_reached`` is called with each item done."""
        session = self.session
        if self.orders.flies_mission and session.is_armed:
            if not self.orders.is_paused:
                return rejected_for_now("Mission refused: the one before is being flown; hold first")
            self.orders.forget_mission()
        self._plans[PlanType.MISSION] = tuple(items)
        labels = [label(item, number) for number, item in enumerate(items)]
        self._take(mission_of(self._plans, self.base) if items else None, labels)
        self._on_reached = on_reached
        self.orders.choose(labels[current] if current else "")
        return ACCEPTED

    def load(self, mission: Mission) -> Answer:
        """Have the mission of a file: what it flies, and its fence."""
        session = self.session
        if session.is_armed:
            return rejected_for_now("Mission refused: change it on the ground, before arming")
        reference = mission.reference
        sources = [step.source for step in reference.steps] if isinstance(reference, Route) else []
        session.world = replace(self.base, boundary=mission.boundary, excluded=mission.excluded)
        flown = replace(session.world, name=mission.name, reference=reference, limits=mission.limits)
        self._take(flown, [*dict.fromkeys(sources)])
        return ACCEPTED

    def _take(self, mission: Mission | None, labels: list[str]) -> None:
        self.orders.mission, self._labels = mission, labels
        self.orders.choose("")
        self._reached, self._finished = [], False
        self.session.changes += 1

    def take_fence(self, items: Sequence[MissionItem]) -> None:
        """Have another fence from the next arming on."""
        self._plans[PlanType.FENCE] = tuple(items)
        session = self.session
        session.world = mission_of(self._plans, self.base)
        if self.orders.mission is not None:
            self.orders.mission = replace(
                self.orders.mission, boundary=session.world.boundary, excluded=session.world.excluded
            )

    def take_rally_points(self, items: Sequence[MissionItem]) -> None:
        """Have other rally points, places where a return may land, from now on."""
        self._plans[PlanType.RALLY] = tuple(items)

    def set_current_item(self, index: int, now: float) -> Answer:
        """Go on with item ``index``."""
        session = self.session
        if self.orders.mission is None or not 0 <= index < len(self._labels):
            return denied(f"Mission item denied: {index} of {len(self._labels)} items")
        assert isinstance(self.orders.mission.reference, Route)
        flown = {step.source for step in self.orders.mission.reference.steps}
        after = next((name for name in self._labels[index:] if name in flown), None)
        if after is None:
            return denied(f"Mission item denied: after {self._labels[index]} nothing is flown")
        is_begun = self.orders.may_begin_elsewhere or (session.in_air and self.orders.flies_mission)
        if (self.orders.is_at_stop and not is_begun) or (session.in_air and is_begun and not self.orders.may_order):
            return self._refused("Mission item")
        if is_begun and (problem := self.orders.why_not_at(after)) is not None:
            return denied(f"Mission item denied: {problem}")
        self.orders.choose(after)
        if is_begun:
            self.orders.fly_item()
            self._seen = min(self._seen, len(session.flight.passed))  # the last is reported again if it was chosen
        return ACCEPTED

    @property
    def current_item(self) -> int:
        """The item of the mission that is flown to, or will be."""
        session, labels = self.session, self._labels
        source = (session.flight.next_source if self.orders.flies_mission else "") or self.orders.first
        if source in labels and not self._finished:
            return labels.index(source)
        if not (self._finished or self.orders.flies_mission):
            return 0
        done = next((labels.index(reached) for reached in reversed(self._reached) if reached in labels), -1)
        return max(min(done + 1, len(labels) - 1), 0)

    @property
    def mission_finished(self) -> bool:
        """Whether all items have been done."""
        return self._finished

    @property
    def mission_active(self) -> bool:
        """Whether the mode that flies the mission is active."""
        return self.session.mode == px4.MODE_MISSION and self.session.is_armed

    def report_reached(self) -> None:
        """Report the items that were reached since the last call."""
        session = self.session
        if session.flight is not self._flight:
            self._flight, self._seen, self._reported_at = session.flight, 0, math.nan
        if not self.orders.flies_mission or session.flight.time == self._reported_at:
            return  # nothing is reached between two control steps
        self._reported_at = session.flight.time
        passed = session.flight.passed
        for source in passed[self._seen :]:
            if source in self._labels:
                self._reached.append(source)
                self._on_reached(self._labels.index(source))
        self._seen = max(self._seen, len(passed))  # what is left of a hold is not passed, but was reported
        self._finished = self.orders.is_mission_done
