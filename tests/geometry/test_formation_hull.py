"""The hull in flat coordinates against the exact formation, and its distances against coal."""

import coal
import numpy as np
import pytest
import trimesh
from avoidance_scene import hull_of
from paper_system import system
from plain_barrier import disc_support
from plain_flatness import flat_forces

from idc_controller.geometry.formation import Formation, outward_facets
from idc_controller.geometry.obstacles import PredictedObstacle
from idc_controller.geometry.shapes import Pole, Sphere, Wall
from idc_controller.safety.separation import PredictedObstacles, separations
from idc_controller.trajectory.flatness import Load

TEAMS = [3, 4, 6, 8]
SHAPES = [Sphere(0.5), Pole(0.3, 12.0), Wall(size=(0.3, 4.0, 5.0), yaw=0.4)]


def accelerations(rng, K=40, lateral=3.0, vertical=2.5):
    a = rng.uniform(-1.0, 1.0, (K, 3)) * [lateral, lateral, vertical]
    a[0] = 0.0
    return a


@pytest.mark.parametrize("n", TEAMS)
def test_rims_span_the_outward_half_of_each_disc(n):
    parameters, formation = system(n), Formation(system(n))
    outward = parameters.p[:, :2] / np.linalg.norm(parameters.p[:, :2], axis=1, keepdims=True)
    aside = np.column_stack([-outward[:, 1], outward[:, 0]])
    along, across = (np.einsum("nrk,nk->nr", formation.rims[:, :, :2], axis) for axis in (outward, aside))
    assert np.all(along > -1e-12) and np.hypot(along, across) == pytest.approx(parameters.disc_radius)
    assert across.max(axis=1) == pytest.approx(parameters.disc_radius)
    assert across.min(axis=1) == pytest.approx(-parameters.disc_radius)


@pytest.mark.parametrize("n", TEAMS)
def test_uav_offsets_agree_with_flatness(n):
    parameters, formation = system(n), Formation(system(n))
    a = accelerations(np.random.default_rng(n))
    derivatives = np.zeros((5, len(a), 3))
    derivatives[2] = a
    q = flat_forces(parameters, derivatives, Load(parameters.m_0, np.zeros(3))).q
    exact = parameters.p - parameters.l[:, None] * q[:, None]
    rims = formation.hull_points(a)[:, len(formation.corners) :].reshape(len(a), n, -1, 3)
    computed = (rims - formation.rims)[:, :, 0]
    tilt = np.hypot(a[:, 0], a[:, 1]) / (parameters.g - a[:, 2])
    error = np.abs(computed - exact)
    l = parameters.l.max()
    # Tangent for sine sideways, and the link's full length for its height.
    assert np.all(error[..., :2].max(axis=(1, 2)) <= 0.5 * l * tilt**3 + 1e-12)
    assert np.all(error[..., 2].max(axis=1) <= 0.5 * l * tilt**2 + 1e-12)
    assert np.all(error[0] < 1e-12)
    assert error.max() > 1e-3  # the accelerations are large enough to distinguish them


@pytest.mark.parametrize("n", TEAMS)
def test_at_rest_hull_is_the_exact_one_to_within_the_rims_polygons(n):
    parameters, formation = system(n), Formation(system(n))
    exact = hull_of(parameters, np.zeros((5, 1, 3)), rim=64)[0]
    points = formation.hull_points(np.zeros((1, 3)))[0]
    rng = np.random.default_rng(n)
    directions = rng.normal(size=(200, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    excess = (exact @ directions.T).max(axis=0) - (points @ directions.T).max(axis=0)
    # The rims are coarse only as far as the clearance of the plan for the discs covers it, for up to six UAVs.
    assert excess.max() < (0.05 if n <= 6 else 0.1)
    assert excess.min() > -1e-3


@pytest.mark.parametrize("n", TEAMS)
def test_discs_and_payload_supports_bound_the_exact_hull(n):
    """The supports in the planner's rows are never below the true extent, but for the links' own second order."""
    parameters, formation = system(n), Formation(system(n))
    rng = np.random.default_rng(10 + n)
    a = accelerations(rng, 60)
    derivatives = np.zeros((5, len(a), 3))
    derivatives[2] = a
    exact = hull_of(parameters, derivatives, rim=32)
    normals = rng.normal(size=(len(a), 3))
    normals[::2, 2] = 0.0
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    lever = formation.lengths[0] / (formation.g - a[:, 2])
    computed = np.maximum(
        (normals @ formation.payload.vertices.T).max(axis=1),
        disc_support(formation, normals, a) + lever * np.sum(normals[:, :2] * a[:, :2], axis=1),
    )
    true = np.einsum("kpi,ki->kp", exact, normals).max(axis=1)
    tilt = np.hypot(a[:, 0], a[:, 1]) / (parameters.g - a[:, 2])
    allowed = 0.5 * parameters.l.max() * (tilt**3 + tilt**2 * np.abs(normals[:, 2]))
    assert np.all(computed >= true - allowed - 1e-9)


@pytest.mark.parametrize("n", TEAMS)
@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: s.kind)
def test_distance_and_plane_are_those_of_the_convex_hulls(n, shape):
    formation, rng, K, apart = Formation(system(n)), np.random.default_rng(20 + n), 8, 0
    a, position = accelerations(rng, K), rng.normal((0.0, 0.0, -6.0), size=(K, 3))
    away = rng.normal(size=(K, 3)) * [1.0, 1.0, 0.4]
    offset = 3.2 * away / np.linalg.norm(away, axis=1, keepdims=True) + [0.0, 0.0, -1.5]
    obstacle = PredictedObstacle("o", shape, position + offset, np.zeros(K))
    (found,) = separations(formation, position, a, PredictedObstacles([obstacle]), 50.0)
    for k, points in enumerate(formation.hull_points(a)):
        there, here = coal.Transform3s(shape.rotation, offset[k]), coal.Transform3s.Identity()
        request, result = coal.DistanceRequest(), coal.DistanceResult()
        expected = coal.distance(formation.hull(points), here, shape.geometry(), there, request, result)
        if expected > 1e-3:
            apart += 1
            assert found.distance[k] == pytest.approx(expected, abs=2e-3)
            # A plane with this clearance between the bodies proves that they are no nearer.
            normal = found.normals[k]
            assert np.linalg.norm(normal) == pytest.approx(1.0)
            gap = normal @ offset[k] - shape.support(-normal) - (points @ normal).max()
            assert gap == pytest.approx(found.distance[k], abs=2e-3)
    assert apart >= 3


def test_only_near_obstacles_are_active():
    formation = Formation(system())
    shape = Sphere(0.5)
    K = 5
    position = np.column_stack([np.linspace(0.0, 8.0, K), np.zeros(K), np.full(K, -5.0)])
    near, far, grown = (
        PredictedObstacle(name, shape, np.tile(place, (K, 1)), np.full(K, growth))
        for name, place, growth in (
            ("near", [8.0, 2.5, -5.0], 0.0), ("far", [8.0, 8.0, -5.0], 0.0), ("grown", [8.0, -6.0, -5.0], 3.0),
        )
    )  # fmt: skip
    found = separations(formation, position, np.zeros((K, 3)), PredictedObstacles([near, far, grown]), 2.5)
    assert [s.obstacle.name for s in found] == ["near", "grown"]
    # The distance of far stages is not below the limit of evaluation.
    assert found[0].distance[0] >= 2.5
    assert found[0].clearance == pytest.approx(found[0].distance.min())
    assert found[1].clearance == pytest.approx(found[1].distance.min() - 3.0)


def test_distance_of_overlap_is_negative():
    formation = Formation(system())
    inside = PredictedObstacle("in", Sphere(0.5), np.array([[0.0, 0.0, -6.0]]), np.zeros(1))
    (found,) = separations(formation, np.array([[0.0, 0.0, -5.0]]), np.zeros((1, 3)), PredictedObstacles([inside]), 2.5)
    assert found.distance[0] < -0.4


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("edges", [None, (1.0, 2.0, 0.3)])
def test_facets_are_those_of_trimesh(seed, edges):
    points = np.random.default_rng(seed).standard_normal((30, 3))
    if edges is not None:  # four points on each plane
        points = trimesh.creation.box(edges).vertices + points[0]
    hull = trimesh.convex.convex_hull(points)
    triangles, normals = points[outward_facets(points)], hull.face_normals
    assert triangles == pytest.approx(hull.triangles)
    assert trimesh.triangles.normals(triangles)[0] == pytest.approx(normals)
