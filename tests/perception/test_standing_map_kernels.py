"""The kernels of the standing map agree with plain references."""

import math
from dataclasses import replace

import numpy as np
from range_scene import is_occupied, is_seen_free, occupied

from idc_controller.perception.placed_scan import PlacedScan
from idc_controller.perception.settings import StandingMapSettings
from idc_controller.perception.standing_map import StandingMap

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
    np.testing.assert_array_equal(is_seen_free(standing, middles), expected)


def test_return_carves_up_to_its_noise_and_occupies_its_voxel():
    standing = StandingMap()
    for _ in range(SETTINGS.free_passes):
        standing.add(scan_of(returns=[(5.1, 0.1, 0.1)], origin=(0.1, 0.1, 0.1)))
    places = np.array([(x, 0.1, 0.1) for x in np.arange(0.125, 6.0, SIZE)])
    short = 5.1 - SETTINGS.sigmas_beyond * math.hypot(0.05, 0.03)
    np.testing.assert_array_equal(is_seen_free(standing, places), places[:, 0] + SIZE / 2.0 <= short)
    np.testing.assert_array_equal(is_occupied(standing, places), np.floor(places[:, 0] / SIZE) == 20)


def in_box(box, points, slack=1e-9):
    c, s = box[6:]
    offset = points - box[:3]
    own = np.stack([c * offset[:, 0] + s * offset[:, 1], c * offset[:, 1] - s * offset[:, 0], offset[:, 2]], axis=1)
    return (np.abs(own) <= box[3:6] + slack).all(axis=1)


def test_gaps_are_voxels_in_the_box_that_were_seen_free_two_voxels_off_all_points():
    rng = np.random.default_rng(7)
    standing = StandingMap()
    for _ in range(20):
        standing.add(scan_of(free=rng.uniform(-4.0, 4.0, (200, 3)), returns=rng.uniform(-3.0, 3.0, (2, 3))))
    box = np.array([0.3, -0.2, 0.1, 1.7, 0.9, 1.1, math.cos(0.4), math.sin(0.4)])
    voxels = np.stack(np.meshgrid(*[np.arange(-12, 12)] * 3), axis=-1).reshape(-1, 3)
    middles = (voxels + 0.5) * SIZE
    hit = np.floor(occupied(standing).means / SIZE).astype(int)
    near = (np.abs(voxels[:, None] - hit).max(axis=2) <= 1).any(axis=1)
    expected = middles[is_seen_free(standing, middles) & ~near & in_box(box, middles)]
    found = standing.gaps(box, 10_000)
    assert len(found) > 100
    assert {tuple(row) for row in found.tolist()} == {tuple(row) for row in expected.tolist()}
    assert len(standing.gaps(box, 5)) == 5
