import numpy as np
import pytest

from idc_controller.errors import TrajectoryError
from idc_controller.trajectory.lissajous import LissajousCurve, LissajousTrajectory
from idc_controller.trajectory.settings import Limits

LIMITS = Limits(speed=4.5, acceleration=3.6, jerk=5.0, snap=6.0)
CURVE = LissajousCurve((6.0, 3.0), -5.0)


@pytest.fixture(scope="module")
def eight():
    return LissajousTrajectory(CURVE, 0.5, 40.0, LIMITS, start=10.0)


def assert_on_curve(position):
    """Without the phase: y = -a_y sin 2 phase, x = a_x sin phase."""
    s = position[:, 0] / 6.0
    assert np.allclose((position[:, 1] / 3.0) ** 2, 4.0 * s**2 * (1.0 - s**2), atol=1e-12)
    assert np.all(position[:, 2] == -5.0)


def test_curve_of_the_paper_is_flown_at_full_rate_for_the_duration(eight):
    begin, end = eight.full_rate
    assert end - begin == pytest.approx(40.0)
    times = np.linspace(begin, end, 100)
    phase = eight.phase(times)
    assert np.allclose(np.diff(phase), 0.5 * np.diff(times), atol=1e-9)
    # eq:Lissajous with 0.5 t in the place of the phase
    expected = np.column_stack([6 * np.sin(phase), -6 * np.sin(phase) * np.cos(phase), np.full(100, -5)])
    assert np.allclose(eight.derivatives(times, 0)[0], expected, atol=1e-12)


def test_curve_is_flown_from_rest_to_rest_within_limits(eight):
    times = np.arange(eight.start - 1, eight.end + 1, 0.003)
    derivatives = eight.derivatives(times)
    assert_on_curve(derivatives[0])
    assert np.all(np.linalg.norm(derivatives[1:], axis=2).max(axis=1) <= LIMITS.as_array()[:4])
    outside = eight.derivatives([eight.start - 1, eight.start, eight.end, eight.end + 1])
    assert np.all(outside[1:] == 0.0)
    assert np.array_equal(outside[0, 0], [0.0, 0.0, -5.0])
    for moment in (eight.start, *eight.full_rate, eight.end):
        step = eight.derivatives([moment + 1e-7]) - eight.derivatives([moment - 1e-7])
        assert np.abs(step).max() < 1e-5


def test_derivatives_are_those_of_the_position(eight):
    times = np.linspace(eight.start - 0.5, eight.end + 0.5, 3001)
    h = 1e-4
    difference = (eight.derivatives(times + h) - eight.derivatives(times - h)) / (2 * h)
    assert np.allclose(difference[:4], eight.derivatives(times)[1:], atol=2e-3)


GATHERING_SPEED = [pytest.param(after, marks=pytest.mark.slow) for after in (0.7, 2.0, 3.5, 4.6)]


@pytest.mark.parametrize("after", [-1.0, 0.0, *GATHERING_SPEED, 9.0, 23.0, 44.0, 46.0, 48.0, 60.0])
def test_stop_leaves_continuously_on_the_curve_within_limits(eight, after):
    time = eight.start + after
    stopped = eight.stop(time)
    around = [time - 1.0, time - 1e-3, time]
    assert np.allclose(stopped.derivatives(around), eight.derivatives(around), atol=1e-8)
    step = stopped.derivatives([time + 1e-7]) - stopped.derivatives([time])
    assert np.abs(step).max() < 1e-5
    times = np.arange(time, max(time, stopped.end) + 1.0, 0.003)
    derivatives = stopped.derivatives(times)
    assert_on_curve(derivatives[0])
    assert np.all(np.linalg.norm(derivatives[1:], axis=2).max(axis=1) <= LIMITS.as_array()[:4])
    assert np.all(stopped.derivatives([stopped.end])[1:] == 0.0)
    assert np.abs(stopped.derivatives([stopped.end - 1e-6])[1:]).max() < 1e-3
    assert stopped.end <= min(eight.end, max(time, eight.start) + 7.0) + 1e-9
    assert stopped.stop(time + 1.0).end <= stopped.end


@pytest.mark.parametrize("before", [0.0, 5.0])
def test_stop_before_the_start_never_leaves(eight, before):
    stopped = eight.stop(eight.start - before)
    assert stopped.end <= eight.start + 1.0
    assert np.allclose(stopped.derivatives(np.arange(0.0, 70.0, 0.5))[0], [0.0, 0.0, -5.0], atol=0.01)


def test_centre_and_other_amplitudes():
    curve = LissajousCurve((0.0, 2.0), -3.0, centre=(1.0, -2.0))
    trajectory = LissajousTrajectory(curve, 0.4, 5.0, LIMITS)
    assert np.array_equal(trajectory.position(0.0), [1.0, -2.0, -3.0])
    assert np.all(trajectory.derivatives(np.linspace(0, 10, 50), 0)[0, :, 0] == 1.0)


@pytest.mark.parametrize(
    "bad",
    [
        lambda: LissajousCurve((np.nan, 1.0), -5.0),
        lambda: LissajousCurve((-1.0, 1.0), -5.0),
        lambda: LissajousCurve((0.0, 0.0), -5.0),
        lambda: LissajousTrajectory(CURVE, 0.0, 10.0, LIMITS),
        lambda: LissajousTrajectory(CURVE, 0.5, -1.0, LIMITS),
        lambda: LissajousTrajectory(CURVE, 0.5, 10.0, Limits(2.0, 3.6, 5.0, 6.0)),
    ],
)
def test_trajectory_refuses_invalid_arguments(bad):
    with pytest.raises(TrajectoryError):
        bad()


def test_limit_that_the_curve_exceeds_at_the_full_rate_is_named():
    with pytest.raises(TrajectoryError, match=r"^the curve at 0.5 rad/s needs speed 4\.\d+, the limit is 2$"):
        LissajousTrajectory(CURVE, 0.5, 10.0, Limits(2.0, 3.6, 5.0, 6.0))
