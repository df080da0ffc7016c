"""Measurements, set-points and detections from telemetry, against the fields of pymavlink's messages."""

import math
import random

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from one_measurement import measurement

from gcs.mavlink import px4
from gcs.mavlink.codec import Codec
from gcs.mavlink.telemetry import measurements, scan_returns, setpoint_flown
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Position

SPECIAL = (0.0, 1.0, math.nan, math.inf, -math.inf, 3e38)


def received(message, system=3, component=px4.AUTOPILOT_COMPONENT):
    [only] = Codec(255, 190).decode(Codec(system, component).encode(message))
    return only


def numbers(rng, count):
    return [rng.choice(SPECIAL) if rng.random() < 0.1 else rng.gauss(0.0, 2.0) for _ in range(count)]


def expected_values(message):
    """Pose and motion of a message as the plain reference has them; None: neither can be a measurement."""
    if isinstance(message, mavlink.MAVLink_attitude_quaternion_message):
        pose = np.array([message.q1, message.q2, message.q3, message.q4])
        motion = np.array([message.rollspeed, message.pitchspeed, message.yawspeed])
        norm = math.sqrt(sum(c * c for c in pose.tolist()))
        has_pose, pose = 0.9 < norm < 1.1, pose / (norm or 1.0)
    else:
        pose, motion = np.array([message.x, message.y, message.z]), np.array([message.vx, message.vy, message.vz])
        has_pose = bool(np.isfinite(pose).all())
    has_motion = bool(np.isfinite(motion).all())
    if not (has_pose or has_motion):
        return None
    return np.where(has_pose, pose, np.nan), np.where(has_motion, motion, np.nan)


VEHICLE, UNIT = (3, px4.AUTOPILOT_COMPONENT), (px4.PAYLOAD_UNIT_SYSTEM, px4.PAYLOAD_UNIT_COMPONENT)


@pytest.mark.parametrize(("sender", "source"), [(VEHICLE, 2), (UNIT, PAYLOAD)])
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_measurement_has_the_values_of_the_message_as_far_as_they_can_be_measured(sender, source):
    rng, messages = random.Random(4), []
    for _ in range(1000):
        quaternion = numbers(rng, 4)
        if rng.random() < 0.7 and math.isfinite(norm := math.hypot(*quaternion)) and 1e-3 < norm < 1e30:
            quaternion = [c / norm for c in quaternion]
        messages += [
            mavlink.MAVLink_attitude_quaternion_message(1234, *quaternion, *numbers(rng, 3)),
            mavlink.MAVLink_local_position_ned_message(1234, *numbers(rng, 6)),
        ]
    on_wire = [received(message, *sender) for message in messages]
    expected = [(k, values) for k, r in enumerate(on_wire) if (values := expected_values(r.message)) is not None]
    found, partial = measurements([(message, source, float(k)) for k, message in enumerate(on_wire)])
    for (k, (pose, motion)), sample in zip(expected, found, strict=True):
        assert (sample.time, sample.source) == (k, source)
        assert type(sample) is (Position if k % 2 else Attitude)
        np.testing.assert_array_equal(sample.pose, pose)
        np.testing.assert_array_equal(sample.motion, motion)
    whole = {k for k, values in expected if not np.isnan(np.concatenate(values)).any()}
    assert partial == [k for k in range(len(messages)) if k not in whole]
    assert len(expected) - len(whole) > 50 and len(messages) - len(expected) > 10


def test_set_point_flown_is_tilt_and_thrust():
    def target(mask=0, thrust=0.5):
        return received(mavlink.MAVLink_attitude_target_message(5, mask, [0.8, 0.6, 0.0, 0.0], 0.0, 0.0, 0.0, thrust))

    assert setpoint_flown(target().fields, 20.0) == pytest.approx([0.0, 0.96, 10.0])
    assert setpoint_flown(target(mavlink.ATTITUDE_TARGET_TYPEMASK_ATTITUDE_IGNORE).fields, 20.0) is None
    assert setpoint_flown(target(thrust=math.nan).fields, 20.0) is None
    assert setpoint_flown(target().fields, math.nan) is None


def test_return_has_point_and_range_of_the_message():
    def read(frame):
        message = mavlink.MAVLink_obstacle_distance_3d_message(1234, 0, frame, 65535, 1.5, -2.0, 0.25, 0.0625, 10.0)
        return scan_returns(received(message))

    found = read(mavlink.MAV_FRAME_BODY_FRD)
    assert (found.stamp, found.max_range.tolist()) == (1234, [10.0])
    assert found.points.tolist() == [[1.5, -2.0, 0.25]]
    assert np.isnan(read(mavlink.MAV_FRAME_GLOBAL).points).all()


@pytest.mark.parametrize("sender", [VEHICLE, UNIT])
def test_measurements_are_arrays_to_read_only(sender):
    message = mavlink.MAVLink_local_position_ned_message(1234, 1.0, 2.0, 3.0, 4.0, 5.0, math.nan)
    sample = measurement(received(message, *sender), 2, 7.5)
    for values in (sample.pose, sample.motion):
        with pytest.raises(ValueError, match="read-only"):
            values[0] = 0.0
