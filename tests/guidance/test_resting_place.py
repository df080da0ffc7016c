"""Resting place of the team after link loss: clear of known obstacles, default braking wherever that is clear."""

import numpy as np
import pytest
from braking_path import path_of
from hypothesis import given, settings
from hypothesis import strategies as st
from standing_obstacles import StandingObstacles

from gcs.config import read_system
from idc_controller.geometry.obstacles import PredictedObstacle
from idc_controller.geometry.shapes import Box, Capsule, Mesh, MeshHull, Pole, Sphere, Wall
from idc_controller.guidance.resting_place import RestingPlace, least_distance
from idc_controller.guidance.resting_place_kernels import least_distances
from idc_controller.guidance.settings import RestingPlaceSettings
from idc_controller.trajectory.stop_plan import Braking
from idc_controller.trajectory.stop_plan_kernels import control_points

PARAMETERS = read_system().parameters()
#: Position, velocity, acceleration: 2 m/s north at 5 m.
STATE = np.array([[0.0, 0.0, -5.0], [2.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
USUAL = Braking()
REST = path_of(USUAL, STATE)(USUAL.duration(STATE[1]))
WIDTH = 0.95  # m, more than the formation's half width


def sphere(place, radius=0.5):
    return StandingObstacles([("sphere", Sphere(radius), np.asarray(place, dtype=float))])


class Swinging:
    """A sphere that swings along y through a place."""

    def __init__(self, place, amplitude):
        self._place, self._amplitude = np.asarray(place, dtype=float), amplitude

    def predict(self, times, region=None):
        positions = np.tile(self._place, (len(times), 1))
        positions[:, 1] += self._amplitude * np.sin(1.5 * np.asarray(times))
        return [PredictedObstacle("swinging", Sphere(0.5), positions, np.zeros(len(times)))]


def rest_of(braking):
    return path_of(braking, STATE)(braking.duration(STATE[1]))


@settings(deadline=None, derandomize=True)
@given(
    shape=st.sampled_from([Sphere(0.5), Pole(0.2, 9.0), Wall((0.3, 3.0, 2.0), 0.4), Capsule(0.3, 1.5, pitch=0.7)]),
    place=st.tuples(*[st.floats(-6.0, 6.0)] * 2, st.floats(-8.0, 0.0)),
    velocity=st.tuples(*[st.floats(-2.0, 2.0)] * 3),
    state=st.tuples(*[st.floats(-2.0, 2.0)] * 6),
)
def test_least_distance_of_kernel_agrees_with_plain_formula(shape, place, velocity, state):
    state = np.array([[0.0, 0.0, -5.0], state[:3], state[3:]])
    elapsed, axis = np.linspace(0.0, 10.0, 21), np.linspace(-1.0, 0.3, 9)
    centres, growth = np.array(place) + elapsed[:, None] * np.array(velocity), 0.05 * elapsed
    duration = USUAL.duration(state[1])
    control = control_points(state[None], np.array([duration]), np.array([USUAL.aside]))
    least = least_distances(
        control, np.array([duration]), elapsed, axis, 0.4,
        shape.row[None], np.array([shape.reach]), centres[None], growth[None], 2.0,
    )  # fmt: skip
    places = path_of(USUAL, state)(np.minimum(elapsed, duration))
    assert least[0] == pytest.approx(least_distance(shape, places, axis, centres, growth, 2.0), abs=1e-12)


def test_resting_place_beside_mesh_is_that_beside_box_of_its_corners():
    box = Box((0.8, 1.0, 1.2), yaw=0.3)
    mesh = Mesh(MeshHull("box.stl", tuple(map(tuple, box.corners.tolist()))), yaw=0.3)
    place = REST + np.array([0.3, 0.1, 0.0])
    by_box, by_mesh = (RestingPlace(PARAMETERS, StandingObstacles([("o", s, place)]))(0.0, STATE) for s in (box, mesh))
    assert by_box == by_mesh != USUAL


def test_default_braking_path_starts_with_current_motion_and_ends_at_rest():
    braking_path = path_of(USUAL, STATE)
    assert [braking_path.derivative(k)(0.0) for k in (1, 2)] == [pytest.approx(STATE[1]), pytest.approx(STATE[2])]
    assert braking_path.derivative()(braking_path.x[-1]) == pytest.approx(np.zeros(3))


@pytest.mark.parametrize(
    "obstacles",
    [StandingObstacles([]), sphere((REST[0], 6.0, -5.0)), sphere((-4.0, 0.0, -5.0)), sphere((REST[0], 0.0, -11.0))],
    ids=["none", "aside", "behind", "above"],
)
def test_default_braking_is_used_where_it_is_clear(obstacles):
    assert RestingPlace(PARAMETERS, obstacles)(0.0, STATE) == USUAL


@pytest.mark.parametrize("height", [1.0, 2.5, 5.0])
@pytest.mark.parametrize("beside", [(0.0, 0.0), (0.6, 0.0), (0.0, -0.8)])
def test_resting_place_and_descent_keep_clear_of_obstacle(beside, height):
    place = np.array([REST[0] + beside[0], REST[1] + beside[1], -height])
    rest = rest_of(RestingPlace(PARAMETERS, sphere(place))(0.0, STATE))
    assert np.hypot(*(rest - place)[:2]) - 0.5 - WIDTH > 0.6
    assert np.hypot(*(REST - place)[:2]) - 0.5 - WIDTH < 0.6


def test_resting_place_keeps_clear_of_swinging_obstacle():
    obstacle = Swinging((REST[0], 2.0, -5.0), 2.0)
    rest = rest_of(RestingPlace(PARAMETERS, obstacle)(0.0, STATE))
    places = obstacle.predict(np.linspace(0.0, 20.0, 400))[0].positions
    assert np.hypot(*(places - rest)[:, :2].T).min() - 0.5 - WIDTH > 0.6


def test_chosen_braking_is_kept_while_clear():
    chosen = RestingPlace(PARAMETERS, sphere(REST))
    first = chosen(0.0, STATE)
    assert first != USUAL
    for k in range(1, 10):
        moved = STATE.copy()
        moved[0, 0] += 0.02 * k
        assert chosen(0.05 * k, moved) == first


class Changing:
    """Obstacles that are exchanged for others."""

    def __init__(self, source):
        self.source = source

    def predict(self, times, region=None):
        return self.source.predict(times, region)


@pytest.mark.parametrize("meanwhile", ["near", "far"])
def test_chosen_braking_is_forgotten_once_no_obstacle_is_near(meanwhile):
    source, other = Changing(sphere(REST)), sphere(np.add(REST, [0.3, 0.2, 0.0]))
    choose = RestingPlace(PARAMETERS, source)
    first, anew = choose(0.0, STATE), RestingPlace(PARAMETERS, other)(0.0, STATE)
    assert len({USUAL, first, anew}) == 3
    if meanwhile == "far":
        source.source = StandingObstacles([])
        assert choose(1.0, STATE) == USUAL
    source.source = other
    assert choose(2.0, STATE) == (anew if meanwhile == "far" else first)


def test_braking_with_most_clearance_is_chosen_when_none_is_clear():
    everywhere = StandingObstacles(
        [(f"{x} {y}", Pole(0.2, 10.0), np.array([x, y, -5.0]))
         for x in np.arange(-1.0, 12.0, 2.2) for y in np.arange(-5.5, 6.0, 2.2)]
    )  # fmt: skip

    def clearance_at_rest(braking):
        places = np.array([obstacle.positions[0] for obstacle in everywhere.predict(np.zeros(1))])
        return np.hypot(*(rest_of(braking) - places)[:, :2].T).min() - 0.2 - WIDTH

    chosen = clearance_at_rest(RestingPlace(PARAMETERS, everywhere)(0.0, STATE))
    assert clearance_at_rest(USUAL) - 0.2 < chosen < RestingPlaceSettings().clearance


@pytest.mark.parametrize("speed", [0.0, 0.5, 2.0, 8.0])
@pytest.mark.parametrize("acceleration", [0.0, 1.5])
def test_obstacles_are_considered_as_far_as_any_stop_leads(speed, acceleration):
    class Watched(StandingObstacles):
        def predict(self, times, region=None):
            regions.append(region)
            return super().predict(times, region)

    regions, settings = [], RestingPlaceSettings()
    choose = RestingPlace(PARAMETERS, Watched([]))
    for k in range(8):
        heading = np.array([np.cos(k), np.sin(k), 0.0])
        state = np.array([[3.0, 4.0, -5.0], speed * heading, acceleration * heading[[1, 0, 2]] * [1, -1, 1]])
        choose(0.0, state)
        region = regions.pop()
        farthest = 0.0
        for stop in choose._choices.stops:
            path = path_of(stop, state)
            places = path(np.linspace(0.0, path.x[-1], 50)) - region.place
            farthest = max(farthest, np.linalg.norm(places, axis=1).max())
        assert region.place == pytest.approx(state[0])
        assert region.radius > farthest + WIDTH - 0.01 + settings.clearance + settings.growth_max
