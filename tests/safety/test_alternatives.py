"""Sides on which an obstacle in conflict may be passed: the planes of the plans that are tried."""

from types import SimpleNamespace

import numpy as np
import pytest

from idc_controller.geometry.obstacles import PredictedObstacle
from idc_controller.geometry.shapes import Sphere
from idc_controller.safety.safety_filter import alternatives
from idc_controller.safety.separation import Separation

STAGES, PERIOD = 9, 0.25
ABOVE, STOPPED = 0, 3  # places among the alternatives; 1 is left, 2 right


def separation(normal, velocity=(0.0, 0.0, 0.0)):
    centres = np.array([5.0, 0.0, -5.0]) + PERIOD * np.arange(STAGES)[:, None] * np.array(velocity)
    obstacle = PredictedObstacle("ball", Sphere(0.5), centres, np.zeros(STAGES))
    return Separation(obstacle, np.ones(STAGES), np.tile(normal, (STAGES, 1)))


def normals_of(velocity, obstacles, values):
    """Normals (4, O, K + 1, 3) of the alternatives for a reference's ``velocity`` (3,) and ``values`` (O, K + 1)."""
    barrier = SimpleNamespace(
        values=lambda *_: np.stack([values, values + 1.0], axis=1),
        settings=SimpleNamespace(chain=SimpleNamespace(period=PERIOD)),
    )
    zeros = np.zeros((STAGES, 3))
    sets = alternatives(barrier, obstacles, zeros, zeros, np.tile(velocity, (STAGES, 1)))
    return np.array([[s.normals for s in one] for one in sets])


def conflict(first, last):
    values = np.ones((1, STAGES))
    values[0, first : last + 1] = -0.1
    return values


def heading_of(velocity, obstacle):
    """Return the direction that a stop before the obstacle blocks."""
    return normals_of(velocity, [obstacle], conflict(3, 5))[STOPPED, 0, 3]


def test_obstacle_is_passed_above_left_and_right_of_the_motion_or_stopped_before():
    normal = np.array([0.6, 0.8, 0.0])
    normals = normals_of((2.0, 0.0, 0.0), [separation(normal)], conflict(3, 5))[:, 0]
    blocked = [(0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (1.0, 0.0, 0.0)]  # NED: below, right, left, ahead
    for found, expected in zip(normals, blocked, strict=True):
        assert np.array_equal(found[:3], np.tile(normal, (3, 1)))
        np.testing.assert_allclose(found[3:6], np.tile(expected, (3, 1)), atol=1e-12)
    assert np.array_equal(normals[ABOVE, 6:], np.tile(normal, (3, 1)))
    np.testing.assert_allclose(normals[STOPPED, 6:], np.tile(blocked[STOPPED], (3, 1)), atol=1e-12)


@pytest.mark.parametrize(
    ("velocity", "heading"),
    [
        ((0.06, 0.0, 0.0), (1.0, 0.0, 0.0)),
        ((0.0, -2.0, 3.0), (0.0, -1.0, 0.0)),
        ((0.04, 0.0, 0.0), (0.6, 0.8, 0.0)),  # too slow to have a direction
        ((0.0, 0.0, -2.0), (0.6, 0.8, 0.0)),  # no horizontal one
    ],
)
def test_sides_are_those_of_the_horizontal_motion_or_of_the_obstacle_without_one(velocity, heading):
    np.testing.assert_allclose(heading_of(velocity, separation((0.36, 0.48, 0.8))), heading, atol=1e-12)


def test_sides_are_those_of_the_motion_relative_to_the_obstacle():
    crossing = separation((1.0, 0.0, 0.0), velocity=(0.0, 1.5, 0.0))
    np.testing.assert_allclose(heading_of((2.0, 0.0, 0.0), crossing), (0.8, -0.6, 0.0), atol=1e-12)


def test_only_the_obstacle_of_the_first_conflict_is_passed_otherwise():
    obstacles = [separation((1.0, 0.0, 0.0)), separation((0.0, 1.0, 0.0))]
    values = np.vstack([conflict(6, 7), conflict(2, 3)])
    normals = normals_of((2.0, 0.0, 0.0), obstacles, values)
    assert np.array_equal(normals[:, 0], np.tile(obstacles[0].normals, (4, 1, 1)))
    np.testing.assert_allclose(normals[ABOVE, 1, 2:4], np.tile([0.0, 0.0, 1.0], (2, 1)))


def test_nearest_stage_is_passed_otherwise_where_no_margin_is_missed():
    values = np.ones((1, STAGES))
    values[0, 4] = 0.2
    normals = normals_of((2.0, 0.0, 0.0), [separation((1.0, 0.0, 0.0))], values)[ABOVE, 0]
    assert np.flatnonzero(normals[:, 2]).tolist() == [4]
