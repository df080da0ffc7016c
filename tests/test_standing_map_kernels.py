"""The kernels of the standing map agree with plain references."""

import math
from dataclasses import replace

import numpy as np
import pytest
from range_scene import return_variance
from scipy.stats import chi2, norm

from idc_controller.perception.carving_kernels import followed_rays
from idc_controller.perception.normal_kernels import least_direction
from idc_controller.perception.placed_scan import PlacedScan
from idc_controller.perception.settings import StandingMapSettings
from idc_controller.perception.standing_map import StandingMap
from idc_controller.perception.upright_box_kernels import extended_box, fitted_box, reaches_out

SETTINGS = StandingMapSettings()
SIZE = SETTINGS.voxel


def scan_of(returns=(), free=(), origin=(0.0, 0.0, 0.0), time=0.0, sigmas=(0.05, 0.03, 0.009)):
    rows = [np.array(ends, dtype=float).reshape(-1, 3) for ends in (returns, free)]
    return PlacedScan(time, np.array(origin, dtype=float), rows[0], *sigmas, rows[1])


def passed_voxels(origin, end):
    """Voxels that a straight line from ``origin`` to ``end`` leaves, by all of its crossings in order."""
    way = end - origin
    crossings = [0.0]
    for axis in range(3):
        low, high = sorted((origin[axis] / SIZE, end[axis] / SIZE))
        sides = np.arange(math.ceil(low), math.floor(high) + 1) * SIZE
        crossings += [(side - origin[axis]) / way[axis] for side in sides.tolist()]
    crossings = np.unique([t for t in crossings if 0.0 <= t <= 1.0])
    middles = origin + ((crossings[1:] + crossings[:-1]) / 2.0)[:, None] * way
    return {tuple(voxel) for voxel in np.floor(middles / SIZE).astype(int).tolist()}


def test_voxels_are_seen_free_that_enough_rays_pass():
    rng = np.random.default_rng(1)
    standing, counts = StandingMap(replace(SETTINGS, exploring_stride=1)), {}
    for _ in range(20):
        origin, ends = rng.uniform(-3.0, 3.0, 3), rng.uniform(-9.0, 9.0, (60, 3))
        standing.add(scan_of(free=ends, origin=origin))
        for end in ends:
            for voxel in passed_voxels(origin, end):
                counts[voxel] = counts.get(voxel, 0) + 1
    middles = (np.stack(np.meshgrid(*[np.arange(-40, 40)] * 3), axis=-1).reshape(-1, 3) + 0.5) * SIZE
    expected = [counts.get(tuple(v), 0) >= SETTINGS.free_passes for v in np.floor(middles / SIZE).astype(int).tolist()]
    assert sum(expected) > 1000
    np.testing.assert_array_equal(standing.is_seen_free(middles), expected)


def test_rays_without_return_are_followed_where_something_stands_and_one_of_some_elsewhere():
    standing, rng = StandingMap(), np.random.default_rng(1)
    standing.add(scan_of(returns=[(5.0, 0.0, 0.0), (0.0, -5.0, -1.0)]))
    ends = 9.0 * rng.normal(size=(400, 3))
    arrays = standing._store
    for first in range(4):
        followed = followed_rays(arrays.elements, arrays.counts, np.zeros(3), ends, first, 4)
        kept = (ends[:, None] == followed[None]).all(axis=2).any(axis=1)
        assert kept[first::4].all()
        unit = ends / np.linalg.norm(ends, axis=1)[:, None]
        nearest = np.max(unit @ (np.array([[5.0, 0.0, 0.0], [0.0, -5.0, -1.0]]) / [[5.0], [26.0**0.5]]).T, axis=1)
        # Closer than a cell of directions.
        assert kept[nearest > np.cos(0.08)].all() and (nearest > np.cos(0.08)).any()
        assert not kept[(nearest < np.cos(0.6)) & (np.arange(400) % 4 != first)].any()


def test_return_carves_up_to_its_noise_and_occupies_its_voxel():
    standing = StandingMap()
    for _ in range(SETTINGS.free_passes):
        standing.add(scan_of(returns=[(5.1, 0.1, 0.1)], origin=(0.1, 0.1, 0.1)))
    places = np.array([(x, 0.1, 0.1) for x in np.arange(0.125, 6.0, SIZE)])
    short = 5.1 - SETTINGS.sigmas_beyond * math.hypot(0.05, 0.03)
    np.testing.assert_array_equal(standing.is_seen_free(places), places[:, 0] + SIZE / 2.0 <= short)
    np.testing.assert_array_equal(standing.is_occupied(places), np.floor(places[:, 0] / SIZE) == 20)


def test_elements_have_weighted_moments_and_bounds_of_their_points():
    rng = np.random.default_rng(2)
    standing, points, weights = StandingMap(), [], []
    for distance in (3.0, 9.0):
        origin = np.array([-distance, 0.125, 0.125])
        returns = rng.uniform(0.01, 0.24, (12, 3))
        scan = scan_of(returns=returns, origin=origin)
        standing.add(scan)
        points.append(returns)
        weights.append(3.0 / np.trace(return_variance(scan), axis1=1, axis2=2))
    points, weights = np.concatenate(points), np.concatenate(weights)
    elements = standing.occupied()
    assert elements.voxels.tolist() == [[0, 0, 0]]
    np.testing.assert_allclose(elements.means[0], np.average(points, axis=0, weights=weights))
    np.testing.assert_allclose(elements.sigma[0], math.sqrt(len(weights) / weights.sum()))
    assert (elements.low[0] <= points.min(axis=0)).all() and (elements.high[0] >= points.max(axis=0)).all()
    assert np.abs(elements.low[0] - points.min(axis=0)).max() <= SETTINGS.tolerance + 1e-12
    scatter = np.cov(points.T, aweights=weights, bias=True)
    row = standing._store.elements[elements.indices[0]]
    np.testing.assert_allclose(row[3:9] / row[9], scatter[np.triu_indices(3)], rtol=1e-9)


def test_covariance_of_returns_is_range_noise_along_the_ray_and_attitude_noise_across():
    scan = scan_of(returns=[(4.0, 0.0, 0.0), (0.0, 0.0, 2.0)])
    along, across = 0.05**2 + 0.03**2, 0.03**2
    np.testing.assert_allclose(return_variance(scan)[0], np.diag([along, *[across + (4.0 * 0.009) ** 2] * 2]))
    np.testing.assert_allclose(return_variance(scan)[1], np.diag([*[across + (2.0 * 0.009) ** 2] * 2, along]))


def test_least_direction_is_the_eigenvector_of_the_least_eigenvalue():
    rng = np.random.default_rng(3)
    for _ in range(200):
        root = rng.normal(size=(3, 3)) * rng.uniform(0.05, 2.0, 3)
        matrix, normal = root @ root.T, np.empty(3)
        least_direction(matrix, normal)
        value, vectors = np.linalg.eigh(matrix)
        if value[1] - value[0] > 1e-3 * value[2]:
            assert abs(normal @ vectors[:, 0]) == pytest.approx(1.0, abs=1e-6)
    least_direction(np.eye(3), normal)
    assert not normal.any()


def unexplained(standing, scan):
    """Plain reference of :meth:`StandingMap.unexplained`."""
    limit = chi2.ppf(1.0 - SETTINGS.false_alarm, 3)
    elements, found = standing.occupied(), []
    rows = standing._store.elements[elements.indices]
    for point, own in zip(scan.returns, return_variance(scan), strict=True):
        radius = math.sqrt(limit * np.linalg.eigvalsh(own).max())
        first, last = np.floor((point - radius) / SIZE).astype(int), np.floor((point + radius) / SIZE).astype(int)
        free = True
        for voxel in np.ndindex(*(last - first + 1)):
            low = (first + voxel) * SIZE
            if np.linalg.norm(np.maximum(np.maximum(low - point, point - low - SIZE), 0.0)) <= radius:
                seen = bool(standing._cells_at(low + SIZE / 2.0)[0] & 127 >= SETTINGS.free_passes)
                held = (elements.voxels == first + voxel).all(axis=1) & elements.standing
                free = free and seen and not held.any()
        for mean, row, stands in zip(elements.means, rows, elements.standing, strict=True):
            covariance = np.zeros((3, 3))
            covariance[np.triu_indices(3)] = row[3:9] / row[9]
            covariance += np.triu(covariance, 1).T + own
            offset = point - mean
            free = free and not (stands and offset @ np.linalg.solve(covariance, offset) <= limit)
        found.append(free)
    return np.array(found)


def test_unexplained_returns_agree_with_plain_reference():
    rng = np.random.default_rng(4)
    standing = StandingMap()
    for k in range(30):
        ways = rng.normal(size=(400, 3))
        free = 4.0 * ways / np.linalg.norm(ways, axis=1)[:, None]
        standing.add(scan_of(free=free, time=0.1 * k, origin=rng.normal(size=3) * 0.3))
        standing.add(scan_of(returns=rng.normal(size=(10, 3)) * 0.05 + (2.0, 0.0, 0.0), time=0.1 * k))
    scan = scan_of(returns=rng.uniform(-3.0, 3.0, (300, 3)))
    expected = unexplained(standing, scan)
    assert 50 < expected.sum() < 250
    np.testing.assert_array_equal(standing.unexplained(scan), expected)


def random_bounds(rng, count):
    low = rng.normal(size=(count, 3)) * (3.0, 0.4, 1.0)
    turn = rng.uniform(0.0, math.pi)
    low[:, :2] = low[:, :2] @ np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    return np.hstack([low, low + rng.uniform(0.01, 0.3, (count, 3))])


def in_box(box, points, slack=1e-9):
    c, s = box[6:]
    offset = points - box[:3]
    own = np.stack([c * offset[:, 0] + s * offset[:, 1], c * offset[:, 1] - s * offset[:, 0], offset[:, 2]], axis=1)
    return (np.abs(own) <= box[3:6] + slack).all(axis=1)


def corners_of(bounds):
    return np.array([[row[3 * i], row[1 + 3 * j], row[2 + 3 * k]] for row in bounds for i, j, k in np.ndindex(2, 2, 2)])


def test_fitted_box_holds_all_bounds_in_nearly_the_smallest_plan_view():
    rng = np.random.default_rng(5)
    for _ in range(30):
        bounds = random_bounds(rng, 40)
        box = fitted_box(bounds, np.arange(40))
        corners = corners_of(bounds)
        assert in_box(box, corners).all()
        areas = []
        for heading in np.radians(np.arange(0.0, 90.0, 0.25)):
            turn = np.array([[math.cos(heading), math.sin(heading)], [-math.sin(heading), math.cos(heading)]])
            areas.append(np.ptp(corners[:, :2] @ turn.T, axis=0).prod())
        assert 4.0 * box[3] * box[4] <= 1.05 * min(areas)


def test_extended_box_holds_what_it_held_and_the_new_bounds():
    rng = np.random.default_rng(6)
    bounds = random_bounds(rng, 40)
    box = fitted_box(bounds, np.arange(20))
    rows = np.arange(20, 40)
    out = reaches_out(box, bounds, rows, 0.05)
    np.testing.assert_array_equal(
        out, [not in_box(box, corners_of(bounds[row : row + 1]), 0.05).all() for row in rows.tolist()]
    )
    assert out.any()
    larger = extended_box(box, bounds, rows)
    assert in_box(larger, corners_of(bounds)).all()
    np.testing.assert_array_equal(larger[6:], box[6:])


def test_gaps_are_voxels_in_the_box_that_were_seen_free_two_voxels_off_all_points():
    rng = np.random.default_rng(7)
    standing = StandingMap()
    for _ in range(20):
        standing.add(scan_of(free=rng.uniform(-4.0, 4.0, (200, 3)), returns=rng.uniform(-3.0, 3.0, (2, 3))))
    box = np.array([0.3, -0.2, 0.1, 1.7, 0.9, 1.1, math.cos(0.4), math.sin(0.4)])
    voxels = np.stack(np.meshgrid(*[np.arange(-12, 12)] * 3), axis=-1).reshape(-1, 3)
    middles = (voxels + 0.5) * SIZE
    occupied = standing.occupied().voxels
    near = (np.abs(voxels[:, None] - occupied).max(axis=2) <= 1).any(axis=1)
    expected = middles[standing.is_seen_free(middles) & ~near & in_box(box, middles)]
    found = standing.gaps(box, 10_000)
    assert len(found) > 100
    assert {tuple(row) for row in found.tolist()} == {tuple(row) for row in expected.tolist()}
    assert len(standing.gaps(box, 5)) == 5


def test_nearest_owners_agree_with_plain_reference():
    rng = np.random.default_rng(8)
    standing = StandingMap()
    for _ in range(5):
        standing.add(scan_of(returns=rng.uniform(-2.0, 2.0, (30, 3)), origin=(0.0, 0.0, 9.0)))
    elements = standing.occupied()
    owners = np.full((standing.element_count, 2), -1)
    owned = elements.indices[::3]
    owners[owned, 0], owners[owned, 1] = np.arange(len(owned)), elements.numbers[::3]
    owners[owned[::5], 1] += 1  # of an element that is no more
    valid = np.isin(elements.indices, np.setdiff1d(owned, owned[::5]))
    found = standing.nearest_owners(elements.indices, owners)
    reach = math.ceil(SETTINGS.bridged_gap / SIZE)
    apart = elements.voxels[:, None] - elements.voxels[valid]
    square = np.where((np.abs(apart) <= reach).all(axis=2), (apart**2).sum(axis=2), 10**6)
    least = np.where(square.min(axis=1) <= reach**2, square.min(axis=1), -1)
    by_owner = dict(zip(owners[elements.indices[valid], 0].tolist(), elements.voxels[valid].tolist(), strict=True))
    assert (least < 0).any() and (least > 0).any()
    for voxel, owner, expected in zip(elements.voxels, found.tolist(), least.tolist(), strict=True):
        assert (-1 if owner < 0 else ((voxel - by_owner[owner]) ** 2).sum()) == expected


def test_covered_bounds_are_moved_by_as_many_sigmas_as_the_scans_about_require():
    rng = np.random.default_rng(9)
    standing = StandingMap()
    for _ in range(40):
        standing.add(scan_of(returns=rng.normal(size=(3, 3)) * (0.6, 0.6, 0.05), origin=(0.0, 0.0, -8.0)))
    standing.add(scan_of(returns=[(6.1, 0.1, 0.1)], origin=(6.0, 0.0, -8.0)))
    elements = standing.occupied()
    bounds = np.zeros((standing.element_count, 6))
    standing.cover(elements.indices, bounds)
    for i, voxel in enumerate(elements.voxels):
        near = (np.abs(elements.voxels - voxel) <= 1).all(axis=1)
        hits = elements.hits[near]
        sigmas = max(-norm.ppf(SETTINGS.uncovered ** (1.0 / min(hits.sum(), SETTINGS.memory))), -1.0)
        out, middle = sigmas * elements.sigma[i], np.average(elements.means[near], axis=0, weights=hits)
        low, high = elements.low[i].copy(), elements.high[i].copy()
        if out >= 0.0:
            low, high = low - out, high + out
        else:
            high = np.where(high > middle, np.maximum(high + out, middle), high)
            low = np.where(low < middle, np.minimum(low - out, middle), low)
            crossed = low > high
            side = np.where(high > middle, high, low)
            low, high = np.where(crossed, side, low), np.where(crossed, side, high)
        expected = np.append(low - SETTINGS.tolerance, high + SETTINGS.tolerance)
        np.testing.assert_allclose(bounds[elements.indices[i]], expected, atol=1e-9)
    # A single return is covered with more than three standard deviations.
    lone = elements.indices[elements.voxels[:, 0] == 24]
    assert np.diff(bounds[lone].reshape(2, 3), axis=0).min() > 6.0 * 0.05
