"""A swarm of free vehicles without sockets, and a ground that speaks MAVLink to them."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pymavlink.dialects.v20.common as mavlink

from gcs.config import read_system
from gcs.mavlink import px4
from gcs.mavlink.codec import Codec
from gcs.mavlink.services.local_frame import LocalFrame
from gcs.mavlink.services.mission_item import MissionItem
from gcs.mission.model import DEFAULT_HOME
from vehicle_sim.swarm import Swarm

GROUND = ("ground", 1)
FRAME = LocalFrame(DEFAULT_HOME)
STEP = 0.02
NAN = math.nan
OFFBOARD = (mavlink.MAV_CMD_DO_SET_MODE, 1, px4.MainMode.OFFBOARD)


def mode(sub: int) -> tuple[int, ...]:
    """Return the command that enters a sub-mode of AUTO."""
    return mavlink.MAV_CMD_DO_SET_MODE, 1, px4.MainMode.AUTO, sub


def config_of(vehicles: int) -> Any:
    system = read_system()
    return dataclasses.replace(system, team=dataclasses.replace(system.team, vehicles=vehicles))


def item(command: int, north: float = 0.0, east: float = 0.0, up: float = 0.0, *parameters: float) -> MissionItem:
    """Return an item of a mission at a place (m from the origin); parameters not given are NaN, the first two 0."""
    latitude, longitude, _ = FRAME.geodetic(north, east, 0.0)
    values = [*parameters, *(0.0, 0.0, NAN, NAN)[len(parameters) :]]
    frame = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT
    return MissionItem(frame, command, True, *values, round(latitude * 1e7), round(longitude * 1e7), up)


class FreeBench:
    """``swarm`` with ``vehicles``; ``track`` has the true states (N, 13) of every 20 ms."""

    def __init__(self, vehicles: int = 1, seed: int = 1, **options: Any) -> None:
        self.swarm = Swarm(config_of(vehicles), seed=seed, free=True, **options)
        self.vehicles = self.swarm.vehicles
        self.codec, self.reader = Codec(255, 190), Codec(254, 1)
        self.streaming: dict[int, Any] = {}
        """What is sent to each vehicle (its system id) at 20 Hz: a function of time (s), or a message."""
        self.messages: list[Any] = []
        self.track: list[Any] = []
        self.times: list[float] = []
        self.ticks = 0

    def __enter__(self) -> FreeBench:
        return self

    def __exit__(self, *_: object) -> None:
        self.swarm.close()

    @property
    def now(self) -> float:
        return self.ticks * STEP

    def send(self, message: Any, vehicle: int = 1) -> None:
        self.swarm.receive(vehicle, self.codec.encode(message), GROUND, self.now)
        self._collect()

    def _collect(self) -> None:
        for i, datagram, _ in self.swarm.datagrams_to_send(self.now):
            self.messages += [(self.now, i, received.message) for received in self.reader.decode(datagram)]

    def command(self, number: int, *parameters: float, vehicle: int = 1) -> int:
        """Send a command and return the result of its acknowledgement."""
        values = [*parameters, *([0.0] * (7 - len(parameters)))]
        self.messages.clear()
        self.send(mavlink.MAVLink_command_long_message(vehicle, 1, number, 0, *values), vehicle)
        [result] = [m.result for _, i, m in self.messages if m.get_type() == "COMMAND_ACK" and i == vehicle]
        return result

    def requested(self, number: int) -> Any:
        """Request a message of vehicle 1 once; return it, None if it is refused."""
        if self.command(mavlink.MAV_CMD_REQUEST_MESSAGE, number) != mavlink.MAV_RESULT_ACCEPTED:
            return None
        [message] = [m for _, _, m in self.messages if m.get_msgId() == number]
        return message

    def set_parameter(self, name: str, value: float, vehicle: int = 1) -> None:
        kind = self.vehicles[vehicle - 1].parameters.by_name(name).type
        wire = px4.parameter_to_wire(value, kind)
        self.send(mavlink.MAVLink_param_set_message(vehicle, 1, name.encode(), wire, kind), vehicle)
        assert self.vehicles[vehicle - 1].parameters[name] == np.float32(value)

    def run(self, seconds: float, until: Any = None) -> bool:
        """Let time go on; return True as soon as ``until`` holds, False if it does not in time."""
        for _ in range(round(seconds / STEP)):
            self.ticks += 1
            self.swarm.advance_to(self.now)
            if self.ticks % 3 == 0:
                for vehicle, message in self.streaming.items():
                    found = message(self.now) if callable(message) else message
                    self.swarm.receive(vehicle, self.codec.encode(found), GROUND, self.now)
            self._collect()
            self.track.append(self.swarm.world.states().copy())
            self.times.append(self.now)
            if until is not None and until():
                return True
        return until is None

    def mode_of(self, vehicle: int = 1) -> str:
        return px4.mode_name(self.vehicles[vehicle - 1].autopilot.mode)

    def armed(self, vehicle: int = 1) -> bool:
        return self.vehicles[vehicle - 1].autopilot.armed

    def position(self, vehicle: int = 1) -> Any:
        return self.swarm.world.states()[vehicle - 1, :3]

    def heading(self, vehicle: int = 1) -> float:
        w, x, y, z = self.swarm.world.states()[vehicle - 1, 3:7]
        return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))

    def path(self, vehicle: int = 1) -> Any:
        """Return the true states (n, 13) so far."""
        return np.array(self.track)[:, vehicle - 1]

    def take_off(self, height: float = 5.0) -> None:
        """Arm all and take off, all to one height (m)."""
        self.run(0.5)
        for i, vehicle in enumerate(self.vehicles, start=1):
            assert self.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1, vehicle=i) == mavlink.MAV_RESULT_ACCEPTED
            assert vehicle.aircraft.take_off(DEFAULT_HOME.altitude + height, self.now).result == 0
        assert self.run(20.0, lambda: all(self.mode_of(i + 1) == "AUTO.LOITER" for i in range(len(self.vehicles))))

    def texts(self) -> str:
        """Return all texts since the messages were cleared, the chunks of each joined."""
        found = [m for _, _, m in self.messages if m.get_type() == "STATUSTEXT"]
        return "".join((" " if m.chunk_seq == 0 else "") + m.text for m in found)
