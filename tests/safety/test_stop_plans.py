"""Stops of the safety filter: where no plan along the reference keeps clear of obstacles, the payload comes to rest."""

import numpy as np
import pytest
from avoidance_checks import MARGIN
from avoidance_scene import Scene, avoidance, fly, pole, straight
from paper_system import system

from idc_controller.geometry.formation import Formation
from idc_controller.safety.planner import Planner
from idc_controller.safety.settings import PlannerSettings

SIGHT = 4.5
"""Horizontal distance from the payload within which poles are known (m)."""


class SceneInSight(Scene):
    """Obstacles that are known once they are in sight."""

    def __init__(self, obstacles):
        super().__init__(obstacles)
        self.payload = np.zeros(3)

    def predict(self, times, region=None):
        return [o for o in super().predict(times) if np.hypot(*(o.positions[0] - self.payload)[:2]) < SIGHT]


def dense_poles(seed):
    """Poles across the path, some 2.4 m apart: less than the formation needs with its margin in most places."""
    rng, poles = np.random.default_rng(seed), []
    for north in np.arange(5.0, 14.0, 2.4):
        for east in np.arange(-7.2, 7.3, 2.4):
            place = np.array([north, east]) + rng.uniform(-0.6, 0.6, 2)
            poles.append(pole(f"pole {len(poles)}", *place, 0.2))
    return poles


def fly_among(poles):
    """Fly north through what comes into sight; the slack, and the least true clearance (m)."""
    avoided, scene = avoidance([]), SceneInSight(poles)
    avoided.safety.obstacles = avoided.guidance.navigator.obstacles = scene

    def look(flown, time):
        scene.payload = flown.derivatives[-1][0]

    flown = fly(avoided, straight(20.0), 20.0, look)
    return flown.slack, min(flown.clearance(4).values())


@pytest.mark.parametrize("seed", [5, *(pytest.param(seed, marks=pytest.mark.long) for seed in (2, 3, 9))])
def test_payload_comes_to_rest_where_no_plan_keeps_the_margin(seed):
    slack, clearance = fly_among(dense_poles(seed))
    assert slack > 0.1
    assert clearance >= MARGIN


def test_nearest_rest_costs_less_than_rest_elsewhere():
    planner = Planner(Formation(system()), PlannerSettings())
    state = np.array([[3.0, -2.0, -5.0], [1.5, -0.5, 0.2], [0.3, 0.4, 0.0], [0.1, 0.0, 0.2], [0.0, 0.5, 0.0]])

    def cost(place):
        return planner.free(state - np.vstack([place, np.zeros((4, 3))])).cost

    best = planner.nearest_rest(state)
    for offset in 0.1 * np.vstack([np.eye(3), -np.eye(3)]):
        assert cost(best + offset) > cost(best)
    np.testing.assert_array_equal(planner.nearest_rest(np.vstack([best, np.zeros((4, 3))])), best)
