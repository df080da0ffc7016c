"""Stop plans: they take over the reference's motion and end at rest, all UAVs in their places."""

import numpy as np
import pytest
from braking_path import path_of
from scipy.interpolate import BPoly

from gcs.config import read_system
from idc_controller.model.linear import StateLayout
from idc_controller.trajectory.flatness import Load, flat_reference
from idc_controller.trajectory.lissajous import LissajousCurve, LissajousTrajectory
from idc_controller.trajectory.settings import Limits
from idc_controller.trajectory.stop_plan import Braking, Descent, stop_plan
from idc_controller.trajectory.trajectory import RestTrajectory
from vehicle_sim.autopilot.hold_control import HoldPlan

PARAMETERS = read_system().parameters()
LIMITS = Limits(20.0, 6.0, 20.0, 80.0)
LOAD = Load(PARAMETERS.m_0, np.zeros(3))


def uav_positions(curve, times):
    flat = flat_reference(PARAMETERS, curve, np.asarray(times), LOAD)
    links = PARAMETERS.l[:, None] * flat.links.q[:, None, :]
    return flat.payload[0][:, None, :] + PARAMETERS.p - links


@pytest.mark.parametrize("time", [11.0, 13.7, 18.2])
def test_stop_plan_starts_with_current_motion_and_ends_at_rest(time):
    curve = LissajousTrajectory(LissajousCurve((6.0, 3.0), -2.5), 0.5, 40.0, LIMITS, start=10.0)
    flat = flat_reference(PARAMETERS, curve, np.array([time]), LOAD)
    plan = stop_plan(PARAMETERS, flat, time)
    h = 0.01
    before, here, after = uav_positions(curve, [time - h, time, time + h])
    for i, points in enumerate(plan.control_points):
        path = BPoly(points[:, None, :], [0.0, plan.duration])
        assert path(0.0) == pytest.approx(here[i], abs=1e-9)
        assert path.derivative()(0.0) == pytest.approx((after[i] - before[i]) / (2 * h), abs=2e-3)
        assert path.derivative(2)(0.0) == pytest.approx((after[i] - 2 * here[i] + before[i]) / h**2, abs=5e-3)
        assert path.derivative()(plan.duration) == pytest.approx(0.0, abs=1e-9)
        assert path.derivative(2)(plan.duration) == pytest.approx(0.0, abs=1e-9)
    # All of them are moved alike, so the payload stays level.
    places = plan.control_points[:, -1] - plan.control_points[0, -1]
    assert places == pytest.approx(PARAMETERS.p - PARAMETERS.p[0], abs=1e-6)


@pytest.mark.parametrize("time", [11.0, 13.7, 18.2])
def test_resting_place_is_predicted_with_swinging_payload(time):
    """The braking function receives the predicted position of the payload, not its own motion."""
    curve = LissajousTrajectory(LissajousCurve((6.0, 3.0), -2.5), 0.6, 40.0, LIMITS, start=10.0)
    flat = flat_reference(PARAMETERS, curve, np.array([time]), LOAD)
    states = []

    def choose(when, state):
        states.append(state)
        return Braking(1.3, (0.8, 0.0, 0.0))

    plan = stop_plan(PARAMETERS, flat, time, choose=choose)
    predicted = path_of(Braking(1.3, (0.8, 0.0, 0.0)), states[0])(plan.duration)
    hangs = plan.control_points[:, -1] - PARAMETERS.p + PARAMETERS.l[:, None] * [0.0, 0.0, 1.0]
    assert hangs == pytest.approx(np.tile(predicted, (PARAMETERS.number_of_uavs, 1)), abs=1e-6)
    times = np.array([0.0, 0.3 * plan.duration, plan.duration, plan.duration + 1.0])
    path = path_of(Braking(1.3, (0.8, 0.0, 0.0)), states[0])(np.minimum(times, plan.duration))
    assert plan.payload_positions(PARAMETERS, times) == pytest.approx(path, abs=1e-6)
    own = path_of(Braking(1.3, (0.8, 0.0, 0.0)), flat.payload[:3, 0])(plan.duration)
    assert np.linalg.norm(own - predicted) > 1.0


def test_stop_plan_starts_at_current_positions_and_translates_all_uavs_alike():
    curve = LissajousTrajectory(LissajousCurve((6.0, 3.0), -2.5), 0.5, 40.0, LIMITS, start=10.0)
    flat = flat_reference(PARAMETERS, curve, np.array([13.7]), LOAD)
    layout = StateLayout(PARAMETERS.number_of_uavs)
    x = flat.x[0].copy()
    x[layout.r_0] += (1.5, -0.8, 0.2)
    x[layout.v_0] += (0.3, 0.0, 0.0)
    x[layout.s] += np.tile([0.1, 0.0], 4)  # each link leans: its UAV is l_i s_i farther south
    x[layout.s][0] += 0.05  # one more than the others: it is not left behind
    usual, plan = stop_plan(PARAMETERS, flat, 13.7), stop_plan(PARAMETERS, flat, 13.7, x)
    moved = plan.control_points - usual.control_points
    link = PARAMETERS.l[0]
    assert moved[:, 0] == pytest.approx(np.tile([1.5 - link * (0.1 + 0.05 / 4), -0.8, 0.2], (4, 1)))
    path = BPoly(plan.control_points[0][:, None, :], [0.0, plan.duration])
    before = BPoly(usual.control_points[0][:, None, :], [0.0, usual.duration])
    assert path.derivative()(0.0) - before.derivative()(0.0) == pytest.approx([0.3, 0.0, 0.0], abs=1e-9)
    places = plan.control_points[:, -1] - plan.control_points[0, -1]
    assert places == pytest.approx(PARAMETERS.p - PARAMETERS.p[0], abs=1e-6)
    # What is not known is not reckoned with.
    x[layout.r_0] = np.nan
    assert stop_plan(PARAMETERS, flat, 13.7, x).control_points == pytest.approx(usual.control_points)


@pytest.mark.parametrize("sinking", [0.0, 0.3, 0.55, 0.8, -0.4])
@pytest.mark.parametrize("left", [0.0, 0.2, 1.0, 3.0, 6.0])
def test_descent_that_begins_while_the_payload_is_braked_adds_nothing_to_its_speed(sinking, left):
    flat = flat_reference(PARAMETERS, RestTrajectory(np.array([1.0, 2.0, -5.0]), 0.0), np.array([5.0]), LOAD)
    x = flat.x[0].copy()
    x[5] = sinking
    plan = stop_plan(PARAMETERS, flat, 5.0, x)
    points = tuple(tuple(point) for point in plan.control_points[0].tolist())
    flown = HoldPlan(plan.start, plan.duration, points, 0.0, 5.0 + left, 0.5, 1.0)
    step = 0.01
    states = [flown.at(5.0 + step * k) for k in range(1000)]
    speeds = np.array([state.velocity[2] for state in states])
    assert speeds[0] == pytest.approx(sinking)
    assert min(sinking, 0.0) - 1e-9 <= speeds.min() and speeds.max() <= max(sinking, 0.5) + 1e-9
    assert speeds[-1] == pytest.approx(0.5)
    # Position and acceleration are those of the velocity.
    z = np.array([state.position[2] for state in states])
    assert np.diff(z) == pytest.approx(step * (speeds[1:] + speeds[:-1]) / 2.0, abs=1e-4)
    a_z = np.array([state.acceleration[2] for state in states])
    assert np.abs(np.diff(speeds) - step * (a_z[1:] + a_z[:-1]) / 2.0).sum() < 0.02


@pytest.mark.parametrize(("sinking", "starts_with"), [(0.0, 0.0), (0.3, 0.3), (0.8, 0.8), (-0.4, -0.4)])
def test_landing_goes_on_from_its_speed_to_that_of_the_descent(sinking, starts_with):
    flat = flat_reference(PARAMETERS, RestTrajectory(np.array([1.0, 2.0, -0.5]), 0.0), np.array([5.0]), LOAD)
    x = flat.x[0].copy()
    x[5] = sinking
    descent = Descent(0.5, 1.0)
    plan = stop_plan(PARAMETERS, flat, 5.0, x, landing=descent)
    points = tuple(tuple(point) for point in plan.control_points[0].tolist())
    flown = HoldPlan(plan.start, plan.duration, points, 0.0, plan.descent, descent.speed, descent.ramp)
    place = flat.payload[0, 0] + PARAMETERS.p[0] - [0.0, 0.0, PARAMETERS.l[0]]
    assert flown.at(5.0).position == pytest.approx(place)
    assert flown.at(5.0).velocity == pytest.approx([0.0, 0.0, starts_with])
    speeds = [flown.at(5.0 + 0.1 * k).velocity[2] for k in range(100)]
    assert speeds[-1] == pytest.approx(descent.speed)
    between = min(sinking, descent.speed), max(sinking, descent.speed)
    assert between[0] - 1e-9 <= min(speeds) and max(speeds) <= between[1] + 1e-9
