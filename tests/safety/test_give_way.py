"""Time to give way: that of the planner's own limits."""

import math

import numpy as np
import pytest

from idc_controller.safety.planner import give_way_time
from idc_controller.safety.settings import PlannerSettings

PLANNER = PlannerSettings()


@pytest.mark.parametrize("distance", [0.5, 2.3, 5.0])
def test_it_is_more_than_the_largest_acceleration_alone_takes(distance):
    at_once = math.sqrt(2.0 * distance / PLANNER.acceleration_limit[1])
    assert at_once < give_way_time(PLANNER, distance) < at_once + 1.5


@pytest.mark.parametrize("limit", ["pop_limit", "snap_share", "acceleration_share"])
def test_each_limit_of_the_planner_counts(limit):
    halved = tuple(0.5 * value for value in getattr(PLANNER, limit))
    assert give_way_time(PlannerSettings(**{limit: halved}), 2.3) > give_way_time(PLANNER, 2.3) + 0.1


def test_it_grows_with_the_distance_beyond_the_horizon_too():
    times = [give_way_time(PLANNER, distance) for distance in np.linspace(0.2, 20.0, 25)]
    assert np.all(np.diff(times) > 0.0)
    assert times[-1] > PLANNER.chain.times[-1]
