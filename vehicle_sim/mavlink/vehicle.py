"""One vehicle on the wire: bytes in, bytes out, and the autopilot behind them. No socket, no clock."""

import math
from collections.abc import Callable, Mapping, Set
from types import MappingProxyType
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config.vehicle_settings import AutopilotSettings, VehicleLinkSettings
from gcs.mavlink import newer_messages, px4
from gcs.mavlink.address import Address
from gcs.mavlink.codec import Codec
from gcs.mavlink.messages import BROADCAST
from gcs.mavlink.services.commands import CommandServer
from gcs.mavlink.services.dispatcher import Dispatcher, Request
from gcs.mavlink.services.files import FileServices
from gcs.mavlink.services.link import LinkServices
from gcs.mavlink.services.local_frame import LocalFrame
from gcs.mavlink.services.mission_store import MissionStore
from gcs.mavlink.services.missions import MissionServer
from gcs.mavlink.services.other_components import OtherComponents
from gcs.mavlink.services.parameters import ParameterServer
from gcs.mavlink.services.peer import Peer
from gcs.mavlink.services.peers import Peers
from gcs.mavlink.services.streams import StreamRequests
from gcs.mavlink.services.unserved_inputs import STICKS, UnservedInputs
from gcs.mission.model import DEFAULT_HOME, Home
from vehicle_sim.autopilot.airframe import Airframe
from vehicle_sim.autopilot.autopilot import Autopilot
from vehicle_sim.autopilot.free.autopilot import FreeAutopilot
from vehicle_sim.autopilot.onboard_arrays import OnboardArrays
from vehicle_sim.autopilot.vehicle_parameters import vehicle_parameters
from vehicle_sim.mavlink.aircraft import CoupledAircraft
from vehicle_sim.mavlink.control_owner import ControlOwner
from vehicle_sim.mavlink.free_aircraft import FreeAircraft
from vehicle_sim.mavlink.mission_plans import CoupledPlans, MissionPlans
from vehicle_sim.mavlink.payload_unit import PayloadUnit
from vehicle_sim.mavlink.setpoint_server import AttitudeSetpointServer, PositionSetpointServer, SetpointServer
from vehicle_sim.mavlink.streams import CLIENT_STREAMS, OFFSETS, default_intervals
from vehicle_sim.mavlink.telemetry import Telemetry
from vehicle_sim.world.range_sensor import RangeSample
from vehicle_sim.world.sensors import Measurement, ReportedState


class Vehicle:
    """A quadrotor that speaks MAVLink like a PX4 autopilot.

    It answers every address that sends it valid MAVLink, up to a bounded number, and sends all streams to the ports of
    ``clients`` from the start and for ever. It forwards the messages of the payload unit, which is a system of its own.

    A driver calls, at any time, :meth:`receive` with every datagram, :meth:`datagrams_to_send` after it and whenever
    :meth:`next_timer` is due. Its autopilot takes its steps with the team.
    """

    def __init__(
        self,
        system_id: int,
        airframe: Airframe,
        *,
        onboard_rate: float = 250.0,
        telemetry_rate: float = 50.0,
        home: Home = DEFAULT_HOME,
        clients: Mapping[Address, bool] = MappingProxyType({}),
        boot_time: float = 0.0,
        clock: Callable[[float], float] = float,
        autopilot: AutopilotSettings = AutopilotSettings(),
        link: VehicleLinkSettings = VehicleLinkSettings(),
        arrays: OnboardArrays | None = None,
        plans: MissionStore | None = None,
        free: bool = False,
        unit: PayloadUnit | None = None,
    ) -> None:
        """``system_id`` 1 .. 255; rates in Hz; ``boot_time`` (s) is the zero of every ``time_boot_ms``.

        ``clients``: ports of clients, and whether the payload unit's messages go there, too.
        ``clock`` is what its clock shows at a time; ``arrays`` as in :class:`.Autopilot`; ``free``: it has no payload,
        and flies by itself. ``plans``: its mission, fence and rally points, if not those of its kind. ``unit``: what
        carries out the commands to the payload unit that it forwards.
        """
        intervals = default_intervals(link.intervals, 1.0 / telemetry_rate)
        if free:
            intervals = {key: interval for key, interval in intervals.items() if key[0] == px4.AUTOPILOT_COMPONENT}
        of_caller = {key: interval for key, interval in intervals.items() if key not in CLIENT_STREAMS}
        self.system_id = system_id
        self.parameters = vehicle_parameters(airframe, system_id, round(onboard_rate), autopilot, free=free)
        self.autopilot = (FreeAutopilot if free else Autopilot)(airframe, self.parameters, autopilot, arrays)
        self.telemetry = Telemetry(system_id, self.autopilot, home, boot_time, clock)
        self._decoder = Codec(system_id, px4.AUTOPILOT_COMPONENT)
        own, payload_unit = (
            (system_id, px4.AUTOPILOT_COMPONENT),
            (px4.PAYLOAD_UNIT_SYSTEM, px4.PAYLOAD_UNIT_COMPONENT),
        )
        self._own = own, payload_unit
        """System and component of all that it sends."""
        self._systems = own[0], payload_unit[0]
        self._peers = Peers(
            lambda address, with_payload: Peer(
                address,
                self._own,
                intervals if address in clients else of_caller,
                link,
                silent=None if with_payload else px4.PAYLOAD_UNIT_COMPONENT,
                offsets=OFFSETS,
            ),
            clients,
            link,
        )
        self._sent_changes = 0
        self._latest = -math.inf
        owner = ControlOwner(self.autopilot, link)
        self.dispatcher = Dispatcher()
        """All that it does for others."""
        self.aircraft: FreeAircraft | CoupledAircraft
        """What commands and missions are carried out by."""
        if isinstance(self.autopilot, FreeAutopilot):
            frame = LocalFrame(home)
            self._setpoints: SetpointServer = PositionSetpointServer(self.autopilot, owner, clock, frame)
            self.aircraft = FreeAircraft(self.autopilot, owner, frame)
            self.telemetry.capabilities |= (
                mavlink.MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED
                | mavlink.MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_GLOBAL_INT
            )
            plans = plans or MissionPlans(home, self.aircraft)
        else:
            self._setpoints = AttitudeSetpointServer(self.autopilot, owner, clock)
            self.aircraft = CoupledAircraft(self.autopilot, owner)
        # A further protocol registers its messages and commands here.
        self._setpoints.register(self.dispatcher)
        self._owner = None if free else owner
        self.dispatcher.register_fields(mavlink.MAVLink_heartbeat_message, self._on_heartbeat)
        LinkServices(clock).register(self.dispatcher)
        self._missions = MissionServer(system_id, plans or CoupledPlans(), owner, self._peers, link.missions)
        self._missions.register(self.dispatcher)
        self.telemetry.builders.update(self._missions.builders)
        streams = StreamRequests(px4.AUTOPILOT_COMPONENT, self.telemetry, owner, link, self.dispatcher.requests)
        of_payload_unit = StreamRequests(px4.PAYLOAD_UNIT_COMPONENT, self.telemetry, owner, link)
        CommandServer(self.aircraft, owner, self.telemetry, streams, self.parameters).register(self.dispatcher)
        of_unit = {**of_payload_unit.handlers, **({} if unit is None else unit.handlers(system_id, owner))}
        self._other_components = OtherComponents(own, own if free else payload_unit, of_unit)
        ParameterServer(self.parameters, owner, self._peers).register(self.dispatcher)
        FileServices().register(self.dispatcher)
        UnservedInputs(system_id, STICKS).register(self.dispatcher)

    @property
    def refused_setpoints(self) -> int:
        """Set-points that could not be flown or came from a ground that is not in control."""
        return self._setpoints.refused

    # The simulator's side

    def report(self, reported: ReportedState) -> None:
        """Send this from now on as the vehicle's own state, where that is not its estimate."""
        self.telemetry.reported = reported

    def relay(self, sample: Measurement | None) -> None:
        """Send a sample of the payload's navigation unit as it is, with its own stamp."""
        if sample is None or sample.is_encodable():
            self.telemetry.payload = sample

    def count_clipping(self, *, own: bool, payload: bool) -> None:
        """Count an accelerometer that exceeded its range, the vehicle's own or the payload unit's, and say so."""
        for exceeded, component in ((own, px4.AUTOPILOT_COMPONENT), (payload, px4.PAYLOAD_UNIT_COMPONENT)):
            if exceeded:
                self.telemetry.clipping[component] += 1
                self._peers.repeat(mavlink.MAVLINK_MSG_ID_VIBRATION, component=component)

    def take_scan(self, scan: RangeSample | None) -> None:
        """Send a scan of the range sensor, with its own stamp."""
        if scan is None:
            return
        if self.telemetry.scan is None or self.telemetry.scan.works != scan.works:
            self._peers.repeat(mavlink.MAVLINK_MSG_ID_SYS_STATUS)
        self.telemetry.scan = scan

    # The wire's side

    def receive(self, datagram: bytes, sender: Address, now: float) -> None:
        """Take what came from an address. Never raises for anything that a datagram can hold."""
        if now > self._latest:
            self._latest = now
        peer = request = None
        is_foreign = False
        messages = self._decoder.decode(datagram)
        for received in messages:
            system, component = received.system, received.component
            if system == BROADCAST or (system, component) in self._own:
                continue  # nobody, or its own messages coming back
            if peer is None:
                peer = self._peers.receive_from(sender, now)
                if peer is None:
                    return
                if not peer.answered:
                    peer.hear(len(datagram), addressed=any(m.target_system in self._systems for m in messages))
            if not is_foreign and system != self.system_id:
                is_foreign = True
                self.autopilot.message_received()
                if self._owner is not None and self._owner.owner == (sender, system):
                    self.autopilot.ground_heard(now)
            if request is None or request.component != component or request.system != system:
                request = Request((sender, system), component, peer, now)
            if received.is_for(self.system_id, px4.AUTOPILOT_COMPONENT):
                self.dispatcher.dispatch(received, request)
            else:
                self._other_components.handle(received, request)

    def datagrams_to_send(self, now: float) -> list[tuple[bytes, Address]]:
        """Return all that is due at ``now`` (s), each with its address."""
        if now > self._latest:
            self._latest = now
        if self.autopilot.changes != self._sent_changes or self.autopilot.state.notices:
            self.send_changes()
        self._missions.run(now)
        return self._peers.datagrams_to_send(self.telemetry, now)

    def _on_heartbeat(self, fields: tuple[Any, ...], request: Request) -> None:
        """Take the HEARTBEAT of a ground: where none is in control of a vehicle on a payload, its data link is up."""
        _, kind, *_ = fields
        if kind != mavlink.MAV_TYPE_GCS or request.system == self.system_id:  # a companion of its own is none
            return
        if self._owner is None or self._owner.owner is None:
            self.autopilot.ground_heard(request.now)

    @property
    def listeners(self) -> Set[Address]:
        """Ports of clients from which nothing has come yet."""
        return self._peers.listeners

    def next_timer(self) -> float | None:
        """Return when :meth:`datagrams_to_send` has something to do (s; in the past: at once), None: never."""
        due = min(self._peers.next_due, self._missions.next_due)
        if due == -math.inf:
            return self._latest if math.isfinite(self._latest) else 0.0
        return due if due < math.inf else None

    def send_changes(self) -> None:
        """Send the HEARTBEAT anew, and what is to be said to the operator."""
        self._sent_changes = self.autopilot.changes
        self._peers.repeat(
            mavlink.MAVLINK_MSG_ID_HEARTBEAT, mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE, newer_messages.CURRENT_MODE
        )
        for text in self.autopilot.take_notices():
            self._peers.send_statustext(text)
