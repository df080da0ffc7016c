"""Plans of the safety filter from step to step: when they are made and kept, what they return to and report."""

from dataclasses import replace

import numpy as np
import pytest
from avoidance_checks import MARGIN
from avoidance_scene import (
    STEP,
    avoidance,
    estimate_at,
    fly,
    sphere,
    straight,
)  # fmt: skip

from idc_controller.trajectory.trajectory import RestTrajectory


def test_plan_is_kept_for_length_of_a_stage():
    scene, mission = [sphere("s", (3.0, 0.0, -5.0))], straight(16.0)
    avoided = avoidance(scene)
    shapes = []
    for k in range(4):
        time = 1.0 + STEP * k
        ahead = time + np.linspace(0.0, 2.0, 5)
        shapes.append(avoided.step(time, mission))
        if k % 2:
            np.testing.assert_array_equal(shapes[k].derivatives(ahead), shapes[k - 1].derivatives(ahead))
    assert not np.array_equal(shapes[2].derivatives(ahead), shapes[1].derivatives(ahead))
    avoided.guidance.restart(1.2, 1.2)
    other = straight(16.0, 0.5)
    new = avoided.step(1.2, other)
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


def test_past_reference_is_the_tracked_one():
    """Late measurements are compared with the plan tracked then, not with the newest plan."""
    avoided, tracked_past = avoidance([sphere("s", (8.0, 0.0, -5.0))]), {}

    def watch(flown, time):
        tracked_past[round(flown.times[-1], 6)] = flown.derivatives[-1]
        if time > 6.0 and round(time / STEP) % 20 == 0:
            trajectory = avoided.step(time, flown.mission)
            past = time - STEP * np.arange(1, 20)
            expected = np.stack([tracked_past[round(t, 6)] for t in past], axis=1)
            np.testing.assert_allclose(trajectory.derivatives(past), expected, atol=1e-9)

    fly(avoided, straight(16.0), 9.0, watch)


def test_tracking_error_of_payload_increases_distance_of_plan():
    avoided, mission = avoidance([sphere("beside", (1.0, -2.3, -5.0))]), straight(16.0)
    avoided.step(0.0, mission)
    # Within tracking errors it is unchanged.
    near = mission.position(STEP) + np.array([0.0, 0.1, 0.0])
    trajectory = avoided.plan(estimate_at(STEP, near), mission)
    np.testing.assert_array_equal(trajectory.derivatives(np.array([STEP]))[0], mission.derivatives(np.array([STEP]))[0])
    far = mission.position(2 * STEP) + np.array([0.0, 1.15, 0.0])
    trajectory = avoided.plan(estimate_at(2 * STEP, far), mission)
    # No step in what is tracked: the estimator stands on it.
    now = np.array([2 * STEP])
    np.testing.assert_allclose(trajectory.derivatives(now)[0], mission.derivatives(now)[0], atol=1e-9)
    assert avoided.safety.report.active
    ahead = np.array([2 * STEP + 1.0])
    assert (trajectory.derivatives(ahead) - mission.derivatives(ahead))[0, 0, 1] > 0.03


def test_disturbance_leaves_mission_unchanged_without_near_obstacles():
    avoided, mission = avoidance([sphere("far", (50.0, 50.0, -5.0))]), straight(16.0)
    for k in range(40):
        pushed = mission.position(k * STEP) + np.array([0.0, 1.0, 0.0])
        trajectory = avoided.plan(estimate_at(k * STEP, pushed), mission)
    now = np.array([39 * STEP])
    np.testing.assert_array_equal(trajectory.derivatives(now)[0], mission.derivatives(now)[0])
    assert not avoided.safety.report.active


def test_filter_leaves_setpoints_unchanged():
    u = np.arange(12.0)
    assert avoidance([]).safety.correct(0.0, u, estimate_at(0.0, np.zeros(3))) is u


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
        avoided.step(time, mission)
        # A plan is kept for the length of a stage, and its report with it.
        expected = len(solved) - before or (expected if avoided.safety.report.qp_count else 0)
        assert avoided.safety.report.qp_count == expected, time
        counts.append(expected)
    assert len({*counts}) >= 3


def plans(avoided, mission, steps):
    """Reference, trajectory before and trajectory from then on, at every new plan; the payload is on the trajectory."""
    before = None
    for k in range(steps):
        time = STEP * k
        reference = avoided.guidance.reference(time, mission)
        now = avoided.step(time, mission)
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
        assert avoided.safety.report.lag == pytest.approx(max(behind, 0.0), abs=1e-9), time
        lags.append(avoided.safety.report.lag)
    assert max(lags) > 0.1


def test_lag_of_a_team_that_is_to_rest_is_its_horizontal_distance_from_there():
    avoided, lags = avoidance([sphere("m", (4.0, 0.5, -5.0), (-1.0, 0.0, 0.0))]), []
    rest = RestTrajectory([0.0, 0.0, -5.0], 0.0)
    for time, _, before, _ in plans(avoided, rest, 60):
        lags.append(avoided.safety.report.lag)
        assert lags[-1] == pytest.approx(np.hypot(*before.derivatives(np.array([time]))[0, 0, :2]), abs=1e-9)
    assert max(lags) > 0.3


def test_stop_is_flown_in_place_of_a_plan_that_does_not_keep_the_barrier(monkeypatch):
    """By exact distances both keep the margin, up to the horizon; the plan's slack says that it does not beyond."""
    avoided, mission = avoidance([sphere("s", (8.0, 0.0, -5.0))]), straight(16.0)
    flown = fly(avoided, mission, 3.0)
    planner, end = avoided.safety.planner, flown.times[-1] + 3.0 * STEP + avoided.safety.settings.chain.times[-1:]
    solve = planner.solve

    def with_slack(start, reference, *others):
        plan = solve(start, reference, *others)
        return replace(plan, slack=0.3) if reference[1].any() else plan

    moving = avoided.step(flown.times[-1] + STEP, mission).derivatives(end)
    assert avoided.safety.report.verified and np.linalg.norm(moving[1]) > 0.3
    monkeypatch.setattr(planner, "solve", with_slack)
    stopped = avoided.step(flown.times[-1] + 3.0 * STEP, mission).derivatives(end)
    report = avoided.safety.report
    assert report.qp_count and report.verified and report.slack == 0.3
    assert np.linalg.norm(stopped[1]) < 0.1
