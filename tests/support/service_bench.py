"""The MAVLink services of an aircraft that keeps what it is asked, for tests: bytes in, messages out."""

from __future__ import annotations

import math
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import newer_messages, px4
from gcs.mavlink.codec import Codec
from gcs.mavlink.layout import LAYOUTS, packed
from gcs.mavlink.services.answer import ACCEPTED, Answer, denied
from gcs.mavlink.services.commands import CommandServer
from gcs.mavlink.services.dispatcher import Dispatcher, Request
from gcs.mavlink.services.files import FileServices
from gcs.mavlink.services.parameter_table import INTEGER, Parameter, ParameterTable
from gcs.mavlink.services.parameters import ParameterServer
from gcs.mavlink.services.peer import Peer
from gcs.mavlink.services.streams import StreamRequests
from gcs.mavlink.settings import PeerSettings

SYSTEM, COMPONENT = 7, px4.AUTOPILOT_COMPONENT
SENDER = ("10.0.0.1", 5)
HOME_ALTITUDE = 488.0
EMPTY, ABSENT = mavlink.MAVLINK_MSG_ID_ATTITUDE, mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE
"""A message without data now, and one that there will never be."""


def command(number: int, *parameters: float, system: int = SYSTEM, confirmation: int = 0) -> Any:
    values = [*parameters, *([0.0] * (7 - len(parameters)))]
    return mavlink.MAVLink_command_long_message(system, COMPONENT, number, confirmation, *values)


def command_int(number: int, frame: int, *parameters: float, x: int = 0, y: int = 0, z: float = 0.0) -> Any:
    values = [*parameters, *([0.0] * (4 - len(parameters)))]
    return mavlink.MAVLink_command_int_message(SYSTEM, COMPONENT, frame, number, 0, 0, *values, x, y, z)


class Recorder:
    """An aircraft that keeps what it is asked, and answers ``answer``."""

    modes = (px4.MODE_HOLD, px4.MODE_MISSION, px4.MODE_OFFBOARD)

    def __init__(self) -> None:
        self.calls: list[tuple[Any, ...]] = []
        self.answer: Answer = ACCEPTED
        self.obeys_broadcasts = True
        self.problem: str | None = None

    def arming_problem(self, now: float) -> str | None:
        return self.problem

    def enter_mode(self, custom_mode: int, sender: Any, now: float) -> Answer:
        self.calls.append(("enter_mode", custom_mode))
        return self.answer

    def __getattr__(self, name: str) -> Any:
        def call(*arguments: Any) -> Answer:
            *others, last = arguments
            if isinstance(last, bool):  # arm and disarm: sender and time are before it
                others = [last]
            self.calls.append((name, *others))
            return self.answer

        return call


class ServiceBench:
    """All services with one peer. ``stranger``: another ground is in control."""

    def __init__(self) -> None:
        self.now = 100.0
        self.aircraft = Recorder()
        self.stranger = False
        self.parameters = ParameterTable(
            [
                Parameter("AA_REAL", 2.5, limits=(1.0, 3.0)),
                Parameter("BB_INT", 3, INTEGER, (0, 3), values=(0, 3)),
                Parameter("CC_FIXED", 9.0),
            ]
        )
        home = packed(
            mavlink.MAVLink_home_position_message(1, 2, round(HOME_ALTITUDE * 1e3), 0, 0, 0, [1, 0, 0, 0], 0, 0, 0, 5)
        )
        version = (LAYOUTS[newer_messages.PROTOCOL_VERSION].pack(200, 100, 200, *[0] * 16),)
        beat = packed(mavlink.MAVLink_heartbeat_message(2, 12, 0, 0, 3, 3))
        of_id = {
            mavlink.MAVLINK_MSG_ID_HOME_POSITION: home, newer_messages.PROTOCOL_VERSION: version,
            mavlink.MAVLINK_MSG_ID_HEARTBEAT: beat, EMPTY: (), ABSENT: (),
        }  # fmt: skip
        self.builders = {(COMPONENT, number): (lambda now, built=built: built) for number, built in of_id.items()}
        settings = PeerSettings()
        self.intervals = {(COMPONENT, mavlink.MAVLINK_MSG_ID_HEARTBEAT): 1.0}
        self.peer = Peer(SENDER, [(SYSTEM, COMPONENT)], self.intervals, settings)
        self.peer.answered = True
        self.dispatcher = Dispatcher()
        streams = StreamRequests(COMPONENT, self, self, settings, self.dispatcher.requests)
        CommandServer(self.aircraft, self, self, streams, self.parameters).register(self.dispatcher)
        ParameterServer(self.parameters, self).register(self.dispatcher)
        FileServices().register(self.dispatcher)
        self._decoder = Codec(SYSTEM, COMPONENT)
        self.drain()

    # Control and message source

    def is_stranger(self, sender: Any, now: float) -> bool:
        return self.stranger

    def is_stranger_at_its_address(self, sender: Any, now: float) -> bool:
        return self.stranger

    def absence(self, key: Any) -> str | None:
        return "no such sensor" if key[1] == ABSENT else None

    # The wire

    def drain(self) -> list[Any]:
        """Return what goes out now, without streams."""
        empty = type("NoSample", (), {"messages": staticmethod(lambda key: ())})
        datagrams = self.peer.datagrams(empty, self.now)  # type: ignore[arg-type]
        return [received.message for datagram in datagrams for received in Codec(254, 1).decode(datagram)]

    def request(self, message: Any, system: int = 255, component: int = 190) -> list[Any]:
        """Send a message, and return the answers."""
        for received in self._decoder.decode(Codec(system, component).encode(message)):
            self.dispatcher.dispatch(received, Request((SENDER, system), component, self.peer, self.now))
        return self.drain()

    def ask(self, message: Any, **sender: int) -> tuple[int, str, list[Any]]:
        """Return result and text of a command, and what else was answered."""
        answers = self.request(message, **sender)
        [ack] = [m for m in answers if m.get_type() == "COMMAND_ACK"]
        assert ack.command == message.command
        self.wrong_parameter = ack.result_param2
        text = "".join(m.text for m in answers if m.get_type() == "STATUSTEXT")
        return ack.result, text, [m for m in answers if m.get_type() not in ("COMMAND_ACK", "STATUSTEXT")]


REFUSED = denied("Recorder denied: because")
NAN = math.nan
