"""The MPC's bandwidth by the age of what its set-points follow from."""

import numpy as np
import pytest
from paper_system import system

from idc_controller.control.delay_margin import HoverLoop
from idc_controller.control.gain_schedule import ScheduledMpc
from idc_controller.control.settings import MpcSettings
from idc_controller.model.linear import LinearModel
from idc_controller.trajectory.flatness import Load, Reference
from idc_controller.trajectory.trajectory import RestTrajectory

MODEL = LinearModel(system(4))
SETTINGS = MpcSettings()
LIMIT = SETTINGS.late_age


@pytest.fixture(scope="module")
def scheduled():
    return ScheduledMpc(MODEL, SETTINGS)


def test_set_points_are_smaller_for_a_second_after_one_that_acts_late(scheduled):
    stages = Reference(MODEL.parameters, RestTrajectory(np.zeros(3), 0.0), Load(MODEL.parameters.m_0, np.zeros(3))).at(
        SETTINGS.period * np.arange(scheduled.horizon + 1)
    )
    error = np.zeros(MODEL.layout.size)
    error[0] = 0.1
    size = lambda age: float(np.abs(scheduled.track(error, stages, age).delta_u).max())  # noqa: E731
    usual = size(0.9 * LIMIT)
    late = size(1.1 * LIMIT)
    assert late < 0.5 * usual
    after = [size(0.9 * LIMIT) for _ in range(30)]
    assert after[:19] == pytest.approx([late] * 19)
    assert after[20:] == pytest.approx([usual] * 10)


@pytest.mark.parametrize("steps", [2, 3, 4, 5])
def test_slower_loop_bears_a_control_period_that_it_does_not_know_of(scheduled, steps):
    """The faster one does not, once it predicts over two periods or more."""
    faster, slower = (HoverLoop(MODEL, mpc) for mpc in scheduled.by_age)
    assert faster.mean_square_growth(steps, 0.0, late=1) > 1.1
    assert slower.mean_square_growth(steps, 0.0, late=1) < 1.0


def test_loop_that_is_late_by_a_period_it_does_not_know_of_is_that_of_the_delay(scheduled):
    """At an age of one period without loss the growth is the square of the spectral radius."""
    for loop in (HoverLoop(MODEL, mpc) for mpc in scheduled.by_age):
        assert loop.mean_square_growth(1, 0.0) == pytest.approx(loop.spectral_radius(0.0) ** 2, abs=0.02)
