"""The filter that smooths paths: as short as the limits of the motion allow."""

from functools import reduce

import numpy as np
import pytest

from idc_controller.trajectory.settings import Limits
from idc_controller.trajectory.smoothing import SHORTEST_INTERVAL, smoothing_for
from idc_controller.trajectory.spline import SUPPORT, evaluate

AMPLE = 1e4


def running_means(*lengths):
    return reduce(np.convolve, [np.full(n, 1.0 / n) for n in lengths])


@pytest.mark.parametrize(
    ("limits", "lengths"),
    [
        (Limits(speed=1.5, acceleration=0.5, jerk=AMPLE, snap=AMPLE, crackle=AMPLE), (10,)),
        (Limits(speed=1.5, acceleration=AMPLE, jerk=2.0, snap=AMPLE, crackle=AMPLE), (6, 5)),
        (Limits(speed=1.5, acceleration=AMPLE, jerk=AMPLE, snap=2.0, crackle=AMPLE), (6, 3, 3)),
        (Limits(speed=1.5, acceleration=2.0, jerk=4.0, snap=6.0, crackle=AMPLE), (6, 3, 3)),
    ],
    ids=["acceleration", "jerk", "snap", "all"],
)
def test_filter_has_a_running_mean_for_each_derivative_that_is_limited(limits, lengths):
    np.testing.assert_allclose(smoothing_for(limits).weights, running_means(*lengths), rtol=1e-12)


@pytest.mark.parametrize(
    "limits",
    [
        Limits(speed=1.5, acceleration=2.0, jerk=4.0, snap=6.0, crackle=AMPLE),
        Limits(speed=3.0, acceleration=1.0, jerk=AMPLE, snap=AMPLE, crackle=AMPLE),
        Limits(speed=0.5, acceleration=AMPLE, jerk=2.0, snap=AMPLE, crackle=AMPLE),
    ],
)
def test_right_angle_at_full_speed_takes_one_limit_whole_and_exceeds_none(limits):
    smoothing = smoothing_for(limits)
    step = limits.speed * smoothing.interval
    along = np.arange(-60, 61)
    corner = step * np.stack([np.minimum(along, 0), np.maximum(along, 0), np.zeros_like(along)], axis=1)
    control = smoothing.control_points(corner.astype(float))
    arguments = np.linspace(2.0 * SUPPORT, len(control) - 2.0 * SUPPORT, 8000)
    derivatives = evaluate(control, smoothing.interval, arguments, 4)
    crackle = np.diff(derivatives[4:], axis=1) / (smoothing.interval * (arguments[1] - arguments[0]))
    norms = [np.linalg.norm(derivative, axis=1).max() for derivative in (*derivatives[1:], crackle[0])]
    shares = norms / limits.as_array()
    assert shares.max() <= 1.0 + 1e-9
    assert shares[1:].max() > 0.9


def test_interval_is_no_shorter_than_a_spline_needs():
    assert (
        smoothing_for(Limits(speed=0.001, acceleration=AMPLE, jerk=AMPLE, snap=AMPLE, crackle=AMPLE)).interval
        == SHORTEST_INTERVAL
    )
