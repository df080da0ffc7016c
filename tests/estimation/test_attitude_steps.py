"""Steps of an attitude without rates: on board the vehicle turns against them, in telemetry alone it does not."""

import numpy as np
import pytest
from estimator_scene import HOVER, LAYOUT, REFERENCE, P, all_samples, started

from idc_controller.estimation.health.attitude_steps import AttitudeStep, AttitudeSteps, step_response
from idc_controller.estimation.measurements import Attitude, MeasurementNoise
from idc_controller.estimation.settings import AttitudeStepSettings
from idc_controller.rotations_float import attitude_of_direction

PERIOD, ONSET, UAV = 0.04, 0.99, 2  # s
ANGLE = np.array([0.1, -0.08])
NOISE = MeasurementNoise()


def attitude(time, n, n_dot, rng, noise=1.0, uav=UAV):
    """Return what a vehicle with a thrust direction ``n`` (2,) and its derivative measures."""
    n = n + rng.normal(0.0, noise * NOISE.attitude, 2)
    turn = attitude_of_direction((*n, -np.sqrt(1.0 - n @ n)))
    return Attitude(time, uav, np.array(turn), np.array([n_dot[1], -n_dot[0], 0.0]) + rng.normal(0.0, 0.005, 3))


def found(step=ANGLE, on_board=True, lasts=np.inf, swing=0.0, noise=1.0, seconds=2.0, seed=1, lost=()):
    """Return the detector and what it has found: of a vehicle that swings, with a ``step`` at the onset.

    ``lost``: samples (of the 25 a second) that do not arrive.
    """
    steps, rng, confirmed = AttitudeSteps(P, NOISE, AttitudeStepSettings()), np.random.default_rng(seed), []
    rate = lambda t: swing * np.array([np.sin(5.0 * t), 0.0])  # noqa: E731
    for k in range(round(seconds / PERIOD)):
        if k in lost:
            continue
        time = PERIOD * k
        n, n_dot = -swing / 5.0 * np.array([np.cos(5.0 * time), 0.0]), rate(time)
        if ONSET < time < ONSET + lasts:
            turned, rate_of_turn, _ = step_response(P, time - ONSET)
            n = n + step * (1.0 + turned * on_board)
            n_dot = n_dot + step * rate_of_turn * on_board
        steps.add(attitude(time, n, n_dot, rng, noise))
        confirmed += steps.confirmed(lambda uav, a, b: rate(b) - rate(a))
    return steps, confirmed


@pytest.mark.parametrize("swing", [0.0, 0.5])
def test_step_that_a_vehicle_flies_by_is_found_with_its_angle(swing):
    steps, (step,) = found(swing=swing)
    assert step.uav == UAV and step.time == pytest.approx(1.0) and step.interval == pytest.approx(PERIOD)
    assert step.angle == pytest.approx(ANGLE, abs=0.025)
    assert steps.total[UAV] == pytest.approx(step.angle)


@pytest.mark.parametrize("swing", [0.0, 0.5])
@pytest.mark.parametrize("lost", [(24, 25), (25, 26, 27), (26, 27), (25, 26, 28), (24, 25, 26, 27)])
def test_step_is_found_where_samples_about_it_are_lost(swing, lost):
    _, (step,) = found(swing=swing, lost=lost)
    assert step.angle == pytest.approx(ANGLE, abs=0.03)
    assert not found(swing=swing, lost=lost, on_board=False)[1]


@pytest.mark.parametrize("swing", [0.0, 0.5])
def test_step_in_telemetry_alone_is_none_that_a_vehicle_flies_by(swing):
    steps, confirmed = found(on_board=False, swing=swing)
    assert not confirmed
    assert steps.total[UAV] == pytest.approx(ANGLE, abs=0.025)  # whatever it is, nothing takes off by it


def test_spike_of_one_sample_is_no_step():
    steps, confirmed = found(lasts=0.04)
    assert not confirmed
    assert np.linalg.norm(steps.total[UAV]) < 0.025


def test_outlier_of_one_sample_leaves_no_sum_behind():
    sums = [
        np.linalg.norm(found(0.06 * ANGLE / np.linalg.norm(ANGLE), lasts=0.04, seed=k)[0].total[UAV]) for k in range(40)
    ]
    assert max(sums) < 0.025


def test_attitude_that_repeats_itself_while_the_vehicle_turns_is_no_step():
    steps, rng, stuck = AttitudeSteps(P, NOISE, AttitudeStepSettings()), np.random.default_rng(1), np.zeros(4)
    for k in range(75):
        time = PERIOD * k
        n, n_dot = np.array([0.1 * np.sin(2.0 * time), 0.0]), np.array([0.2 * np.cos(2.0 * time), 0.0])
        sample = attitude(time, n, n_dot, rng)
        if 1.0 < time < 2.0:
            sample = Attitude(time, UAV, stuck, sample.motion)
        stuck = sample.pose
        steps.add(sample)
    assert np.linalg.norm(steps.total[UAV]) < 0.025


@pytest.mark.parametrize("noise", [1.0, 5.0])
def test_noise_is_no_step(noise):
    _, confirmed = found(step=np.zeros(2), noise=noise, seconds=400.0)
    assert not confirmed


def test_blow_that_turns_a_vehicle_is_no_step_of_its_attitude():
    steps, rng = AttitudeSteps(P, NOISE, AttitudeStepSettings()), np.random.default_rng(1)
    for k in range(16):
        after = max(PERIOD * k - 0.39, 0.0)
        steps.add(attitude(PERIOD * k, 3.0 * after * np.array([1.0, 0.0]), np.array([3.0 * (after > 0.0), 0.0]), rng))
        assert not steps.confirmed(lambda uav, a, b: np.zeros(2))


@pytest.mark.parametrize("others", [-0.003, -0.001, 0.001, 0.003])
def test_estimator_takes_a_step_once_however_moments_lie_about_it(others):
    estimator, rng = started(), np.random.default_rng(1)
    for k in range(1, 26):
        for sample in all_samples(PERIOD * k, rng):
            time = sample.time + others * (sample.source != UAV)
            estimator.add(type(sample)(time, sample.source, sample.pose, sample.motion))
    before = estimator.estimate(PERIOD * k + 0.01, REFERENCE)
    estimator.take_attitude_step(AttitudeStep(UAV, PERIOD * k, PERIOD, ANGLE, 0.01))
    after = estimator.estimate(PERIOD * k + 0.01, REFERENCE)
    force = after.uav_force[UAV, :2] - before.uav_force[UAV, :2]
    assert force == pytest.approx(-P.hover_thrust[UAV] * ANGLE, rel=0.3)


def test_estimator_takes_a_step_for_a_force_of_the_vehicle_and_goes_on_with_its_attitude():
    estimator, rng = started(), np.random.default_rng(1)
    for k in range(1, 76):
        time = PERIOD * k
        for sample in all_samples(time, rng):
            if isinstance(sample, Attitude) and sample.source == UAV:
                n, n_dot = np.zeros(2), np.zeros(2)
                if time > ONSET:
                    turned, rate, _ = step_response(P, time - ONSET)
                    n, n_dot = ANGLE * (1.0 + turned), ANGLE * rate
                sample = attitude(time, n, n_dot, rng)
            elif sample.source == UAV:
                continue  # its position is lost
            estimator.attitude_steps.add(sample)
            estimator.add(sample)
        estimate = estimator.estimate(time, REFERENCE)
        for step in estimator.new_attitude_steps():
            assert isinstance(step, AttitudeStep)
            estimator.take_attitude_step(step)
            estimate = estimator.estimate(time, REFERENCE)
            assert estimate.uav_force[UAV, :2] == pytest.approx(-P.hover_thrust[UAV] * ANGLE, abs=0.4)
        if ONSET + 0.1 < time < ONSET + 0.3:
            assert not any((UAV, Attitude) in record.rejected for record in estimate.innovations)
    assert estimate.x[LAYOUT.r_0] == pytest.approx(HOVER, abs=0.1)


@pytest.mark.parametrize("on_board", [True, False])
def test_drift_of_an_attitude_is_what_it_turns_without_rates(on_board):
    """On board the vehicle keeps its attitude as it reports it, and its rates show how it turns against the drift."""
    rng, steps = np.random.default_rng(3), AttitudeSteps(P, NOISE, AttitudeStepSettings())
    rate, swing = np.array([0.03, -0.02]), 0.3
    for k in range(1500):
        time = PERIOD * k
        drift, n_dot = rate * max(time - 58.0, 0.0), swing * np.array([np.sin(5.0 * time), 0.0])
        n = -swing / 5.0 * np.array([np.cos(5.0 * time), 0.0]) + (not on_board) * drift
        steps.add(attitude(time, n, n_dot - on_board * rate * (time > 58.0), rng))
        if time < 58.0:
            assert np.abs(steps.drift).max() < 0.035
    assert steps.drift[UAV] == pytest.approx(2.0 * rate, abs=0.025)
