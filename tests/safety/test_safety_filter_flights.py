"""The safety filter flown kinematically: what it must do in each situation."""

import numpy as np
import pytest
from avoidance_checks import MARGIN, TOLERANCE, check_arrived, check_smooth
from avoidance_scene import (
    STEP,
    avoidance,
    clearance_of,
    fly,
    hull_of,
    pole,
    sphere,
    straight,
    swinging,
    wall,
)  # fmt: skip
from paper_system import system

from idc_controller.trajectory.trajectory import RestTrajectory

CROSSING = {
    "sphere": [sphere("s", (9.0, 0.0, -5.0))],
    "sphere at the links": [sphere("s", (9.0, 0.3, -6.8))],
    "low wall": [wall("w", 9.0, 0.0, (0.3, 8.0, 4.4))],
    "head-on": [sphere("m", (22.0, 0.1, -5.0), (-1.2, 0.0, 0.0))],
    "head-on above": [sphere("m", (24.0, 0.1, -6.5), (-1.5, 0.0, 0.0))],
    "crossing": [sphere("m", (9.0, 9.0, -5.0), (0.0, -1.2, 0.0))],
    "swinging": [swinging("m", (9.0, 0.0, -5.0), (0.0, 1.5, 0.0))],
}


@pytest.mark.parametrize("name", CROSSING)
def test_obstacle_is_avoided_and_mission_completed(name):
    flown = fly(avoidance(CROSSING[name]), straight(16.0), 40.0)
    assert min(flown.clearance().values()) >= MARGIN - TOLERANCE
    check_arrived(flown)
    check_smooth(flown)
    # Plans are made at the same times, so none is constrained by the one before it.
    assert max(r.slack for r in flown.reports) < 1e-4  # m: the plan begins with the crackle in force
    assert not any(r.infeasible for r in flown.reports)
    assert any(r.active for r in flown.reports)
    assert {r.nearest for r in flown.reports} == {"", CROSSING[name][0][0]}


ROUND = {
    "pole": ([pole("p", 9.0, 0.0)], 1.5),
    "pole, slowly": ([pole("p", 9.0, 0.0)], 1.0),
    "high wall": ([wall("w", 9.0, 0.0, (0.3, 4.0, 13.0))], 1.5),
    "poles with a gap too narrow": ([pole("a", 9.0, -1.2), pole("b", 9.0, 1.2)], 1.5),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.long] * (n == "pole, slowly")) for n in ROUND])
def test_blocking_obstacle_is_passed_by_detour(name):
    """No deadlock: the progress rate falls, a detour is found, and the progress rate returns to 1."""
    obstacles, speed = ROUND[name]
    flown = fly(avoidance(obstacles, speed=speed), straight(16.0, speed), 60.0)
    assert min(flown.clearance().values()) >= MARGIN - TOLERANCE
    check_arrived(flown)
    check_smooth(flown)
    rates = np.array(flown.rates)
    assert rates.min() < 0.9
    assert rates[-1] == 1.0
    changes = np.diff(rates)
    assert (changes <= 0.051 + 1e-9).all()
    # At the end of a detour, at rest, the mission is resumed from rest.
    assert np.count_nonzero(changes < -0.051 - 1e-9) <= flown.avoidance.guidance.detours
    assert flown.avoidance.guidance.blocked(flown.times[-1]) == ""


def test_reference_after_a_detour_begins_at_rest():
    obstacles, speed = ROUND["high wall"]
    stack = avoidance(obstacles, speed=speed)
    velocities, reference = [], stack.guidance.reference

    def watched(time, mission):
        found = reference(time, mission)
        velocities.append(found.derivatives(np.array([time]), 1)[1, 0])
        return found

    stack.guidance.reference = watched
    flown = fly(stack, straight(16.0, speed), 60.0)
    check_arrived(flown)
    assert stack.guidance.detours == 1
    steps = np.linalg.norm(np.diff(velocities, axis=0), axis=1)
    # By no more than the rate at which the mission is held up, not by the mission's speed.
    assert steps.max() < stack.guidance.navigator.settings.held_up_rate * speed


def test_wide_gap_is_flown_through():
    flown = fly(avoidance([pole("a", 9.0, -2.2), pole("b", 9.0, 2.2)]), straight(16.0), 40.0)
    clearance = flown.clearance()
    assert min(clearance.values()) >= MARGIN - TOLERANCE
    check_arrived(flown)
    at = int(np.argmin(np.abs(flown.path[0, :, 0] - 9.0)))
    assert abs(flown.path[0, at, 1]) < 0.5
    assert flown.avoidance.guidance.detours == 0


@pytest.mark.slow
def test_progress_rate_falls_with_lag_and_recovers():
    """The obstacle on the path disappears later: progress waits for the payload."""

    def curtain(times):
        return np.where((times < 14.0)[:, None], [[9.0, 0.0, -10.0]], [[9.0, 0.0, 60.0]])

    _, shape, _, growth = wall("w", 9.0, 0.0, (0.3, 300.0, 60.0))
    flown = fly(avoidance([("w", shape, curtain, growth)]), straight(16.0), 50.0)
    rates = np.array(flown.rates)
    lags = np.array([r.lag for r in flown.reports])
    assert rates.min() < 0.02
    assert lags.max() < 2.6
    assert np.all(rates[lags > 2.41][5:] < 0.3)
    check_arrived(flown)
    assert rates[-1] == 1.0
    # The clock never runs back.
    clock = [flown.avoidance.guidance.progress(t) for t in (flown.times[-1], flown.times[-1] + 1.0)]
    assert clock[1] - clock[0] == pytest.approx(1.0)
    assert clock[0] < flown.times[-1] - 5.0
    check_smooth(flown)


@pytest.mark.slow
@pytest.mark.parametrize("when", [4.0, 6.5, 12.0])
def test_abort_stops_safely_and_smoothly(when):
    """On the path, while it is deflected, and beside the obstacle: a rest near by follows."""
    avoided = avoidance([sphere("s", (9.0, 0.0, -5.0)), pole("p", 13.0, 0.5)])
    mission = straight(18.0)
    flown = fly(avoided, mission, when, until_end=False)
    followed, clock = avoided.guidance.stopping_trajectory(when, mission)
    stop = followed.stop(clock)
    avoided.guidance.restart(when, clock)
    before = flown.path[:, -1]
    time, previous, points = when, None, []
    while time < when + 12.0:
        trajectory = avoided.step(time, stop)
        now = trajectory.derivatives(np.array([time, time + STEP]))
        if previous is None:
            # From where it was, as it moved.
            expected = before[0] + STEP * before[1] + STEP**2 / 2 * before[2] + STEP**3 / 6 * before[3]
            np.testing.assert_allclose(now[0, 0], expected, atol=1e-3)
            np.testing.assert_allclose(now[1, 0], before[1] + STEP * before[2] + STEP**2 / 2 * before[3], atol=1e-2)
        else:
            np.testing.assert_allclose(now[:4, 0], previous[:4, 1], atol=1e-6)
        points.append(now[:, 0])
        previous, time = now, round(time + STEP, 6)
    path = np.stack(points, axis=1)
    assert np.linalg.norm(path[1, -1]) < 0.05
    assert np.linalg.norm(path[0, -1] - before[0]) < 6.0
    hull = hull_of(system(), path)
    for _, shape, motion, _ in avoided.safety.obstacles.obstacles:
        place = motion(np.zeros(1))[0]
        assert min(clearance_of(hull[k], shape, place) for k in range(0, path.shape[1], 4)) > MARGIN - 0.05


def test_team_at_rest_evades_approaching_obstacle():
    avoided = avoidance([sphere("m", (6.0, 0.2, -5.0), (-0.8, 0.0, 0.0))])
    rest = RestTrajectory([0.0, 0.0, -5.0], 0.0)
    flown = fly(avoided, rest, 16.0, until_end=False)
    assert min(flown.clearance().values()) >= MARGIN - TOLERANCE
    np.testing.assert_allclose(flown.path[0, -1], [0.0, 0.0, -5.0], atol=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("margin", [0.25, 0.75, 1.0])
def test_commanded_margin_is_kept(margin):
    flown = fly(avoidance([sphere("s", (9.0, 0.2, -5.2))], margin=margin), straight(16.0), 40.0)
    least = flown.clearance()["s"]
    assert margin - TOLERANCE <= least <= margin + 0.35
    check_arrived(flown)


@pytest.mark.slow
@pytest.mark.parametrize("n", [3, 8])
def test_obstacles_are_avoided_with_any_number_of_uavs(n):
    flown = fly(avoidance([sphere("s", (9.0, 0.2, -5.0)), pole("p", 13.0, 3.2)], n=n), straight(17.0), 50.0)
    # The polygons of the rims leave out a little of the discs.
    assert min(flown.clearance().values()) >= MARGIN - TOLERANCE - (0.03 if n > 6 else 0.0)
    check_arrived(flown)
