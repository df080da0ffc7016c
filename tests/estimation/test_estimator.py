"""Estimator: order, delay and relays of measurements, missing ones, set-points and the held payload."""

from dataclasses import replace

import numpy as np
import pytest
from estimator_scene import HOVER, INTERVAL, LAYOUT, MODEL, REFERENCE, P, all_samples, run, sample, samples_of, started

from idc_controller.estimation.estimator import Estimator
from idc_controller.estimation.measurements import PAYLOAD, Position
from idc_controller.estimation.settings import EstimatorSettings
from idc_controller.trajectory.flatness import Load, Reference


def test_estimate_is_independent_of_order_of_arrival():
    moments = samples_of(1.0)
    _, in_order, _ = run(moments)
    rng = np.random.default_rng(2)
    # Each up to 0.2 s late; in the last fifth of a second all are in time.
    late = lambda k, samples: [(k + (rng.integers(0, 10) if k < 35 else 0), s) for s in samples]  # noqa: E731
    _, shuffled, _ = run(moments, late)
    assert shuffled.x == pytest.approx(in_order.x, abs=1e-9)
    assert shuffled.covariance == pytest.approx(in_order.covariance, abs=1e-12)


def test_estimate_is_independent_of_delay_of_measurement():
    moments = samples_of(0.6)
    _, in_time, _ = run(moments)
    _, late, _ = run(moments, lambda k, samples: [(min(k + 12, 29), s) for s in samples])
    assert late.x == pytest.approx(in_time.x, abs=1e-9)


def test_estimator_discards_measurement_older_than_history():
    estimator, _, _ = run(samples_of(2.0))
    assert estimator.add(sample(0, Position, 0.5)) is None
    assert estimator.add(sample(0, Position, 1.5)) is not None


def test_covariance_of_force_is_that_of_whole_state():
    estimator, _, _ = run(samples_of(0.5))
    estimator.setpoints.add(0.55, REFERENCE.at(np.array([0.55])).u[0])
    force = slice(LAYOUT.size, LAYOUT.size + 3)
    for time in (0.5, 0.7):
        estimate = estimator.estimate(time, REFERENCE)
        assert (estimate.force_covariance == estimate.covariance[force, force]).all()
        assert estimate.force_covariance[0, 0] > 0.0


def test_variances_of_payload_are_those_of_whole_state():
    estimator, _, _ = run(samples_of(0.5))
    u = REFERENCE.at(np.array([0.55])).u[0]
    for time, switches in ((0.5, ()), (0.7, ()), (0.9, (0.55, 0.62))):
        for switch in switches:  # which a vehicle may not have received
            estimator.setpoints.add(switch, u + 0.1)
        estimate = estimator.estimate(time, REFERENCE)
        assert estimate.predict_payload_variances() == pytest.approx(estimate.covariance.diagonal()[:12], rel=1e-9)


@pytest.mark.parametrize(("missing", "tested"), [((True, False), [False, True]), ((False, True), [True, False])])
def test_test_ratio_of_channel_that_is_not_measured_is_nan(missing, tested):
    estimator = started()
    for each in all_samples(INTERVAL, np.random.default_rng(5)):
        estimator.add(each.without(*missing) if (each.source, type(each)) == (2, Position) else each)
    [innovation] = estimator.estimate(INTERVAL, REFERENCE).innovations
    ratios = dict(zip(innovation.keys, innovation.test_ratios, strict=True))
    assert np.isfinite(ratios.pop((2, Position))).tolist() == tested
    assert len(ratios) == 9 and all((ratio > 0.0).all() and (ratio < 1.0).all() for ratio in ratios.values())


def test_covariance_grows_with_missing_measurements():
    moments = samples_of(2.0)
    rng = np.random.default_rng(3)
    _, full, innovations = run(moments)
    _, half, _ = run(moments, lambda k, samples: [(k, s) for s in samples if rng.random() < 0.5])
    _, without_two, _ = run(moments, lambda k, samples: [(k, s) for s in samples if s.source != 2])
    for estimate in (half, without_two):
        sigma = np.sqrt(np.diag(estimate.covariance))[: LAYOUT.size]
        truth = REFERENCE.at(np.zeros(1)).x[0]
        assert np.all(np.abs(estimate.x - truth) < 5.0 * sigma + 1e-9)
        # A vehicle that is not measured gets no process noise of its disturbance force either.
        unsure, sure = (np.diag(e.covariance)[: LAYOUT.size] for e in (estimate, full))
        assert np.all(unsure >= sure * (1.0 - 1e-9))
    assert len(innovations) == 100


@pytest.mark.parametrize(
    ("noise", "part"),
    [
        ("payload_acceleration", "v_0"), ("payload_angular_acceleration", "omega"), ("link_acceleration", "s_dot"),
        ("uav_jerk", "n_acc"), ("thrust", "f"),
    ],
)  # fmt: skip
def test_process_noise_of_each_part_widens_its_covariance_by_its_density(noise, part):
    """White noise of density d adds d^2 t to the variance, while t is too short for anything else."""
    time, variances = 0.002, []
    for density in (0.0, 2.0):
        process = replace(EstimatorSettings().process, **{noise: density})
        estimator = started(replace(EstimatorSettings(), process=process))
        variances.append(np.diag(estimator.estimate(time, REFERENCE).covariance)[getattr(LAYOUT, part)])
    assert variances[1] - variances[0] == pytest.approx(2.0**2 * time, rel=0.15)


class Planned:
    """A plan whose snap (m/s4) is linear between knots 0.1 s apart: its kinks are within the flat map's stencil."""

    KNOTS = np.array([0.0, 6.0, -6.0, 6.0, -6.0, 6.0, -6.0, 6.0, 0.0, 0.0])

    def derivatives(self, times, order=4):
        fine = np.arange(0.0, 0.9, 1e-4)
        columns = [np.interp(fine, 0.1 * np.arange(10), self.KNOTS)]
        for _ in range(4):
            columns.append(np.append(0.0, np.cumsum((columns[-1][1:] + columns[-1][:-1]) * 0.5e-4)))
        result = np.zeros((order + 1, len(times), 3))
        for o in range(order + 1):
            result[o, :, 0] = np.interp(times - 1.0, fine, columns[4 - o])
        result[0] += HOVER
        return result


@pytest.mark.parametrize("begin", [1.1, 1.13, 1.25])
def test_attitudes_and_thrusts_follow_from_setpoints_whatever_kinks_the_plan_has(begin):
    reference = Reference(P, Planned(), Load(P.m_0, np.zeros(3)))
    # As the controller takes them: those of the reference in the middle of the 0.05 s for which they are held.
    u = reference.at(begin + 0.025 + 0.05 * np.arange(6)).u
    x = reference.at(np.array([begin])).x[0]
    estimator = Estimator(MODEL)
    estimator.start(begin, x)
    for k, setpoints in enumerate(u):
        estimator.setpoints.add(begin + 0.05 * k, setpoints)
        A, B, _ = MODEL.discretised(50_000)
        x = A @ x + B @ setpoints
    estimated = estimator.estimate(begin + 0.3, reference).x
    for part in (LAYOUT.n, LAYOUT.n_dot, LAYOUT.n_acc, LAYOUT.f):
        assert estimated[part] == pytest.approx(x[part], abs=1e-9)


def test_estimate_is_predicted_without_measurements_and_recovers():
    estimator = started()
    for s in all_samples(INTERVAL):
        estimator.add(s)
    estimate = estimator.estimate(0.9, REFERENCE)
    assert np.all(np.isfinite(estimate.x))
    assert estimate.time == 0.9
    for s in all_samples(0.9):
        assert estimator.add(s)
    estimate = estimator.estimate(0.92, REFERENCE)
    assert estimate.x[LAYOUT.r_0] == pytest.approx(HOVER, abs=0.01)


def test_estimator_uses_relayed_payload_sample_once():
    moments = samples_of(1.0)
    _, once, _ = run(moments)
    copies = lambda k, samples: [(k, s) for s in samples for _ in range(4 if s.source == PAYLOAD else 1)]  # noqa: E731
    _, four, _ = run(moments, copies)
    assert four.x == pytest.approx(once.x, abs=1e-12)
    assert four.covariance == pytest.approx(once.covariance, abs=1e-15)
    # One that arrives after the sample was applied changes nothing.
    estimator, before, _ = run(moments)
    assert estimator.add(next(s for s in moments[-1] if s.source == PAYLOAD))
    after = estimator.estimate(before.time, REFERENCE)
    assert after.x == pytest.approx(before.x, abs=1e-15)


def test_held_payload_keeps_its_position_when_its_unit_times_out():
    def flown(held):
        rng, estimator = np.random.default_rng(4), started()
        for k in range(1, 150):
            time = k * INTERVAL
            for m in all_samples(time, rng):
                if m.source != PAYLOAD:
                    estimator.add(m)
            if held:
                estimator.hold_payload(time, HOVER, 0.0)
            estimate = estimator.estimate(time, REFERENCE)
        sigma = np.sqrt(np.diag(estimate.covariance))
        return np.abs(estimate.x[:12] - REFERENCE.at(np.zeros(1)).x[0][:12]).max(), sigma[LAYOUT.r_0].max()

    (error, sigma), (_, without_sigma) = flown(held=True), flown(held=False)
    assert error < 0.02
    # Four links and the model give its place away, too: without the ground after 3 s to 8.3 mm, with it to 4.6 mm.
    assert 1.5 * sigma < without_sigma


def test_estimate_is_drawn_to_where_the_payload_is_held():
    """In place and heading, against what the links say of it."""

    def held(aside, yaw):
        rng, estimator = np.random.default_rng(4), started()
        for k in range(1, 60):
            time = k * INTERVAL
            for m in all_samples(time, rng):
                if m.source != PAYLOAD:
                    estimator.add(m)
            estimator.hold_payload(time, HOVER + np.array([0.0, aside, 0.0]), yaw)
            estimate = estimator.estimate(time, REFERENCE)
        return estimate.x[:12]

    straight, beside, turned = held(0.0, 0.0), held(0.02, 0.0), held(0.0, 0.02)
    assert 0.1 < (beside - straight)[1] / 0.02 < 1.0 and 0.25 < (turned - straight)[8] / 0.02 < 1.0
    assert abs((beside - straight)[0]) < 1e-4 and abs((turned - straight)[1]) < 1e-4


@pytest.mark.parametrize(("share", "held"), [(0.95, False), (1.05, True)])
def test_payload_is_held_once_its_unit_is_silent_for_the_timeout(share, held):
    silent = share * EstimatorSettings().payload_timeout
    estimates = []
    for hold in (False, True):
        estimator = started()
        for moment in samples_of(1.0):
            for m in moment:
                estimator.add(m)
        last = moment[0].time
        estimator.estimate(last, REFERENCE)
        for m in all_samples(last + silent, np.random.default_rng(2)):
            if m.source != PAYLOAD:
                estimator.add(m)
        if hold:
            estimator.hold_payload(last + silent, HOVER + 0.02, 0.0)
        estimates.append(estimator.estimate(last + silent, REFERENCE).x)
    assert np.array_equal(*estimates) is not held


def test_held_position_is_ignored_when_payload_unit_is_received():
    estimator = started()
    for moment in samples_of(1.0):
        for m in moment:
            estimator.add(m)
        estimator.hold_payload(moment[0].time, HOVER + np.array([0.0, 3.0, 0.0]), 0.0)
        estimate = estimator.estimate(moment[0].time, REFERENCE)
    assert np.linalg.norm(estimate.x[LAYOUT.r_0] - HOVER) < 0.03


def test_setpoint_not_flown_counts_as_lost():
    lost, other = started(), started()
    hover = REFERENCE.at(np.zeros(1)).u[0]
    sent = [hover + 0.01 * k for k in range(4)]
    second = [2, 3, 9]  # vehicle 2's part of a set-point
    for k, u in enumerate(sent):
        lost.setpoints.add(0.1 + 0.05 * k, u)
        flown = u.copy()
        if k == 2:
            flown[second] = sent[1][second]  # it still flies the one before
        other.setpoints.add(0.1 + 0.05 * k, flown)
    for estimator in (lost, other):
        for samples in samples_of(0.28):
            for measurement in samples:
                estimator.add(measurement)
        estimator.estimate(0.28, REFERENCE)
    assert lost.confirm_setpoint(1, 0.15, 0.18, sent[1][second]).as_sent is not False
    assert lost.confirm_setpoint(1, 0.15, 0.201, sent[1][second]).as_sent is True  # the next may come a little later
    assert lost.confirm_setpoint(1, 0.22, 0.23, np.array([0.3, 0.3, 9.0])) is None  # that it was never sent
    assert lost.confirm_setpoint(1, 0.15, 0.23, sent[1][second]).as_sent is False
    a, b = lost.estimate(0.3, REFERENCE), other.estimate(0.3, REFERENCE)
    # The change of the set-points, which decides their noise, stays that of those that were sent.
    assert a.x[: LAYOUT.n_acc.start] == pytest.approx(b.x[: LAYOUT.n_acc.start], abs=2e-3)


@pytest.mark.parametrize(("share", "lasts", "taken"), [(0.5, True, True), (0.9, True, False), (0.5, False, False)])
def test_model_takes_a_mass_that_is_learnt_far_from_its_own_for_long_and_carries_on_with_the_weight(
    share, lasts, taken
):
    estimator, before, _ = run(samples_of(0.5))
    estimator.follow_mass(share * P.m_0)
    for moment in samples_of(0.6 + EstimatorSettings().model_mass_time):
        for measurement in moment:
            if measurement.time > before.time:
                estimator.add(measurement)
    before = estimator.estimate(measurement.time, REFERENCE)
    if not lasts:
        estimator.follow_mass(P.m_0)
    estimator.follow_mass(share * P.m_0)
    estimate = estimator.estimate(before.time, REFERENCE)
    weight = [each.mass_excess * P.g + each.force[2] for each in (before, estimate)]
    # What it was off the model's mass is no force any more, and the other way round.
    assert weight[1] == pytest.approx(weight[0], abs=1e-6)
    assert bool(estimate.force[2] != before.force[2]) is taken


def test_model_that_has_taken_the_mass_of_a_blow_goes_back_to_the_one_that_is_learnt_then():
    settings, (estimator, before, _) = EstimatorSettings(), run(samples_of(0.5))

    def model():
        return estimator._process.model.parameters.m_0

    def learnt(mass, seconds, last):
        for moment in samples_of(last + seconds):
            fresh = [measurement for measurement in moment if measurement.time > last]
            for measurement in fresh:
                estimator.add(measurement)
            if fresh:
                estimator.estimate(fresh[-1].time, REFERENCE)
                estimator.follow_mass(mass)
        return last + seconds

    time = learnt(0.6 * P.m_0, settings.model_mass_time + 0.1, before.time)
    assert model() == pytest.approx(0.6 * P.m_0)
    time = learnt(0.7 * P.m_0, 0.5 * settings.model_mass_settling, time)
    assert model() == pytest.approx(0.6 * P.m_0)
    learnt(0.7 * P.m_0, settings.model_mass_settling, time)
    assert model() == pytest.approx(0.7 * P.m_0)
