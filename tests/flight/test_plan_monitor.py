"""Wrecks as the vehicles and the payload's unit report them."""

import math

import numpy as np
import pytest

from gcs.config.flight_settings import DEFAULTS
from gcs.flight.plan_monitor import PlanMonitor
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Position

SETTINGS = DEFAULTS.failsafe
PLACES = np.array([[0.5, 0.5, -5.0], [0.5, -0.5, -5.0], [-0.5, 0.5, -5.0], [-0.5, -0.5, -5.0]])


def report(monitor, time, offsets):
    for i, offset in enumerate(offsets):
        monitor.add(Position(time, i, PLACES[i] + offset, np.zeros(3)))
    monitor.compare(time, PLACES)


def tilted(time, angle):
    return Attitude(time, PAYLOAD, np.array([math.cos(angle / 2.0), math.sin(angle / 2.0), 0.0, 0.0]), np.zeros(3))


@pytest.mark.parametrize(("far", "wreck"), [(0, False), (1, False), (2, True), (4, True)])
def test_off_plan_if_half_of_the_vehicles_are(far, wreck):
    monitor = PlanMonitor(4)
    # Half of four: the median is the mean of the second and the third.
    offsets = [np.array([0.0, 2.2 * SETTINGS.deviation_limit * (i < far), 0.0]) for i in range(4)]
    for time in np.arange(0.0, 0.5, 0.05):
        report(monitor, time, offsets)
    assert monitor.is_off(0.5) == wreck


def test_off_plan_only_after_its_time_without_a_break():
    monitor, far = PlanMonitor(4), [np.array([2.0 * SETTINGS.deviation_limit, 0.0, 0.0])] * 4
    report(monitor, 0.0, far)
    assert not monitor.is_off(0.5 * SETTINGS.deviation_time)
    report(monitor, 0.1, [np.zeros(3)] * 4)
    report(monitor, 0.15, far)
    assert not monitor.is_off(0.15 + 0.5 * SETTINGS.deviation_time)
    assert monitor.is_off(0.15 + 1.01 * SETTINGS.deviation_time)


def test_positions_that_contradict_their_velocities_say_nothing_of_the_plan():
    monitor = PlanMonitor(4)
    report(monitor, 0.0, [np.array([2.0 * SETTINGS.deviation_limit, 0.0, 0.0])] * 4)
    monitor.compare(0.05, PLACES, contradicted=True)
    assert np.isnan(monitor.deviations).all()
    assert not monitor.is_off(9.0)
    monitor.compare(0.1, PLACES)
    assert monitor.is_off(0.1 + 1.01 * SETTINGS.deviation_time)


def test_positions_are_brought_to_the_time_of_the_plan():
    monitor, velocity = PlanMonitor(4), np.array([2.5, 0.0, 0.0])
    for i in range(4):
        monitor.add(Position(1.0, i, PLACES[i] - 0.2 * velocity, velocity))
    monitor.compare(1.2, PLACES)
    np.testing.assert_allclose(monitor.deviations, 0.0, atol=1e-12)


def test_old_positions_do_not_count():
    monitor = PlanMonitor(4)
    report(monitor, 0.0, [np.array([9.0, 0.0, 0.0])] * 4)
    monitor.compare(2.0 * SETTINGS.telemetry_timeout, PLACES)
    assert np.isnan(monitor.deviations).all()
    assert not monitor.is_off(9.0)


@pytest.mark.parametrize(
    ("degrees", "offset", "overturned"), [(60.0, 0.5, True), (60.0, 0.0, False), (30.0, 0.5, False)]
)
def test_overturned_if_a_vehicle_confirms_it(degrees, offset, overturned):
    monitor = PlanMonitor(4)
    report(monitor, 0.0, [np.array([0.0, 0.0, offset]), *[np.zeros(3)] * 3])
    for time in (0.0, 0.02, 0.04):
        assert not monitor.is_overturned
        monitor.add(tilted(time, math.radians(degrees)))
    assert monitor.is_overturned is overturned


def test_one_damaged_attitude_overturns_nothing():
    monitor = PlanMonitor(4)
    report(monitor, 0.0, [np.array([0.0, 0.0, 0.5])] * 4)
    for k in range(20):
        monitor.add(tilted(0.02 * k, math.radians(170.0 if k % 3 else 2.0)))
        assert not monitor.is_overturned
