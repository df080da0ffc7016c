import itertools
import math
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import BSpline

from idc_controller.errors import TrajectoryError
from idc_controller.trajectory.paths import Circle, Leg
from idc_controller.trajectory.sampled_path import distance_to_line, smoothing_for
from idc_controller.trajectory.settings import Limits
from idc_controller.trajectory.spline import SplineTrajectory
from idc_controller.trajectory.trajectory import RestTrajectory
from idc_controller.trajectory.waypoints import WaypointTrajectory

LIMITS = Limits(speed=1.5, acceleration=2.0, jerk=4.0, snap=6.0)
ORIGIN = np.zeros(3)
HIGH = np.array([0.0, 0.0, -5.0])
STEP = 0.02


def planned(legs, start=HIGH, limits=LIMITS, **options):
    trajectory = WaypointTrajectory(start, legs, limits, kept=math.inf, **options)
    trajectory.derivatives([1e5])
    assert math.isfinite(trajectory.end)
    return trajectory


def sampled(trajectory, step=STEP):
    times = np.arange(trajectory.start - 0.5, trajectory.end + 0.5, step)
    return times, trajectory.derivatives(times)


def assert_within(derivatives, limits=LIMITS, step=STEP):
    crackle = np.diff(derivatives[4:], axis=1)[0] / step
    norms = np.array([np.linalg.norm(d, axis=1).max() for d in (*derivatives[1:], crackle)])
    assert np.all(norms <= limits.as_array() * (1 + 1e-6)), norms


def assert_consistent(trajectory, times, h=1e-3):
    """Each derivative against central differences of the one below."""
    middle = trajectory.derivatives(times)
    difference = (trajectory.derivatives(times + h) - trajectory.derivatives(times - h)) / (2 * h)
    # Snap is only continuous: its kinks (knots) bound the error of the last one by h * crackle / 4.
    for d in range(4):
        assert np.abs(difference[d] - middle[d + 1]).max() < (0.05 if d == 3 else 1e-4)


coordinate = st.floats(-15.0, 15.0, allow_nan=False)
far = st.tuples(coordinate, coordinate, st.floats(-15.0, -0.1))
near = st.tuples(*[st.floats(-0.4, 0.4)] * 3)


@st.composite
def missions(draw):
    """Legs that go far, hardly move, reverse, repeat a point, go straight up or on, and circles."""
    start = np.array(draw(far))
    here, before, legs = start, start, []
    for kind in draw(st.lists(st.sampled_from("fffnnrsvoc"), min_size=1, max_size=7)):
        speed = draw(st.sampled_from([0.3, 1.0, 1.5, 5.0]))
        hold = draw(st.sampled_from([0.0, 0.0, 0.0, 1.0]))
        if kind == "c":
            radius = draw(st.floats(0.3, 6.0))
            turns = draw(st.sampled_from([0.25, 1.0, 2.0]))
            legs.append(Circle(here + draw(near), radius, turns, speed, draw(st.booleans()), hold))
            angles = math.atan2(here[1] - legs[-1].centre[1], here[0] - legs[-1].centre[0])
            angles += (1 if legs[-1].clockwise else -1) * 2 * math.pi * turns
            if np.linalg.norm((here - legs[-1].centre)[:2]) <= 1e-6:
                angles -= math.atan2(here[1] - legs[-1].centre[1], here[0] - legs[-1].centre[0])
            here = legs[-1].centre + radius * np.array([math.cos(angles), math.sin(angles), 0.0])
            continue
        target = {
            "f": lambda: np.array(draw(far)),
            "n": lambda h=here: h + draw(near),
            "r": lambda b=before: b,
            "s": lambda h=here: h,
            "v": lambda h=here: h + np.array([0.0, 0.0, draw(st.floats(-4.0, 4.0))]),
            "o": lambda h=here, b=before: h + 0.5 * (h - b),
        }[kind]()
        legs.append(Leg(target, speed, hold))
        before, here = here, target
    return start, legs


@settings(max_examples=60)
@given(missions())
def test_any_mission_keeps_limits_passes_every_waypoint_and_rests_at_both_ends(mission):
    start, legs = mission
    trajectory = planned(legs, start)
    _, derivatives = sampled(trajectory)
    assert_within(derivatives)
    ends = trajectory.derivatives([trajectory.start, trajectory.end, trajectory.end + 7.0])
    assert np.all(np.abs(ends[1:]) < 1e-9)
    assert np.allclose(ends[0, 0], start, atol=1e-12)
    passed = trajectory.passages
    assert np.all(np.diff(passed) >= 0.0)
    for time, leg in zip(passed, legs, strict=True):
        if isinstance(leg, Circle):
            continue
        distance = np.linalg.norm(derivatives[0] - leg.position, axis=1)
        assert distance.min() <= 0.21  # the samples are up to 0.03 m apart
        if leg.hold > 0.0:
            held = trajectory.derivatives(np.linspace(time, time + leg.hold, 20))
            assert np.linalg.norm(held[0] - leg.position, axis=1).max() <= 1e-3
    if isinstance(legs[-1], Leg):
        assert np.allclose(ends[0, -1], legs[-1].position, atol=2e-6)


@settings(max_examples=30)
@given(missions(), st.floats(0.0, 1.0))
def test_stop_leaves_continuously_keeps_limits_and_never_ends_later(mission, share):
    start, legs = mission
    trajectory = planned(legs, start)
    time = share * trajectory.end
    stopped = trajectory.stop(time)
    around = time + np.array([-0.3, -0.01, 0.0])
    assert np.allclose(stopped.derivatives(around), trajectory.derivatives(around), atol=1e-6)
    assert stopped.end <= trajectory.end + 1e-9
    times = np.arange(time, max(stopped.end, time) + 0.1, 0.02)
    derivatives = stopped.derivatives(times)
    assert_within(derivatives)
    assert np.all(stopped.derivatives([max(stopped.end, time)])[1:] == pytest.approx(0.0, abs=1e-9))
    # It stays on the path that was planned.
    path = trajectory.derivatives(np.arange(time, trajectory.end + 0.02, 0.02), 0)[0]
    gaps = np.linalg.norm(derivatives[0, ::5, None] - path[None], axis=2).min(axis=1)
    assert gaps.max() < 0.1


def test_derivatives_are_those_of_the_position():
    trajectory = planned([Leg([3, 0, -5], 1.5), Leg([3, 4, -6], 1.0, 1.0), Leg([0, 0, -5], 1.5)])
    assert_consistent(trajectory, np.linspace(0.2, trajectory.end - 0.2, 501))
    stopped = trajectory.stop(3.0)
    assert_consistent(stopped, np.linspace(1.0, stopped.end + 1.0, 301))


def test_spline_agrees_with_scipy():
    rng = np.random.default_rng(3)
    points = rng.normal(size=(20, 3))
    spline = SplineTrajectory(points, 0.3, 2.0, LIMITS)
    reference = BSpline(2.0 + 0.3 * np.arange(26), points, 5)
    times = rng.uniform(2.0 + 0.3 * 5, 2.0 + 0.3 * 20, 50)
    for d in range(5):
        expected = reference.derivative(d)(times) if d else reference(times)
        assert np.allclose(spline.derivatives(times)[d], expected, rtol=1e-9, atol=1e-7)


@pytest.mark.parametrize("moment", [8.0, 15.0, 22.0])
@pytest.mark.parametrize("standing", [0, 7])
def test_spline_stops_within_a_braking_distance_on_its_curve(moment, standing):
    """A long curve at steady speed, at rest at first: it leaves the spline at ``moment`` only, and soon rests."""
    at = np.concatenate([np.zeros(standing), np.linspace(0.0, 60.0, 300) * 0.6])
    ramp = np.convolve(np.pad(at, 12, mode="edge"), np.full(13, 1.0 / 13), mode="valid")
    points = np.column_stack([ramp, 4.0 * np.sin(ramp / 9.0), np.full(len(ramp), -5.0)])
    spline = SplineTrajectory(points, 0.2, 0.0, Limits(speed=1.5, acceleration=2.0, jerk=4.0, snap=8.0))
    assert spline.end > 50.0
    stopped = spline.stop(moment)
    before = np.linspace(0.0, moment, 60)
    assert np.allclose(stopped.derivatives(before), spline.derivatives(before), atol=1e-9)
    assert moment < stopped.end < moment + 6.0
    around = stopped.derivatives(np.linspace(moment - 1.0, stopped.end + 1.0, 400))
    assert_within(around, spline.limits)
    curve = spline.derivatives(np.linspace(0.0, 40.0, 8001), 0)[0]
    off = [np.linalg.norm(curve - place, axis=1).min() for place in around[0][::20]]
    assert max(off) < 0.02
    assert np.abs(stopped.derivatives([stopped.end])[1:]).max() < 1e-9


@pytest.mark.parametrize(("steps", "length"), [(12, 0.3), (30, 0.1), (30, 0.3)])
def test_stop_of_a_spline_never_ends_later_than_the_spline(steps, length):
    along = np.concatenate([np.zeros(5), length * np.arange(1, steps + 1), np.full(5, length * steps)])
    spline = SplineTrajectory(np.column_stack([along, 0.0 * along, 0.0 * along - 5.0]), 0.25, 0.0, LIMITS)
    ends = [spline.stop(time).end for time in np.arange(0.5, spline.end, 0.25)]
    assert min(ends) < spline.end
    assert max(ends) <= spline.end


def test_straight_leg_is_flown_at_constant_speed():
    # Unequal legs, two of them shorter than the smoothing reaches.
    legs = [Leg([x, 0, -5], 1.5) for x in (7.0, 7.9, 8.3, 20.0, 30.0)]
    trajectory = planned(legs)
    first, last = (trajectory.passages[i] for i in (0, 3))
    speed = np.linalg.norm(trajectory.derivatives(np.linspace(first, last, 200), 1)[1], axis=1)
    assert np.allclose(speed, 1.5, atol=1e-6)
    for time, leg in zip(trajectory.passages[:4], legs, strict=False):
        assert np.linalg.norm(trajectory.position(time) - leg.position) < 0.1


def test_change_of_speed_on_a_straight_line_needs_no_pause():
    trajectory = planned([Leg([10, 0, -5], 1.5), Leg([20, 0, -5], 0.5)])
    _, derivatives = sampled(trajectory)
    between = (derivatives[0, :, 0] > 3.0) & (derivatives[0, :, 0] < 18.0)
    assert np.linalg.norm(derivatives[1, between], axis=1).min() > 0.5 - 1e-6


def test_corner_is_flown_through_not_stopped_at():
    trajectory = planned([Leg([10, 0, -5], 1.5), Leg([10, 10, -5], 1.5)])
    time = trajectory.passages[0]
    derivatives = trajectory.derivatives(np.linspace(time - 0.5, time + 0.5, 50))
    assert np.linalg.norm(derivatives[1], axis=1).min() > 0.2
    assert np.linalg.norm(derivatives[0] - [10, 0, -5], axis=1).min() <= 0.2


def test_pause_at_a_corner_ends_at_the_first_sample_from_which_limits_hold():
    def duration(turn):
        corner, direction = np.array([2.0, 0.0, -5.0]), np.array([math.cos(turn), math.sin(turn), 0.0])
        before, after = planned([Leg(corner, 1.5), Leg(corner + 2.0 * direction, 1.5)]).passages
        return after - before

    # A turn by 40 deg needs no pause; one by 50 deg may begin at the next sample.
    pause = duration(math.radians(50.0)) - duration(math.radians(40.0))
    assert 0.0 < pause < smoothing_for(LIMITS).interval


def test_waypoints_are_those_passed_between_two_times():
    corners = np.array([[3.0, 0.0, -5.0], [3.0, 4.0, -6.0], [0.0, 0.0, -5.0]])
    trajectory = planned([Leg(corner, 1.5) for corner in corners])
    first, second, _ = trajectory.passages
    assert trajectory.waypoints(0.0, trajectory.end) == pytest.approx(corners, abs=0.2)
    assert trajectory.waypoints(first, second) == pytest.approx(corners[:2], abs=0.2)
    assert trajectory.waypoints(first + 0.1, second - 0.1).shape == (0, 3)


def test_trajectory_stays_on_the_legs():
    points = [[4, 0, -0.2], [4, 4, -0.2], [0, 0, 0]]
    _, derivatives = sampled(planned([Leg(p, 1.5) for p in points], [0, 0, -0.2]))
    assert derivatives[0, :, 2].max() <= 1e-12
    assert derivatives[0, :, :2].min() >= -1e-12
    assert derivatives[0, :, :2].max() <= 4 + 1e-12


def test_take_off_and_landing_are_vertical():
    trajectory = planned([Leg(HIGH, 0.5, 2.0), Leg(ORIGIN, 0.3)], ORIGIN)
    _, derivatives = sampled(trajectory)
    assert np.all(derivatives[:, :, :2] == 0.0)
    assert np.abs(derivatives[1]).max() == pytest.approx(0.5)
    assert np.array_equal(trajectory.position(trajectory.end), ORIGIN)


def test_circle_keeps_its_radius_and_direction_and_slows_down_where_it_is_tight():
    for direction, sign in (((), 1.0), ((True,), 1.0), ((False,), -1.0)):
        trajectory = planned([Circle([3, 0, -5], 3.0, 2.0, 1.5, *direction)])
        _, d = sampled(trajectory)
        arm = d[0] - [3, 0, -5]
        assert np.abs(np.linalg.norm(arm, axis=1) - 3.0).max() < 0.15
        angle = np.unwrap(np.arctan2(arm[:, 1], arm[:, 0]))
        assert angle[-1] - angle[0] == pytest.approx(sign * 4 * math.pi, abs=1e-6)
    tight = planned([Circle([0.3, 0, -5], 0.3, 3.0, 1.5)])
    _, d = sampled(tight)
    assert_within(d)
    arm = np.linalg.norm(d[0] - [0.3, 0, -5], axis=1)
    assert arm.min() > 0.15


def test_endless_mission_is_read_only_to_evaluated_time_and_past_is_dropped():
    read = 0

    def legs():
        nonlocal read
        for corner in itertools.cycle([[10, 0, -5], [10, 10, -5], [0, 10, -5], [0, 0, -5]]):
            read += 1
            yield Leg(corner, 1.5)

    trajectory = WaypointTrajectory(HIGH, legs(), LIMITS)
    assert read == 0
    trajectory.derivatives([10.0])
    assert read <= 5
    memory = []
    tracemalloc.start()
    for now in np.arange(0.0, 1000.0, 10.0):
        derivatives = trajectory.derivatives(now + np.arange(21) * 0.1)
        assert_within(derivatives, step=0.1)
        memory.append(tracemalloc.get_traced_memory()[0])
    tracemalloc.stop()
    assert trajectory.end == math.inf
    assert max(memory[50:]) < 1.5 * max(memory[:50])  # what has been flown is forgotten
    with pytest.raises(TrajectoryError, match="no longer kept"):
        trajectory.derivatives([10.0])
    stopped = trajectory.stop(1000.0)
    assert stopped.end < 1006.0


def test_planning_in_steps_equals_planning_at_once():
    legs = [Leg(p, 1.5) for p in ([5, 0, -5], [5, 1, -5], [0, 1, -5], [0, 0.5, -5.2], [8, 8, -8])]
    at_once = planned(legs)
    stepwise = WaypointTrajectory(HIGH, iter(legs), LIMITS)
    times = np.arange(0.0, at_once.end + 1, 0.05)
    for time in times:
        assert np.allclose(stepwise.derivatives([time]), at_once.derivatives([time]), atol=1e-9)
    assert stepwise.end == pytest.approx(at_once.end)
    assert np.allclose(stepwise.passages, at_once.passages)


def sequence_in_sequences():
    """Return a sequence of a sequence of a sequence, with rests of known end between motions of unknown end."""

    def to(place):
        return lambda now, here: WaypointTrajectory(here, [Leg(place, 1.5)], LIMITS, start=now)

    inner = to([2, 0, -5])(0.0, HIGH).then(lambda now, here: RestTrajectory(here, now, now + 4.0)).then(to([2, 2, -5]))
    middle = to([1, 0, -5])(-6.0, HIGH).then(lambda now, here: inner)
    return middle.then(lambda now, here: RestTrajectory(here, now, now + 4.0)).then(to(HIGH))


@pytest.mark.parametrize("seed", range(5))
def test_sequence_in_sequences_evaluated_in_steps_equals_that_evaluated_at_once(seed):
    rng = np.random.default_rng(seed)
    at_once, stepwise = sequence_in_sequences(), sequence_in_sequences()
    at_once.derivatives([200.0])
    horizon = np.linspace(-0.3, 1.0, 8)
    for now in np.arange(-7.0, at_once.end + 1.0, 0.1):
        times = now + horizon[: rng.integers(1, 9)]
        assert (stepwise.derivatives(times) == at_once.derivatives(times)).all()
    assert stepwise.end == at_once.end
    for now in rng.uniform(-7.0, at_once.end, 50):
        assert (stepwise.derivatives(now + horizon) == at_once.derivatives(now + horizon)).all()


def test_holding_for_ever_and_stopping_then_flying_home():
    trajectory = WaypointTrajectory(HIGH, [Leg([5, 0, -5], 1.5, math.inf)], LIMITS, start=3.0)
    assert np.allclose(trajectory.position(1e4), [5, 0, -5])
    assert trajectory.end == math.inf
    # From an endless hold, and in mid-flight.
    for time in (50.0, 6.0):
        trajectory = WaypointTrajectory(HIGH, [Leg([5, 0, -5], 1.5, math.inf)], LIMITS, start=3.0)
        stopped = trajectory.stop(time)
        resting = RestTrajectory(stopped.position(time), time) if time > stopped.end else stopped
        back = [Leg(HIGH, 1.5, 1.0), Leg(ORIGIN, 0.3)]
        home = resting.then(lambda now, here, legs=back: WaypointTrajectory(here, legs, LIMITS, start=now))
        times = np.arange(time, time + 60.0, 0.02)
        derivatives = home.derivatives(times)
        assert_within(derivatives)
        assert np.abs(np.diff(derivatives[0], axis=0)).max() < 0.04
        assert np.allclose(derivatives[0, -1], ORIGIN)
        assert home.end < time + 60.0
        again = home.stop(home.end - 3.0)
        assert again.end <= home.end + 1e-9


def test_stop_is_prompt():
    trajectory = planned([Leg([40, 0, -5], 1.5)])
    assert trajectory.stop(15.0).end - 15.0 < 3.3  # of which 0.3 s are for the limit of the crackle
    slow = planned([Leg([10, 0, -5], 0.3)])
    assert slow.stop(15.0).end - 15.0 < 2.6


@pytest.mark.parametrize(
    "bad",
    [
        lambda: Limits(0.0, 1, 1, 1),
        lambda: Limits(1, math.nan, 1, 1),
        lambda: Leg([0, 0, math.inf], 1.0),
        lambda: Leg([0, 0], 1.0),
        lambda: Leg([0, 0, 0], 0.0),
        lambda: Leg([0, 0, 0], 1.0, -1.0),
        lambda: Leg([0, 0, 0], 1.0, math.nan),
        lambda: Circle([0, 0, 0], 0.0, 1.0, 1.0),
        lambda: Circle([0, 0, 0], 1.0, -1.0, 1.0),
        lambda: WaypointTrajectory([0, 0, math.nan], [], LIMITS),
        lambda: WaypointTrajectory(HIGH, [], LIMITS, corner=0.0),
        lambda: WaypointTrajectory(HIGH, [], LIMITS).derivatives([math.nan]),
        lambda: WaypointTrajectory(HIGH, [], LIMITS).derivatives([0.0], 5),
        lambda: WaypointTrajectory(HIGH, itertools.repeat(Leg(HIGH, 1.0)), LIMITS).derivatives([1.0]),
        lambda: SplineTrajectory(np.zeros((0, 3)), 0.1, 0.0, LIMITS),
        lambda: SplineTrajectory(np.zeros((4, 3)), 0.0, 0.0, LIMITS),
        lambda: RestTrajectory(HIGH, 2.0, 1.0),
    ],
)
def test_trajectory_refuses_invalid_arguments(bad):
    with pytest.raises(TrajectoryError):
        bad()


def test_mission_without_legs_is_a_rest():
    trajectory = WaypointTrajectory(HIGH, [], LIMITS, start=2.0)
    assert np.array_equal(trajectory.position(9.0), HIGH)
    assert trajectory.end == 2.0
    assert trajectory.stop(3.0).end <= 3.0


@pytest.mark.parametrize(
    ("position", "distance"),
    [((1.0, 0.5, 0.0), 0.5), ((2.4, 0.0, 0.0), 0.4), ((-0.3, 0.4, 0.0), 0.5), ((2.3, 1.0, 0.0), 0.3)],
    ids=["beside", "beyond the corner", "before the begin", "beside the second part"],
)
def test_distance_to_a_line_is_to_its_parts_and_not_to_their_extensions(position, distance):
    line = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0]])
    assert distance_to_line(np.array(position), line) == pytest.approx(distance)
    assert distance_to_line(np.array(position), line[:1]) == pytest.approx(np.linalg.norm(position))
