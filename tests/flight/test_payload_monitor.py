"""Touchdown detection, by an estimate without a model of the ground."""

from types import SimpleNamespace

import numpy as np
import pytest
from flights import MISSIONS

from gcs.config import read_system
from gcs.config.flight_settings import DEFAULTS
from gcs.flight.payload_monitor import PayloadMonitor
from idc_controller.trajectory.trajectory import RestTrajectory

PARAMETERS = read_system(MISSIONS / "system.toml").parameters()
HALF = PARAMETERS.payload.below


def steps_to_touchdown(heights, velocities, below):
    """Return the control step of touch-down detection, the reference ``below`` (m) the ground; None: not detected."""
    monitor = PayloadMonitor(PARAMETERS)
    descent = RestTrajectory(np.array([0.0, 0.0, -HALF + below]), 0.0)
    for k, (height, velocity) in enumerate(zip(heights, velocities, strict=True)):
        x = np.zeros(56)
        x[2], x[5] = -HALF - height, velocity
        if monitor.has_touched_down(0.0, descent, SimpleNamespace(x=x)):
            return k + 1
    return None


def test_touchdown_is_detected_where_the_reference_sinks_on():
    assert steps_to_touchdown([0.05] * 6, [0.0] * 6, below=0.1) == 4


def test_touchdown_is_detected_of_a_payload_that_bounces_on_its_pad():
    assert steps_to_touchdown([0.05, 0.06, 0.04, 0.05, 0.05], [0.2, -0.1, 0.2, -0.15, 0.1], below=0.05) == 4


@pytest.mark.parametrize(("height", "velocity"), [(0.3, 0.2), (0.05, 0.2), (1.5, 0.0)])
def test_touchdown_is_not_detected_while_the_payload_follows_its_reference_or_is_high(height, velocity):
    below = 0.3 if height > 1.0 else -height + 0.02
    assert steps_to_touchdown([height] * 20, [velocity] * 20, below) is None


def estimate(height=3.0, roll=0.0, pitch=0.0):
    x = np.zeros(56)
    x[2], x[6], x[7] = -HALF - height, roll, pitch
    return SimpleNamespace(x=x)


@pytest.mark.parametrize(("excess", "clear"), [(-0.001, False), (0.001, True)])
def test_payload_is_clear_above_its_height_alone(excess, clear):
    height = DEFAULTS.takeoff_landing.clear_height + excess
    assert PayloadMonitor(PARAMETERS).is_clear(estimate(height)) is clear


TILT, TIME = DEFAULTS.failsafe.tilt_limit, DEFAULTS.failsafe.tilt_time


@pytest.mark.parametrize(
    ("roll", "pitch", "is_lost"),
    [(0.99, 0.0, False), (1.01, 0.0, True), (-1.01, 0.0, True), (0.0, 1.01, True), (0.0, -1.01, True),
     (0.99, -0.99, False), (np.nan, 0.0, True)],
)  # fmt: skip
def test_payload_is_out_of_control_once_tilted_for_long(roll, pitch, is_lost):
    monitor = PayloadMonitor(PARAMETERS)
    assert not monitor.is_out_of_control(10.0, estimate())
    wrong = estimate(roll=roll * TILT, pitch=pitch * TILT)
    assert not monitor.is_out_of_control(10.0 + TIME, wrong)
    assert monitor.is_out_of_control(10.01 + TIME, wrong) is is_lost
    assert not monitor.is_out_of_control(10.02 + TIME, estimate())
    assert not monitor.is_out_of_control(10.01 + 2.0 * TIME, wrong)


def test_payload_that_was_never_in_control_has_not_lost_it():
    assert not PayloadMonitor(PARAMETERS).is_out_of_control(1e6, estimate(roll=2.0 * TILT))


def test_payload_that_stays_a_little_above_the_ground_is_never_taken_to_have_touched_down():
    monitor, descent = PayloadMonitor(PARAMETERS), RestTrajectory(np.array([0.0, 0.0, -HALF - 0.3]), 0.0, 1.0)
    assert not any(monitor.has_touched_down(time, descent, estimate(0.3)) for time in np.arange(0.0, 20.0, 0.05))


@pytest.mark.parametrize(("late", "stalled"), [(-0.1, False), (0.1, True)])
def test_descent_is_stalled_long_after_its_end(late, stalled):
    descent = RestTrajectory(np.zeros(3), 5.0, 20.0)
    progress = 20.0 + DEFAULTS.failsafe.descent_timeout + late
    assert PayloadMonitor(PARAMETERS).is_descent_stalled(progress, descent) is stalled
