"""A ground station of a few lines for the swarm's tests: arms all, lifts the payload open loop, then stops sending."""

import math
import socket

import pymavlink.dialects.v20.common as mavlink

from gcs.mavlink import px4
from gcs.mavlink.codec import Codec
from gcs.mavlink.lockstep import Done, decode_tick
from gcs.mavlink.setpoints import attitude_target

INTERVAL = 0.05
GROUND = ("127.0.0.1", 1)
UP = (0.0, 0.0, -1.0)


class ScriptedGround:
    """Sans-I/O like the real one. ``finished`` once the payload has risen by ``lift`` (m)."""

    def __init__(self, addresses, hover_thrust, thrust_max, lift=0.6, excess=1.03):
        self.addresses = dict(enumerate(addresses, start=1))
        self.codec = Codec(255, mavlink.MAV_COMP_ID_MISSIONPLANNER)
        self.decoders = {address: Codec(255, 1) for address in self.addresses.values()}
        self.top = excess * hover_thrust
        self.thrust_max = thrust_max
        self.altitude_to_reach = lift + 0.30
        self.finished = False
        self.commanded = False
        self.next = 0.0
        self.messages = []
        self.of_payload = []
        self.stamps = {}

    def receive(self, datagram, sender, now):
        for received in self.decoders[sender].decode(datagram):
            message = received.message
            self.messages.append(message)
            if message.get_srcSystem() == px4.PAYLOAD_UNIT_SYSTEM:
                self.of_payload.append((sender, message))
            if message.get_type() != "LOCAL_POSITION_NED":
                continue
            if message.get_srcSystem() == px4.PAYLOAD_UNIT_SYSTEM:
                self.finished |= -message.z > self.altitude_to_reach
            else:
                self.stamps.setdefault(message.get_srcSystem(), []).append((message.time_boot_ms, now))

    def next_timer(self):
        return None if self.finished else self.next

    def datagrams_to_send(self, now):
        if self.finished or now + 1e-6 < self.next:
            return []
        self.next = (math.floor((now + 1e-6) / INTERVAL) + 1) * INTERVAL
        thrust = self.top * min(max((now - 0.6) / 2.0, 0.0), 1.0)
        out = []
        for i, address in self.addresses.items():
            out.append((self.codec.frame(attitude_target(i, now, UP, thrust, self.thrust_max)), address))
            if now > 0.3 and not self.commanded:
                mode = (mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED, px4.MainMode.OFFBOARD, 0)
                out.append((self.command(i, mavlink.MAV_CMD_DO_SET_MODE, *mode), address))
                out.append((self.command(i, mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1), address))
        self.commanded |= now > 0.3
        return out

    def command(self, system_id, number, *parameters):
        padded = (*map(float, parameters), *[0.0] * (7 - len(parameters)))
        return self.codec.encode(mavlink.MAVLink_command_long_message(system_id, 1, number, 0, *padded))

    def of_type(self, name, system_id=None):
        return [m for m in self.messages if m.get_type() == name and system_id in (None, m.get_srcSystem())]


def exchange(swarm, ground, until, stop=lambda: False):
    """Fly in one process, without sockets: the vehicles' addresses are ("uav", i), the ground's is :data:`GROUND`.

    To the simulated time ``until`` (s), or until ``stop()`` says so.
    """
    now = swarm.time
    while now <= until and not stop():
        swarm.advance_to(now)
        for i, datagram, address in swarm.datagrams_to_send(now):
            if address == GROUND:
                ground.receive(datagram, ("uav", i), now)
        for datagram, (_, i) in ground.datagrams_to_send(now):
            swarm.receive(i, datagram, GROUND, now)
        due = [t for t in (swarm.next_timer(), ground.next_timer()) if t is not None]
        now = max(min(due), now)
    return now


class LockstepClient:
    """The ground's side of the lockstep barrier, on a real socket."""

    def __init__(self, ground, clock):
        self.ground = ground
        self.clock = clock
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.settimeout(20.0)
        self.now = -1.0

    def join(self):
        self.socket.sendto(Done(0, None).encode(), self.clock)

    def run(self, stop):
        """Answer ticks until ``stop()``; the last one stays unanswered."""
        while True:
            datagram, sender = self.socket.recvfrom(65535)
            if sender != self.clock:
                self.ground.receive(datagram, sender, self.now)
                continue
            tick = decode_tick(datagram)
            self.now = tick.time_us / 1e6
            if stop():
                self.last_tick = tick
                return
            for out, address in self.ground.datagrams_to_send(self.now):
                self.socket.sendto(out, address)
            due = self.ground.next_timer()
            next_us = None if due is None else max(round(due * 1e6), tick.time_us + 1)
            self.socket.sendto(Done(tick.serial, next_us).encode(), self.clock)

    def leave(self):
        self.socket.sendto(Done(self.last_tick.serial, None, leaving=True).encode(), self.clock)

    def close(self):
        self.socket.close()
