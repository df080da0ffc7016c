"""Set-points and stop plans on the wire: the bytes that pymavlink's own messages give, and how long they take."""

import math
from types import SimpleNamespace

import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gcs.mavlink import px4
from gcs.mavlink.layout import packed
from gcs.mavlink.setpoints import IGNORE_RATES, SetpointStream, attitude_target, stop_plan_message
from gcs.mavlink.settings import LinkSettings
from idc_controller.rotations_float import attitude_of_direction

ANGLES = st.floats(-math.pi, math.pi)
NUMBERS = st.floats(-1e3, 1e3)
POINT = st.tuples(NUMBERS, NUMBERS, NUMBERS)


@settings(deadline=None, derandomize=True)
@given(st.integers(1, 255), st.floats(-1.0, 5e6), ANGLES, ANGLES, st.floats(-10.0, 40.0))
def test_setpoint_is_packed_as_by_pymavlink(system, boot_time, tilt, heading, thrust):
    direction = (math.sin(tilt) * math.cos(heading), math.sin(tilt) * math.sin(heading), -math.cos(tilt))
    message = mavlink.MAVLink_set_attitude_target_message(
        round(boot_time * 1e3) % 2**32, system, mavlink.MAV_COMP_ID_AUTOPILOT1, IGNORE_RATES,
        attitude_of_direction(direction), 0.0, 0.0, 0.0, max(0.0, min(1.0, thrust / 30.0)),
    )  # fmt: skip
    assert attitude_target(system, boot_time, direction, thrust, 30.0) == packed(message)[0]


@settings(deadline=None, derandomize=True)
@given(st.floats(-1.0, 5e6), st.floats(0.0, 100.0), st.lists(POINT, min_size=5, max_size=5))
def test_stop_plan_is_packed_as_by_pymavlink(boot_time, duration, points):
    x, y, z = ([point[axis] for point in points] for axis in range(3))
    start = boot_time if boot_time >= 0.0 else boot_time + 2**32 * 1e-3
    message = mavlink.MAVLink_trajectory_representation_bezier_message(
        round(start * 1e6), 5, x, y, z, [duration] * 5, [0.0] * 5
    )
    assert stop_plan_message(boot_time, duration, points) == packed(message)[0]


@pytest.mark.parametrize(("rate", "step"), [(250.0, 0.004), (100.0, 0.01), (0.0, 0.0), (None, 0.0)])
def test_setpoint_takes_the_latency_of_the_link_and_an_onboard_step_where_its_rate_is_known(rate, step):
    parameters = {} if rate is None else {px4.PARAM_ONBOARD_RATE: rate}
    stream = SetpointStream(SimpleNamespace(delay=0.03, round_trip_max=0.1), parameters, LinkSettings())
    assert stream.delay == pytest.approx(0.03 + step)
    assert stream.delay_max == pytest.approx(0.1 + 2.0 * step + LinkSettings().stamp_error)
