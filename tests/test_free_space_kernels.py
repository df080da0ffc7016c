"""Free space on lattices and segments, and the lattice's graph, against plain numpy."""

import numpy as np
import pytest
from scipy.ndimage import label

from idc_controller.geometry.bounding_cylinder import BoundingCylinder
from idc_controller.geometry.box import Box, Wall
from idc_controller.geometry.capsule import Capsule
from idc_controller.geometry.free_space import TOUCHING, FreeSpace
from idc_controller.geometry.pole import Pole
from idc_controller.geometry.sphere import Sphere
from idc_controller.guidance.detour_kernels import connected, lattice_graph

FORMATION = BoundingCylinder(1.1, 1.3, 0.2)
GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0


def space(seed, turned=True):
    rng = np.random.default_rng(seed)
    shapes = [Sphere(0.6), Pole(0.3, 6.0), Sphere(1.4)]
    if turned:
        shapes += [Wall((0.4, 3.0, 4.0), yaw=0.5), Box(roll=0.4, pitch=0.2, yaw=1.0, size=(0.5, 1.0, 2.0)),
                   Capsule(roll=1.0, yaw=0.3, radius=0.3, length=2.0)]  # fmt: skip
    obstacles = [(shape, rng.uniform([-5.0, -5.0, -8.0], [5.0, 5.0, -1.0])) for shape in shapes]
    return FreeSpace(obstacles, FORMATION, 0.4, 0.5, 11.0, growth=rng.uniform(0.0, 0.3, len(shapes)))


def least_clearances(space, starts, ends):
    """To each obstacle on each segment (S, M), by golden section."""
    each = np.arange(len(space.centres))

    def at(fraction):
        places = starts[:, None] + fraction[..., None] * (ends - starts)[:, None]
        return space.clearance(places.reshape(-1, 3)).reshape(*fraction.shape, -1)[:, each, each]

    low, high = np.zeros((len(starts), len(each))), np.ones((len(starts), len(each)))
    left, right = np.full(low.shape, 1.0 - GOLDEN), np.full(low.shape, GOLDEN)
    for _ in range(60):
        falls = at(left) > at(right)
        low, high = np.where(falls, left, low), np.where(falls, high, right)
        left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    return np.minimum.reduce([at(left), at(right), at(np.zeros_like(low)), at(np.ones_like(low))])


@pytest.mark.parametrize("turned", [True, False])
@pytest.mark.parametrize("seed", range(3))
def test_segments_that_keep_away_are_those_of_golden_section(seed, turned):
    within, rng = space(seed, turned), np.random.default_rng(seed + 10)
    starts = rng.uniform([-9.0, -9.0, -10.0], [9.0, 9.0, -1.0], (400, 3))
    ends = starts + rng.normal(size=starts.shape) * rng.choice([0.3, 3.0, 9.0], (400, 1))
    least = rng.uniform(0.0, 0.4, len(within.centres))
    beyond = (least_clearances(within, starts, ends) - least).min(axis=1)
    clear = np.abs(beyond) > 1e-3
    expected = beyond >= 0.0
    assert clear.sum() > 350
    assert 20 < expected[clear].sum() < clear.sum() - 20
    np.testing.assert_array_equal(within.keep_away(starts, ends, least)[clear], expected[clear])


@pytest.mark.parametrize("turned", [True, False])
@pytest.mark.parametrize("seed", range(3))
def test_free_lattice_is_that_of_its_places(seed, turned):
    within = space(seed, turned)
    axes = np.arange(-9.0, 9.0, 0.7), np.arange(-8.0, 8.0, 0.6), np.arange(-12.0, 0.5, 0.5)
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    free = within.free_lattice(*axes, 0.2).ravel()
    clearance = within.clearance(places).min(axis=1) - (within.margin + 0.2)
    decided = np.abs(clearance + TOUCHING) > 1e-9
    expected = within.within_bounds(places) & (clearance >= -TOUCHING)
    assert expected.any()
    np.testing.assert_array_equal(free[decided], expected[decided])


def test_graph_of_lattice_has_its_edges_start_and_goal():
    rng = np.random.default_rng(4)
    shape = (9, 8, 7)
    free = np.zeros(shape, dtype=bool)
    free[2:-2, 2:-2, 2:-2] = rng.random((5, 4, 3)) < 0.8
    strides = np.array([56, 7, 1])
    nodes = np.argwhere(free & (np.indices(shape) % 2 == 0).all(axis=0))
    flat, count = nodes @ strides, len(nodes)
    number = np.full(free.size, -1, dtype=np.int32)
    number[flat] = np.arange(count)
    directions = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [1, 1, 0], [-1, -1, 0]])
    lengths, to_goal = np.linalg.norm(directions, axis=1), rng.uniform(0.0, 1.5, count)
    first, out, is_last = np.array([0, 2]), np.array([0.4, -0.1]), np.arange(count) == count - 1
    costs, heads, begins = lattice_graph(
        flat, number, free.ravel(), directions @ strides, lengths, to_goal, first, out, is_last
    )
    expected = {(count, 0): 0.4 + 1e-9, (count, 2): 1e-9, (count - 1, count + 1): 1e-9}
    for a, node in enumerate(nodes.tolist()):
        for direction, length in zip(directions, lengths, strict=True):
            b = number[(node + 2 * direction) @ strides]
            if b >= 0 and free[tuple(node + direction)]:
                expected[a, int(b)] = max(length + to_goal[b] - to_goal[a], 0.0) + 1e-9
    rows = np.repeat(np.arange(count + 2), np.diff(begins))
    assert len(costs) == len(expected)
    found = {(int(a), int(b)): cost for a, b, cost in zip(rows, heads, costs, strict=True)}
    assert found == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("seed", range(6))
def test_connected_nodes_are_those_of_the_parts_that_starts_are_in(seed):
    rng = np.random.default_rng(seed)
    shape = (11, 10, 9)
    free = rng.random(shape) < 0.12
    places = np.pad(np.zeros(tuple(2 * n - 1 for n in shape), dtype=bool), 2)
    places[2:-2:2, 2:-2:2, 2:-2:2] = free
    strides = np.array([places.shape[1] * places.shape[2], places.shape[2], 1])
    nodes = np.argwhere(free)
    flat, number = (2 * nodes + 2) @ strides, np.full(places.size, -1, dtype=np.int32)
    number[flat] = np.arange(len(nodes))
    directions = np.array([d for d in np.ndindex(3, 3, 3) if d != (1, 1, 1)]) - 1
    starts = rng.integers(0, len(nodes), 4)
    parts, count = label(free, np.ones((3, 3, 3)))
    part = parts[tuple(nodes.T)]
    assert count > 5
    found = connected(flat, number, directions @ strides, starts)
    np.testing.assert_array_equal(found, np.isin(part, part[starts]))
    assert connected.py_func(flat, number, directions @ strides, starts).tolist() == found.tolist()
