"""What the team reports: the payload's motion as that of one multicopter, and the state of its flight."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.flight.phase import CONTROLLED, IN_AIR, Phase
from gcs.mavlink import px4
from gcs.mavlink.services.report import Report
from gcs.mavlink.team_failsafe import Reaction
from gcs.serve.aircraft import TeamAircraft
from gcs.serve.session import TeamSession
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Position
from idc_controller.rotations import quaternion_from_euler
from idc_controller.rotations_float import Quaternion, Vector

_FRESH = 0.5
"""s; for which what was estimated last is the present state."""
_REST = (0.0, 0.0, 0.0)


class PayloadMotion(NamedTuple):
    """A :class:`.Motion` of the payload; times are the ground's (s)."""

    time: float
    attitude: Quaternion
    rates: Vector
    position: Vector
    velocity: Vector


class TeamReport(Report):
    """What the messages of the team are made of."""

    def __init__(self, system_id: int, session: TeamSession, aircraft: TeamAircraft) -> None:
        super().__init__(system_id, session.world.home)
        self._session, self._aircraft = session, aircraft
        self.clipping = {px4.AUTOPILOT_COMPONENT: 0}
        self._motion: PayloadMotion | None = None

    def time_boot_ms(self, time: float) -> int:
        """See :meth:`.Report.time_boot_ms`: since the ground began."""
        return round(time * 1e3) & 0xFFFFFFFF

    def update(self, now: float) -> None:
        """Take the payload's motion as it is known at ``now``: estimated in flight, measured on the ground."""
        flight = self._session.flight
        record = flight.last_record
        if flight.phase in CONTROLLED and record is not None and flight.time - record.estimate.time < _FRESH:
            x, y, z, v_x, v_y, v_z, roll, pitch, yaw, p, q, r = record.estimate.x[:12].tolist()
            attitude = tuple(quaternion_from_euler(roll, pitch, yaw).tolist())
            self._motion = PayloadMotion(now, attitude, (p, q, r), (x, y, z), (v_x, v_y, v_z))
            return
        measured = flight.system.preflight.latest
        position, turned = measured.get((PAYLOAD, Position)), measured.get((PAYLOAD, Attitude))
        if position is not None and turned is not None and flight.phase in (Phase.CHECK, Phase.ARM):
            attitude, place = tuple(turned.pose.tolist()), tuple(position.pose.tolist())
            self._motion = PayloadMotion(now, attitude, _REST, place, _REST)

    # Status

    @property
    def armed(self) -> bool:
        """See :attr:`.Report.armed`."""
        return any(link.status.armed for link in self._session.station.links)

    @property
    def failsafe(self) -> bool:
        """See :attr:`.Report.failsafe`."""
        return self._session.in_air and self._session.flight.failsafes.reaction > Reaction.NONE

    @property
    def mode(self) -> int:
        """See :attr:`.Report.mode`: in a failsafe LAND."""
        return px4.MODE_LAND if self.failsafe else self._session.mode

    @property
    def intended_mode(self) -> int:
        """See :attr:`.Report.intended_mode`."""
        return self._session.mode

    @property
    def landed_state(self) -> int:
        """See :attr:`.Report.landed_state`."""
        phase = self._session.flight.phase
        if phase in (Phase.LAND, Phase.AUTONOMOUS_LANDING):
            return mavlink.MAV_LANDED_STATE_LANDING
        if phase is Phase.CLIMB:
            return mavlink.MAV_LANDED_STATE_TAKEOFF
        return mavlink.MAV_LANDED_STATE_IN_AIR if phase in IN_AIR else mavlink.MAV_LANDED_STATE_ON_GROUND

    @property
    def is_booting(self) -> bool:
        """See :attr:`.Report.is_booting`."""
        return self._motion is None

    @property
    def range_sensor_works(self) -> bool | None:
        """See :attr:`.Report.range_sensor_works`."""
        return all(link.status.obstacle_sensing_valid for link in self._session.station.links)

    @property
    def return_position(self) -> Vector:
        """See :attr:`.Report.return_position`."""
        return 0.0, 0.0, 0.0

    def arming_problem(self, now: float) -> str | None:
        """See :meth:`.Report.arming_problem`."""
        return self._aircraft.arming_problem(now)

    def has_attitude(self, now: float) -> bool:
        """See :meth:`.Report.has_attitude`."""
        return self._motion is not None

    def has_position(self, now: float) -> bool:
        """See :meth:`.Report.has_position`."""
        return self._motion is not None

    # Motion

    @property
    def own_attitude(self) -> PayloadMotion | None:
        """See :attr:`.Report.own_attitude`."""
        return self._motion

    @property
    def own_position(self) -> PayloadMotion | None:
        """See :attr:`.Report.own_position`."""
        return self._motion

    @property
    def own_state(self) -> PayloadMotion | None:
        """See :attr:`.Report.own_state`."""
        return self._motion

    @property
    def throttle(self) -> float:
        """See :attr:`.Report.throttle`: the mean of the vehicles'."""
        record, flight = self._session.flight.last_record, self._session.flight
        if record is None or flight.phase not in CONTROLLED:
            return 0.0
        limits = [link.status.parameters.get(px4.PARAM_THRUST_MAX, math.inf) for link in self._session.station.links]
        return float(np.mean(record.decision.thrusts / np.array(limits)))

    @property
    def specific_force(self) -> Vector | None:
        """See :attr:`.Report.specific_force`: not measured."""
        return None
