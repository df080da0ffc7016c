"""Estimator in flight, against the truth: errors within their covariance."""

import numpy as np
import pytest
from estimator_truth import known_to_the_world, true_state
from flights import MISSIONS, InProcessFlight, short_figure
from scipy.stats import chi2

from gcs.config import read_system
from idc_controller.model.linear import LinearModel

pytestmark = pytest.mark.slow

MODEL = LinearModel(read_system(MISSIONS / "system.toml").parameters())
P, LAYOUT = MODEL.parameters, MODEL.layout


class Watched(InProcessFlight):
    """A flight that compares every estimate with the world at the moment it is for."""

    def __init__(self, *arguments, force=None, from_time=np.inf, **options):
        super().__init__(*arguments, **options)
        self.compared = []
        self._latest = None
        self.innovations = []
        step = self.recorder.step

        def listen(flight, time, record):
            self._latest = record
            if record is not None:
                self.innovations += record.estimate.innovations
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
    return [record for record in flight.innovations if begin < record.time < end]


def test_innovations_are_within_their_covariance_in_flight(flown):
    records = air_innovations(flown)
    nis = np.array([record.normalised_squared for record in records])
    dof = np.array([record.degrees_of_freedom for record in records])
    assert nis.sum() / dof.sum() == pytest.approx(1.0, abs=0.06)
    inside = (nis > chi2.ppf(0.025, dof)) & (nis < chi2.ppf(0.975, dof))
    assert inside.mean() > 0.92
    assert sum(len(record.rejected) for record in records) <= 3
    # Whiteness: successive normalised innovations are uncorrelated.
    centred = nis / dof - np.mean(nis / dof)
    assert abs(np.mean(centred[1:] * centred[:-1]) / np.mean(centred**2)) < 0.1


def test_estimation_errors_are_within_their_covariance_in_flight(flown):
    pairs = flown.in_the_air()
    known = known_to_the_world(LAYOUT)
    nees = normalised_errors(pairs, known)
    upper = chi2.ppf(0.975, len(known))
    assert (nees < upper).mean() > 0.97
    assert 0.7 < nees.mean() / len(known) < 1.1  # a little too modest rather than too sure
    # Of single parts the bounds are wider: the errors of one flight are correlated for a second or so, which leaves the
    # mean some ten independent ones.
    for part in ("r_0", "v_0", "Theta", "omega", "s", "s_dot", "n", "n_dot", "f"):
        which = np.arange(LAYOUT.size)[getattr(LAYOUT, part)]
        assert 0.3 < normalised_errors(pairs, which).mean() / len(which) < 1.5, part


def test_estimate_is_within_nominal_errors(flown):
    errors = np.array([estimate.x - truth for estimate, truth in flown.in_the_air()])
    rms = {part: np.sqrt(np.mean(errors[:, getattr(LAYOUT, part)] ** 2)) for part in ("r_0", "v_0", "Theta", "s")}
    assert rms["r_0"] < 0.004
    assert rms["v_0"] < 0.006
    assert rms["Theta"] < np.radians(0.08)
    assert rms["s"] < 0.002


@pytest.mark.parametrize(
    "force", [pytest.param((3.0, 0.0, 0.0), marks=pytest.mark.long), (0.0, 8.0, 0.0)], ids=["3 N", "8 N"]
)
def test_disturbance_force_is_estimated_without_offset(tmp_path, force):
    mission = short_figure(tmp_path, duration=12.0)
    flight = Watched(mission, tmp_path / "run", force=force, from_time=14.0)
    with flight:
        flight.fly(flight.watch, until=30.0)
        assert flight.flight.phase.value in ("fly", "hold")
        assert not flight.flight.reason
    estimate, truth = flight.compared[-1][1:]
    assert estimate.force == pytest.approx(force, abs=0.3)
    assert estimate.x[LAYOUT.r_0] == pytest.approx(truth[LAYOUT.r_0], abs=0.01)
    reference, _ = flight.flight.reference(np.array([estimate.time]))
    assert truth[LAYOUT.r_0] == pytest.approx(reference[0], abs=0.1)
    assert any(record.covariance_reset for record in flight.innovations)
