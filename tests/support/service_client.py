"""A client of one vehicle, for tests: it knows what comes over the wire only. Sans-I/O."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as m
from mission_ground import MISSION, PLAN, item_message
from vehicle_bench import GROUND, PAYLOAD_UNIT, Bench, command

from gcs.mavlink import px4
from gcs.mavlink.services.local_frame import LocalFrame
from gcs.mission.model import DEFAULT_HOME
from vehicle_sim.world.range_sensor import RangeSample

NAN = math.nan
FRAME = LocalFrame(DEFAULT_HOME)
ARM, TAKEOFF = m.MAV_CMD_COMPONENT_ARM_DISARM, m.MAV_CMD_NAV_TAKEOFF
HEIGHT = 2.5  # m, of a take-off


def text_of(messages: list[Any]) -> str:
    return "".join(found.text for found in messages if found.get_type() == "STATUSTEXT")


class Asking:
    """What a client sends, and what comes back, on a bench whose :meth:`collect` lets the aircraft answer."""

    inbox: dict[Any, list[Any]]

    def send(self, message: Any, sender: Any = GROUND) -> None:
        raise NotImplementedError

    def collect(self) -> None:
        raise NotImplementedError

    def ask(self, message: Any, sender: Any = GROUND) -> list[Any]:
        """Send a message; return what comes back at once, apart from streams that were due."""
        self.collect()
        before = len(self.inbox.setdefault(sender, []))
        self.send(message, sender)
        self.collect()
        return self.inbox[sender][before:]

    def has(self, kind: str, message: Any, **fields: Any) -> bool:
        """Send a message; return True if one of a kind with these fields comes back."""
        return any(
            found.get_type() == kind and all(getattr(found, name) == value for name, value in fields.items())
            for found in self.ask(message)
        )

    def texts(self, message: Any) -> str:
        """Send a message; return the texts that come back, long ones put together from their chunks."""
        return text_of(self.ask(message))


class ServiceClient(Bench, Asking):
    """``address`` is a port of clients; the vehicle stands, and has heard the client."""

    address = GROUND

    def __init__(self, *, free: bool) -> None:
        super().__init__(free=free, clients={GROUND: True})
        self.free = free
        self.run(0.1)
        self.send(m.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
        self.run(0.1)

    # What comes

    def result(self, message: Any, sender: Any = GROUND, system: int = 255) -> int:
        """Send a command; return the result of its acknowledgement, -1 without one."""
        acks = [found for found in self.ask(message, sender) if found.get_type() == "COMMAND_ACK"]
        return acks[0].result if acks else -1

    def accepts(self, number: int, *parameters: float) -> bool:
        return self.result(command(number, *parameters)) == m.MAV_RESULT_ACCEPTED

    def last(self, kind: str) -> Any:
        return self.got(kind)[-1]

    @property
    def mode(self) -> int:
        self.run(0.04)
        return int(self.last("HEARTBEAT").custom_mode)

    @property
    def armed(self) -> bool:
        self.run(0.04)
        return bool(self.last("HEARTBEAT").base_mode & m.MAV_MODE_FLAG_SAFETY_ARMED)

    @property
    def place(self) -> Any:
        """Position (m) from home, north-east-down."""
        found = self.last("LOCAL_POSITION_NED")
        return np.array([found.x, found.y, found.z])

    @property
    def speed(self) -> float:
        """Speed over the ground (m/s)."""
        found = self.last("LOCAL_POSITION_NED")
        return math.hypot(found.vx, found.vy)

    # Before a check

    def stream(self, message: Any) -> None:
        """Send a set-point 20 times a second from now on."""
        self.streaming[GROUND, 255] = message
        self.run(0.3)

    def take_off(self) -> None:
        """Bring the vehicle into the air, whatever services there are."""
        if not self.free:
            self.fly()
            return
        self.vehicle.aircraft.take_off(NAN, self.now)
        self.vehicle.aircraft.arm(self.now)
        self.run(4.5)
        assert self.mode == px4.MODE_HOLD and self.place[2] < 0.2 - HEIGHT

    def upload(self, plan: Any = PLAN) -> bool:
        """Upload a mission; return whether it was accepted."""
        waiting: list[Any] = [m.MAVLink_mission_count_message(1, 1, len(plan), MISSION)]
        while waiting:
            answers = self.ask(waiting.pop())
            if any(found.get_type() == "MISSION_ACK" and found.type == 0 for found in answers):
                return True
            asked = [found.seq for found in answers if found.get_type() == "MISSION_REQUEST_INT"]
            waiting = [item_message(number, plan[number], current=number == 0) for number in asked]
        return False

    def scan(self) -> None:
        """Have the range sensor see something."""
        self.vehicle.take_scan(RangeSample(self.now, 10.0, np.array([[3.0, 0.0, 0.0]])))

    def streamed(self, component: int, seconds: float) -> set[int]:
        """Ids of the messages of a component that come unasked in a time (s)."""
        self.inbox[GROUND] = []
        system = 1 if component == px4.AUTOPILOT_COMPONENT else PAYLOAD_UNIT[0]
        for _ in range(round(seconds / 0.1)):
            self.scan()
            self.run(0.1)
        return {found.get_msgId() for found in self.inbox[GROUND] if found.get_srcSystem() == system}
