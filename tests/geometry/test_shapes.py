"""Every shape of the registry: its methods agree with each other and with the distance library's geometry."""

import dataclasses
import json
import math

import coal
import numpy as np
import pytest
import shapely
from bodies import EXAMPLES

from idc_controller.errors import ShapeError
from idc_controller.geometry.obstacles import Bodies, PointGroups
from idc_controller.geometry.shapes import SHAPES, Wall, shape_class

pytestmark = pytest.mark.numerics

HERE = np.array([1.0, -2.0, -4.0])
OTHER_BATCH = 1e-13
"""Most that distances (m) of some 10 m differ by between batch sizes: BLAS may sum each size in an order of its own."""


def test_every_registered_shape_has_an_example():
    assert {type(shape) for shape in EXAMPLES} == set(SHAPES.values())


def test_unknown_shape_is_refused():
    with pytest.raises(ShapeError, match="shape is 'cone', expected one of sphere, pole, wall, capsule, box, mesh"):
        shape_class("cone")


@pytest.fixture(params=EXAMPLES, ids=lambda shape: shape.kind)
def shape(request):
    return request.param


def points_about(shape, count=200, seed=3):
    rng = np.random.default_rng(seed)
    return rng.uniform(-1.0, 1.0, (count, 3)) * (shape.reach + 1.5)


def distance_by_library(shape, point):
    place = coal.Transform3s(shape.rotation, np.zeros(3))
    probe = coal.Transform3s(np.eye(3), point)
    return coal.distance(
        shape.geometry(), place, coal.Sphere(1e-9), probe, coal.DistanceRequest(), coal.DistanceResult()
    )


def test_distance_outside_is_that_of_the_distance_library(shape):
    points = points_about(shape)
    distance = Bodies([shape]).distance(points + HERE, HERE[None])[0]
    outside = distance > 0.01
    assert outside.any()
    expected = [distance_by_library(shape, point) for point in points[outside]]
    np.testing.assert_allclose(distance[outside], expected, atol=1e-5)


def distance_to_rounded_box(shape, points):
    """The distance kernel in numpy: horizontal and vertical gap, joined by Pythagoras."""
    box, (x, y, z) = shape.rounded_box, (points @ shape.rotation).T
    x, y, z = np.abs(x) - box.half_x, np.abs(y) - box.half_y, np.abs(z) - box.half_z
    across = np.hypot(np.maximum(x, 0.0), np.maximum(y, 0.0)) + np.minimum(np.maximum(x, y), 0.0) - box.radial
    return np.hypot(np.maximum(across, 0.0), np.maximum(z, 0.0)) + np.minimum(np.maximum(across, z), 0.0) - box.ball


@pytest.mark.parametrize("shape", [shape for shape in EXAMPLES if shape.rounded_box], ids=lambda shape: shape.kind)
def test_distance_kernels_agree_with_formula_in_numpy(shape):
    points, bodies = points_about(shape, 2000), Bodies([shape])
    expected = distance_to_rounded_box(shape, points)
    np.testing.assert_allclose(bodies.from_offsets(points[None])[0], expected, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(bodies.distance(points + HERE, HERE[None])[0], expected, rtol=0.0, atol=1e-12)


def test_points_inside_have_negative_distance(shape):
    assert Bodies([shape]).from_offsets(np.zeros((1, 1, 3)))[0, 0] < -0.1


def test_distances_of_several_shapes_equal_those_of_each_shape():
    points = points_about(EXAMPLES[0])
    shapes = [*EXAMPLES, *EXAMPLES[::-1]]
    centres = np.random.default_rng(1).uniform(-3.0, 3.0, (len(shapes), 3))
    together = Bodies(shapes).distance(points, centres)
    for shape, centre, distance in zip(shapes, centres, together, strict=True):
        alone = Bodies([shape]).distance(points, centre[None])[0]
        np.testing.assert_allclose(distance, alone, rtol=0.0, atol=OTHER_BATCH)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("spread", [(0.3, 0.3, 0.3), (3.0, 0.1, 0.1), (0.1, 3.0, 0.1)], ids=["ball", "x", "y"])
@pytest.mark.parametrize("far", [math.inf, 1.0])
def test_mean_distances_of_groups_equal_those_of_their_points(far, spread, seed):
    rng = np.random.default_rng(2 + seed)
    bodies, centres = Bodies(EXAMPLES), rng.uniform(-6.0, 6.0, (len(EXAMPLES), 3))
    groups = [rng.normal(rng.uniform(-6.0, 6.0, 3), spread, (size, 3)) for size in (3, 0, 1, 9, 0)]
    found = bodies.mean_distances(PointGroups.of(groups), centres, far)
    expected = [
        np.abs(bodies.distance(group, centres)).mean(axis=1) if len(group) else np.full(len(centres), np.inf)
        for group in groups
    ]
    near = np.array(expected) <= far
    assert found.shape == near.shape
    np.testing.assert_allclose(found[near], np.array(expected)[near], rtol=1e-12)
    assert (found[~near] > far).all() or far == math.inf
    assert bodies.mean_distances(PointGroups.of([]), centres).shape == (0, len(centres))
    assert Bodies(()).mean_distances(PointGroups.of(groups), np.empty((0, 3))).shape == (5, 0)


def test_distance_of_one_point_from_each_body():
    points, shapes = points_about(EXAMPLES[0], 20), [*EXAMPLES, *EXAMPLES]
    indices = np.random.default_rng(1).integers(0, len(shapes), 20).tolist()
    expected = [
        Bodies([shapes[i]]).from_offsets(point[None, None])[0, 0] for i, point in zip(indices, points, strict=True)
    ]
    np.testing.assert_allclose(Bodies(shapes).from_own_offsets(indices, points), expected, rtol=0.0, atol=OTHER_BATCH)


def test_support_is_reached_and_not_exceeded_by_the_body(shape):
    points = points_about(shape, 4000)
    inside = points[Bodies([shape]).from_offsets(points[None])[0] <= 0.0]
    directions = np.random.default_rng(2).normal(size=(50, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    support = shape.support(directions)
    assert ((inside @ directions.T).max(axis=0) <= support + 1e-9).all()
    # A point just beyond the supporting plane's point of contact does not belong to the body.
    assert (Bodies([shape]).from_offsets((directions * (support + 0.01)[:, None])[None])[0] > 0.0).all()
    assert (support <= shape.reach + 1e-9).all()


def test_bounds_hold_the_body(shape):
    points = points_about(shape, 4000)
    inside = points[Bodies([shape]).from_offsets(points[None])[0] <= 0.0]
    assert np.hypot(inside[:, 0], inside[:, 1]).max() <= shape.horizontal_reach + 1e-9
    bounds = shape.upright_bounds
    along = np.abs(bounds.cosine * inside[:, 0] + bounds.sine * inside[:, 1]) - bounds.half_x
    across = np.abs(bounds.cosine * inside[:, 1] - bounds.sine * inside[:, 0]) - bounds.half_y
    lateral = np.hypot(np.maximum(along, 0.0), np.maximum(across, 0.0)) - bounds.radial
    above = np.abs(inside[:, 2]) - bounds.half_z
    assert (np.hypot(np.maximum(lateral, 0.0), np.maximum(above, 0.0)) <= bounds.ball + 1e-9).all()
    outline = shapely.Polygon(shape.plan_view.outline()).buffer(1e-3 * shape.horizontal_reach)
    assert shapely.contains_xy(outline, inside[:, 0], inside[:, 1]).all()
    assert all(shape.plan_view.contains(tuple(point)) for point in inside[:50, :2])


def test_quaternion_is_the_rotation(shape):
    from idc_controller.rotations import rotation_from_quaternion

    np.testing.assert_allclose(rotation_from_quaternion(np.array(shape.quaternion)), shape.rotation, atol=1e-12)


def test_columns_or_fields_give_the_shape_back(shape):
    if shape.in_columns:
        assert type(shape).from_columns(shape.columns) == shape
    else:
        with pytest.raises(ShapeError, match="needs the run's obstacle_shapes"):
            type(shape).from_columns(shape.columns)
    assert type(shape).from_fields(json.loads(json.dumps(dataclasses.asdict(shape)))) == shape


def test_shape_without_extent_is_refused():
    with pytest.raises(ShapeError, match="size_y must be positive, got 0"):
        Wall((1.0, 0.0, 1.0)).check()
    with pytest.raises(ShapeError, match="yaw must be finite"):
        Wall((1.0, 1.0, 1.0), float("nan")).check()
