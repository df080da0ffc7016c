"""A vehicle that flies by a wrong attitude, found by the force that it pulls aside with."""

from types import SimpleNamespace

import numpy as np
import pytest

from gcs.config import SystemConfig
from gcs.flight.attitude_error import attitude_wrong
from gcs.flight.condition import Moment
from gcs.flight.phase import Phase

PARAMETERS = SystemConfig().parameters()
LIMIT = SystemConfig().flight.failsafe.attitude_error


def trigger(force, clear=True):
    """Return what is found of forces (4, 2) (N) on the UAVs."""
    estimate = SimpleNamespace(uav_force=np.column_stack([force, np.zeros(4)]))
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


@pytest.mark.parametrize(("error", "clear"), [(0.0, True), (0.06, True), (0.2, False)])
def test_wind_and_small_errors_are_no_failsafe_nor_is_anything_on_the_ground(error, clear):
    assert trigger(aside(error), clear) is None
