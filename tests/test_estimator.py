"""The estimator: measurements as they come, and whether it knows how well it knows."""

from dataclasses import replace

import numpy as np
import pytest
from estimator_truth import known_to_the_world, true_state
from flight_in_process import MISSIONS, Rehearsal, noiseless, short_figure
from scipy.stats import chi2

from gcs.config import read_system
from gcs.mission.read import read_mission
from idc_controller.estimate.dead_reckoning import Group
from idc_controller.estimate.estimator import Estimator, EstimatorSettings
from idc_controller.estimate.measurements import PAYLOAD, Attitude, Position
from idc_controller.model.linear import LinearModel
from idc_controller.plan.flatness import Load
from idc_controller.plan.reference import Reference
from idc_controller.plan.trajectory import RestTrajectory

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
        assert np.all(np.diag(estimate.covariance) >= np.diag(full.covariance) * (1.0 - 1e-9))
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


def test_vehicles_tell_what_is_estimated_of_them():
    rng = np.random.default_rng(3)
    moved = next_to_hover(rng)
    flat = REFERENCE.at(np.zeros(1))
    of_moved = Estimator(MODEL, EstimatorSettings()).measurement_model
    for told in of_moved.vehicles(0.0, moved):
        channel = of_moved.channels[told.source, type(told)]
        expected = channel.rows @ (moved - flat.x[0])
        assert of_moved.innovation(told, flat, 0) == pytest.approx(expected, abs=2e-3)


def next_to_hover(rng):
    """A state next to hover."""
    return REFERENCE.at(np.zeros(1)).x[0] + 0.01 * rng.standard_normal(LAYOUT.size)


def test_a_single_vehicle_never_overrules_the_others():
    estimator, _ = run([[sample(1, Position, s[0].time, offset=2.0), *s[:4], *s[6:]] for s in samples_of(3.0)])
    assert not any(record.surprised for record in estimator.innovations)


# In flight


class Watched(Rehearsal):
    """A flight that compares every estimate with the world at the moment it is for."""

    def __init__(self, *arguments, force=None, from_time=np.inf, **options):
        super().__init__(*arguments, **options)
        self.compared = []
        self._latest = None
        step = self.recorder.step

        def listen(flight, time, record):
            self._latest = record
            step(flight, time, record)

        self.recorder.step = listen
        if force is not None:
            push = self.swarm.world.step
            world = self.swarm.world
            world.step = lambda thrusts, torques: push(
                thrusts, torques, payload_force=force if world.time >= from_time else None
            )

    def watch(self, _):
        record, self._latest = self._latest, None
        if record is None:
            return
        estimate = record.estimate
        self.swarm.advance_to(estimate.time)  # a few ms ahead: nothing else is due before
        truth = true_state(self.swarm.world.state(), self.swarm.world.parameters)
        self.compared.append((self.flight.phase.value, estimate, truth))

    def in_the_air(self):
        return [(e, x) for phase, e, x in self.compared if phase in ("climb", "fly", "hold", "land")][20:-20]


def normalised_errors(pairs, which):
    """Normalised estimation error squared of some coordinates (K,)."""
    errors = []
    for estimate, truth in pairs:
        e = (estimate.x - truth)[which]
        errors.append(e @ np.linalg.solve(estimate.covariance[np.ix_(which, which)], e))
    return np.array(errors)


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    folder = tmp_path_factory.mktemp("estimated")
    with Watched(short_figure(folder, duration=16.0), folder / "run", seed=31) as flight:
        flight.fly(flight.watch)
        assert flight.flight.completed
        return flight


def air_innovations(flight):
    pairs = flight.in_the_air()
    begin, end = pairs[0][0].time, pairs[-1][0].time
    return [record for record in flight.flight.estimator.innovations if begin < record.time < end]


def test_innovations_are_within_their_bounds_over_a_whole_flight(flown):
    records = air_innovations(flown)
    nis = np.array([record.normalised_squared for record in records])
    dof = np.array([record.degrees_of_freedom for record in records])
    assert nis.sum() / dof.sum() == pytest.approx(1.0, abs=0.06)
    inside = (nis > chi2.ppf(0.025, dof)) & (nis < chi2.ppf(0.975, dof))
    assert inside.mean() > 0.92
    assert sum(len(record.rejected) for record in records) <= 3
    # White: what one innovation says of the next is nothing.
    centred = nis / dof - np.mean(nis / dof)
    assert abs(np.mean(centred[1:] * centred[:-1]) / np.mean(centred**2)) < 0.1


def test_estimation_errors_are_within_their_bounds_over_a_whole_flight(flown):
    pairs = flown.in_the_air()
    known = known_to_the_world(LAYOUT)
    nees = normalised_errors(pairs, known)
    upper = chi2.ppf(0.975, len(known))
    assert (nees < upper).mean() > 0.97
    assert 0.7 < nees.mean() / len(known) < 1.1  # a little too modest rather than too sure
    for part in ("r_0", "v_0", "Theta", "omega", "s", "s_dot", "n", "n_dot", "f"):
        which = np.arange(LAYOUT.size)[getattr(LAYOUT, part)]
        assert 0.3 < normalised_errors(pairs, which).mean() / len(which) < 1.5, part


def test_the_estimate_is_as_good_as_it_should_be(flown):
    errors = np.array([estimate.x - truth for estimate, truth in flown.in_the_air()])
    rms = {part: np.sqrt(np.mean(errors[:, getattr(LAYOUT, part)] ** 2)) for part in ("r_0", "v_0", "Theta", "s")}
    assert rms["r_0"] < 0.004
    assert rms["v_0"] < 0.006
    assert rms["Theta"] < np.radians(0.08)
    assert rms["s"] < 0.002


def test_without_noise_it_is_not_too_sure_of_itself(tmp_path):
    mission = noiseless(read_mission(short_figure(tmp_path, duration=8.0)))
    with Watched(mission, tmp_path / "run") as flight:
        flight.fly(flight.watch)
        assert flight.flight.completed
    pairs = flight.in_the_air()
    known = known_to_the_world(LAYOUT)
    assert normalised_errors(pairs, known).mean() / len(known) < 1.0
    assert normalised_errors(pairs, np.arange(12)).mean() / 12 < 1.0
    errors = np.array([(estimate.x - truth)[LAYOUT.r_0] for estimate, truth in pairs])
    assert np.sqrt(np.mean(errors**2)) < 0.001


@pytest.mark.parametrize("factor", [0.9, 1.1])
def test_a_payload_of_another_mass_leaves_no_offset(tmp_path, factor):
    mission = read_mission(short_figure(tmp_path, duration=6.0))
    world = replace(mission.system, world=replace(mission.system.world, payload_mass_factor=factor))
    with Watched(mission, tmp_path / "run", world=world) as flight:
        flight.fly(flight.watch)
        assert flight.flight.completed
    last = [estimate for estimate, _ in flight.in_the_air()][-60:]
    excess = np.mean([estimate.mass_excess + 0.0 for estimate in last])
    force = np.mean([estimate.force for estimate in last], axis=0)
    # Part of a mass looks like a steady force down: together they make up the weight.
    weight = excess * P.g + force[2]
    assert weight == pytest.approx((factor - 1.0) * P.m_0 * P.g, abs=0.15)
    assert np.abs(force[:2]).max() < 0.3


@pytest.mark.parametrize("force", [(3.0, 0.0, 0.0), (0.0, 8.0, 0.0)], ids=["3 N", "8 N"])
def test_a_sudden_steady_force_is_learnt_and_leaves_no_offset(tmp_path, force):
    mission = short_figure(tmp_path, duration=20.0)
    flight = Watched(mission, tmp_path / "run", force=force, from_time=14.0)
    with flight:
        flight.fly(flight.watch, until=40.0)
        assert flight.flight.phase.value in ("fly", "hold")
        assert not flight.flight.reason
    estimate, truth = flight.compared[-1][1:]
    assert estimate.force == pytest.approx(force, abs=0.3)
    assert estimate.x[LAYOUT.r_0] == pytest.approx(truth[LAYOUT.r_0], abs=0.01)
    asked, _ = flight.flight.asked(np.array([estimate.time]))
    assert truth[LAYOUT.r_0] == pytest.approx(asked[0], abs=0.1)
    assert any(record.surprised for record in flight.flight.estimator.innovations)


# Set-points that do not arrive


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
