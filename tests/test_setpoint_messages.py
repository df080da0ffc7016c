"""Set-points and stop plans on the wire: the bytes that pymavlink's own messages give."""

import math

import pymavlink.dialects.v20.ardupilotmega as mavlink
from hypothesis import given, settings
from hypothesis import strategies as st

from gcs.mavlink.layout import packed
from gcs.mavlink.setpoints import IGNORE_RATES, attitude_target, stop_plan_message
from idc_controller.rotations_float import attitude_of_direction

ANGLES = st.floats(-math.pi, math.pi)
NUMBERS = st.floats(-1e3, 1e3)
POINT = st.tuples(NUMBERS, NUMBERS, NUMBERS)


@settings(deadline=None, derandomize=True)
@given(st.integers(1, 255), st.floats(-1.0, 5e6), ANGLES, ANGLES, st.floats(-10.0, 40.0))
def test_setpoint_is_packed_as_by_pymavlink(system, boot_time, tilt, heading, thrust):
    direction = (math.sin(tilt) * math.cos(heading), math.sin(tilt) * math.sin(heading), -math.cos(tilt))
    message = mavlink.MAVLink_set_attitude_target_message(
        max(round(boot_time * 1e3), 0) & 0xFFFFFFFF, system, mavlink.MAV_COMP_ID_AUTOPILOT1, IGNORE_RATES,
        attitude_of_direction(direction), 0.0, 0.0, 0.0, max(0.0, min(1.0, thrust / 30.0)),
    )  # fmt: skip
    assert attitude_target(system, boot_time, direction, thrust, 30.0) == packed(message)[0]


@settings(deadline=None, derandomize=True)
@given(st.floats(-1.0, 5e6), st.floats(0.0, 100.0), st.lists(POINT, min_size=5, max_size=5))
def test_stop_plan_is_packed_as_by_pymavlink(boot_time, duration, points):
    x, y, z = ([point[axis] for point in points] for axis in range(3))
    message = mavlink.MAVLink_trajectory_representation_bezier_message(
        max(round(boot_time * 1e6), 0), 5, x, y, z, [duration] * 5, [0.0] * 5
    )
    assert stop_plan_message(boot_time, duration, points) == packed(message)[0]
