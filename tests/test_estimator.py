"""The estimator: measurements as they come, late, doubled, wrong or not at all."""

from dataclasses import replace

import numpy as np
import pytest
from flight_in_process import MISSIONS

from gcs.config import read_system
from gcs.mavlink.setpoints import attitude_of
from idc_controller.estimation.estimator import Estimator, EstimatorSettings
from idc_controller.estimation.health.dead_reckoning import Group
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Position
from idc_controller.model.linear import LinearModel
from idc_controller.rotations import quaternion_product
from idc_controller.trajectory.flatness import Load
from idc_controller.trajectory.reference import Reference
from idc_controller.trajectory.trajectory import RestTrajectory

MODEL = LinearModel(read_system(MISSIONS / "system.toml").parameters())
P, LAYOUT = MODEL.parameters, MODEL.layout
HOVER = np.array([1.0, -2.0, -5.0])
REFERENCE = Reference(P, RestTrajectory(HOVER, 0.0), Load(P.m_0, np.zeros(3)))
INTERVAL = 0.02


def sample(source, kind, time, rng=None, offset=0.0):
    """A measurement at rest in hover."""
    noise = (lambda sigma, n: sigma * rng.standard_normal(n)) if rng is not None else (lambda sigma, n: np.zeros(n))
    if kind is Attitude:
        half = noise(np.radians(0.1), 3)
        return Attitude(time, source, np.append(1.0, half) / np.sqrt(1.0 + half @ half), noise(0.006, 3))
    position = HOVER if source == PAYLOAD else HOVER + P.p[source] - P.l[source] * np.array([0.0, 0.0, 1.0])
    return Position(time, source, position + offset + noise(0.02, 3), noise(0.01, 3))


def all_samples(time, rng=None):
    return [sample(source, kind, time, rng) for source in (PAYLOAD, 0, 1, 2, 3) for kind in (Attitude, Position)]


def started():
    estimator = Estimator(MODEL, EstimatorSettings())
    x = REFERENCE.at(np.zeros(1)).x[0]
    estimator.start(0.0, x)
    estimator.add_setpoint(0.0, REFERENCE.at(np.zeros(1)).u[0])
    return estimator


def samples_of(seconds, seed=1):
    rng = np.random.default_rng(seed)
    return [all_samples(INTERVAL * (k + 1), rng) for k in range(round(seconds / INTERVAL))]


def run(moments, order=lambda k, samples: [(k, s) for s in samples], until=None):
    """The estimate after measurements were delivered in ``order``: pairs of (moment of arrival, sample)."""
    arrivals = sorted(
        (pair for k, samples in enumerate(moments) for pair in order(k, samples)), key=lambda pair: pair[0]
    )
    estimator = started()
    waiting = iter([*arrivals, (np.inf, None)])
    arrival, item = next(waiting)
    last = None
    for k in range(len(moments)):
        while arrival <= k:
            estimator.add(item)
            arrival, item = next(waiting)
        last = estimator.estimate(INTERVAL * (k + 1), REFERENCE)
    return estimator, last


def test_measurements_out_of_order_give_what_measurements_in_order_give():
    moments = samples_of(1.0)
    _, in_order = run(moments)
    rng = np.random.default_rng(2)
    # Each up to 0.2 s late; in the last fifth of a second all are in time.
    late = lambda k, samples: [(k + (rng.integers(0, 10) if k < 35 else 0), s) for s in samples]  # noqa: E731
    estimator, shuffled = run(moments, late)
    assert estimator.discarded_late == 0
    assert shuffled.x == pytest.approx(in_order.x, abs=1e-9)
    assert shuffled.covariance == pytest.approx(in_order.covariance, abs=1e-12)


def test_a_late_measurement_counts_as_if_it_had_been_in_time():
    moments = samples_of(0.6)
    _, in_time = run(moments)
    _, late = run(moments, lambda k, samples: [(min(k + 12, 29), s) for s in samples])
    assert late.x == pytest.approx(in_time.x, abs=1e-9)


def test_older_than_the_memory_is_discarded_and_counted():
    estimator, _ = run(samples_of(2.0))
    assert not estimator.add(sample(0, Position, 0.5))
    assert estimator.discarded_late == 1


def test_missing_measurements_only_make_it_less_sure():
    moments = samples_of(2.0)
    rng = np.random.default_rng(3)
    full_estimator, full = run(moments)
    _, half = run(moments, lambda k, samples: [(k, s) for s in samples if rng.random() < 0.5])
    _, without_two = run(moments, lambda k, samples: [(k, s) for s in samples if s.source != 2])
    for estimate in (half, without_two):
        sigma = np.sqrt(np.diag(estimate.covariance))[: LAYOUT.size]
        truth = REFERENCE.at(np.zeros(1)).x[0]
        assert np.all(np.abs(estimate.x - truth) < 5.0 * sigma + 1e-9)
        # Of what is not measured no change of its own force is expected either.
        unsure, sure = (np.diag(e.covariance)[: LAYOUT.size] for e in (estimate, full))
        assert np.all(unsure >= sure * (1.0 - 1e-9))
    assert len(full_estimator.innovations) == 100


def test_nothing_at_all_is_predicted_and_forgives_later():
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


def test_relays_of_one_payload_sample_count_once():
    moments = samples_of(1.0)
    _, once = run(moments)
    copies = lambda k, samples: [(k, s) for s in samples for _ in range(4 if s.source == PAYLOAD else 1)]  # noqa: E731
    _, four = run(moments, copies)
    assert four.x == pytest.approx(once.x, abs=1e-12)
    assert four.covariance == pytest.approx(once.covariance, abs=1e-15)
    # One that arrives after the sample was applied changes nothing.
    estimator, before = run(moments)
    assert estimator.add(next(s for s in moments[-1] if s.source == PAYLOAD))
    after = estimator.estimate(before.time, REFERENCE)
    assert after.x == pytest.approx(before.x, abs=1e-15)


def test_one_corrupted_relay_is_outvoted():
    moments = samples_of(1.0)
    _, sound = run(moments)

    def with_a_liar(k, samples):
        out = [(k, s) for s in samples]
        for s in samples:
            if s.source == PAYLOAD and isinstance(s, Position):
                out += [(k, s), (k, replace(s, position=s.position + 30.0))]
        return out

    _, lied_to = run(moments, with_a_liar)
    assert lied_to.x == pytest.approx(sound.x, abs=1e-12)


@pytest.mark.parametrize("offset", [0.5, 50.0, np.nan, np.inf])
def test_outliers_are_kept_out(offset):
    rng = np.random.default_rng(9)
    moments = samples_of(1.0)
    _, sound = run(moments)
    estimator, estimate = run(
        [*moments[:40], *[[sample(1, Position, s[0].time, rng, offset), *s[:4], *s[6:]] for s in moments[40:]]]
    )
    if np.isfinite(offset):  # what is no number does not even come to the gate
        assert all((1, "Position") in record.rejected for record in estimator.innovations[40:])
    sigma = np.sqrt(np.diag(estimate.covariance))[: LAYOUT.size]
    assert np.all(np.abs(estimate.x - sound.x) < 3.0 * sigma)


def spoilt(s, **parts):
    """Measurements of one moment, of which the position of UAV 1 is ``parts``."""
    return [replace(m, **parts) if m.source == 1 and isinstance(m, Position) else m for m in s]


@pytest.mark.parametrize(
    "position",
    [lambda k: np.full(3, np.nan), lambda k: np.ones(3), lambda k: HOVER + 0.1 * INTERVAL * k + 1.0],
    ids=["unknown", "frozen", "drifting"],
)
def test_a_velocity_is_used_whatever_becomes_of_its_position(position):
    moments = samples_of(2.0)
    estimator, estimate = run([spoilt(s, position=position(k)) for k, s in enumerate(moments)])
    _, without = run([[m for m in s if m.source != 1 or not isinstance(m, Position)] for s in moments])
    sigma, blind = (np.sqrt(np.diag(e.covariance))[LAYOUT.s_dot][2:4] for e in (estimate, without))
    assert np.all(sigma < 0.7 * blind)
    assert np.all(
        np.abs(estimate.x - REFERENCE.at(np.zeros(1)).x[0]) < 5.0 * np.sqrt(np.diag(estimate.covariance))[: LAYOUT.size]
    )
    assert not any(record.surprised for record in estimator.innovations)


def test_a_position_is_used_when_its_velocity_is_unknown():
    moments = samples_of(2.0)
    _, estimate = run([spoilt(s, velocity=np.full(3, np.nan)) for s in moments])
    _, without = run([[m for m in s if m.source != 1 or not isinstance(m, Position)] for s in moments])
    sigma, blind = (np.sqrt(np.diag(e.covariance))[LAYOUT.s][2:4] for e in (estimate, without))
    assert np.all(sigma < 0.7 * blind)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("position", "velocity", "left_out"), [(0.1, 0.0, (True, False)), (0.0, 0.5, (False, True))], ids=["p", "v"]
)
@pytest.mark.parametrize("of_payload", [False, True])
def test_of_what_contradicts_itself_that_is_used_which_fits(of_payload, position, velocity, left_out):
    north, begin = np.array([1.0, 0.0, 0.0]), 2.0
    spoilt = [
        [
            replace(
                m,
                position=m.position + position * max(m.time - begin, 0.0) * north,
                velocity=m.velocity + velocity * (m.time > begin) * north,
            )
            if (m.source == PAYLOAD) == of_payload and isinstance(m, Position)
            else m
            for m in moment
        ]
        for moment in samples_of(8.0)
    ]
    estimator, estimate = run(spoilt)
    assert estimator.left_out == {Group(of_payload, Position): left_out}
    assert estimator.untrusted(Position) == (set() if of_payload else {0, 1, 2, 3})
    error = np.abs(estimate.x - REFERENCE.at(np.zeros(1)).x[0])
    assert max(error[:12].max(), error[LAYOUT.s].max()) < 0.02


def test_a_payload_that_stands_stays_where_it_is_though_its_unit_is_silent():
    def flown(stands):
        rng, estimator = np.random.default_rng(4), started()
        for k in range(1, 150):
            time = k * INTERVAL
            for m in all_samples(time, rng):
                if m.source != PAYLOAD:
                    estimator.add(m)
            if stands:
                estimator.payload_stands(time, HOVER, 0.0)
            estimate = estimator.estimate(time, REFERENCE)
        sigma = np.sqrt(np.diag(estimate.covariance))
        return np.abs(estimate.x[:12] - REFERENCE.at(np.zeros(1)).x[0][:12]).max(), sigma[LAYOUT.r_0].max()

    (error, sigma), (_, blind) = flown(stands=True), flown(stands=False)
    assert error < 0.02
    assert 1.5 * sigma < blind


def test_where_its_unit_speaks_that_is_believed():
    estimator = started()
    for moment in samples_of(1.0):
        for m in moment:
            estimator.add(m)
        estimator.payload_stands(moment[0].time, HOVER + np.array([0.0, 3.0, 0.0]), 0.0)
        estimate = estimator.estimate(moment[0].time, REFERENCE)
    assert np.linalg.norm(estimate.x[LAYOUT.r_0] - HOVER) < 0.03


def test_vehicles_tell_what_is_estimated_of_them():
    rng = np.random.default_rng(3)
    moved = next_to_hover(rng)
    flat = REFERENCE.at(np.zeros(1))
    of_moved = Estimator(MODEL, EstimatorSettings()).measurement_model
    for told in of_moved.vehicles(0.0, moved):
        channel = of_moved.channels[told.source, type(told)]
        expected = channel.rows @ (moved - flat.x[0])
        assert of_moved.innovation(told, flat, 0) == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize("tilt", [(0.4, 0.3), (-0.3, 0.4), (0.0, -0.5)])
def test_however_they_are_tilted_they_head_north(tilt):
    """As they are told to: what they see of obstacles is placed by it."""
    model, step = Estimator(MODEL, EstimatorSettings()).measurement_model, 1e-5
    n, n_dot = np.tile(tilt, LAYOUT.number_of_uavs), np.tile([0.7, -0.4], LAYOUT.number_of_uavs)
    x = REFERENCE.at(np.zeros(1)).x[0]
    x[LAYOUT.n_dot] = n_dot
    told = []
    for time in (0.0, step):
        x[LAYOUT.n] = n + time * n_dot
        told.append(next(t for t in model.vehicles(time, x) if isinstance(t, Attitude)))
    now, then = told
    assert now.quaternion == pytest.approx(attitude_of([*tilt, -np.sqrt(1.0 - np.square(tilt).sum())]), abs=1e-12)
    turned = quaternion_product(now.quaternion * [1.0, -1.0, -1.0, -1.0], then.quaternion)
    assert 2.0 * turned[1:] / step == pytest.approx(now.rates, abs=1e-4)


def next_to_hover(rng):
    """A state next to hover."""
    return REFERENCE.at(np.zeros(1)).x[0] + 0.01 * rng.standard_normal(LAYOUT.size)


def test_a_single_vehicle_never_overrules_the_others():
    estimator, _ = run([[sample(1, Position, s[0].time, offset=2.0), *s[:4], *s[6:]] for s in samples_of(3.0)])
    assert not any(record.surprised for record in estimator.innovations)


# In flight


def test_a_setpoint_that_a_vehicle_did_not_fly_counts_as_lost():
    lost, other = started(), started()
    hover = REFERENCE.at(np.zeros(1)).u[0]
    sent = [hover + 0.01 * k for k in range(4)]
    second = [2, 3, 9]  # vehicle 2's part of a set-point
    for k, u in enumerate(sent):
        lost.add_setpoint(0.1 + 0.05 * k, u)
        flown = u.copy()
        if k == 2:
            flown[second] = sent[1][second]  # it still flies the one before
        other.add_setpoint(0.1 + 0.05 * k, flown)
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
    # The change of the set-points, which tells how far to trust them, stays that of those that were sent.
    assert a.x[: LAYOUT.n_acc.start] == pytest.approx(b.x[: LAYOUT.n_acc.start], abs=2e-3)
