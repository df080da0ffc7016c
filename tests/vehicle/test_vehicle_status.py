"""All fields of the messages in which a vehicle tells its status, its place and what it is."""

from __future__ import annotations

import math
from importlib.metadata import version as package_version

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from onboard import step_alone
from vehicle_bench import ACCEPTED, Bench, command

from gcs.mavlink import px4
from vehicle_sim.world.range_sensor import RangeSample
from vehicle_sim.world.sensors import Measurement, ReportedState

HALF = math.radians(30.0)
SAMPLE = Measurement(
    2.5, (math.cos(HALF), 0.0, 0.0, -math.sin(HALF)), (0.1, 0.2, 0.3), (1.0, 2.0, -7.0), (3.0, -4.0, 1.0)
)
"""Yaw of -60 degrees; a speed of 5 m/s over the ground, and a descent of 1 m/s."""
SENSORS = (
    mavlink.MAV_SYS_STATUS_SENSOR_3D_GYRO | mavlink.MAV_SYS_STATUS_SENSOR_3D_ACCEL
    | mavlink.MAV_SYS_STATUS_SENSOR_3D_MAG | mavlink.MAV_SYS_STATUS_SENSOR_ABSOLUTE_PRESSURE
    | mavlink.MAV_SYS_STATUS_SENSOR_GPS | mavlink.MAV_SYS_STATUS_AHRS
)  # fmt: skip
ALWAYS = mavlink.MAV_SYS_STATUS_SENSOR_BATTERY | mavlink.MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS
RANGE, PREARM = mavlink.MAV_SYS_STATUS_SENSOR_PROXIMITY, mavlink.MAV_SYS_STATUS_PREARM_CHECK


def fields(bench: Bench, kind: str, component: int = 1) -> dict[str, object]:
    """Fields of a message as a ground decodes it, built now; zeros are left out, as at the end of one."""
    number = getattr(mavlink, f"MAVLINK_MSG_ID_{kind}")
    packed = bench.vehicle.telemetry.builders[component, number](bench.now)
    if not packed:
        return {}
    codec = bench.codecs.setdefault("status", type(bench.reader)(1, component))
    [message] = [received.message for received in bench.reader.decode(codec.frame(packed[0]))]
    return {name: value for name in message.fieldnames if np.any(value := getattr(message, name))}


@pytest.fixture
def still() -> Bench:
    """A vehicle on the ground that has its sensors."""
    bench = Bench()
    bench.run(0.1)
    return bench


def test_place_and_motion_are_those_of_the_sample_in_units_of_each_message(still: Bench) -> None:
    """What MAVLink calls unknown is sent where nothing measures it."""
    still.vehicle.report(ReportedState(SAMPLE, SAMPLE))
    home = fields(still, "HOME_POSITION")
    place = {
        "lat": home["latitude"] + 90,
        "lon": home["longitude"] + 265,
        "alt": home["altitude"] + 7000,
    }  # 1e-7 deg, mm
    assert fields(still, "GLOBAL_POSITION_INT") == {
        "time_boot_ms": 2500, **place, "relative_alt": 7000, "vx": 300, "vy": -400, "vz": 100, "hdg": 30000,
    }  # fmt: skip
    assert fields(still, "GPS_RAW_INT") == {
        "time_usec": 2500000, "fix_type": mavlink.GPS_FIX_TYPE_RTK_FIXED, **place, "eph": 50, "epv": 50, "vel": 500,
        "cog": 30687, "satellites_visible": 20,
    }  # fmt: skip
    assert fields(still, "ATTITUDE") == pytest.approx({
        "time_boot_ms": 2500, "yaw": -math.pi / 3.0, "rollspeed": 0.1, "pitchspeed": 0.2, "yawspeed": 0.3,
    })  # fmt: skip
    hud = {"airspeed": 5.0, "groundspeed": 5.0, "heading": 300, "alt": 495.0, "climb": -1.0}
    assert fields(still, "VFR_HUD") == hud
    odometry = fields(still, "ODOMETRY")
    for name in ("pose_covariance", "velocity_covariance"):
        first, *others = odometry.pop(name)
        assert math.isnan(first) and set(others) == {0.0}
    turned = complex(3.0, -4.0) * complex(0.5, math.sqrt(0.75))
    assert odometry.pop("q") == pytest.approx(SAMPLE.attitude)
    assert odometry == pytest.approx({
        "time_usec": 2500000, "frame_id": mavlink.MAV_FRAME_LOCAL_NED, "child_frame_id": mavlink.MAV_FRAME_BODY_FRD,
        "x": 1.0, "y": 2.0, "z": -7.0, "vx": turned.real, "vy": turned.imag, "vz": 1.0, "rollspeed": 0.1,
        "pitchspeed": 0.2, "yawspeed": 0.3,
    })  # fmt: skip


def test_attitude_and_position_of_two_samples_are_told_apart(still: Bench) -> None:
    """Where they differ, messages of both have the position's time."""
    other = SAMPLE._replace(time=3.0, attitude=(1.0, 0.0, 0.0, 0.0), rates=(0.4, 0.5, 0.6), position=(0.0, 0.0, -1.0))
    still.vehicle.report(ReportedState(SAMPLE, other))
    odometry = fields(still, "ODOMETRY")
    assert (odometry["time_usec"], odometry["z"]) == (3000000, -1.0)
    assert odometry["q"] == pytest.approx(SAMPLE.attitude) and odometry["pitchspeed"] == pytest.approx(0.2)
    assert fields(still, "ATTITUDE")["time_boot_ms"] == 2500
    assert fields(still, "LOCAL_POSITION_NED")["time_boot_ms"] == 3000


@pytest.mark.parametrize("part", ["position", "velocity", "attitude", "rates"])
def test_no_message_in_whole_numbers_is_made_of_a_sample_that_is_not_finite(still: Bench, part: str) -> None:
    broken = SAMPLE._replace(**{part: (math.nan, *getattr(SAMPLE, part)[1:])})
    still.vehicle.report(ReportedState(broken, broken))
    for kind in ("GLOBAL_POSITION_INT", "GPS_RAW_INT", "VFR_HUD", "ODOMETRY"):
        assert fields(still, kind) == {}


def test_place_of_home(still: Bench) -> None:
    home = fields(still, "HOME_POSITION")
    assert all(math.isnan(home.pop(f"approach_{axis}")) for axis in "xyz")
    origin = {"latitude": 473977420, "longitude": 85455940, "altitude": 488000}
    assert home == {**origin, "q": (1.0, 0.0, 0.0, 0.0), "time_usec": 100000}
    assert fields(still, "GPS_GLOBAL_ORIGIN") == {**origin, "time_usec": 100000}


def test_battery_is_full_and_without_current(still: Bench) -> None:
    assert fields(still, "BATTERY_STATUS") == {
        "battery_function": mavlink.MAV_BATTERY_FUNCTION_ALL, "type": mavlink.MAV_BATTERY_TYPE_LIPO,
        "temperature": 32767, "voltages": (4000,) * 4 + (65535,) * 6, "current_battery": -1, "current_consumed": -1,
        "energy_consumed": -1, "battery_remaining": 100,
    }  # fmt: skip


def test_version_tells_capabilities_and_the_vehicle(still: Bench) -> None:
    version = fields(still, "AUTOPILOT_VERSION")
    capabilities = version.pop("capabilities")
    assert capabilities & mavlink.MAV_PROTOCOL_CAPABILITY_MAVLINK2
    assert capabilities & mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE
    assert capabilities & mavlink.MAV_PROTOCOL_CAPABILITY_SET_ATTITUDE_TARGET
    assert capabilities & mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_INT
    assert not capabilities & mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_FLOAT
    assert capabilities & mavlink.MAV_PROTOCOL_CAPABILITY_COMMAND_INT
    assert not capabilities & mavlink.MAV_PROTOCOL_CAPABILITY_FTP
    software = version.pop("flight_sw_version")
    numbers = [int(part) for part in package_version("cooplift").split(".")]
    assert [software >> 24, software >> 16 & 0xFF, software >> 8 & 0xFF] == numbers and software & 0xFF == 0
    assert version.pop("uid") == 1 and bytes(version.pop("uid2")) == b"cooplift" + bytes(9) + b"\1"
    assert version == {}


def test_health_is_what_works_of_what_there_is(still: Bench) -> None:
    no_points = np.empty((0, 3))

    def status() -> tuple[int, int]:
        found = fields(still, "SYS_STATUS")
        present, enabled, health = (found.pop(f"onboard_control_sensors_{n}") for n in ("present", "enabled", "health"))
        assert found == {"load": 100, "voltage_battery": 16000, "current_battery": -1, "battery_remaining": 100}
        assert enabled == present
        return present, health

    everything = SENSORS | ALWAYS | PREARM
    assert status() == (everything, everything)
    still.vehicle.take_scan(RangeSample(still.now, 10.0, no_points))
    assert status() == (everything | RANGE, everything | RANGE)
    still.vehicle.take_scan(RangeSample(still.now, 10.0, no_points, works=False))
    assert status() == (everything | RANGE, everything)
    for _ in range(1000):
        step_alone(still.vehicle.autopilot, None, still.now)
        still.body.tick += 1
    assert status() == (everything | RANGE, ALWAYS)


def test_heartbeat_tells_mode_arming_and_failsafe() -> None:
    """Of the vehicle, and of the payload's unit that it relays."""
    bench = Bench()
    custom, auto = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED, mavlink.MAV_MODE_FLAG_AUTO_ENABLED
    guided, stabilised = mavlink.MAV_MODE_FLAG_GUIDED_ENABLED, mavlink.MAV_MODE_FLAG_STABILIZE_ENABLED
    armed = mavlink.MAV_MODE_FLAG_SAFETY_ARMED

    def heartbeat() -> tuple[int, int, int]:
        found = fields(bench, "HEARTBEAT")
        changing = tuple(found.pop(name, 0) for name in ("base_mode", "custom_mode", "system_status"))
        assert found == {
            "type": mavlink.MAV_TYPE_QUADROTOR,
            "autopilot": mavlink.MAV_AUTOPILOT_PX4,
            "mavlink_version": 3,
        }
        return changing

    flown = custom | stabilised | auto | guided
    assert heartbeat() == (flown, px4.MODE_HOLD, mavlink.MAV_STATE_BOOT)
    assert fields(bench, "HEARTBEAT", px4.PAYLOAD_UNIT_COMPONENT) == {}
    bench.run(0.1)
    assert heartbeat() == (flown, px4.MODE_HOLD, mavlink.MAV_STATE_STANDBY)
    bench.fly()
    assert heartbeat() == (flown | armed, px4.MODE_OFFBOARD, mavlink.MAV_STATE_ACTIVE)
    bench.streaming.clear()
    bench.run(1.5)
    base_mode, mode, state = heartbeat()
    assert base_mode == flown | armed and mode != px4.MODE_OFFBOARD and state == mavlink.MAV_STATE_CRITICAL
    assert fields(bench, "HEARTBEAT", px4.PAYLOAD_UNIT_COMPONENT) == {
        "type": mavlink.MAV_TYPE_ONBOARD_CONTROLLER, "autopilot": mavlink.MAV_AUTOPILOT_INVALID, "mavlink_version": 3,
        "system_status": mavlink.MAV_STATE_ACTIVE,
    }  # fmt: skip


def test_points_of_a_scan_have_their_ranges_and_no_object(still: Bench) -> None:
    points = np.array([[1.0, 2.0, 3.0], [-4.0, 5.0, -6.0]])
    still.vehicle.take_scan(RangeSample(0.75, 12.0, points, range_min=0.25))
    run = still.vehicle.telemetry.builders[1, mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D](1.0)
    sent = [r.message for frame in type(still.reader)(1, 1).frames(run) for r in still.reader.decode(frame)]
    assert [(m.x, m.y, m.z, m.obstacle_id) for m in sent] == [(1.0, 2.0, 3.0, 65535), (-4.0, 5.0, -6.0, 65535)]
    for message in sent:
        assert (message.time_boot_ms, message.min_distance, message.max_distance) == (750, 0.25, 12.0)
        assert message.sensor_type == mavlink.MAV_DISTANCE_SENSOR_LASER and message.frame == mavlink.MAV_FRAME_BODY_FRD


def test_requested_scan_comes_whole(bench: Bench) -> None:
    points = np.array([[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, -3.0]])
    bench.vehicle.take_scan(RangeSample(bench.now, 12.0, points))
    bench.run(0.02)
    bench.inbox.clear()
    assert bench.result(command(512, mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D)) == ACCEPTED
    assert [(m.x, m.y, m.z) for m in bench.got("OBSTACLE_DISTANCE_3D")] == [tuple(point) for point in points]
