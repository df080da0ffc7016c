"""The kernels of the planner against plain numpy."""

import numpy as np
import pytest
from paper_system import system
from plain_barrier import disc_support

from idc_controller.geometry.box import Box, Wall
from idc_controller.geometry.formation import Formation
from idc_controller.geometry.pole import Pole
from idc_controller.geometry.sphere import Sphere
from idc_controller.safety import planner_kernels as kernels
from idc_controller.safety.constraints.exponential_barrier import barrier_operator
from idc_controller.safety.settings import PlannerSettings

CHAIN = PlannerSettings().chain
K = CHAIN.stages


def within_reach_plainly(points, position, centres, growth, reach, upright, limit):
    """All obstacles by whole arrays."""
    middle = (points.max(axis=1) + points.min(axis=1)) / 2.0
    about = points - middle[:, None]
    offsets = centres - position
    directions = offsets - middle
    directions[upright, :, 2] = 0.0
    bound = np.where(
        upright[:, None],
        np.linalg.norm(about[:, :, :2], axis=2).max(axis=1),
        np.linalg.norm(about, axis=2).max(axis=1),
    )
    away = np.linalg.norm(directions, axis=2)
    far = away - bound - reach[:, None]
    near = np.flatnonzero((far - growth < limit).any(axis=1))
    return near, far[near], offsets[near], (directions / np.maximum(away, 1e-9)[..., None])[near]


@pytest.mark.parametrize("seed", range(5))
def test_obstacles_within_reach_are_those_of_whole_arrays(seed):
    rng = np.random.default_rng(seed)
    number, stages = 30, 7
    arguments = (
        rng.normal(size=(stages, 12, 3)), rng.normal(size=(stages, 3)), rng.normal(size=(number, stages, 3)) * 8.0,
        rng.uniform(0.0, 0.5, (number, stages)), rng.uniform(0.2, 1.0, number), rng.random(number) < 0.5, 2.0,
    )  # fmt: skip
    expected = within_reach_plainly(*arguments)
    assert 0 < len(expected[0]) < number
    for found, wanted in zip(kernels.within_reach(*arguments), expected, strict=True):
        np.testing.assert_allclose(found, wanted, atol=1e-13)


def test_no_obstacle_within_reach_gives_empty_arrays():
    found, far, offsets, normals = kernels.within_reach(
        np.zeros((3, 4, 3)), np.zeros((3, 3)), np.full((2, 3, 3), 50.0), np.zeros((2, 3)), np.ones(2),
        np.array([True, False]), 2.0,
    )  # fmt: skip
    assert (found.shape, far.shape, offsets.shape, normals.shape) == ((0,), (0, 3), (0, 3, 3), (0, 3, 3))


@pytest.mark.parametrize("rates", [(), (5.0,), (2.0, 7.0), (6.0, 6.0, 6.0, 6.0)])
def test_rows_are_the_change_of_the_barrier_with_the_knots(rates):
    rng = np.random.default_rng(len(rates))
    separations, knots = 3, CHAIN.knots
    normals = rng.normal(size=(separations, K + 1, 3))
    payload, discs = rng.normal(size=(2, separations, K + 1))
    lever = rng.uniform(0.1, 0.3, K + 1)
    operator = barrier_operator(rates, CHAIN)

    def barrier(z):
        states = CHAIN.roll_out(np.zeros((5, 3)), z.reshape(3, knots).T)
        along = np.einsum("jka,ka->jk", normals, states[:, 0])
        shear = lever * np.einsum("jka,ka->jk", normals[..., :2], states[:, 2, :2])
        plain = np.stack([payload - along, discs - along - shear], axis=1)
        values = kernels.barrier_values(
            normals, payload, discs, lever, states[:, 0].copy(), states[:, 2].copy()
        )  # fmt: skip
        np.testing.assert_allclose(values, plain, atol=1e-12)
        return (plain @ operator.T).ravel()

    z = rng.normal(size=3 * knots)
    G = kernels.barrier_rows(normals, lever, CHAIN.response[1], operator, len(rates))
    assert G.shape == (2 * K * separations, 3 * knots)
    np.testing.assert_allclose(barrier(np.zeros_like(z)) - barrier(z), G @ z, atol=1e-9)


@pytest.mark.parametrize("n", [3, 8])
def test_points_of_the_hull_are_those_of_the_formation(n):
    formation = Formation(system(n))
    acceleration = np.random.default_rng(n).normal(size=(9, 3)) * [2.0, 2.0, 9.0]
    points = kernels.hull_points(
        formation.corners, formation.rims, formation.hover_offsets, formation.lengths, formation.g, acceleration
    )
    np.testing.assert_array_equal(points, formation.hull_points(acceleration))


@pytest.mark.parametrize("seed", range(3))
def test_planes_are_those_of_the_supports_of_payload_discs_and_obstacles(seed):
    formation, rng = Formation(system(3 + seed)), np.random.default_rng(seed)
    box = Box(roll=0.3, pitch=-0.5, yaw=1.0, size=(0.4, 1.0, 3.0))
    shapes = [Sphere(0.5), Pole(0.3, 6.0), Wall((0.3, 4.0, 5.0), yaw=0.4), box, box]
    given = len(shapes) - 1  # the support of the last is given, as that of a mesh
    normals = rng.normal(size=(len(shapes), K + 1, 3))
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    centres, growth = rng.normal(size=normals.shape) * 5.0, rng.uniform(0.0, 0.5, normals.shape[:2])
    acceleration = rng.normal(size=(K + 1, 3))
    bodies, supports = np.array([shape.row for shape in shapes]), np.zeros_like(growth)
    bodies[given], supports[given] = 0.0, box.support(-normals[given])
    payload, discs, lever = kernels.barrier_planes(
        normals, centres, growth, bodies, supports, formation.payload.vertices.copy(), formation.hover_offsets,
        formation.lengths, formation.disc_radius, formation.g, 0.3, 0.02, acceleration,
    )  # fmt: skip
    np.testing.assert_array_equal(lever, formation.levers(acceleration)[:, 0])
    for j, shape in enumerate(shapes):
        surface = np.sum(normals[j] * centres[j], axis=1) - shape.support(-normals[j]) - growth[j] - 0.3
        np.testing.assert_allclose(payload[j], surface - formation.payload.support(normals[j]), atol=1e-12)
        reach = disc_support(formation, normals[j], acceleration)
        np.testing.assert_allclose(discs[j], surface - 0.02 - reach, atol=1e-12)
