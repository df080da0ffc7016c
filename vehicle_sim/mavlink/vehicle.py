"""One vehicle on the wire: bytes in, bytes out, and the onboard loop behind them. No socket, no clock."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pymavlink.dialects.v20.common as mavlink

from gcs.mavlink import px4
from gcs.mavlink.address import Address
from gcs.mavlink.codec import Codec
from vehicle_sim.autopilot.airframe import Airframe
from vehicle_sim.autopilot.autopilot import Autopilot
from vehicle_sim.autopilot.parameter_table import vehicle_parameters
from vehicle_sim.autopilot.setpoints import SetpointError, read_setpoint, read_stop_plan
from vehicle_sim.mavlink.commands import CommandServer
from vehicle_sim.mavlink.control_owner import ControlOwner, Sender
from vehicle_sim.mavlink.parameter_server import ParameterServer
from vehicle_sim.mavlink.peers import PEER_TIMEOUT, PEERS_MAX, TIME_TOLERANCE, Peer
from vehicle_sim.mavlink.telemetry import Home, Telemetry
from vehicle_sim.world.range_sensor import RangeSample
from vehicle_sim.world.rotors import Four
from vehicle_sim.world.sensors import Measurement, Told

STAMP_WRAP = 2**32 * 1e-3  # s after which stamps of 32 bits begin anew


class Vehicle:
    """A quadrotor that speaks MAVLink like a PX4 autopilot.

    It answers every address that sends it valid MAVLink, up to a bounded number, and offers itself with heartbeats to
    ``ground_address``. A driver calls, at the times it likes:

    - :meth:`step` at the onboard rate with what the sensors measured; its rotor speeds drive the rotors
    - :meth:`receive` with every datagram, :meth:`datagrams_to_send` after it and whenever :meth:`next_timer` is due

    ``refused_setpoints`` counts those that made no sense or came from a stranger.
    """

    def __init__(
        self,
        system_id: int,
        airframe: Airframe,
        *,
        onboard_rate: float = 250.0,
        telemetry_rate: float = 50.0,
        home: Home | None = None,
        ground_address: Address | None = None,
        boot_time: float = 0.0,
        clock: Callable[[float], float] = float,
    ) -> None:
        """``system_id`` 1 .. 255; rates in Hz; ``boot_time`` (s) is the zero of every ``time_boot_ms``.

        ``clock`` is what its clock shows at a time.
        """
        self.system_id = system_id
        self.parameters = vehicle_parameters(airframe, system_id, round(onboard_rate))
        self.autopilot = Autopilot(airframe, self.parameters)
        self.telemetry = Telemetry(system_id, self.autopilot, home or Home(), boot_time, clock)
        self._clock = clock
        self.owner = ControlOwner(self.autopilot)
        self.refused_setpoints = 0
        #: The stamp of the newest set-point from a ground that may command, sane or not: the lockstep echo.
        self.setpoint_stamp_ms: int | None = None
        self._telemetry_interval = 1.0 / telemetry_rate
        self._decoder = Codec(system_id, px4.AUTOPILOT_COMPONENT)
        self._peers: dict[Address, Peer] = {}
        self._ground_address = ground_address
        if ground_address is not None:
            self._add_peer(ground_address).offer()
        self._told_changes = 0
        self._latest = -math.inf
        commands = CommandServer(self.autopilot, self.owner, self.telemetry)
        parameter_server = ParameterServer(self.parameters, self.owner)
        # A further protocol (missions, ...) registers its messages here.
        self._handlers: dict[int, Callable[[Any, Sender, Peer, float], None]] = {
            mavlink.MAVLINK_MSG_ID_SET_ATTITUDE_TARGET: self._on_setpoint,
            mavlink.MAVLINK_MSG_ID_TRAJECTORY_REPRESENTATION_BEZIER: self._on_stop_plan,
            mavlink.MAVLINK_MSG_ID_TIMESYNC: self._on_timesync,
            mavlink.MAVLINK_MSG_ID_PING: self._on_ping,
            **commands.handlers,
            **parameter_server.handlers,
        }

    # The simulator's side

    def step(self, measurement: Measurement | None, now: float) -> Four:
        """One step of the onboard loop: rotor-speed commands (rad/s), in the order of :mod:`vehicle_sim.world.rotors`.

        ``measurement`` is what the vehicle's sensor delivered, None if it delivered nothing.
        """
        speeds = self.autopilot.step(measurement, now)
        if self.autopilot.changes != self._told_changes:
            self._tell_changes()
        return speeds

    def tell(self, told: Told) -> None:
        """What is told from now on of the vehicle's own measurement, where that is not what it flies by."""
        self.telemetry.told = told

    def relay(self, sample: Measurement | None) -> None:
        """A sample of the payload's navigation unit, to be passed on as it is, with its own stamp."""
        if sample is None or sample.can_be_told():
            self.telemetry.payload = sample

    def see(self, scan: RangeSample | None) -> None:
        """A scan of the range sensor, to be passed on with its own stamp."""
        if scan is None:
            return
        if self.telemetry.scan is None or self.telemetry.scan.works != scan.works:
            for peer in self._peers.values():
                peer.hasten(mavlink.MAVLINK_MSG_ID_SYS_STATUS)
        self.telemetry.scan = scan

    # The wire's side

    def receive(self, datagram: bytes, sender: Address, now: float) -> None:
        """Whatever came from an address. Never raises for anything that a datagram can hold."""
        self._latest = max(self._latest, now)
        for message in self._decoder.decode(datagram):
            system = message.get_srcSystem()
            if system in (0, self.system_id):
                continue  # nobody, or its own words coming back
            peer = self._peers.get(sender)
            if peer is None:
                self._drop_silent_peers(now)
                if len(self._peers) >= PEERS_MAX + (self._ground_address is not None):
                    return
                peer = self._add_peer(sender)
            if not peer.is_streaming:
                peer.start_streams()
            peer.heard_at = now
            self.autopilot.heard_from_ground(now)
            handler = self._handlers.get(message.get_msgId())
            if handler is not None and self._is_for_us(message):
                handler(message, (sender, system), peer, now)

    def datagrams_to_send(self, now: float) -> list[tuple[bytes, Address]]:
        """All that is due at ``now`` (s), each with its address."""
        self._latest = max(self._latest, now)
        if self.autopilot.changes != self._told_changes or self.autopilot.notices:
            self._tell_changes()
        telemetry = self.telemetry
        out: list[tuple[bytes, Address]] = []
        for peer in tuple(self._peers.values()):
            if now + TIME_TOLERANCE < peer.next_due:
                continue
            if peer.is_streaming and now - peer.heard_at > PEER_TIMEOUT:
                self._drop_silent_peers(now)
                if peer.address not in self._peers:
                    continue
            out.extend([(datagram, peer.address) for datagram in peer.datagrams(telemetry, now)])
        return out

    def next_timer(self) -> float | None:
        """When :meth:`datagrams_to_send` has something to do (s; in the past: at once). None: never as things are."""
        due = min((peer.next_due for peer in self._peers.values()), default=math.inf)
        if due == -math.inf:
            return self._latest if math.isfinite(self._latest) else 0.0
        return due if math.isfinite(due) else None

    # Inside

    def _add_peer(self, address: Address) -> Peer:
        peer = Peer(address, self.system_id, self._telemetry_interval)
        self._peers[address] = peer
        return peer

    def _drop_silent_peers(self, now: float) -> None:
        for address, peer in tuple(self._peers.items()):
            if peer.is_streaming and now - peer.heard_at > PEER_TIMEOUT:
                if address == self._ground_address:
                    peer.offer()
                else:
                    del self._peers[address]

    def _is_for_us(self, message: Any) -> bool:
        """Addressed to this autopilot, or to everybody, or to nobody in particular."""
        system = getattr(message, "target_system", 0)
        component = getattr(message, "target_component", 0)
        return system in (0, self.system_id) and component in (0, px4.AUTOPILOT_COMPONENT)

    def _tell_changes(self) -> None:
        self._told_changes = self.autopilot.changes
        for peer in self._peers.values():
            peer.hasten(mavlink.MAVLINK_MSG_ID_HEARTBEAT, mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE)
        notices, self.autopilot.notices = self.autopilot.notices, []
        for text in notices:
            for peer in self._peers.values():
                if peer.is_streaming:
                    peer.tell(text)

    def _on_setpoint(self, message: Any, sender: Sender, peer: Peer, now: float) -> None:
        if self.owner.is_stranger(sender, now):
            self.refused_setpoints += 1
            return
        self.setpoint_stamp_ms = message.time_boot_ms
        try:
            setpoint = read_setpoint(message)
        except SetpointError:
            self.refused_setpoints += 1
            return
        self.owner.take(setpoint, sender, now)

    def _on_stop_plan(self, message: Any, sender: Sender, peer: Peer, now: float) -> None:
        if self.owner.in_control(now) != sender:
            return
        try:
            plan = read_stop_plan(message)
        except SetpointError:
            self.refused_setpoints += 1
            return
        start = plan.start - (self._clock(now) - now)
        # The ground knows this clock by stamps of 32 bits, which may have begun anew since.
        start += round((now - start) / STAMP_WRAP) * STAMP_WRAP
        self.autopilot.stop_plan = plan._replace(start=start)

    def _on_timesync(self, message: Any, sender: Sender, peer: Peer, now: float) -> None:
        if message.tc1 == 0:  # a question
            peer.reply(mavlink.MAVLink_timesync_message(round(self._clock(now) * 1e9), message.ts1))

    def _on_ping(self, message: Any, sender: Sender, peer: Peer, now: float) -> None:
        if message.target_system == 0:  # a question
            peer.reply(
                mavlink.MAVLink_ping_message(message.time_usec, message.seq, sender[1], message.get_srcComponent())
            )
