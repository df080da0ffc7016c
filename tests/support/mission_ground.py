"""A ground that uploads and downloads plans as MAVSDK and QGroundControl do, for tests: sans-I/O."""

from __future__ import annotations

import math
import struct
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as m
from vehicle_bench import GROUND, Bench

from gcs.config.vehicle_settings import VehicleLinkSettings
from gcs.mavlink.services.answer import ACCEPTED as ACCEPTED_COMMAND
from gcs.mavlink.services.answer import Answer
from gcs.mavlink.services.mission_item import MissionItem, PlanType
from gcs.mission.model import DEFAULT_HOME
from vehicle_sim.mavlink.mission_plans import MissionPlans

ACCEPTED = m.MAV_MISSION_ACCEPTED
RETRY = 1.0  # s
TRIES = 12
_IDS = {
    m.MAVLINK_MSG_ID_MISSION_COUNT: struct.Struct("<HBBBI"),
    m.MAVLINK_MSG_ID_MISSION_ACK: struct.Struct("<BBBBI"),
    m.MAVLINK_MSG_ID_MISSION_CURRENT: struct.Struct("<HHBBIII"),
}


KINDS = ("MISSION_REQUEST_INT", "MISSION_REQUEST", "MISSION_ACK", "STATUSTEXT", "MISSION_ITEM_REACHED")


def ids_in(received: Any) -> tuple[int, ...]:
    """The ids of plans in a message that pymavlink's dialect reads without them."""
    fields = _IDS[received.message_id]
    values = fields.unpack(received.payload.ljust(fields.size, b"\0"))
    return values[-3:] if received.message_id == m.MAVLINK_MSG_ID_MISSION_CURRENT else values[-1:]


def waypoint(number: int = 0, **changes: Any) -> MissionItem:
    """A waypoint near the home of PX4's simulations, each ``number`` another."""
    item = MissionItem(
        m.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, m.MAV_CMD_NAV_WAYPOINT, True,
        0.0, 0.0, 0.0, math.nan, 473977420 + 100 * number, 85455940, 10.0 + number,
    )  # fmt: skip
    return item._replace(**changes)


def placeless(command: int, *parameters: float) -> MissionItem:
    """An item without a place."""
    filled = [*map(float, parameters), *[0.0] * (4 - len(parameters))]
    return MissionItem(m.MAV_FRAME_MISSION, command, True, *filled, 0, 0, 0.0)


def corners(command: int, count: int = 3) -> list[MissionItem]:
    """A fence polygon."""
    return [waypoint(i, frame=m.MAV_FRAME_GLOBAL, command=command, param1=float(count)) for i in range(count)]


def rally_point(number: int = 0) -> MissionItem:
    return waypoint(number, command=m.MAV_CMD_NAV_RALLY_POINT)


def item_message(number: int, item: MissionItem, plan_type: int = 0, current: int = 0, target: int = 1) -> Any:
    return m.MAVLink_mission_item_int_message(
        target, 1, number, item.frame, item.command, current, item.autocontinue, *item[3:], plan_type
    )


def same(items: Any, others: Any) -> bool:
    """Whether two plans are equal, NaN to NaN."""
    return repr(tuple(items)) == repr(tuple(others))


class Uploader:
    """The client side of an upload: answers what it is asked, and repeats itself when nothing comes."""

    def __init__(self, items: Any, plan_type: int = PlanType.MISSION, target: int = 1) -> None:
        self.items = tuple(items)
        self.plan_type, self.target = plan_type, target
        self.result: int | None = None
        self.tries = 0
        self.due = 0.0
        self._last: Any = m.MAVLink_mission_count_message(target, 1, len(self.items), plan_type)

    @property
    def is_done(self) -> bool:
        return self.result is not None

    def start(self, now: float) -> list[Any]:
        self.due = now + RETRY
        return [self._last]

    def take(self, message: Any, now: float) -> list[Any]:
        if self.result is not None or getattr(message, "mission_type", None) != self.plan_type:
            return []
        kind = message.get_type()
        if kind == "MISSION_ACK":
            self.result = message.type
        elif kind == "MISSION_REQUEST_INT" and message.seq < len(self.items):
            item = self.items[message.seq]
            self._last = item_message(message.seq, item, self.plan_type, target=self.target)
            self.tries, self.due = 0, now + RETRY
            return [self._last]
        return []

    def run(self, now: float) -> list[Any]:
        if self.result is not None or now < self.due:
            return []
        self.tries += 1
        if self.tries > TRIES:
            self.result = -1  # gives up
            return []
        self.due = now + RETRY
        return [self._last]


class Downloader:
    """The client side of a download."""

    def __init__(self, plan_type: int = PlanType.MISSION, target: int = 1) -> None:
        self.plan_type, self.target = plan_type, target
        self.items: list[MissionItem] = []
        self.count: int | None = None
        self.gave_up = False
        self.tries = 0
        self.due = 0.0

    @property
    def is_done(self) -> bool:
        return self.gave_up or (self.count is not None and len(self.items) == self.count)

    def start(self, now: float) -> list[Any]:
        self.due = now + RETRY
        return [self._request()]

    def take(self, message: Any, now: float) -> list[Any]:
        if self.is_done or getattr(message, "mission_type", None) != self.plan_type:
            return []
        kind = message.get_type()
        if kind == "MISSION_COUNT" and self.count is None:
            self.count = message.count
        elif kind == "MISSION_ITEM_INT" and message.seq == len(self.items) and self.count is not None:
            m_ = message
            self.items.append(
                MissionItem(
                    m_.frame, m_.command, bool(m_.autocontinue), m_.param1, m_.param2, m_.param3, m_.param4,
                    m_.x, m_.y, m_.z,
                )
            )  # fmt: skip
        else:
            return []
        self.tries, self.due = 0, now + RETRY
        if self.is_done:
            return [m.MAVLink_mission_ack_message(self.target, 1, ACCEPTED, self.plan_type)]
        return [self._request()]

    def run(self, now: float) -> list[Any]:
        if self.is_done or now < self.due:
            return []
        self.tries += 1
        self.gave_up = self.tries > TRIES
        self.due = now + RETRY
        return [] if self.gave_up else [self._request()]

    def _request(self) -> Any:
        if self.count is None:
            return m.MAVLink_mission_request_list_message(self.target, 1, self.plan_type)
        return m.MAVLink_mission_request_int_message(self.target, 1, len(self.items), self.plan_type)


class Flight:
    """What flies a mission, in place of an autopilot."""

    def __init__(self) -> None:
        self.items: tuple[MissionItem, ...] = ()
        self.current_item = 0
        self.mission_finished = False
        self.mission_active = False
        self.fence: tuple[MissionItem, ...] = ()
        self.rally_points: tuple[MissionItem, ...] = ()
        self.taken = 0
        """Missions that were handed over."""

    def take_mission(self, items: Any, current: int, on_reached: Any) -> Answer:
        self.items, self.current_item, self.on_reached = tuple(items), current, on_reached
        self.mission_finished = False
        self.taken += 1
        return ACCEPTED_COMMAND

    def set_current_item(self, index: int, now: float) -> Answer:
        self.current_item = index
        return ACCEPTED_COMMAND

    def take_fence(self, items: Any) -> None:
        self.fence = tuple(items)

    def take_rally_points(self, items: Any) -> None:
        self.rally_points = tuple(items)


class MissionBench(Bench):
    """A vehicle with plans of its own, at rest."""

    def __init__(self) -> None:
        self.flight = Flight()
        self.plans = MissionPlans(DEFAULT_HOME, self.flight)
        super().__init__(plans=self.plans)
        self.received: list[Any] = []
        self.time = 0.0

    @property
    def now(self) -> float:
        return self.time

    def collect(self) -> None:
        for datagram, address in self.vehicle.datagrams_to_send(self.now):
            for received in self.reader.decode(datagram):
                self.received.append(received)
                self.inbox.setdefault(address, []).append(received.message)

    def answers(self, message: Any, sender: Any = GROUND, system: int = 255, component: int = 190) -> list[Any]:
        """Messages of the mission protocol that a message draws, and texts."""
        self.collect()
        before = len(self.inbox.setdefault(sender, []))
        self.send(message, sender, system, component)
        self.collect()
        kinds = ("STATUSTEXT", "COMMAND_ACK")
        return [
            found
            for found in self.inbox[sender][before:]
            if found.get_type() in kinds or (found.get_type().startswith("MISSION_") and found.id != 42)
        ]

    def wait(self, seconds: float) -> list[Any]:
        """Let time pass as a driver does, which calls when a timer is due; return what of the protocol came."""
        before, end = len(self.inbox.setdefault(GROUND, [])), self.time + seconds
        for _ in range(round(100 * seconds) + 100):
            due = self.vehicle.next_timer()
            if due is None or due > end:
                break
            self.time = max(self.time, due)
            self.collect()
        else:
            raise AssertionError("a timer that is always due")
        self.time = end
        return [found for found in self.inbox[GROUND][before:] if found.get_type() in KINDS]

    def upload(self, items: Any, plan_type: int = PlanType.MISSION, **options: Any) -> int:
        uploader = Uploader(items, plan_type)
        waiting = uploader.start(self.now)
        while waiting and uploader.result is None:
            waiting = [new for found in self.answers(waiting[0], **options) for new in uploader.take(found, self.now)]
        assert uploader.result is not None
        return uploader.result

    def download(self, plan_type: int = PlanType.MISSION) -> list[Any]:
        downloader = Downloader(plan_type)
        waiting = downloader.start(self.now)
        while waiting and not downloader.is_done:
            waiting = [new for found in self.answers(waiting[0]) for new in downloader.take(found, self.now)]
        assert downloader.is_done
        return downloader.items


MISSION, FENCE, RALLY = PlanType
LIMITS = VehicleLinkSettings().missions
PLAN = [
    waypoint(0, command=m.MAV_CMD_NAV_TAKEOFF),
    waypoint(1),
    placeless(m.MAV_CMD_DO_CHANGE_SPEED, 1, 4.0),
    waypoint(2),
    placeless(m.MAV_CMD_NAV_RETURN_TO_LAUNCH),
]


def count(number: int, plan_type: int = MISSION, target: int = 1) -> Any:
    return m.MAVLink_mission_count_message(target, 1, number, plan_type)


def request_list(plan_type: int = MISSION) -> Any:
    return m.MAVLink_mission_request_list_message(1, 1, plan_type)


def results(messages: list[Any]) -> list[int]:
    return [found.type for found in messages if found.get_type() == "MISSION_ACK"]


def texts(messages: list[Any]) -> str:
    return "".join(found.text for found in messages if found.get_type() == "STATUSTEXT")
