"""The kernels of the planner against plain numpy."""

import numpy as np
import pytest

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
