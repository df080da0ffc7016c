"""The distance between hull and rounded box against the distance library."""

import coal
import numpy as np
import pytest
from paper_system import system

from idc_controller.geometry.formation import Formation
from idc_controller.geometry.gjk_kernels import measure_distances
from idc_controller.geometry.shapes import Box, Capsule, Pole, Sphere, Wall

STAGES = 200
SHAPES = [
    Sphere(0.5), Pole(0.3, 12.0), Wall((0.3, 4.0, 5.0), yaw=0.4), Wall((1.0, 1.0, 1.0)),
    Box(roll=0.3, pitch=-0.5, yaw=1.0, size=(0.4, 1.0, 3.0)), Capsule(pitch=0.7, yaw=0.2, radius=0.2, length=3.0),
]  # fmt: skip


def measured(points, shape, offsets, growth=0.0, limit=np.inf):
    toward = offsets / np.linalg.norm(offsets, axis=1, keepdims=True)
    normals = toward[None].copy()
    bounds = np.linalg.norm(offsets, axis=1)[None] - shape.reach - np.linalg.norm(points, axis=2).max(axis=1)
    distances, missing = measure_distances(
        points, np.array([1]), offsets[None], bounds, normals, np.full((2, len(points)), growth),
        np.array([np.zeros(14), shape.row]), np.array([False, shape.rounded_box is not None]), 0.5, limit,
    )  # fmt: skip
    return distances[0], missing[0], normals[0], bounds[0], toward


def by_library(formation, points, shape, offset):
    result = coal.DistanceResult()
    distance = coal.distance(
        formation.hull(points), coal.Transform3s.Identity(), shape.geometry(),
        coal.Transform3s(shape.rotation, offset), coal.DistanceRequest(), result,
    )  # fmt: skip
    return distance, np.array(result.normal)


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("shape", SHAPES, ids=repr)
def test_distance_and_normal_are_those_of_the_library(shape, seed):
    formation, rng = Formation(system(3 + seed)), np.random.default_rng(seed)
    points = formation.hull_points(rng.normal(size=(STAGES, 3)) * 1.5)
    offsets = rng.normal(size=(STAGES, 3)) * [4.0, 4.0, 3.0]
    distances, missing, normals, _, _ = measured(points, shape, offsets)
    assert (~missing).sum() > 0.4 * STAGES
    for k in range(STAGES):
        distance, normal = by_library(formation, points[k], shape, offsets[k])
        if missing[k]:
            assert distance < 1e-4
            continue
        assert distances[k] == pytest.approx(distance, abs=2e-5)
        np.testing.assert_allclose(normals[k], normal, atol=3e-3)
        # The plane across the shortest way proves that the bodies are no nearer.
        gap = normals[k] @ offsets[k] - shape.support(-normals[k]) - (points[k] @ normals[k]).max()
        assert gap == pytest.approx(distances[k], abs=1e-6)


def test_nothing_is_measured_beyond_the_limit():
    formation, shape = Formation(system()), Sphere(0.5)
    points = formation.hull_points(np.zeros((3, 3)))
    offsets = np.array([[9.0, 0.0, 0.0], [6.0, 1.0, 0.0], [30.0, 0.0, 0.0]])
    distances, missing, normals, bounds, toward = measured(points, shape, offsets, growth=0.2, limit=4.5)
    assert not missing.any()
    assert bounds[1] - 0.2 < 4.5 <= bounds[0] - 0.2
    np.testing.assert_array_equal(distances[[0, 2]], bounds[[0, 2]])
    np.testing.assert_array_equal(normals[[0, 2]], toward[[0, 2]])
    assert distances[1] > bounds[1]


def test_bound_below_the_least_is_replaced_by_it():
    formation = Formation(system())
    points = formation.hull_points(np.zeros((1, 3)))
    distances, missing, _, bounds, _ = measured(points, Sphere(0.5), np.array([[2.0, 0.0, 0.0]]), limit=-9.0)
    assert bounds[0] < 0.5
    assert distances[0] == 0.5
    assert not missing.any()


def test_overlap_and_other_bodies_are_left_to_the_library():
    formation = Formation(system())
    points = formation.hull_points(np.zeros((2, 3)))
    offsets = np.array([[0.0, 0.0, -0.3], [4.0, 0.0, 0.0]])
    assert measured(points, Sphere(0.5), offsets)[1].tolist() == [True, False]
