"""What a vehicle reports: its autopilot, the samples that it sends of its own state, and those that it relays."""

from collections.abc import Callable

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from gcs.mission.model import Home
from vehicle_sim.autopilot.autopilot import Autopilot
from vehicle_sim.mavlink.geodesy import LocalFrame, is_finite
from vehicle_sim.world.range_sensor import RangeSample
from vehicle_sim.world.sensors import Measurement, ReportedState

#: Capabilities of every vehicle; :attr:`Report.capabilities` adds those of the services that it has.
_CAPABILITIES: int = (
    mavlink.MAV_PROTOCOL_CAPABILITY_MAVLINK2
    | mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE
    | mavlink.MAV_PROTOCOL_CAPABILITY_COMMAND_INT
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_INT
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_FENCE
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_RALLY
    | mavlink.MAV_PROTOCOL_CAPABILITY_FLIGHT_TERMINATION
    | mavlink.MAV_PROTOCOL_CAPABILITY_SET_ATTITUDE_TARGET
)


class Report:
    """What the messages of one vehicle are made of."""

    def __init__(
        self, system_id: int, autopilot: Autopilot, home: Home, boot_time: float, clock: Callable[[float], float]
    ) -> None:
        """``boot_time`` (s) is the zero of all ``time_boot_ms``; ``clock`` is what its clock shows at a time."""
        self.system_id = system_id
        self.autopilot = autopilot
        self.home = home
        self.frame = LocalFrame(home)
        self.boot_time = boot_time
        self._clock = clock
        self.capabilities = _CAPABILITIES
        """MAV_PROTOCOL_CAPABILITY of AUTOPILOT_VERSION."""
        self.reported: ReportedState | None = None
        """Sample that is sent of the vehicle's own state instead of its estimate; None: the estimate."""
        self.payload: Measurement | None = None
        self.clipping = {px4.AUTOPILOT_COMPONENT: 0, px4.PAYLOAD_UNIT_COMPONENT: 0}
        """Physics steps in which the accelerometer of the vehicle and of the payload unit exceeded its range."""
        self.scan: RangeSample | None = None

    def time_boot_ms(self, time: float) -> int:
        """Return the stamp of a time (s)."""
        return round((self._clock(time) - self.boot_time) * 1e3) & 0xFFFFFFFF

    def time_boot_us(self, time: float) -> int:
        """Return the stamp of a time (s) in microseconds, a whole number of milliseconds."""
        return self.time_boot_ms(time) * 1000

    @property
    def own_attitude(self) -> Measurement | None:
        """The sample whose attitude and rates are sent."""
        return self.autopilot.state.navigation.reported if self.reported is None else self.reported.attitude

    @property
    def own_position(self) -> Measurement | None:
        """The sample whose position and velocity are sent."""
        return self.autopilot.state.navigation.reported if self.reported is None else self.reported.position

    @property
    def own_state(self) -> Measurement | None:
        """Both in one, for messages that need both; None without either, and for what integers cannot hold."""
        attitude, position = self.own_attitude, self.own_position
        if attitude is None or position is None:
            return None
        if attitude is not position:
            position = position._replace(attitude=attitude.attitude, rates=attitude.rates)
        return position if is_finite(position) else None
