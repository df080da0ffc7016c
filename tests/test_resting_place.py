"""Where a team that hears no more comes to rest: clear of what is known, and the usual way wherever that is."""

import numpy as np
import pytest

from gcs.config import read_system
from idc_controller.geometry.obstacles import PredictedObstacle, StandingObstacles
from idc_controller.geometry.pole import Pole
from idc_controller.geometry.sphere import Sphere
from idc_controller.guidance.resting_place import RestingPlace
from idc_controller.guidance.settings import RestingPlaceSettings
from idc_controller.trajectory.stop_plan import Braking

PARAMETERS = read_system().parameters()
#: Position, velocity, acceleration: 2 m/s north at 5 m.
STATE = np.array([[0.0, 0.0, -5.0], [2.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
USUAL = Braking()
REST = USUAL.path(STATE)(USUAL.duration(STATE[1]))
WIDTH = 0.95  # m, more than the formation's half width


def sphere(place, radius=0.5):
    return StandingObstacles([("sphere", Sphere(radius), np.asarray(place, dtype=float))])


class Swinging:
    """A sphere that swings along y through a place."""

    def __init__(self, place, amplitude):
        self._place, self._amplitude = np.asarray(place, dtype=float), amplitude

    def predict(self, times):
        positions = np.tile(self._place, (len(times), 1))
        positions[:, 1] += self._amplitude * np.sin(1.5 * np.asarray(times))
        return [PredictedObstacle("swinging", Sphere(0.5), positions, np.zeros(len(times)))]


def rest_of(braking):
    return braking.path(STATE)(braking.duration(STATE[1]))


def test_the_usual_way_takes_over_the_motion_and_ends_at_rest():
    way = USUAL.path(STATE)
    assert [way.derivative(k)(0.0) for k in (1, 2)] == [pytest.approx(STATE[1]), pytest.approx(STATE[2])]
    assert way.derivative()(way.x[-1]) == pytest.approx(np.zeros(3))


@pytest.mark.parametrize(
    "obstacles",
    [StandingObstacles([]), sphere((REST[0], 6.0, -5.0)), sphere((-4.0, 0.0, -5.0)), sphere((REST[0], 0.0, -11.0))],
    ids=["none", "aside", "behind", "above"],
)
def test_where_it_is_clear_nothing_changes(obstacles):
    assert RestingPlace(PARAMETERS, obstacles)(0.0, STATE) == USUAL


@pytest.mark.parametrize("height", [1.0, 2.5, 5.0])
@pytest.mark.parametrize("beside", [(0.0, 0.0), (0.6, 0.0), (0.0, -0.8)])
def test_it_neither_rests_at_an_obstacle_nor_comes_down_on_one(beside, height):
    place = np.array([REST[0] + beside[0], REST[1] + beside[1], -height])
    rest = rest_of(RestingPlace(PARAMETERS, sphere(place))(0.0, STATE))
    assert np.hypot(*(rest - place)[:2]) - 0.5 - WIDTH > 0.6
    assert np.hypot(*(REST - place)[:2]) - 0.5 - WIDTH < 0.6


def test_it_does_not_rest_where_an_obstacle_swings_by():
    obstacle = Swinging((REST[0], 2.0, -5.0), 2.0)
    rest = rest_of(RestingPlace(PARAMETERS, obstacle)(0.0, STATE))
    places = obstacle.predict(np.linspace(0.0, 20.0, 400))[0].positions
    assert np.hypot(*(places - rest)[:, :2].T).min() - 0.5 - WIDTH > 0.6


def test_it_keeps_to_what_it_chose_while_that_is_clear():
    chosen = RestingPlace(PARAMETERS, sphere(REST))
    first = chosen(0.0, STATE)
    assert first != USUAL
    for k in range(1, 10):
        moved = STATE.copy()
        moved[0, 0] += 0.02 * k
        assert chosen(0.05 * k, moved) == first


def test_where_nothing_is_clear_the_best_is_taken():
    everywhere = StandingObstacles(
        [(f"{x} {y}", Pole(0.2, 10.0), np.array([x, y, -5.0]))
         for x in np.arange(-1.0, 12.0, 2.2) for y in np.arange(-5.5, 6.0, 2.2)]
    )  # fmt: skip

    def room(braking):
        places = np.array([obstacle.positions[0] for obstacle in everywhere.predict(np.zeros(1))])
        return np.hypot(*(rest_of(braking) - places)[:, :2].T).min() - 0.2 - WIDTH

    chosen = room(RestingPlace(PARAMETERS, everywhere)(0.0, STATE))
    assert room(USUAL) - 0.2 < chosen < RestingPlaceSettings().clearance
