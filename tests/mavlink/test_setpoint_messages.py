"""Set-points and stop plans on the wire: the bytes that pymavlink's own messages give, and how long they take."""

import math
from types import SimpleNamespace

import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from packed_messages import message_of

from gcs.mavlink import px4
from gcs.mavlink.codec import Codec
from gcs.mavlink.layout import packed
from gcs.mavlink.setpoints import IGNORE_RATES, SetpointStream, attitude_target
from gcs.mavlink.settings import LinkSettings
from gcs.mavlink.stop_plan import PAYLOAD_TYPE, StopPlanContent, read_stop_plan, stop_plan_message
from gcs.mavlink.vehicle_link import VehicleLink
from idc_controller.estimation.setpoint_history import Confirmation
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
@given(
    st.integers(1, 255), st.integers(0, 2**32 - 1), st.integers(0, 2**32 - 1), st.floats(-1.0, 5e6),
    st.floats(-10.0, 3600.0), st.floats(0.0, 100.0), st.lists(POINT, min_size=5, max_size=5),
)  # fmt: skip
def test_stop_plan_is_read_by_its_vehicle_as_it_was_sent(system, session, number, start, hold, duration, points):
    plan = StopPlanContent(session, number, start, start + hold, duration, 0.5, points, (1.5, -0.25, -12.5))
    [on_wire] = Codec(system, 1).decode(Codec(255, 190).frame(stop_plan_message(system, plan)))
    assert on_wire.is_for(system, px4.AUTOPILOT_COMPONENT) and not on_wire.is_for(system % 255 + 1)
    read = read_stop_plan(on_wire.fields)
    assert read is not None and read[:2] == (session, number)
    assert read[2:6] == pytest.approx(plan[2:6], rel=1e-6, abs=1e-6)
    assert read.hover_force == (1.5, -0.25, -12.5)
    for own, sent in zip(read.control_points, points, strict=True):
        assert own == pytest.approx(sent, rel=1e-6, abs=1e-30)


@pytest.mark.parametrize(
    "changes", [{"payload_type": PAYLOAD_TYPE + 1}, {"target_system": 0}, {"payload_length": 91}, {"payload_length": 0}]
)
def test_other_tunnels_and_plans_for_nobody_in_particular_hold_no_plan(changes):
    message = message_of(stop_plan_message(1, StopPlanContent(1, 1, 0.0, 5.0, 4.0, 0.0, [(0.0, 0.0, 0.0)] * 5)))
    for name, value in changes.items():
        setattr(message, name, value)
    [(layout, payload)] = packed(message)
    assert read_stop_plan(layout.fields(payload)) is None


@pytest.mark.parametrize(("rate", "step"), [(250.0, 0.004), (100.0, 0.01), (0.0, 0.0), (None, 0.0)])
def test_setpoint_takes_the_latency_of_the_link_and_an_onboard_step_where_its_rate_is_known(rate, step):
    parameters = {} if rate is None else {px4.PARAM_ONBOARD_RATE: rate}
    stream = SetpointStream(SimpleNamespace(delay=0.03, round_trip_max=0.1), parameters, LinkSettings())
    assert stream.delay == pytest.approx(0.03 + step)
    assert stream.delay_max == pytest.approx(0.1 + 2.0 * step + LinkSettings().stamp_error)


def test_setpoints_that_were_only_late_leave_no_loss():
    link = VehicleLink(1, None)
    for _ in range(3):
        link.setpoints.confirm(Confirmation(as_sent=True))
    for _ in range(4):
        link.setpoints.confirm(Confirmation(as_sent=False))
        assert link.setpoints.loss > 0.0
        link.setpoints.confirm(Confirmation(as_sent=False, delay=0.1, late=True))
        assert link.setpoints.loss == 0.0
    link.setpoints.confirm(Confirmation(as_sent=False))
    link.setpoints.confirm(Confirmation(as_sent=True))
    assert link.setpoints.loss > 0.04
