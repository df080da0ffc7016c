"""Estimator: measurements in order, late, repeated, wrong or missing."""

from dataclasses import replace

import numpy as np
import pytest
from flight_in_process import MISSIONS
from paper_system import system

from gcs.config import read_system
from idc_controller.estimation.estimator import Estimator
from idc_controller.estimation.measurement_model import MeasurementModel
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Channel, MeasurementNoise, Position, SensorGroup
from idc_controller.estimation.settings import EstimatorSettings, MeasurementModelSettings
from idc_controller.estimation.vehicle_kernels import vehicle_states
from idc_controller.model.linear import LinearModel, StateLayout
from idc_controller.rotations import quaternion_from_euler, quaternion_product, rotation_from_quaternion
from idc_controller.rotations_float import attitude_of_direction
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


def started(settings=EstimatorSettings()):
    estimator = Estimator(MODEL, settings=settings)
    x = REFERENCE.at(np.zeros(1)).x[0]
    estimator.start(0.0, x)
    estimator.setpoints.add(0.0, REFERENCE.at(np.zeros(1)).u[0])
    return estimator


def samples_of(seconds, seed=1):
    rng = np.random.default_rng(seed)
    return [all_samples(INTERVAL * (k + 1), rng) for k in range(round(seconds / INTERVAL))]


def run(moments, order=lambda k, samples: [(k, s) for s in samples], until=None):
    """Return estimator, last estimate and all innovations of measurements delivered in ``order``.

    ``order`` returns pairs of (moment of arrival, sample).
    """
    arrivals = sorted(
        (pair for k, samples in enumerate(moments) for pair in order(k, samples)), key=lambda pair: pair[0]
    )
    estimator = started()
    waiting = iter([*arrivals, (np.inf, None)])
    arrival, item = next(waiting)
    last, innovations = None, []
    for k in range(len(moments)):
        while arrival <= k:
            estimator.add(item)
            arrival, item = next(waiting)
        last = estimator.estimate(INTERVAL * (k + 1), REFERENCE)
        innovations += last.innovations
    return estimator, last, innovations


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


def test_estimator_ignores_one_corrupted_relay():
    moments = samples_of(1.0)
    _, nominal, _ = run(moments)

    def with_corrupted_relay(k, samples):
        out = [(k, s) for s in samples]
        for s in samples:
            if s.source == PAYLOAD and isinstance(s, Position):
                out += [(k, s), (k, replace(s, pose=s.pose + 30.0))]
        return out

    _, corrupted, _ = run(moments, with_corrupted_relay)
    assert corrupted.x == pytest.approx(nominal.x, abs=1e-12)


@pytest.mark.parametrize("offset", [0.5, 50.0, np.nan, np.inf])
def test_estimator_rejects_outliers(offset):
    rng = np.random.default_rng(9)
    moments = samples_of(1.0)
    _, nominal, _ = run(moments)
    _, estimate, innovations = run(
        [*moments[:40], *[[sample(1, Position, s[0].time, rng, offset), *s[:4], *s[6:]] for s in moments[40:]]]
    )
    if np.isfinite(offset):  # what is not finite is not tested
        assert all((1, Position) in record.rejected for record in innovations[40:])
    sigma = np.sqrt(np.diag(estimate.covariance))[: LAYOUT.size]
    assert np.all(np.abs(estimate.x - nominal.x) < 3.0 * sigma)


def corrupted(s, **parts):
    """Measurements of one moment, of which the position of UAV 1 is ``parts``."""
    return [replace(m, **parts) if m.source == 1 and isinstance(m, Position) else m for m in s]


@pytest.mark.parametrize(
    "position",
    [lambda k: np.full(3, np.nan), lambda k: np.ones(3), lambda k: HOVER + 0.1 * INTERVAL * k + 1.0],
    ids=["missing", "stuck", "drifting"],
)
def test_estimator_uses_velocity_when_position_is_unusable(position):
    moments = samples_of(2.0)
    _, estimate, innovations = run([corrupted(s, pose=position(k)) for k, s in enumerate(moments)])
    _, without, _ = run([[m for m in s if m.source != 1 or not isinstance(m, Position)] for s in moments])
    sigma, without_sigma = (np.sqrt(np.diag(e.covariance))[LAYOUT.s_dot][2:4] for e in (estimate, without))
    assert np.all(sigma < 0.7 * without_sigma)
    assert np.all(
        np.abs(estimate.x - REFERENCE.at(np.zeros(1)).x[0]) < 5.0 * np.sqrt(np.diag(estimate.covariance))[: LAYOUT.size]
    )
    assert not any(record.covariance_reset for record in innovations)


def test_estimate_is_the_same_whatever_an_isolated_channel_measures():
    """It is left out, though it would be accepted: neither gated nor given less weight."""
    estimates = []
    for offset in (0.02, -0.02):
        estimator = started()
        for k, samples in enumerate(samples_of(1.5)):
            off = 0.3 * INTERVAL * k if k < 70 else offset
            for measurement in corrupted(samples, pose=samples[5].pose + np.array([off, 0.0, 0.0])):
                estimator.add(measurement)
            estimate = estimator.estimate(INTERVAL * (k + 1), REFERENCE)
            if k >= 69:
                assert estimator.health.isolation.isolated == (Channel(1, Position, 0),)
        estimates.append(estimate.x)
    assert estimates[0] == pytest.approx(estimates[1], abs=1e-12)


def test_estimator_uses_position_when_velocity_is_missing():
    moments = samples_of(2.0)
    _, estimate, _ = run([corrupted(s, motion=np.full(3, np.nan)) for s in moments])
    _, without, _ = run([[m for m in s if m.source != 1 or not isinstance(m, Position)] for s in moments])
    sigma, without_sigma = (np.sqrt(np.diag(e.covariance))[LAYOUT.s][2:4] for e in (estimate, without))
    assert np.all(sigma < 0.7 * without_sigma)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("position", "velocity", "isolated"), [(0.1, 0.0, (True, False)), (0.0, 0.5, (False, True))], ids=["p", "v"]
)
@pytest.mark.parametrize("of_payload", [False, True])
def test_estimator_isolates_worse_fitting_part_of_inconsistent_group(of_payload, position, velocity, isolated):
    north, begin = np.array([1.0, 0.0, 0.0]), 2.0
    corrupted = [
        [
            replace(
                m,
                pose=m.pose + position * max(m.time - begin, 0.0) * north,
                motion=m.motion + velocity * (m.time > begin) * north,
            )
            if (m.source == PAYLOAD) == of_payload and isinstance(m, Position)
            else m
            for m in moment
        ]
        for moment in samples_of(8.0)
    ]
    estimator, estimate, _ = run(corrupted)
    assert estimator.health.isolated_groups == {SensorGroup(of_payload, Position): isolated}
    assert estimator.health.unusable_poses(Position, estimator.time) == (set() if of_payload else {0, 1, 2, 3})
    error = np.abs(estimate.x - REFERENCE.at(np.zeros(1)).x[0])
    assert max(error[:12].max(), error[LAYOUT.s].max()) < 0.02


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


def test_held_position_is_ignored_when_payload_unit_is_received():
    estimator = started()
    for moment in samples_of(1.0):
        for m in moment:
            estimator.add(m)
        estimator.hold_payload(moment[0].time, HOVER + np.array([0.0, 3.0, 0.0]), 0.0)
        estimate = estimator.estimate(moment[0].time, REFERENCE)
    assert np.linalg.norm(estimate.x[LAYOUT.r_0] - HOVER) < 0.03


def test_stacked_observations_know_the_rows_of_the_payload_unit_and_of_each_height():
    model = MeasurementModel(MODEL, MeasurementNoise(), MeasurementModelSettings())
    keys = ((2, Position), (PAYLOAD, Attitude), (1, Attitude), (PAYLOAD, Position), (0, Position))
    observation = model.observation(keys)
    stack = observation.stack
    assert stack.sizes.tolist() == [6, 6, 4, 6, 6]
    assert np.flatnonzero(stack.of_payload).tolist() == [*range(6, 12), *range(16, 22)]
    assert (observation.uavs.tolist(), observation.heights.tolist()) == ([2, 0], [2, 24])


def test_estimated_vehicles_match_measurement_model():
    rng = np.random.default_rng(3)
    moved = next_to_hover(rng)
    flat = REFERENCE.at(np.zeros(1))
    model = Estimator(MODEL).measurement_model
    for measurement in model.vehicles(0.0, moved):
        observation = model.observation(((measurement.source, type(measurement)),))
        expected = observation.rows.dense(LAYOUT.size) @ (moved - flat.x[0])
        assert model.less_reference(observation, [measurement], flat, 0) == pytest.approx(expected, abs=2e-3)


def vehicle_states_in_arrays(x, layout, p, l):
    """Position, velocity, quaternion and body rates (N, 13): the same as the kernel, in arrays over all UAVs."""

    def pairs(values):
        return values.reshape(-1, 2)

    def third(lateral):
        return np.sqrt(np.maximum(1.0 - (lateral**2).sum(axis=1), 0.01))

    attached = p @ rotation_from_quaternion(quaternion_from_euler(*x[layout.Theta])).T
    s, s_dot, n, n_dot = (pairs(x[part]) for part in (layout.s, layout.s_dot, layout.n, layout.n_dot))
    position = x[layout.r_0] + attached - l[:, None] * np.column_stack([s, third(s)])
    sinking = -(s * s_dot).sum(axis=1) / third(s)
    swinging = l[:, None] * np.column_stack([s_dot, sinking])
    velocity = x[layout.v_0] + np.cross(x[layout.omega], attached) - swinging
    roll, pitch = np.arcsin(n[:, 1]), np.arctan2(-n[:, 0], third(n))
    (a, b), (c, d) = (np.cos([roll / 2, pitch / 2]), np.sin([roll / 2, pitch / 2]))
    about_x = n_dot[:, 1] / np.cos(roll)
    about_y = (np.sin(pitch) * np.sin(roll) * about_x - n_dot[:, 0]) / np.cos(pitch)
    turn = np.column_stack([a * b, c * b, a * d, -c * d])
    return np.column_stack([position, velocity, turn, about_x, about_y, -np.tan(roll) * about_y])


@pytest.mark.parametrize("number_of_uavs", [3, 4, 8])
def test_estimated_vehicles_are_those_of_the_arithmetic_in_arrays(number_of_uavs):
    rng, parameters, layout = np.random.default_rng(8), system(number_of_uavs), StateLayout(number_of_uavs)
    for _ in range(50):
        x = rng.uniform(-0.6, 0.6, layout.size)
        links = x[layout.s.start : layout.s_dot.stop]
        found = vehicle_states(x[:12], links, x[layout.n], x[layout.n_dot], parameters.p, parameters.l)
        expected = vehicle_states_in_arrays(x, layout, parameters.p, parameters.l)
        np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-14)


@pytest.mark.parametrize("tilt", [(0.4, 0.3), (-0.3, 0.4), (0.0, -0.5)])
def test_estimated_vehicles_head_north_at_any_tilt(tilt):
    """As commanded: their detections are placed by it."""
    model, step = Estimator(MODEL).measurement_model, 1e-5
    n, n_dot = np.tile(tilt, LAYOUT.number_of_uavs), np.tile([0.7, -0.4], LAYOUT.number_of_uavs)
    x = REFERENCE.at(np.zeros(1)).x[0]
    x[LAYOUT.n_dot] = n_dot
    attitudes = []
    for time in (0.0, step):
        x[LAYOUT.n] = n + time * n_dot
        attitudes.append(next(t for t in model.vehicles(time, x) if isinstance(t, Attitude)))
    now, then = attitudes
    direction = [*tilt, -np.sqrt(1.0 - np.square(tilt).sum())]
    assert now.quaternion == pytest.approx(attitude_of_direction(direction), abs=1e-12)
    turned = quaternion_product(now.quaternion * [1.0, -1.0, -1.0, -1.0], then.quaternion)
    assert 2.0 * turned[1:] / step == pytest.approx(now.rates, abs=1e-4)


def next_to_hover(rng):
    """A state next to hover."""
    return REFERENCE.at(np.zeros(1)).x[0] + 0.01 * rng.standard_normal(LAYOUT.size)


def test_single_vehicle_never_causes_covariance_reset():
    _, _, innovations = run([[sample(1, Position, s[0].time, offset=2.0), *s[:4], *s[6:]] for s in samples_of(3.0)])
    assert not any(record.covariance_reset for record in innovations)


# In flight


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
