"""A session flown with the team over the wire: two flights with all orders, and a third with a loss."""

from __future__ import annotations

import weakref
from pathlib import Path
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as m
from mission_ground import placeless, waypoint
from team_bench import FRAME, TeamBench, Truth, reposition, set_mode, team_command

from gcs.mavlink import px4
from gcs.mavlink.services.mission_item import MissionItem, PlanType
from gcs.mission.read import read_mission

ARM, DISARM = team_command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1), team_command(m.MAV_CMD_COMPONENT_ARM_DISARM, 0)
START = team_command(m.MAV_CMD_MISSION_START)
LAND, RETURN = team_command(m.MAV_CMD_NAV_LAND), team_command(m.MAV_CMD_NAV_RETURN_TO_LAUNCH)
NAN = float("nan")
ALTITUDE = FRAME.altitude

CORNERS = [(6.0, 0.0, 3.0), (6.0, 6.0, 4.0), (0.0, 6.0, 3.0)]
"""Waypoints of the mission: north, east, up (m)."""
ASIDE, RALLY_POINT = (3.0, 3.0, 4.0), (0.0, 4.0)
RADIUS = 15.0
"""m; of the fence about home."""


def take_off(height: float) -> Any:
    return team_command(m.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, NAN, NAN, NAN, ALTITUDE + height)


def change_speed(speed: float) -> Any:
    return team_command(m.MAV_CMD_DO_CHANGE_SPEED, 1, speed, -1)


def at(north: float, east: float, up: float, command: int = m.MAV_CMD_NAV_WAYPOINT, **changes: Any) -> MissionItem:
    x, y, _ = FRAME.place((north, east, 0.0))
    return waypoint(command=command, x=x, y=y, z=up, **changes)


MISSION = [
    placeless(m.MAV_CMD_NAV_TAKEOFF)._replace(frame=m.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, param4=NAN, z=3.0),
    *(at(*corner) for corner in CORNERS),
]
FENCE = [at(0.0, 0.0, 0.0, m.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION, frame=m.MAV_FRAME_GLOBAL, param1=RADIUS, param4=0.0)]
RALLY = [at(*RALLY_POINT, 4.0, m.MAV_CMD_NAV_RALLY_POINT, param4=0.0)]
PLANS = {PlanType.MISSION: MISSION, PlanType.FENCE: FENCE, PlanType.RALLY: RALLY}

REFUSED_ON_GROUND = {
    "take-off": (take_off(3.0), m.MAV_RESULT_TEMPORARILY_REJECTED, "Takeoff denied: not armed"),
    "mission": (START, m.MAV_RESULT_TEMPORARILY_REJECTED, "Mission denied: no mission"),
    "mode": (set_mode(px4.MODE_OFFBOARD), m.MAV_RESULT_DENIED, "Mode denied: the team does not fly OFFBOARD"),
    "turn": (team_command(m.MAV_CMD_CONDITION_YAW, 90), m.MAV_RESULT_DENIED, "Turn denied: the payload keeps its"),
    "orbit": (team_command(m.MAV_CMD_DO_ORBIT, 5, 1, 0, 0, NAN, NAN, NAN), m.MAV_RESULT_DENIED, "Orbit denied: "),
    "home": (team_command(m.MAV_CMD_DO_SET_HOME, 1), m.MAV_RESULT_DENIED, "Home denied: "),
    "go-to": (reposition(*ASIDE), m.MAV_RESULT_TEMPORARILY_REJECTED, "Reposition denied: not in the air"),
    "landing": (LAND, m.MAV_RESULT_TEMPORARILY_REJECTED, "Land denied: not in the air"),
    "return": (RETURN, m.MAV_RESULT_TEMPORARILY_REJECTED, "Return denied: not in the air"),
    "speed": (change_speed(9.0), m.MAV_RESULT_DENIED, "Speed change denied: 9 m/s is outside 0.1 .. 3 m/s"),
}  # fmt: skip
"""Orders, each with the result and the beginning of the reason."""
REFUSED_IN_FLIGHT = {
    "take-off": (take_off(3.0), m.MAV_RESULT_TEMPORARILY_REJECTED, "Takeoff denied: it has taken off already"),
    "outside": (reposition(20.0, 0.0, 4.0), m.MAV_RESULT_DENIED, "Reposition denied: outside the fence"),
    "too low": (reposition(3.0, 0.0, 0.1), m.MAV_RESULT_DENIED, "Reposition denied: 0.1 m above home is lower"),
    "too far": (reposition(9e4, 0.0, 4.0), m.MAV_RESULT_DENIED, "Reposition denied: farther than "),
    "too fast": (reposition(*ASIDE, 9.0), m.MAV_RESULT_DENIED, "Reposition denied: 9 m/s is outside 0.1 .. 3 m/s"),
    "disarming": (DISARM, m.MAV_RESULT_DENIED, "Disarming denied: in the air"),
    "forced": (team_command(400, 0, px4.FORCE_ARM_DISARM), m.MAV_RESULT_DENIED, "Disarming denied: in the air"),
    "item": (team_command(m.MAV_CMD_DO_SET_MISSION_CURRENT, 9), m.MAV_RESULT_DENIED, "Mission item denied: 9 of 4"),
}  # fmt: skip


class Session:
    """Flies at once; keeps what was answered, the time of each step, and the true motion."""

    def __init__(self, folder: Path) -> None:
        folder.mkdir()
        self.answers: dict[str, Any] = {}
        self._times: dict[str, tuple[float, float]] = {}
        with TeamBench(read_mission("hover", None, {"team.vehicles": 3}), folder) as self.bench:
            self._on_ground()
            self._mission()
            self._second_flight()
            self._third_flight()
            self.bench.land_and_close()
        self._folder = folder

    def truth(self, *steps: str) -> Truth:
        """Return the true motion during steps that follow each other; none: the whole session."""
        if not steps:
            return Truth(self._folder)
        return Truth(self._folder, self._times[steps[0]][0], self._times[steps[-1]][1])

    def time(self, step: str) -> float:
        """Return when a step began (s)."""
        return self._times[step][0]

    def _step(self, name: str, order: Any, *wait: Any) -> None:
        began = self.bench.now
        if order is not None:
            self.answers[name] = self.bench.answer(order)
        for one in wait:
            one()
        self._times[name] = began, self.bench.now

    def _refuse(self, where: str, orders: dict[str, Any]) -> None:
        self.answers[where] = {name: self.bench.answer(order) for name, (order, *_) in orders.items()}

    def _on_ground(self) -> None:
        bench = self.bench
        self.answers["too early"] = bench.answer(ARM)
        bench.ready()
        self._refuse("on ground", REFUSED_ON_GROUND)
        unflyable = [MISSION[0], at(3.0, 0.0, -2.0)]
        self.answers["unflyable"] = bench.upload(unflyable, PlanType.MISSION)
        self.answers["uploads"] = [bench.upload(items, kind) for kind, items in PLANS.items()]
        self.answers["downloads"] = {kind: bench.download(kind) for kind in PLANS}

    def _mission(self) -> None:
        bench = self.bench
        self._step("arm", ARM, lambda: bench.until("HEARTBEAT", lambda found: found.base_mode & 128))
        self.first_flight = weakref.ref(bench.server.session.station)
        self._step("start", START, lambda: bench.until("LOCAL_POSITION_NED", lambda found: found.x > 1.0))
        self._refuse("in flight", REFUSED_IN_FLIGHT)
        self.answers["fence in flight"] = bench.upload([FENCE[0]._replace(param1=9.0)], PlanType.FENCE)
        self.answers["mission in flight"] = bench.upload(MISSION[:3], PlanType.MISSION)
        self._step("pause", set_mode(px4.MODE_HOLD), bench.at_rest)
        self._step("go-to", reposition(*ASIDE), lambda: bench.settled(*ASIDE))
        self._step("resume", set_mode(px4.MODE_MISSION), lambda: self._reached(1))
        self._step("slower", change_speed(0.5), lambda: bench.run(6.0))
        self._step("faster", change_speed(2.0), lambda: self._reached(2))
        self._times["set item"] = bench.now, bench.now
        self.answers["set item"] = bench.ask(m.MAVLink_mission_set_current_message(*bench.target, 1))
        self._step("again", None, lambda: self._reached(1), lambda: self._reached(3), lambda: bench.run(1.0))
        self._step("return", RETURN, lambda: bench.until("HEARTBEAT", lambda found: not found.base_mode & 128))
        self.answers["arm while ending"] = bench.answer(ARM)
        self._step("ended", None, bench.disarmed)

    def _second_flight(self) -> None:
        bench = self.bench
        bench.ready()
        self._step("arm again", ARM, lambda: bench.until("HEARTBEAT", lambda found: found.base_mode & 128))
        north, east = RALLY_POINT
        self._step("take-off", take_off(2.0), lambda: bench.settled(north, east, 2.0), lambda: bench.run(2.0))
        self._step("reposition", reposition(2.0, 3.0, 3.0, 0.8), lambda: bench.settled(2.0, 3.0, 3.0))
        self._step("land", LAND, bench.disarmed)

    def _third_flight(self) -> None:
        bench = self.bench
        bench.ready()
        self._step("arm for loss", ARM, lambda: bench.until("HEARTBEAT", lambda found: found.base_mode & 128))
        self._step("take-off for loss", take_off(2.0), lambda: bench.run(8.0))
        bench.silenced = bench.server.session.station.links[1].address
        self._step("loss", None, bench.disarmed)
        bench.silenced = None
        self._step("after loss", None, bench.ready)

    def _reached(self, item: int) -> None:
        self.bench.until("MISSION_ITEM_REACHED", lambda found: found.seq == item)
