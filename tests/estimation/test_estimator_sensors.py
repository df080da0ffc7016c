"""Estimator: sensors that are wrong, missing, stuck or inconsistent."""

from dataclasses import replace

import numpy as np
import pytest
from estimator_scene import HOVER, INTERVAL, LAYOUT, REFERENCE, all_samples, run, sample, samples_of, started

from idc_controller.estimation.measurements import PAYLOAD, Channel, Position, SensorGroup


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
                assert Channel(1, Position, 0) in estimator.health.isolation.isolated
        estimates.append(estimate.x)
    assert estimates[0] == pytest.approx(estimates[1], abs=1e-12)


def test_estimator_uses_position_when_velocity_is_missing():
    moments = samples_of(2.0)
    _, estimate, _ = run([corrupted(s, motion=np.full(3, np.nan)) for s in moments])
    _, without, _ = run([[m for m in s if m.source != 1 or not isinstance(m, Position)] for s in moments])
    sigma, without_sigma = (np.sqrt(np.diag(e.covariance))[LAYOUT.s][2:4] for e in (estimate, without))
    assert np.all(sigma < 0.7 * without_sigma)


@pytest.mark.parametrize(
    ("position", "velocity", "isolated"), [(0.1, 0.0, (True, False)), (0.0, 0.5, (False, True))], ids=["p", "v"]
)
@pytest.mark.parametrize("of_payload", [pytest.param(False, marks=pytest.mark.slow), True])
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


def test_single_vehicle_never_causes_covariance_reset():
    _, _, innovations = run([[sample(1, Position, s[0].time, offset=2.0), *s[:4], *s[6:]] for s in samples_of(3.0)])
    assert not any(record.covariance_reset for record in innovations)


@pytest.mark.parametrize("k", [0, 1, 2])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_estimator_uses_nothing_of_a_channel_that_is_partly_not_finite(k, value):
    moments = samples_of(0.5)
    partly, whole = [], []
    for moment in moments:
        position = moment[5].pose.copy()
        position[k] = value
        partly.append(corrupted(moment, pose=position))
        whole.append(corrupted(moment, pose=np.full(3, np.nan)))
    (_, found, _), (_, expected, _) = run(partly), run(whole)
    assert (found.x == expected.x).all()
    nothing = replace(moments[0][5], pose=np.full(3, value), motion=np.array([0.0, value, 0.0]))
    assert started().add(nothing) is None


@pytest.mark.parametrize("change", [(np.nan, 1.0, 2.0), (1.0, np.nan, 2.0)])
def test_measurements_are_the_same_only_where_all_values_are(change):
    a, b, c = (Position(0.0, 0, np.array(change) + shift, np.zeros(3)) for shift in (0.0, 0.0, [0.0, 0.0, 1.0]))
    assert a.same_values(b)
    assert not a.same_values(c)


def test_estimator_begins_anew_from_the_reference_when_its_state_is_no_number():
    """Set-points that are no numbers make it so, until others are in force."""
    estimator, hover, rng = started(), REFERENCE.at(np.zeros(1)), np.random.default_rng(3)
    is_lost, is_reset = [], []
    for k in range(60):
        time = INTERVAL * (k + 1)
        estimator.setpoints.add(time, hover.u[0] * (np.nan if k == 20 else 1.0))
        for measurement in all_samples(time, rng):
            estimator.add(measurement)
        estimate = estimator.estimate(time + 0.5 * INTERVAL, REFERENCE)
        is_lost.append(not np.isfinite(estimate.x).all())
        is_reset += [record.covariance_reset for record in estimate.innovations]
    assert np.flatnonzero(is_lost).tolist() == [20]
    assert np.flatnonzero(is_reset).tolist() == [21, 22]  # the change to the next set-point is no number either
    assert np.isfinite(estimate.covariance).all()
    sigma = np.sqrt(np.diag(estimate.covariance))[: LAYOUT.size]
    assert np.all(np.abs(estimate.x - hover.x[0]) < 5.0 * sigma)
    assert np.abs(estimate.x[LAYOUT.r_0] - HOVER).max() < 0.05
