"""The team on the wire: its vehicles on one side, ground stations and companions on the other. No socket, no clock."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields
from functools import partial

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.flight.failsafe import Failsafe
from gcs.mavlink import newer_messages, px4
from gcs.mavlink.address import Address
from gcs.mavlink.codec import Codec
from gcs.mavlink.messages import BROADCAST
from gcs.mavlink.services import motion_messages, status_messages
from gcs.mavlink.services.aircraft import Built, MessageKey, Sender
from gcs.mavlink.services.commands import CommandServer
from gcs.mavlink.services.dispatcher import Dispatcher, Request
from gcs.mavlink.services.files import FileServices
from gcs.mavlink.services.link import LinkServices
from gcs.mavlink.services.missions import MissionServer
from gcs.mavlink.services.other_components import OtherComponents
from gcs.mavlink.services.parameters import ParameterServer
from gcs.mavlink.services.peer import Peer
from gcs.mavlink.services.peers import Peers
from gcs.mavlink.services.plans import Plans
from gcs.mavlink.services.streams import StreamRequests
from gcs.mavlink.services.unserved_inputs import STICKS, UnservedInputs
from gcs.mission.model import Mission
from gcs.serve.aircraft import TeamAircraft
from gcs.serve.parameters import TeamParameters
from gcs.serve.plan_rules import TeamPlanRules
from gcs.serve.report import TeamReport
from gcs.serve.session import OpenFlight, TeamSession

TEAM_SYSTEM = 101
"""System id of the team: behind its payload unit, above every vehicle's."""
_MISSION_CURRENT = px4.AUTOPILOT_COMPONENT, mavlink.MAVLINK_MSG_ID_MISSION_CURRENT
_OWN = TEAM_SYSTEM, px4.AUTOPILOT_COMPONENT


class _Everybody:
    """Control of the team: whoever is let in by the address that is listened at may command it, as with PX4."""

    def is_stranger(self, sender: Sender, now: float) -> bool:
        return False

    def is_stranger_at_its_address(self, sender: Sender, now: float) -> bool:
        return False


class TeamServer:
    """What a driver runs in place of one ground station: the session's, and the services of the team.

    Times are the ground's (s). Datagrams from the vehicles go to the ground station, all others to the services.
    """

    def __init__(
        self, world: Mission, open_flight: Callable[[Mission, bool], OpenFlight], clients: Sequence[Address] = ()
    ) -> None:
        """``clients``: addresses to which the streams go from the start, whether anybody listens there or not."""
        config = world.system
        self.session = TeamSession(world, open_flight)
        self.parameters = TeamParameters(config, TEAM_SYSTEM)
        self.aircraft = TeamAircraft(self.session, self.parameters)
        self.parameters.on_change = self.aircraft.configure
        self.report = TeamReport(TEAM_SYSTEM, self.session, self.aircraft)
        link = config.vehicle_link
        self.builders: dict[MessageKey, Callable[[float], Built]] = {
            (px4.AUTOPILOT_COMPONENT, number): partial(build, self.report)
            for number, build in (status_messages.MESSAGES | motion_messages.MESSAGES).items()
        }
        self._decoder = Codec(*_OWN)
        self._intervals: dict[MessageKey, float] = {
            key: getattr(link.intervals, setting.name)
            for setting in fields(link.intervals)
            if (key := (px4.AUTOPILOT_COMPONENT, newer_messages.message_number(setting.name)))
            in {*self.builders, _MISSION_CURRENT}
        } | dict.fromkeys(
            [
                (px4.AUTOPILOT_COMPONENT, mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION),
                (px4.AUTOPILOT_COMPONENT, mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED),
            ],
            1.0 / config.rates.control,
        )
        control, clock = _Everybody(), float
        plans = Plans(self.aircraft, TeamPlanRules(self.aircraft))
        self._peers = Peers(lambda address, _: self._new_peer(address), dict.fromkeys(clients, True), link)
        self._missions = MissionServer(TEAM_SYSTEM, plans, control, self._peers, link.missions)
        self.builders.update(self._missions.builders)
        self.dispatcher = Dispatcher()
        """All that the team does for others."""
        LinkServices(clock).register(self.dispatcher)
        self._missions.register(self.dispatcher)
        streams = StreamRequests(px4.AUTOPILOT_COMPONENT, self, control, link, self.dispatcher.requests)
        CommandServer(self.aircraft, control, self, streams, self.parameters).register(self.dispatcher)
        self._other_components = OtherComponents(_OWN, _OWN, streams.handlers)
        ParameterServer(self.parameters, control, self._peers).register(self.dispatcher)
        FileServices().register(self.dispatcher)
        UnservedInputs(TEAM_SYSTEM, STICKS).register(self.dispatcher)
        self._changes = -1
        self.now = 0.0
        """Time of the last exchange."""

    def _new_peer(self, address: Address) -> Peer:
        config = self.session.world.system
        return Peer(address, (_OWN,), self._intervals, config.vehicle_link)

    def absence(self, key: MessageKey) -> str | None:
        """See :meth:`.MessageSource.absence`."""
        return None

    # The driver's side: as a GroundStation

    @property
    def ended(self) -> bool:
        """True if it was closed and the payload is on the ground."""
        return self.session.ended

    def raise_failsafe(self, now: float, failsafe: Failsafe, reason: str) -> None:
        """React to an event that ends the service: what is in the air is landed."""
        self.session.raise_failsafe(now, failsafe, reason)

    def receive_all(self, datagrams: Sequence[tuple[bytes, Address]], now: float) -> None:
        """Take datagrams, each with its sender. Never raises for anything that a datagram can hold."""
        known = {link.address for link in self.session.station.links}
        of_vehicles = []
        for datagram, sender in datagrams:
            if sender in known or (None in known and _is_of_vehicle(datagram)):
                of_vehicles.append((datagram, sender))
            else:
                self._receive(datagram, sender, now)
        self.session.station.receive_all(of_vehicles, now)

    def datagrams_to_send(self, now: float) -> list[tuple[bytes, Address]]:
        """Return all that is due at ``now``, each with its address."""
        self.now = now
        out = self.session.station.datagrams_to_send(now)
        self.aircraft.report_reached()
        self.session.step(now)
        self._send_changes()
        self._missions.run(now)
        self.report.update(now)
        if self._peers.next_due <= now:
            out += self._peers.datagrams_to_send(self, now)
        return out

    def next_timer(self) -> float | None:
        """Return when :meth:`datagrams_to_send` is to be called again; None: never."""
        if self.ended:
            return None
        due = [self._peers.next_due, self._missions.next_due]
        if self.session.run_down > self.now:
            due.append(self.session.run_down)
        if (of_station := self.session.station.next_timer()) is not None:
            due.append(of_station)
        return max(min(due), self.now)

    def resume(self) -> None:
        """See :meth:`.GroundStation.resume`."""
        self.session.station.resume()

    def sent(self) -> None:
        """See :meth:`.GroundStation.sent`."""
        self.session.station.sent()

    def add_latency(self, duration: float) -> None:
        """See :meth:`.GroundStation.add_latency`."""
        self.session.station.add_latency(duration)

    # The services' side

    def _receive(self, datagram: bytes, sender: Address, now: float) -> None:
        peer = request = None
        messages = self._decoder.decode(datagram)
        for received in messages:
            system, component = received.system, received.component
            if system == BROADCAST or (system, component) == _OWN:
                continue
            if peer is None:
                peer = self._peers.receive_from(sender, now)
                if peer is None:
                    return
                if not peer.answered:
                    peer.hear(len(datagram), addressed=any(m.target_system == TEAM_SYSTEM for m in messages))
            if request is None or request.component != component or request.system != system:
                request = Request((sender, system), component, peer, now)
            if received.is_for(*_OWN):
                self.dispatcher.dispatch(received, request)
            else:
                self._other_components.handle(received, request)

    def _send_changes(self) -> None:
        session = self.session
        if session.changes != self._changes:
            self._changes = session.changes
            self._peers.repeat(
                mavlink.MAVLINK_MSG_ID_HEARTBEAT, mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE, newer_messages.CURRENT_MODE
            )
        for text in session.notices:
            self._peers.send_statustext(text)
        session.notices.clear()


def _is_of_vehicle(datagram: bytes) -> bool:
    """Return whether the first message of a datagram is of a vehicle or of the payload unit, by its system id."""
    place = {mavlink.PROTOCOL_MARKER_V1: 3, mavlink.PROTOCOL_MARKER_V2: 5}.get(datagram[0]) if datagram else None
    return place is not None and len(datagram) > place and 0 < datagram[place] <= px4.PAYLOAD_UNIT_SYSTEM
