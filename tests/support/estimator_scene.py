"""Measurements of a team at rest in hover, and an estimator that receives them, for tests."""

import numpy as np
from flights import MISSIONS

from gcs.config import read_system
from idc_controller.estimation.estimator import Estimator
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Position
from idc_controller.estimation.settings import EstimatorSettings
from idc_controller.model.linear import LinearModel
from idc_controller.trajectory.flatness import Load, Reference
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
