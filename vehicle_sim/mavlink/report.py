"""What a vehicle reports: its autopilot, the samples that it sends of its own state, and those that it relays."""

from collections.abc import Callable

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from gcs.mavlink.services.local_frame import is_finite
from gcs.mavlink.services.report import Report
from gcs.mission.model import Home
from idc_controller.rotations_float import Vector
from vehicle_sim.autopilot.autopilot import Autopilot
from vehicle_sim.world.range_sensor import RangeSample
from vehicle_sim.world.sensors import Measurement, ReportedState


class VehicleReport(Report):
    """What the messages of one vehicle are made of."""

    def __init__(
        self, system_id: int, autopilot: Autopilot, home: Home, boot_time: float, clock: Callable[[float], float]
    ) -> None:
        """``boot_time`` (s) is the zero of all ``time_boot_ms``; ``clock`` is what its clock shows at a time."""
        super().__init__(system_id, home)
        self.capabilities |= (
            mavlink.MAV_PROTOCOL_CAPABILITY_FLIGHT_TERMINATION | mavlink.MAV_PROTOCOL_CAPABILITY_SET_ATTITUDE_TARGET
        )
        self.autopilot = autopilot
        self.boot_time = boot_time
        self._clock = clock
        self.reported: ReportedState | None = None
        """Sample that is sent of the vehicle's own state instead of its estimate; None: the estimate."""
        self.payload: Measurement | None = None
        self.clipping = {px4.AUTOPILOT_COMPONENT: 0, px4.PAYLOAD_UNIT_COMPONENT: 0}
        self.scan: RangeSample | None = None

    def time_boot_ms(self, time: float) -> int:
        """See :meth:`.Report.time_boot_ms`."""
        return round((self._clock(time) - self.boot_time) * 1e3) & 0xFFFFFFFF

    @property
    def armed(self) -> bool:
        """See :attr:`.Report.armed`."""
        return self.autopilot.armed

    @property
    def failsafe(self) -> bool:
        """See :attr:`.Report.failsafe`."""
        return self.autopilot.failsafe

    @property
    def mode(self) -> int:
        """See :attr:`.Report.mode`: in a failsafe it is not the one that was commanded."""
        return self.autopilot.mode

    @property
    def intended_mode(self) -> int:
        """See :attr:`.Report.intended_mode`."""
        return self.autopilot.state.mode

    @property
    def landed_state(self) -> int:
        """See :attr:`.Report.landed_state`."""
        return self.autopilot.landed_state

    @property
    def is_booting(self) -> bool:
        """See :attr:`.Report.is_booting`."""
        return self.autopilot.state.navigation.estimate is None

    @property
    def range_sensor_works(self) -> bool | None:
        """See :attr:`.Report.range_sensor_works`."""
        return None if self.scan is None else self.scan.works

    @property
    def return_position(self) -> Vector:
        """See :attr:`.Report.return_position`."""
        return self.autopilot.home

    def arming_problem(self, now: float) -> str | None:
        """See :meth:`.Report.arming_problem`."""
        return self.autopilot.arming_problem(now)

    def has_attitude(self, now: float) -> bool:
        """See :meth:`.Report.has_attitude`."""
        return self.autopilot.state.navigation.is_valid(now)

    def has_position(self, now: float) -> bool:
        """See :meth:`.Report.has_position`."""
        return self.autopilot.state.has_position(now)

    @property
    def own_attitude(self) -> Measurement | None:
        """See :attr:`.Report.own_attitude`."""
        return self.autopilot.state.navigation.reported if self.reported is None else self.reported.attitude

    @property
    def own_position(self) -> Measurement | None:
        """See :attr:`.Report.own_position`."""
        return self.autopilot.state.navigation.reported if self.reported is None else self.reported.position

    @property
    def own_state(self) -> Measurement | None:
        """See :attr:`.Report.own_state`."""
        attitude, position = self.own_attitude, self.own_position
        if attitude is None or position is None:
            return None
        if attitude is not position:
            position = position._replace(attitude=attitude.attitude, rates=attitude.rates)
        return position if is_finite(position) else None

    @property
    def throttle(self) -> float:
        """See :attr:`.Report.throttle`."""
        return self.autopilot.state.actuation.target[2]

    @property
    def specific_force(self) -> Vector | None:
        """See :attr:`.Report.specific_force`: of a free vehicle."""
        return self.autopilot.state.specific_force
