"""The messages a vehicle streams, each built from the vehicle's state on demand."""

import math
from collections.abc import Callable

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from gcs.mavlink.layout import LAYOUTS, Packed, PackedRun, packed
from gcs.mavlink.services.aircraft import Built, MessageKey
from gcs.mission.model import Home
from idc_controller.rotations_float import euler_of, into_body
from vehicle_sim.autopilot.actuation import LEVEL
from vehicle_sim.autopilot.autopilot import Autopilot
from vehicle_sim.mavlink.geodesy import LocalFrame, clamp, is_finite
from vehicle_sim.mavlink.scan_kernels import nearest_by_sector
from vehicle_sim.world.range_sensor import RangeSample
from vehicle_sim.world.sensors import Measurement, ReportedState

_SENSORS: int = (
    mavlink.MAV_SYS_STATUS_SENSOR_3D_GYRO
    | mavlink.MAV_SYS_STATUS_SENSOR_3D_ACCEL
    | mavlink.MAV_SYS_STATUS_SENSOR_3D_MAG
    | mavlink.MAV_SYS_STATUS_SENSOR_ABSOLUTE_PRESSURE
    | mavlink.MAV_SYS_STATUS_SENSOR_GPS
    | mavlink.MAV_SYS_STATUS_AHRS
)
_ALWAYS: int = mavlink.MAV_SYS_STATUS_SENSOR_BATTERY | mavlink.MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS
_RANGE_SENSOR: int = mavlink.MAV_SYS_STATUS_SENSOR_PROXIMITY
_PREARM: int = mavlink.MAV_SYS_STATUS_PREARM_CHECK

_CAPABILITIES: int = (
    mavlink.MAV_PROTOCOL_CAPABILITY_MAVLINK2
    | mavlink.MAV_PROTOCOL_CAPABILITY_COMMAND_INT
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_INT
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_FENCE
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_RALLY
    | mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE
    | mavlink.MAV_PROTOCOL_CAPABILITY_SET_ATTITUDE_TARGET
)
_VERSION = 0x00010000  # 0.1.0, a development version
_CELLS = [4000, 4000, 4000, 4000, 65535, 65535, 65535, 65535, 65535, 65535]
_NAN = math.nan

# What is sent often is packed without a message object, its fields in the order of the wire.
_ATTITUDE = LAYOUTS[mavlink.MAVLINK_MSG_ID_ATTITUDE]
_ATTITUDE_QUATERNION = LAYOUTS[mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION]
_EXTENDED_SYS_STATE = LAYOUTS[mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE]
_GLOBAL_POSITION_INT = LAYOUTS[mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT]
_VFR_HUD = LAYOUTS[mavlink.MAVLINK_MSG_ID_VFR_HUD]
_LOCAL_POSITION_NED = LAYOUTS[mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED]
_ATTITUDE_TARGET = LAYOUTS[mavlink.MAVLINK_MSG_ID_ATTITUDE_TARGET]
_OBSTACLE_DISTANCE_3D = LAYOUTS[mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D]
_OBSTACLE_DISTANCE = LAYOUTS[mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE]
_UNKNOWN_OBSTACLE = 0xFFFF
_SECTORS, _NO_RETURN = 72, 0xFFFF
_NO_OFFSET = (0.0, 0.0, 0.0, 0.0)

_OWN = px4.AUTOPILOT_COMPONENT


class Telemetry:
    """Builds messages from one vehicle's autopilot, and from the payload unit's samples it relays."""

    def __init__(
        self, system_id: int, autopilot: Autopilot, home: Home, boot_time: float, clock: Callable[[float], float]
    ) -> None:
        """``boot_time`` (s) is the zero of all ``time_boot_ms``; ``clock`` is what its clock shows at a time."""
        self._system_id = system_id
        self._autopilot = autopilot
        self._home = home
        self._frame = LocalFrame(home)
        self._boot_time = boot_time
        self._clock = clock
        self.reported: ReportedState | None = None
        """Sample that is sent of the vehicle's own state instead of its estimate; None: the estimate."""
        self.payload: Measurement | None = None
        unit = px4.PAYLOAD_UNIT_COMPONENT
        self.clipping = {_OWN: 0, unit: 0}
        """Physics steps in which the accelerometer of the vehicle and of the payload unit exceeded its range."""
        self.scan: RangeSample | None = None
        self._scan_messages: tuple[RangeSample | None, Built, Built] = (None, (), ())
        """The scan that was built last, its returns, and its end."""
        #: By component and message id.
        self.builders: dict[MessageKey, Callable[[float], Built]] = {
            (_OWN, mavlink.MAVLINK_MSG_ID_HEARTBEAT): self._heartbeat,
            (_OWN, mavlink.MAVLINK_MSG_ID_SYS_STATUS): self._sys_status,
            (_OWN, mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE): self._extended_sys_state,
            (_OWN, mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION): lambda now: self._attitude_of(self._own_attitude),
            (_OWN, mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED): lambda now: self._position_of(self._own_position),
            (_OWN, mavlink.MAVLINK_MSG_ID_ATTITUDE): self._attitude,
            (_OWN, mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT): self._global_position,
            (_OWN, mavlink.MAVLINK_MSG_ID_GPS_RAW_INT): self._gps_raw,
            (_OWN, mavlink.MAVLINK_MSG_ID_HOME_POSITION): self._home_position,
            (_OWN, mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN): self._global_origin,
            (_OWN, mavlink.MAVLINK_MSG_ID_BATTERY_STATUS): self._battery,
            (_OWN, mavlink.MAVLINK_MSG_ID_ATTITUDE_TARGET): self._attitude_target,
            (_OWN, mavlink.MAVLINK_MSG_ID_VFR_HUD): self._vfr_hud,
            (_OWN, mavlink.MAVLINK_MSG_ID_VIBRATION): lambda now: self._vibration(now, _OWN),
            (_OWN, mavlink.MAVLINK_MSG_ID_ODOMETRY): self._odometry,
            (_OWN, mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION): self._autopilot_version,
            (_OWN, mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D): self._scan_returns,
            (_OWN, mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE): self._scan_end,
            (unit, mavlink.MAVLINK_MSG_ID_HEARTBEAT): self._payload_heartbeat,
            (unit, mavlink.MAVLINK_MSG_ID_VIBRATION): lambda now: self._vibration(now, unit),
            (unit, mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION): lambda now: self._attitude_of(self.payload),
            (unit, mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED): lambda now: self._position_of(self.payload),
        }

    def time_boot_ms(self, time: float) -> int:
        """Return the stamp of a time (s)."""
        return round((self._clock(time) - self._boot_time) * 1e3) & 0xFFFFFFFF

    # The autopilot

    def _heartbeat(self, now: float) -> Built:
        autopilot = self._autopilot
        base_mode = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | mavlink.MAV_MODE_FLAG_STABILIZE_ENABLED
        main, _ = px4.decode_custom_mode(autopilot.mode)
        if main in (px4.MainMode.AUTO, px4.MainMode.OFFBOARD):
            base_mode |= mavlink.MAV_MODE_FLAG_AUTO_ENABLED | mavlink.MAV_MODE_FLAG_GUIDED_ENABLED
        else:
            base_mode |= mavlink.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED
        state = mavlink.MAV_STATE_STANDBY
        if autopilot.failsafe:
            state = mavlink.MAV_STATE_CRITICAL
        elif autopilot.armed:
            state = mavlink.MAV_STATE_ACTIVE
        elif autopilot.state.navigation.estimate is None:
            state = mavlink.MAV_STATE_BOOT
        if autopilot.armed:
            base_mode |= mavlink.MAV_MODE_FLAG_SAFETY_ARMED
        return packed(
            mavlink.MAVLink_heartbeat_message(
                mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_PX4, base_mode, autopilot.mode, state, 3
            )
        )

    def _sys_status(self, now: float) -> Built:
        present = _SENSORS | _ALWAYS | _PREARM
        health = _ALWAYS
        if self.scan is not None:
            present |= _RANGE_SENSOR
            if self.scan.works:
                health |= _RANGE_SENSOR
        if self._autopilot.state.navigation.is_valid(now):
            health |= _SENSORS
        if self._autopilot.arming_problem(now) is None:
            health |= _PREARM
        return packed(
            mavlink.MAVLink_sys_status_message(present, present, health, 100, 16000, -1, 100, 0, 0, 0, 0, 0, 0)
        )

    def _extended_sys_state(self, now: float) -> Built:
        return (_EXTENDED_SYS_STATE.pack(mavlink.MAV_VTOL_STATE_UNDEFINED, self._autopilot.landed_state),)

    def _attitude(self, now: float) -> Built:
        measured = self._own_attitude
        if measured is None or not is_finite(measured):
            return ()
        roll, pitch, yaw = euler_of(measured.attitude)
        return (_ATTITUDE.pack(self.time_boot_ms(measured.time), roll, pitch, yaw, *measured.rates),)

    def _global_position(self, now: float) -> Built:
        measured = self._own_state
        if measured is None:
            return ()
        latitude, longitude, altitude = self._frame.place_of(measured)
        v_x, v_y, v_z = (clamp(100.0 * v, 16) for v in measured.velocity)
        heading = round(math.degrees(euler_of(measured.attitude)[2]) * 100.0) % 36000
        height = clamp(-1e3 * measured.position[2], 32)
        stamp = self.time_boot_ms(measured.time)
        return (_GLOBAL_POSITION_INT.pack(stamp, latitude, longitude, altitude, height, v_x, v_y, v_z, heading),)

    def _gps_raw(self, now: float) -> Built:
        measured = self._own_state
        if measured is None:
            return ()
        latitude, longitude, altitude = self._frame.place_of(measured)
        v_n, v_e, _ = measured.velocity
        speed = min(round(100.0 * math.hypot(v_n, v_e)), 65534)
        course = round(math.degrees(math.atan2(v_e, v_n)) * 100.0) % 36000
        return packed(
            mavlink.MAVLink_gps_raw_int_message(
                self.time_boot_ms(measured.time) * 1000, mavlink.GPS_FIX_TYPE_RTK_FIXED,
                latitude, longitude, altitude, 50, 50, speed, course, 20,
            )
        )  # fmt: skip

    def _home_position(self, now: float) -> Built:
        home = self._autopilot.home
        return packed(
            mavlink.MAVLink_home_position_message(
                *self._frame.place(home), *home,
                list(LEVEL), _NAN, _NAN, _NAN, self.time_boot_ms(now) * 1000,
            )
        )  # fmt: skip

    def _global_origin(self, now: float) -> Built:
        return packed(mavlink.MAVLink_gps_global_origin_message(*self._frame.origin, self.time_boot_ms(now) * 1000))

    def _battery(self, now: float) -> Built:
        return packed(
            mavlink.MAVLink_battery_status_message(
                0, mavlink.MAV_BATTERY_FUNCTION_ALL, mavlink.MAV_BATTERY_TYPE_LIPO, 32767, _CELLS, -1, -1, -1, 100
            )
        )

    def _attitude_target(self, now: float) -> Built:
        """Stamped with the moment at which it began to act, as PX4 does it."""
        attitude, rates, thrust = self._autopilot.state.actuation.target
        since = max(self._autopilot.state.actuation.target_since, self._boot_time)
        mask = 0 if attitude is not None else mavlink.ATTITUDE_TARGET_TYPEMASK_ATTITUDE_IGNORE
        return (_ATTITUDE_TARGET.pack(self.time_boot_ms(since), *(attitude or LEVEL), *rates, thrust, mask),)

    def _vfr_hud(self, now: float) -> Built:
        measured = self._own_state
        if measured is None:
            return ()
        v_n, v_e, v_d = measured.velocity
        speed = math.hypot(v_n, v_e)
        heading = round(math.degrees(euler_of(measured.attitude)[2])) % 360
        throttle = round(100.0 * self._autopilot.state.actuation.target[2])
        altitude = self._home.altitude - measured.position[2]
        return (_VFR_HUD.pack(speed, speed, altitude, -v_d, heading, throttle),)

    def _odometry(self, now: float) -> Built:
        measured = self._own_state
        if measured is None:
            return ()
        unknown = [_NAN] + [0.0] * 20
        velocity = into_body(measured.attitude, measured.velocity)
        return packed(
            mavlink.MAVLink_odometry_message(
                self.time_boot_ms(measured.time) * 1000, mavlink.MAV_FRAME_LOCAL_NED, mavlink.MAV_FRAME_BODY_FRD,
                *measured.position, list(measured.attitude), *velocity, *measured.rates, unknown, unknown,
            )
        )  # fmt: skip

    def _autopilot_version(self, now: float) -> Built:
        return packed(
            mavlink.MAVLink_autopilot_version_message(
                _CAPABILITIES, _VERSION, 0, 0, 0, [0] * 8, [0] * 8, [0] * 8, 0, 0, self._system_id
            )
        )

    def _scan_returns(self, now: float) -> Built:
        """The returns of the last scan."""
        return self._built_scan()[1]

    def _scan_end(self, now: float) -> Built:
        """The message behind the returns of the last scan, which says that there was one even if nothing returned."""
        return self._built_scan()[2]

    def _built_scan(self) -> tuple[RangeSample | None, Built, Built]:
        """Return the last scan with its messages, built once for all peers; a failed sensor makes none."""
        scan = self.scan
        if scan is not self._scan_messages[0]:
            made = scan is not None and scan.works and scan.is_sent
            returns = self._points(scan) if scan is not None and made and len(scan.points) else ()
            self._scan_messages = scan, returns, (self._sectors(scan),) if scan is not None and made else ()
        return self._scan_messages

    def _points(self, scan: RangeSample) -> PackedRun:
        points = np.empty(len(scan.points), _OBSTACLE_DISTANCE_3D.dtype)
        points["time_boot_ms"] = self.time_boot_ms(scan.time)
        points["x"], points["y"], points["z"] = scan.points.T
        points["min_distance"], points["max_distance"] = scan.range_min, scan.reach
        points["obstacle_id"] = _UNKNOWN_OBSTACLE
        points["sensor_type"], points["frame"] = mavlink.MAV_DISTANCE_SENSOR_LASER, mavlink.MAV_FRAME_BODY_FRD
        return PackedRun(_OBSTACLE_DISTANCE_3D, points)

    def _sectors(self, scan: RangeSample) -> Packed:
        """The nearest return of each sector (cm), the first ahead, clockwise."""
        end = np.zeros(1, _OBSTACLE_DISTANCE.dtype)
        end["time_usec"] = self.time_boot_ms(scan.time) * 1000
        end["distances"] = nearest_by_sector(scan.points, _SECTORS, _NO_RETURN)
        end["min_distance"], end["max_distance"] = (
            min(round(100.0 * distance), _NO_RETURN - 1) for distance in (scan.range_min, scan.reach)
        )
        end["sensor_type"], end["frame"] = mavlink.MAV_DISTANCE_SENSOR_LASER, mavlink.MAV_FRAME_BODY_FRD
        end["increment"] = 360 // _SECTORS
        return _OBSTACLE_DISTANCE, end.tobytes()

    @property
    def _own_attitude(self) -> Measurement | None:
        """The sample whose attitude and rates are sent."""
        return self._autopilot.state.navigation.reported if self.reported is None else self.reported.attitude

    @property
    def _own_position(self) -> Measurement | None:
        """The sample whose position and velocity are sent."""
        return self._autopilot.state.navigation.reported if self.reported is None else self.reported.position

    @property
    def _own_state(self) -> Measurement | None:
        """Both in one, for messages that need both; None without either, and for what integers cannot hold."""
        attitude, position = self._own_attitude, self._own_position
        if attitude is None or position is None:
            return None
        if attitude is not position:
            position = position._replace(attitude=attitude.attitude, rates=attitude.rates)
        return position if is_finite(position) else None

    # The payload's navigation unit

    def _payload_heartbeat(self, now: float) -> Built:
        if self.payload is None:
            return ()
        return packed(
            mavlink.MAVLink_heartbeat_message(
                mavlink.MAV_TYPE_ONBOARD_CONTROLLER, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, mavlink.MAV_STATE_ACTIVE, 3
            )
        )

    # Shared

    def _vibration(self, now: float, component: int) -> Built:
        """No vibration is simulated; impacts are, by how often they drove the accelerometer out of its range."""
        stamp = self.time_boot_ms(now) * 1000
        return packed(mavlink.MAVLink_vibration_message(stamp, 0.0, 0.0, 0.0, self.clipping[component], 0, 0))

    def _attitude_of(self, measured: Measurement | None) -> Built:
        if measured is None:
            return ()
        return (
            _ATTITUDE_QUATERNION.pack(
                self.time_boot_ms(measured.time), *measured.attitude, *measured.rates, *_NO_OFFSET
            ),
        )

    def _position_of(self, measured: Measurement | None) -> Built:
        if measured is None:
            return ()
        return (_LOCAL_POSITION_NED.pack(self.time_boot_ms(measured.time), *measured.position, *measured.velocity),)
