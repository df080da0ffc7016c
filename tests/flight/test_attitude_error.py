"""A vehicle that flies by a wrong attitude, found by the force that it pulls aside with."""

from statistics import NormalDist
from types import SimpleNamespace

import numpy as np
import pytest

from gcs.config import SystemConfig
from gcs.flight.attitude_error import attitude_misaligned, attitude_wrong
from gcs.flight.condition import Moment
from gcs.flight.phase import Phase
from gcs.flight.preflight import Preflight
from idc_controller.estimation.measurements import PAYLOAD, Attitude
from idc_controller.rotations import quaternion_from_euler

PARAMETERS = SystemConfig().parameters()
LIMIT = SystemConfig().flight.failsafe.attitude_error


def trigger(force, clear=True, deviation=0.05):
    """Return what is found of forces (4, 2) (N) on the UAVs that are known to a standard ``deviation`` (N)."""
    covariance = np.diag([1.0] * 20 + [deviation**2] * 8 + [1.0])  # of other states, the forces, and the mass
    estimate = SimpleNamespace(uav_force=np.column_stack([force, np.zeros(4)]), covariance=covariance)
    system = SimpleNamespace(
        payload=SimpleNamespace(is_clear=lambda of: clear), settings=SystemConfig().flight.failsafe,
        team=SimpleNamespace(parameters=PARAMETERS, links=[SimpleNamespace(system_id=i + 1) for i in range(4)]),
    )  # fmt: skip
    return attitude_wrong(system, Moment(Phase.FLY, 10.0, 10.0, estimate=estimate))


def aside(error, uav=2):
    """Return the forces of a UAV that pulls ``error`` (rad) east of its attitude, in wind."""
    force = np.tile([2.0, -1.0], (4, 1))
    force[uav, 1] += error * PARAMETERS.hover_thrust[uav]
    return force


def test_vehicle_that_pulls_aside_is_named_with_the_error_and_its_limit():
    found = trigger(aside(0.1))
    assert found.vehicles == (2,)
    assert found.reason == f"the thrust of vehicle 3 is 0.10 rad off its attitude (limit {LIMIT:g} rad)"


def test_error_is_a_failsafe_only_where_the_filter_is_certain_of_it():
    beyond = 0.02 * PARAMETERS.hover_thrust[2]  # N, of the error over its limit
    own = np.sqrt(4.0 / 3.0)  # of a force less the mean of three others
    quantile = NormalDist().inv_cdf(SystemConfig().flight.failsafe.attitude_certainty)
    assert trigger(aside(LIMIT + 0.02), deviation=0.9 * beyond / (own * quantile)) is not None
    assert trigger(aside(LIMIT + 0.02), deviation=1.1 * beyond / (own * quantile)) is None


def pad(*errors, phase=Phase.SPOOL_UP, payload=0.0, samples=10):
    """Return what is found on the pad of vehicles with attitudes ``errors`` (rad) about east."""
    links = [SimpleNamespace(system_id=i + 1) for i in range(len(errors))]
    preflight, rng = Preflight(SimpleNamespace(links=links)), np.random.default_rng(1)
    for source, error in ((PAYLOAD, payload), *enumerate(errors)):
        for k in range(samples):
            roll, pitch = rng.normal((0.0, error), SystemConfig().sensors.attitude_deg * np.pi / 180.0)
            turn = quaternion_from_euler(roll, pitch, 0.3)
            preflight.add(Attitude(0.04 * k, source, turn, np.zeros(3)))
    return attitude_misaligned(on_ground(preflight), Moment(phase, 1.0, 1.0))


def on_ground(preflight):
    """Return what conditions on the ground are evaluated on, of vehicles whose attitudes follow from their rates."""
    team = preflight._team
    nothing = np.zeros((len(team.links), 2))
    estimator = SimpleNamespace(attitude_steps=SimpleNamespace(total=nothing.copy(), drift=nothing.copy()))
    settings = SystemConfig().flight.failsafe
    return SimpleNamespace(preflight=preflight, team=team, settings=settings, estimator=estimator)


def test_vehicle_whose_attitude_is_not_the_payloads_is_named_before_it_is_lifted():
    found = pad(0.0, 0.0, 0.1, 0.0)
    assert found.vehicles == (2,) and "vehicle 3 reports an attitude 0.10 rad off the payload's" in found.reason
    assert pad(0.0, 0.0, 0.1, 0.0, phase=Phase.FLY) is None
    assert pad(0.0, 0.0, 0.1, 0.0, samples=3) is None


def test_slope_of_the_pad_is_no_wrong_attitude_and_a_wrong_payload_unit_is_named():
    assert pad(0.06, 0.06, 0.06, 0.06, payload=0.06) is None
    assert pad(0.0, 0.0, 0.0, 0.0, payload=0.1).source == "payload"


def test_vehicle_whose_attitude_has_stepped_without_rates_does_not_take_off_from_where_it_has_landed():
    links = [SimpleNamespace(system_id=i + 1) for i in range(4)]
    preflight = Preflight(SimpleNamespace(links=links))
    preflight.restart(landed=True)
    system = on_ground(preflight)
    moment = Moment(Phase.CHECK, 1.0, 1.0)
    preflight.add(Attitude(0.0, 1, quaternion_from_euler(0.1, 0.0, 0.0), np.zeros(3)))  # as its link leans
    assert attitude_misaligned(system, moment) is None
    system.estimator.attitude_steps.total[2] = 0.1, -0.1
    found = attitude_misaligned(system, moment)
    assert found.vehicles == (2,) and "vehicle 3 reports an attitude 0.14 rad off that by its rates" in found.reason


def test_drift_of_an_attitude_ends_the_spool_up_though_the_vehicle_turns_against_it():
    system = on_ground(Preflight(SimpleNamespace(links=[SimpleNamespace(system_id=i + 1) for i in range(4)])))
    drift = system.estimator.attitude_steps.drift
    drift[1] = 0.04, 0.02
    assert attitude_misaligned(system, Moment(Phase.SPOOL_UP, 1.0, 1.0)) is None
    drift[1] = 0.05, 0.02
    found = attitude_misaligned(system, Moment(Phase.SPOOL_UP, 1.0, 1.0))
    assert found.vehicles == (1,) and "0.05 rad off that by its rates" in found.reason
    assert attitude_misaligned(system, Moment(Phase.CLIMB, 1.0, 1.0)) is None


@pytest.mark.parametrize(("error", "clear"), [(0.0, True), (0.06, True), (0.2, False)])
def test_wind_and_small_errors_are_no_failsafe_nor_is_anything_on_the_ground(error, clear):
    assert trigger(aside(error), clear) is None
