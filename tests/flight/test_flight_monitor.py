"""Flight monitor: when the detectors may compare with the attitude loop's linear model."""

from types import SimpleNamespace

import numpy as np
import pytest

from gcs.config.flight_settings import DEFAULTS
from gcs.flight import monitor
from gcs.flight.monitor import FlightMonitor
from gcs.flight.phase import Phase

SETTINGS = DEFAULTS.monitor
STEP = 0.05


@pytest.fixture
def watched(monkeypatch):
    """(Monitor of two vehicles, its flight, the steps that its one detector was given)."""
    steps = []
    monkeypatch.setattr(monitor, "detectors", lambda flight, settings: [steps.append])
    payload, links = (
        SimpleNamespace(is_clear=lambda estimate: estimate > 0.0),
        [SimpleNamespace(system_id=i) for i in (4, 7)],
    )
    system = SimpleNamespace(team=SimpleNamespace(links=links), payload=payload)
    flight = SimpleNamespace(system=system, phase=Phase.FLY)
    return FlightMonitor(flight, None, None), flight, steps


def record(tilt, height=1.0):
    """A step's record whose tilt set-points are ``tilt`` (rad), followed by thrusts, which do not count."""
    u = np.concatenate([np.full(4, tilt), [7.0 + 100.0 * tilt, 8.0]])
    return SimpleNamespace(estimate=height, decision=SimpleNamespace(u=u))


def test_tilt_step_beyond_the_limit_is_a_manoeuvre_for_its_time(watched):
    watch, _, steps = watched
    tilts = [0.0] * 5 + [1.01 * SETTINGS.manoeuvre_tilt] * 60
    for k, tilt in enumerate(tilts):
        watch.step(STEP * k, 0.0, record(tilt))
    unsteady = [step.time for step in steps if not step.steady]
    assert unsteady[0] == pytest.approx(5 * STEP)
    assert unsteady[-1] == pytest.approx(5 * STEP + SETTINGS.manoeuvre_time, abs=STEP + 1e-9)
    assert np.diff(unsteady) == pytest.approx(STEP)


def test_tilt_steps_up_to_the_limit_are_no_manoeuvre(watched):
    watch, _, steps = watched
    for k in range(40):
        watch.step(STEP * k, 0.0, record(0.99 * SETTINGS.manoeuvre_tilt * (k % 2)))
    assert all(step.steady and step.clear and step.in_air for step in steps)
    assert steps[0].names == ["vehicle 4", "vehicle 7", "payload"]


@pytest.mark.parametrize(
    ("phase", "made", "height", "expected"),
    [
        (Phase.FLY, True, 1.0, (True, True)),
        (Phase.FLY, True, -1.0, (True, False)),
        (Phase.FLY, False, 1.0, (True, False)),
        (Phase.SPOOL_UP, True, 1.0, (False, False)),
    ],
    ids=["in the air", "near the ground", "no step", "on the ground"],
)
def test_model_holds_in_the_air_clear_of_the_ground_alone(watched, phase, made, height, expected):
    watch, flight, steps = watched
    flight.phase = phase
    watch.step(0.0, 0.0, record(0.0, height) if made else None)
    [step] = steps
    assert (step.in_air, step.clear) == expected and step.steady
