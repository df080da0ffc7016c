"""Touchdown detection, by an estimate without a model of the ground."""

from types import SimpleNamespace

import numpy as np
import pytest
from flight_in_process import MISSIONS

from gcs.config import read_system
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
