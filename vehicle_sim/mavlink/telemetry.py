"""The messages a vehicle streams, each built from the vehicle's state on demand."""

from collections.abc import Callable
from functools import partial

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from gcs.mavlink.layout import packed
from gcs.mavlink.services import motion_messages, status_messages
from gcs.mavlink.services.aircraft import Built, MessageKey
from gcs.mavlink.services.motion_messages import attitude_of, position_of, vibration
from gcs.mission.model import Home
from vehicle_sim.autopilot.autopilot import Autopilot
from vehicle_sim.mavlink import target_messages
from vehicle_sim.mavlink.report import VehicleReport
from vehicle_sim.mavlink.scan_messages import ScanMessages

_OWN, _UNIT = px4.AUTOPILOT_COMPONENT, px4.PAYLOAD_UNIT_COMPONENT
_SCAN = mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D, mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE


class Telemetry(VehicleReport):
    """Builds messages from one vehicle's autopilot, and from the payload unit's samples it relays."""

    def __init__(
        self, system_id: int, autopilot: Autopilot, home: Home, boot_time: float, clock: Callable[[float], float]
    ) -> None:
        """See :class:`.VehicleReport`."""
        super().__init__(system_id, autopilot, home, boot_time, clock)
        scan = ScanMessages(self)
        tables = status_messages.MESSAGES | motion_messages.MESSAGES | target_messages.MESSAGES
        own: dict[int, Callable[[float], Built]] = {
            **{number: partial(build, self) for number, build in tables.items()},
            mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D: scan.returns,
            mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE: scan.end,
        }
        unit: dict[int, Callable[[float], Built]] = {
            mavlink.MAVLINK_MSG_ID_HEARTBEAT: self._payload_heartbeat,
            mavlink.MAVLINK_MSG_ID_VIBRATION: lambda now: vibration(self, now, _UNIT),
            mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: lambda now: attitude_of(self, self.payload),
            mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED: lambda now: position_of(self, self.payload),
        }
        #: By component and message id.
        self.builders: dict[MessageKey, Callable[[float], Built]] = {
            (component, number): build for component, table in ((_OWN, own), (_UNIT, unit))
            for number, build in table.items()
        }  # fmt: skip

    def absence(self, key: MessageKey) -> str | None:
        """Return why a message is not sent in this world whoever requests it; None: it is."""
        if key[1] in _SCAN and self.scan is None:
            return "no range sensor: nothing to range in this world"
        return None

    def _payload_heartbeat(self, now: float) -> Built:
        if self.payload is None:
            return ()
        return packed(
            mavlink.MAVLink_heartbeat_message(
                mavlink.MAV_TYPE_ONBOARD_CONTROLLER, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, mavlink.MAV_STATE_ACTIVE, 3
            )
        )
