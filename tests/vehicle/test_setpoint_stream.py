"""Set-point in force on board while no set-point arrives."""

import math

import numpy as np
import pytest

from gcs.config.vehicle_settings import SetpointSettings
from idc_controller.rotations import quaternion_from_euler
from vehicle_sim.autopilot.setpoint_stream import SetpointStream
from vehicle_sim.autopilot.setpoints import AttitudeSetpoint

PERIOD = 0.05


def pitched(angle, thrust=0.5, sign=1.0):
    w, x, y, z = quaternion_from_euler(0.0, angle, 0.0)
    return AttitudeSetpoint((sign * w, sign * x, sign * y, sign * z), (0.0, 0.0, 0.0), thrust, 0)


def pitch_of(setpoint):
    w, _, y, _ = setpoint.attitude
    return 2.0 * math.atan(y / w)


def stream_of(setpoints):
    stream = SetpointStream(SetpointSettings())
    for k, setpoint in enumerate(setpoints):
        stream.add(setpoint, k * PERIOD)
    return stream, (len(setpoints) - 1) * PERIOD


def test_stream_has_no_setpoint_before_first_one():
    stream = SetpointStream(SetpointSettings())
    assert stream.at(1.0) is None
    assert stream.last_time == -math.inf


def test_last_setpoint_is_used_unchanged_without_gap():
    stream, last = stream_of([pitched(0.0), pitched(0.3)])
    for since in (0.0, PERIOD, SetpointSettings.hold - 1e-6):
        assert pitch_of(stream.at(last + since)) == pytest.approx(0.3)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_mean_of_last_setpoints_is_used_in_a_gap(sign):
    angles, thrusts = [0.9, -0.04, 0.02, -0.02, 0.04, 0.2], [0.9, 0.4, 0.5, 0.4, 0.5, 0.7]
    stream, last = stream_of(
        [pitched(a, t, sign if k % 2 else 1.0) for k, (a, t) in enumerate(zip(angles, thrusts, strict=True))]
    )
    flown = stream.at(last + SetpointSettings.hold + 0.001)
    kept = round(SetpointSettings.mean_over / PERIOD) + 1
    assert pitch_of(flown) == pytest.approx(np.mean(angles[-kept:]), abs=1e-3)
    assert flown.thrust == pytest.approx(np.mean(thrusts[-kept:]))
    assert sum(v * v for v in flown.attitude) == pytest.approx(1.0)
    assert stream.at(last + 0.4) is flown


def test_next_setpoint_ends_the_gap():
    stream, last = stream_of([pitched(0.1), pitched(0.2)])
    stream.at(last + 0.3)
    stream.add(pitched(-0.1), last + 0.3)
    assert pitch_of(stream.at(last + 0.3)) == pytest.approx(-0.1)
    assert pitch_of(stream.at(last + 0.3 + SetpointSettings.hold + 0.001)) == pytest.approx(-0.1)


def test_setpoints_of_rates_or_kept_thrust_are_not_averaged():
    rates = AttitudeSetpoint(None, (0.1, 0.0, 0.0), 0.5, 0)
    stream, last = stream_of([pitched(0.1), rates])
    assert stream.at(last + 0.3) is rates
    kept = AttitudeSetpoint((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), None, 0)
    stream, last = stream_of([pitched(0.1), kept])
    assert stream.at(last + 0.3) is kept


def test_cleared_stream_has_no_setpoint():
    stream, last = stream_of([pitched(0.1)])
    stream.clear()
    assert stream.at(last) is None
