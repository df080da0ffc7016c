"""A landing place that is taken: seen on the way down, waited for above, left for home."""

import math

import numpy as np
import pytest
from flights import MISSIONS
from mission_files import TAKE_OFF, read, row, wpl

from gcs.config.flight_settings import DEFAULTS
from gcs.flight.landing_place import LandingPlace
from gcs.flight.mission_trajectory import MissionTrajectory
from gcs.mission.read import read_mission
from idc_controller.geometry.obstacles import PredictedObstacle
from idc_controller.geometry.shapes import Sphere

MISSION = read_mission(MISSIONS / "hop.toml")
PARAMETERS = MISSION.system.parameters()
ABOVE = np.array([8.0, 0.0, -3.0])
GROUND = -PARAMETERS.payload.below


class Obstacles:
    """One ball that is where it is put; None: nowhere."""

    place = None

    def predict(self, times, region=None):
        if self.place is None:
            return []
        return [PredictedObstacle("ball", Sphere(0.3), np.tile(self.place, (len(times), 1)), np.zeros(len(times)))]


@pytest.mark.parametrize(
    ("place", "taken"),
    [
        (None, False),
        ((8.0, 0.0, -0.3), True),
        ((8.0, 0.6, -1.2), True),  # on the way down
        ((8.0, 0.95, -0.3), True),  # 0.15 m beside the payload that stands
        ((8.0, 1.2, 0.1), False),
        ((8.0, 3.0, -0.3), False),
    ],
)
def test_landing_place_is_taken_by_what_is_on_the_way_down(place, taken):
    obstacles = Obstacles()
    obstacles.place = place
    found = LandingPlace(MISSION, PARAMETERS, obstacles)
    assert found.look(10.0, ABOVE) and (found.taken is not None) == taken


def test_landing_place_is_free_after_some_time_without_anything_there():
    obstacles = Obstacles()
    place, interval = (
        LandingPlace(MISSION, PARAMETERS, obstacles),
        1.01 * DEFAULTS.takeoff_landing.landing_look_interval,
    )
    clear, free_since = DEFAULTS.takeoff_landing.landing_clear_time, math.inf
    for k in range(60):
        time = k * interval
        obstacles.place = (8.0, 0.0, -0.3) if k < 10 or k == 15 else None
        assert place.look(time, ABOVE) and not place.look(time + 0.5 * interval, ABOVE)
        free_since = min(free_since, time) if obstacles.place is None else math.inf
        assert place.is_free == (time - free_since >= clear), k
    assert place.is_free


def test_place_is_seen_from_beside_by_the_steepest_rays():
    place, elevation = LandingPlace(MISSION, PARAMETERS, Obstacles()), math.radians(-70.0)
    for height in (1.5, 3.0, 5.0):
        vehicle = max(np.hypot(*PARAMETERS.p[:, :2].T))
        nearest = place.stand_off(height) - vehicle - (vehicle + PARAMETERS.disc_radius)
        above = height + PARAMETERS.l[0] - PARAMETERS.p[0, 2]
        assert nearest == pytest.approx(min(above / math.tan(-elevation), 5.0 - 2.0 * vehicle - 0.3), abs=1e-9)
    assert place.stand_off(100.0) == 5.0


@pytest.fixture
def flown(tmp_path):
    mission = read(tmp_path, wpl(TAKE_OFF, row(21, north=10.0, alt=0)))
    trajectory = MissionTrajectory(mission, np.array([0.0, 0.0, -0.3]), 0.0)
    trajectory.trajectory.position(60.0)
    return trajectory


def is_smooth(trajectory, times):
    position, velocity = trajectory.derivatives(times, 1)
    return np.abs(np.gradient(position, times, axis=0) - velocity)[1:-1].max() < 0.02


@pytest.mark.parametrize("late", [-0.5, 1.5])
@pytest.mark.parametrize("beside", [0.0, 3.0, 50.0])
def test_payload_waits_beside_the_place_and_lands_there_later(flown, late, beside):
    when, above = flown.landing_from + late, flown.above
    flown.wait(flown.trajectory, when, beside)
    assert flown.landing_from == math.inf and flown.phase(when + 30.0) == "hold" and flown.is_at_rest(when + 30.0)
    waits = flown.trajectory.position(when + 30.0)
    assert waits[2] == pytest.approx(above[2], abs=1e-6)
    assert math.dist(waits[:2], above[:2]) == pytest.approx(min(beside, 10.0), abs=0.15)
    flown.resume_landing(when + 30.0)
    times = np.arange(when, when + 90.0, 0.02)
    assert is_smooth(flown.trajectory, times)
    end = flown.trajectory.position(when + 90.0)
    assert np.allclose(end[:2], above[:2], atol=1e-6) and end[2] >= GROUND and flown.phase(when + 90.0) == "land"


def test_return_leads_home_at_the_altitude_before_the_descent(flown):
    when = flown.landing_from + 2.0
    top = flown.above[2]
    flown.wait(flown.trajectory, when)
    flown.return_home(flown.trajectory, when + 20.0)
    times = np.arange(when + 20.0, when + 80.0, 0.02)
    position = flown.trajectory.derivatives(times, 0)[0]
    assert is_smooth(flown.trajectory, times)
    level = np.abs(position[:, 0] - 5.0) < 3.0
    assert np.abs(position[level, 2] - top).max() < 0.05
    assert np.allclose(position[-1, :2], 0.0, atol=1e-6) and position[-1, 2] >= GROUND
