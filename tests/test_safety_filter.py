"""The safety filter flown kinematically: what it must do in each situation, and on random scenes."""

import numpy as np
import pytest
from avoidance_scene import (
    STEP,
    Scene,
    avoidance,
    clearance_of,
    estimate_at,
    fly,
    hull_of,
    pole,
    sphere,
    straight,
    swinging,
    wall,
)  # fmt: skip
from paper_system import system

from idc_controller.safety.safety_filter import NEGLIGIBLE
from idc_controller.safety.settings import PlannerSettings
from idc_controller.trajectory.trajectory import RestTrajectory

MARGIN = 0.5
TOLERANCE = 0.02
"""m: rows hold at the stages, and for a hull that shears linearly."""
SETTINGS = PlannerSettings()


def check_smooth(flown, crackle=150.0):
    """One plan follows another without a step up to snap, and nothing is wilder than the plant can follow."""
    seams = np.max(flown.seams, axis=0)
    # A deviation that has become negligible is dropped.
    assert np.all(seams < 1.01 * NEGLIGIBLE), seams
    path = flown.path
    assert np.linalg.norm(path[2, :, :2], axis=1).max() <= SETTINGS.acceleration_limit[0] + 0.3
    assert np.abs(path[2, :, 2]).max() <= SETTINGS.acceleration_limit[2] + 0.1
    assert np.abs(np.diff(path[4], axis=0)).max() < crackle * STEP
    # The derivatives agree with differences of the position.
    np.testing.assert_allclose((path[0, 2:] - path[0, :-2]) / (2 * STEP), path[1, 1:-1], atol=0.02)


def check_arrived(flown, within=0.02):
    assert np.isfinite(flown.ends_at)
    end = flown.mission.position(flown.mission.end)
    np.testing.assert_allclose(flown.path[0, -1], end, atol=within)


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
@pytest.mark.parametrize("name", ROUND)
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
    assert np.abs(np.diff(rates)).max() <= 0.051 + 1e-9
    assert flown.avoidance.guidance.blocked(flown.times[-1]) == ""


def test_wide_gap_is_flown_through():
    flown = fly(avoidance([pole("a", 9.0, -2.2), pole("b", 9.0, 2.2)]), straight(16.0), 40.0)
    clearance = flown.clearance()
    assert min(clearance.values()) >= MARGIN - TOLERANCE
    check_arrived(flown)
    at = int(np.argmin(np.abs(flown.path[0, :, 0] - 9.0)))
    assert abs(flown.path[0, at, 1]) < 0.5
    assert flown.avoidance.guidance.detours == 0


@pytest.mark.slow
def test_blocked_path_ends_in_safe_stop_with_reason():
    flown = fly(avoidance([wall("the wall", 9.0, 0.0, (0.3, 300.0, 40.0))]), straight(14.0), 26.5)
    assert min(flown.clearance().values()) >= MARGIN - TOLERANCE
    assert np.isnan(flown.ends_at)
    assert "the wall" in flown.avoidance.guidance.blocked(26.5)
    assert np.linalg.norm(flown.path[1, -1]) < 0.05
    assert flown.rates[-1] < 0.1
    assert flown.reports[-1].lag > 1.0
    check_smooth(flown)


def test_plan_is_kept_for_length_of_a_stage():
    scene, mission = [sphere("s", (3.0, 0.0, -5.0))], straight(16.0)
    avoided = avoidance(scene)
    shapes = []
    for k in range(4):
        time = 1.0 + STEP * k
        ahead = time + np.linspace(0.0, 2.0, 5)
        shapes.append(avoided.step(time, mission, estimate_at(time, mission.position(time))))
        if k % 2:
            np.testing.assert_array_equal(shapes[k].derivatives(ahead), shapes[k - 1].derivatives(ahead))
    assert not np.array_equal(shapes[2].derivatives(ahead), shapes[1].derivatives(ahead))
    avoided.guidance.restart(1.2, 1.2)
    other = straight(16.0, 0.5)
    new = avoided.step(1.2, other, estimate_at(1.2, other.position(1.2)))
    assert not np.array_equal(new.derivatives(ahead), shapes[3].derivatives(ahead))


def test_filter_is_inactive_without_near_obstacles():
    mission = straight(16.0)
    flown = fly(avoidance([sphere("s", (8.0, 12.0, -5.0))]), mission, 30.0)
    np.testing.assert_array_equal(flown.path, mission.derivatives(np.array(flown.times)))
    assert not any(r.active or r.qp_count for r in flown.reports)
    assert set(flown.rates) == {1.0}


def test_deviation_returns_to_exactly_zero():
    mission = straight(30.0)
    flown = fly(avoidance([sphere("s", (8.0, 0.0, -5.0))]), mission, 30.0)
    active = np.array([r.active for r in flown.reports])
    last = int(np.flatnonzero(active)[-1])
    assert last < len(active) - 20
    after = np.array(flown.times)[last + 1 :]
    np.testing.assert_array_equal(flown.path[:, last + 1 :], mission.derivatives(after))
    # Soon after the sphere is behind the payload is back to a decimetre.
    behind = int(np.argmax(flown.path[0, :, 0] > 8.0 + 0.5 + 0.8 + MARGIN))
    four_seconds = behind + int(4.0 / STEP)
    off = np.linalg.norm(flown.path[0] - mission.derivatives(np.array(flown.times), 0)[0], axis=1)
    assert off[four_seconds:].max() < 0.1
    assert off.max() > 0.5


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


def test_past_reference_is_the_tracked_one():
    """Late measurements are compared with the plan tracked then, not with the newest plan."""
    avoided, tracked_past = avoidance([sphere("s", (8.0, 0.0, -5.0))]), {}

    def watch(flown, time):
        tracked_past[round(flown.times[-1], 6)] = flown.derivatives[-1]
        if time > 6.0 and round(time / STEP) % 20 == 0:
            trajectory = avoided.step(time, flown.mission, estimate_at(time, flown.derivatives[-1][0]))
            past = time - STEP * np.arange(1, 20)
            expected = np.stack([tracked_past[round(t, 6)] for t in past], axis=1)
            np.testing.assert_allclose(trajectory.derivatives(past), expected, atol=1e-9)

    fly(avoided, straight(16.0), 9.0, watch)


def test_tracking_error_of_payload_increases_distance_of_plan():
    avoided, mission = avoidance([sphere("beside", (1.0, -2.3, -5.0))]), straight(16.0)
    avoided.step(0.0, mission, estimate_at(0.0, mission.position(0.0)))
    # Within tracking errors it is unchanged.
    near = mission.position(STEP) + np.array([0.0, 0.1, 0.0])
    trajectory = avoided.step(STEP, mission, estimate_at(STEP, near))
    np.testing.assert_array_equal(trajectory.derivatives(np.array([STEP]))[0], mission.derivatives(np.array([STEP]))[0])
    far = mission.position(2 * STEP) + np.array([0.0, 1.15, 0.0])
    trajectory = avoided.step(2 * STEP, mission, estimate_at(2 * STEP, far))
    # No step in what is tracked: the estimator stands on it.
    now = np.array([2 * STEP])
    np.testing.assert_allclose(trajectory.derivatives(now)[0], mission.derivatives(now)[0], atol=1e-9)
    assert avoided.report.active
    ahead = np.array([2 * STEP + 1.0])
    assert (trajectory.derivatives(ahead) - mission.derivatives(ahead))[0, 0, 1] > 0.03


def test_disturbance_leaves_mission_unchanged_without_near_obstacles():
    avoided, mission = avoidance([sphere("far", (50.0, 50.0, -5.0))]), straight(16.0)
    for k in range(40):
        pushed = mission.position(k * STEP) + np.array([0.0, 1.0, 0.0])
        trajectory = avoided.step(k * STEP, mission, estimate_at(k * STEP, pushed))
    now = np.array([39 * STEP])
    np.testing.assert_array_equal(trajectory.derivatives(now)[0], mission.derivatives(now)[0])
    assert not avoided.report.active


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
    position, points = before[0], []
    time, previous = when, None
    while time < when + 12.0:
        trajectory = avoided.step(time, stop, estimate_at(time, position))
        now = trajectory.derivatives(np.array([time, time + STEP]))
        if previous is None:
            # From where it was, as it moved.
            expected = before[0] + STEP * before[1] + STEP**2 / 2 * before[2] + STEP**3 / 6 * before[3]
            np.testing.assert_allclose(now[0, 0], expected, atol=1e-3)
            np.testing.assert_allclose(now[1, 0], before[1] + STEP * before[2] + STEP**2 / 2 * before[3], atol=1e-2)
        else:
            np.testing.assert_allclose(now[:4, 0], previous[:4, 1], atol=1e-6)
        points.append(now[:, 0])
        position, previous, time = now[0, 1], now, round(time + STEP, 6)
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


def test_filter_leaves_setpoints_unchanged():
    u = np.arange(12.0)
    assert avoidance([]).safety.correct(0.0, u, estimate_at(0.0, np.zeros(3))) is u


def random_scene(rng):
    """Obstacles about a path of 20 m, none at its ends; moving ones slow enough to be detected in time."""
    obstacles = []
    for i in range(rng.integers(1, 4)):
        north, east = rng.uniform(5.5, 14.0), rng.uniform(-2.5, 2.5)
        kind = rng.choice(["sphere", "moving", "swinging", "pole", "wall"])
        name = f"{kind} {i}"
        if kind == "sphere":
            obstacles.append(sphere(name, (north, east, rng.uniform(-8.5, -4.0)), radius=rng.uniform(0.3, 0.7)))
        elif kind == "moving":
            heading, speed = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(0.3, 1.0)
            velocity = speed * np.array([np.cos(heading), np.sin(heading), 0.0])
            meets = rng.uniform(5.0, 9.0)
            place = np.array([north, east, rng.uniform(-8.0, -4.5)]) - meets * velocity
            if np.linalg.norm(place[:2]) > 3.5:
                obstacles.append(sphere(name, place, velocity))
        elif kind == "swinging":
            swing = rng.uniform(-1.2, 1.2, 3) * [1.0, 1.0, 0.3]
            obstacles.append(swinging(name, (north, east, -5.5), swing, 0.8, rng.uniform(0.0, 6.0)))
        elif kind == "pole":
            obstacles.append(pole(name, north, east, rng.uniform(0.15, 0.4)))
        else:
            size = (0.3, rng.uniform(1.0, 4.0), rng.uniform(2.0, 13.0))
            obstacles.append(wall(name, north, east, size, rng.uniform(-0.6, 0.6)))
    return obstacles


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_random_scene_is_never_entered(seed):
    rng = np.random.default_rng([seed, 5])
    obstacles = random_scene(rng)
    flown = fly(avoidance(obstacles), straight(20.0), 45.0)
    # What the filter says of its slack is what it costs at most.
    assert min(flown.clearance(every=3).values(), default=np.inf) >= MARGIN - TOLERANCE - flown.slack
    assert flown.slack < 0.15
    check_smooth(flown, crackle=250.0)
    if not any("moving" in o[0] or "swinging" in o[0] for o in obstacles):
        check_arrived(flown, 0.05)


def test_equal_scenes_give_equal_flights():
    paths = []
    for _ in range(2):
        obstacles = random_scene(np.random.default_rng([3, 5]))
        paths.append(fly(avoidance(obstacles), straight(12.0), 12.0).path)
    np.testing.assert_array_equal(paths[0], paths[1])


def test_scene_predicts_positions_at_several_times():
    """Helper of the tests: obstacles at several moments."""
    (predicted,) = Scene([swinging("s", (1.0, 2.0, 3.0), (0.5, 0.0, 0.0))]).predict(np.array([0.0, np.pi / 2]))
    np.testing.assert_allclose(predicted.positions, [[1.0, 2.0, 3.0], [1.5, 2.0, 3.0]])


def test_number_of_qps_reported_is_that_of_those_solved(monkeypatch):
    mission, avoided = straight(16.0), avoidance([sphere("s", (5.0, 0.3, -5.0))])
    planner, solved = avoided.safety.planner, []
    solve = planner.solve

    def watched(start, ahead, planes, *others):
        if planes:  # without, it is the return to the reference, no avoidance
            solved.append(len(planes))
        return solve(start, ahead, planes, *others)

    monkeypatch.setattr(planner, "solve", watched)
    counts, expected = [], 0
    for k in range(80):
        time, before = STEP * k, len(solved)
        avoided.step(time, mission, estimate_at(time, mission.position(time)))
        # A plan is kept for the length of a stage, and its report with it.
        expected = len(solved) - before or (expected if avoided.report.qp_count else 0)
        assert avoided.report.qp_count == expected, time
        counts.append(expected)
    assert len({*counts}) >= 3


def plans(avoided, mission, steps):
    """Reference, trajectory before and trajectory from then on, at every new plan; the payload is on the trajectory."""
    before = None
    for k in range(steps):
        time = STEP * k
        place = mission.position(time) if before is None else before.derivatives(np.array([time]))[0, 0]
        reference = avoided.guidance.reference(time, mission)
        now = avoided.safety.filter(time, reference, estimate_at(time, place))
        avoided.guidance.observe(now, avoided.report.lag, avoided.report.deviation, None)
        if before is not None and now is not before:
            yield time, reference, before, now
        before = now


def test_lag_is_how_far_the_trajectory_is_behind_its_reference_along_the_path():
    avoided, lags = avoidance([sphere("s", (5.0, 0.3, -5.0))]), []
    for time, reference, before, _ in plans(avoided, straight(16.0), 80):
        at = np.array([time])
        wanted = reference.derivatives(at)[:, 0]
        apart, speed = before.derivatives(at)[0, 0] - wanted[0], np.linalg.norm(wanted[1])
        behind = -apart @ wanted[1] / speed if speed > 0.05 else np.linalg.norm(apart[:2])
        assert avoided.report.lag == pytest.approx(max(behind, 0.0), abs=1e-9), time
        lags.append(avoided.report.lag)
    assert max(lags) > 0.1


def test_lag_of_a_team_that_is_to_rest_is_its_horizontal_distance_from_there():
    avoided, lags = avoidance([sphere("m", (4.0, 0.5, -5.0), (-1.0, 0.0, 0.0))]), []
    rest = RestTrajectory([0.0, 0.0, -5.0], 0.0)
    for time, _, before, _ in plans(avoided, rest, 60):
        lags.append(avoided.report.lag)
        assert lags[-1] == pytest.approx(np.hypot(*before.derivatives(np.array([time]))[0, 0, :2]), abs=1e-9)
    assert max(lags) > 0.3


def test_plan_in_force_goes_on_where_no_other_is_found(monkeypatch):
    """It is flown to its end, and the report says that there was no solution."""
    avoided = avoidance([sphere("s", (5.0, 0.3, -5.0))])
    horizon = avoided.safety.settings.chain.times[-1]
    made = plans(avoided, straight(16.0), 100)
    time, _, _, last = next(plan for plan in made if plan[0] > 1.5)
    assert avoided.report.active and not avoided.report.infeasible
    monkeypatch.setattr(avoided.safety.planner, "solve", lambda *arguments: None)
    # The reference may go on at another rate: what is kept is the deviation from it.
    ahead = time + np.linspace(0.3, 0.95 * horizon, 9)
    first = avoided.safety._pieces[-1].reference
    kept = (last.derivatives(ahead) - first.derivatives(ahead))[:3]
    assert np.abs(kept[0]).max() > 0.05
    for _ in range(2):
        time, reference, _, now = next(made)
        assert avoided.report.infeasible and avoided.report.active and avoided.report.nearest == "s"
        np.testing.assert_allclose((now.derivatives(ahead) - reference.derivatives(ahead))[:3], kept, atol=1e-6)
