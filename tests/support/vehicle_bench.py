"""A vehicle by its bytes, for tests: sans-I/O, so addresses are just names here."""

from __future__ import annotations

from typing import Any

import pymavlink.dialects.v20.common as mavlink
from flying import AIRFRAME, Body
from onboard import step_alone

from gcs.mavlink import px4
from gcs.mavlink.codec import Codec
from vehicle_sim.mavlink.vehicle import Vehicle
from vehicle_sim.world.sensors import Measurement

PAYLOAD_UNIT = px4.PAYLOAD_UNIT_SYSTEM, px4.PAYLOAD_UNIT_COMPONENT
GROUND, STRANGER = ("127.0.0.1", 40001), ("10.0.0.66", 40002)
ACCEPTED, DENIED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_DENIED
REJECTED, UNSUPPORTED = mavlink.MAV_RESULT_TEMPORARILY_REJECTED, mavlink.MAV_RESULT_UNSUPPORTED
HOVER = 0.7 * 9.81 / 30.0


def attitude_target(
    q: Any = (1, 0, 0, 0), thrust: float = HOVER, mask: int = 7, stamp: int = 0, rates: Any = (0, 0, 0), system: int = 1
) -> Any:
    return mavlink.MAVLink_set_attitude_target_message(stamp, system, 1, mask, list(q), *rates, thrust)


def command(number: int, *parameters: float, system: int = 1, component: int = 1) -> Any:
    values = [*parameters, *([0.0] * (7 - len(parameters)))]
    return mavlink.MAVLink_command_long_message(system, component, number, 0, *values)


OFFBOARD = command(176, 1, px4.MainMode.OFFBOARD)
HOLD = command(176, 1, px4.MainMode.AUTO, px4.AutoMode.LOITER)
LAND = command(176, 1, px4.MainMode.AUTO, px4.AutoMode.LAND)
ARM, DISARM = command(400, 1), command(400, 0)


class Bench:
    """A vehicle, a body that stands or flies, and grounds that keep what they were sent."""

    target = 1, 1

    def __init__(self, *, clients_answer: bool = True, **options: Any) -> None:
        """``clients_answer``: who sends anything has addressed the vehicle by its id before."""
        self.clients_answer = clients_answer
        self.vehicle = Vehicle(1, AIRFRAME, **options)
        self.body = Body()
        self.tick = 0
        self.codecs: dict[Any, Codec] = {}
        self.inbox: dict[Any, list[Any]] = {}
        self.datagrams: list[tuple[float, bytes, Any]] = []
        self.streaming: dict[Any, Any] = {}
        self.reader = Codec(254, 1)

    @property
    def now(self) -> float:
        return self.body.now

    def send(self, message: Any, sender: Any = GROUND, system: int = 255, component: int = 190) -> None:
        is_new = not any(address == sender for address, *_ in self.codecs)
        codec = self.codecs.setdefault((sender, system, component), Codec(system, component))
        if self.clients_answer and is_new:  # it knows the vehicle already
            self.vehicle.receive(codec.encode(mavlink.MAVLink_mission_ack_message(1, 1, 0)), sender, self.now)
        self.vehicle.receive(codec.encode(message), sender, self.now)

    def request(self, message: Any, sender: Any = GROUND, system: int = 255, component: int = 190) -> list[Any]:
        """Send, and return what came back to that address at once, apart from what streams anyway."""
        self.collect()
        before = len(self.inbox.setdefault(sender, []))
        self.send(message, sender, system, component)
        self.collect()
        streamed = ("HEARTBEAT", "EXTENDED_SYS_STATE")
        new = self.inbox[sender][before:]
        return [m for m in new if m.get_type() not in streamed] if len(new) < 30 else new[-1:]

    def result(self, message: Any, sender: Any = GROUND, system: int = 255) -> int:
        [ack] = [m for m in self.request(message, sender, system) if m.get_type() == "COMMAND_ACK"]
        assert ack.command == message.command and ack.target_system == system
        return ack.result

    def collect(self) -> None:
        for datagram, address in self.vehicle.datagrams_to_send(self.now):
            self.datagrams.append((self.now, datagram, address))
            self.inbox.setdefault(address, []).extend(received.message for received in self.reader.decode(datagram))

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / 0.002)):
            if self.body.tick % 25 == 0:
                for (sender, system), message in self.streaming.items():
                    self.send(message, sender, system)
            if self.body.tick % 2 == 0:
                measured = self.body.measure()
                self.body.command = step_alone(self.vehicle.autopilot, measured, self.now)
                self.vehicle.relay(Measurement(self.now, (1, 0, 0, 0), (0, 0, 0), (1, 2, -3), (4, 5, 6)))
            self.collect()
            self.body.advance()

    def got(self, kind: str, address: Any = GROUND, source: tuple[int, int] = (1, 1)) -> list[Any]:
        """Return the messages of a kind that came to an address from a system and component."""
        found = self.inbox.get(address, [])
        return [m for m in found if m.get_type() == kind and (m.get_srcSystem(), m.get_srcComponent()) == source]

    def fly(self) -> None:
        self.streaming[GROUND, 255] = attitude_target(thrust=HOVER * 1.2)
        self.run(0.2)
        assert self.result(OFFBOARD) == ACCEPTED
        assert self.result(ARM) == ACCEPTED
        self.run(1.0)
        self.streaming[GROUND, 255] = attitude_target(thrust=HOVER)
        self.run(0.2)
        assert self.vehicle.autopilot.state.land.in_air
