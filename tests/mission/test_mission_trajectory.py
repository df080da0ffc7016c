"""Mission trajectory: the payload's way from pad to ground."""

from itertools import pairwise

import numpy as np
import pytest
from flights import short_figure
from mission_files import RETURN, TAKE_OFF, A, read, row, wpl

from gcs.flight.mission_trajectory import MissionTrajectory
from gcs.mission.read import read_mission


def test_figure_begins_with_a_climb_at_once(tmp_path):
    flown = MissionTrajectory(read_mission(short_figure(tmp_path)), np.array([1.0, 2.0, 0.0]), start=3.0)
    position = flown.trajectory.derivatives(np.array([3.0, 3.9]), 0)[0]
    np.testing.assert_allclose(position[0], [1.0, 2.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(position[1, :2], [1.0, 2.0], atol=1e-12)
    assert position[1, 2] < -0.005
    assert flown.phase(3.0) == "climb"


@pytest.mark.parametrize("delay", [0.0, 4.0])
def test_delay_before_take_off_is_spent_on_the_pad(tmp_path, delay):
    items = [row(93, delay)] if delay else []
    flown = MissionTrajectory(read(tmp_path, wpl(*items, TAKE_OFF, A, RETURN)), np.zeros(3), start=3.0)
    height = -flown.trajectory.derivatives(3.0 + delay + np.array([-0.1, 0.0, 4.0]), 0)[0][:, 2]
    assert height[:2] == pytest.approx(0.0, abs=1e-3) and height[2] > 0.05


def test_figure_ends_where_the_climb_ended_and_descends_there(tmp_path):
    mission = read_mission(short_figure(tmp_path))
    flown = MissionTrajectory(mission, np.array([1.0, 2.0, 0.0]), start=3.0)
    trajectory = flown.trajectory
    trajectory.derivatives(np.array([200.0]), 0)
    times = np.linspace(3.0, trajectory.end, 4000)
    path, velocity = trajectory.derivatives(times, 1)
    np.testing.assert_allclose(path[-1, :2], [1.0, 2.0], atol=0.01)
    figure = path[path[:, 2] < -mission.reference.altitude + 0.01]
    assert np.ptp(figure[:, 0]) > mission.reference.amplitude[0]
    assert np.linalg.norm(velocity, axis=1).max() <= mission.system.motion.curve_speed


@pytest.fixture
def flown(tmp_path):
    """Up to 5 m at (1, 2) on a pad 0.1 m high, over A with a stop of 2 s there, and down where it started."""
    stop = row(16, 2.0, north=10.0)
    mission = read(tmp_path, wpl(TAKE_OFF, stop, RETURN))
    ground = -mission.system.parameters().payload.below
    flown = MissionTrajectory(mission, np.array([1.0, 2.0, ground - 0.1]), start=3.0)
    flown.settings, flown.motion, flown.ground = mission.system.flight.takeoff_landing, mission.system.motion, ground
    return flown


def times_of(flown):
    """Team times until 1 s after the end (s), with the phase at each."""
    times = np.arange(3.0, 200.0, 0.05)
    flown.trajectory.derivatives(times[-1:], 0)
    times = times[times < flown.trajectory.end + 1.0]
    return times, [flown.phase(time) for time in times.tolist()]


def test_phases_follow_one_another_and_a_stop_is_a_hold(flown):
    assert flown.landing_from == np.inf and flown.phase(3.0) == "climb"
    times, phases = times_of(flown)
    order = [phases[0], *(b for a, b in pairwise(phases) if a != b)]
    assert order[0] == "climb" and order[-1] == "land" and order.count("climb") == order.count("land") == 1
    assert [phase for phase in order if phase != "hold"] == ["climb", "fly", "fly", "land"]
    first_land = times[phases.index("land")]
    assert first_land - 0.05 < flown.landing_from <= first_land
    speed = np.hypot(*flown.trajectory.derivatives(times, 1)[1, :, :2].T)
    for phase, fast in zip(phases, speed > flown.settings.hold_speed, strict=True):
        assert phase == ("fly" if fast else "hold") or phase in ("climb", "land")
    at_stop = [t for t, phase in zip(times, phases, strict=True) if phase == "hold"]
    assert sum(np.diff(at_stop) < 0.06) * 0.05 >= 2.0


def test_climb_and_descent_have_their_speeds_and_the_last_metre_is_slow(flown):
    times, phases = times_of(flown)
    position, velocity = flown.trajectory.derivatives(times, 1)
    climb = np.array([phase == "climb" for phase in phases])
    assert velocity[climb, 2].min() == pytest.approx(-flown.motion.climb_speed, rel=0.01)
    assert position[:, 2].min() == pytest.approx(flown.ground - 5.0, abs=0.3)
    down, height = times > flown.landing_from, flown.ground - position[:, 2]
    assert velocity[down, 2].max() == pytest.approx(flown.motion.climb_speed, rel=0.01)
    low = down & (height < flown.settings.slow_height - 0.01)
    assert velocity[low, 2].max() == pytest.approx(flown.motion.landing_speed, rel=0.01)
    assert height[-1] == pytest.approx(-flown.settings.landing_overshoot, abs=1e-6)


def test_reference_ends_on_the_pad_at_the_begin_and_on_the_ground_elsewhere(flown, tmp_path):
    times, _ = times_of(flown)
    position, velocity = flown.reference(times)
    path, speeds = flown.trajectory.derivatives(times, 1)
    above = path[:, 2] <= flown.ground - 0.1
    np.testing.assert_array_equal(position[above], path[above])
    np.testing.assert_array_equal(velocity[above], speeds[above])
    # It returns to home, which is 2.2 m beside the pad: on the ground.
    assert position[:, 2].max() == flown.ground and velocity[-1].tolist() == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)
    below = path[:, 2] > flown.ground
    assert below.any() and np.all(position[below, 2] == flown.ground) and np.all(velocity[below, 2] == 0.0)
    # Where it started, the pad carries it 0.1 m above the ground.
    back = MissionTrajectory(read(tmp_path, wpl(TAKE_OFF, A, RETURN)), np.array([0.0, 0.0, flown.ground - 0.1]), 3.0)
    times, _ = times_of(back)
    position, velocity = back.reference(times)
    assert position[:, 2].max() == pytest.approx(flown.ground - 0.1) and velocity[-1, 2] == 0.0


def test_braking_stops_soon_then_lands_there_once(flown):
    times, phases = times_of(flown)
    when = times[phases.index("fly")] + 3.0
    before, followed = flown.trajectory.derivatives(np.array([when]), 1)[:, 0], flown.trajectory
    flown.brake_and_land(followed, when)
    braked = flown.trajectory
    assert braked is not followed
    np.testing.assert_allclose(braked.derivatives(np.array([when]), 1)[:, 0], before, atol=1e-6)
    braked.derivatives(np.array([when + 100.0]), 0)
    end = braked.derivatives(np.array([braked.end]), 0)[0, 0]
    assert 0.0 < np.linalg.norm(end[:2] - before[0, :2]) < 5.0 and end[2] > flown.ground
    assert when < flown.landing_from < when + 10.0 and flown.phase(flown.landing_from + 0.1) == "land"
    assert flown.phase(when) == "fly" and flown.phase(flown.landing_from - 0.01) == "hold"
    flown.brake_and_land(braked, when + 1.0)
    assert flown.trajectory is braked


def test_braking_in_the_climb_lands_and_braking_while_landing_changes_nothing(flown):
    whole = flown.trajectory
    times_of(flown)
    flown.brake_and_land(whole, flown.landing_from + 0.5)
    assert flown.trajectory is whole
    flown.brake_and_land(whole, 5.0)
    assert flown.trajectory is not whole and flown.phase(5.0) != "climb"
    flown.trajectory.derivatives(np.array([100.0]), 0)
    assert flown.landing_from < 12.0


@pytest.mark.parametrize(("beyond", "at_once"), [(-0.1, True), (0.1, False)])
def test_descent_from_just_above_its_slow_part_is_slow_as_a_whole(tmp_path, beyond, at_once):
    """From higher up it comes to rest where its slow part begins."""
    low = read(tmp_path, wpl(row(22, alt=3.0), row(21, alt=0)))
    ground, settings = -low.system.parameters().payload.below, low.system.flight.takeoff_landing
    altitude = settings.slow_height + settings.slow_margin + beyond - ground
    flown = MissionTrajectory(read(tmp_path, wpl(row(22, alt=altitude), row(21, alt=0))), np.zeros(3), start=0.0)
    position, velocity = flown.trajectory.derivatives(np.arange(0.0, 60.0, 0.02), 1)[:, :, 2]
    down = (np.arange(0.0, 60.0, 0.02) > flown.landing_from) & (velocity > 0.0)
    where_slow_begins = down & (np.abs(ground - position - settings.slow_height) < 0.005)
    assert (velocity[where_slow_begins].min() > 0.2) == at_once
