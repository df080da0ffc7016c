"""Clusters: returns of a scan that are near to each other, and whose motion can be seen."""

import math
from dataclasses import replace

import numpy as np
import pytest

from idc_controller.perception.clusters import Segmentation, frames
from idc_controller.perception.placed_scan import PlacedScan
from idc_controller.perception.range_sensors import RayPattern

PATTERN = RayPattern(500, math.radians(-70.0), math.radians(30.0))
SPACING, CUT, SIZE = PATTERN.spacing, 9.8, 3.2


def scan_of(points, uav=0, time=1.0, free=()):
    free = np.array(free, dtype=float).reshape(-1, 3)
    return PlacedScan(time, np.zeros(3), np.array(points, dtype=float).reshape(-1, 3), 0.05, 0.02, 0.003, free, uav)


def everything(scan):
    return np.ones(len(scan.returns), dtype=bool)


def test_returns_are_one_cluster_up_to_the_gap_of_their_distance():
    near = [[2.0, 0.0, 0.0], [2.0, 0.5, 0.0], [2.0, 1.0, 0.0], [2.0, 1.7, 0.0]]
    far = [[8.0, 0.0, 0.0], [8.0, 1.5, 0.0], [9.9, 4.0, 0.0]]
    scan = scan_of(near + far)
    clusters = Segmentation(PATTERN, CUT, SIZE).clusters(scan, everything(scan))
    found = sorted(sorted(map(tuple, cluster.points.tolist())) for cluster in clusters)
    expected = [near[:3], near[3:], far[:2], far[2:]]
    assert found == sorted(sorted(map(tuple, group)) for group in expected)
    assert len({cluster.number for cluster in clusters}) == 4
    assert [c.surface_points.cut.any() for c in clusters] == [(c.points[:, 0] > 9.0).any() for c in clusters]
    variance = np.concatenate([cluster.pose_variance for cluster in clusters])
    distance = np.linalg.norm(np.concatenate([cluster.points for cluster in clusters]), axis=1)
    np.testing.assert_allclose(variance, 0.02**2 + (0.003 * distance) ** 2)


@pytest.mark.parametrize("tilt", [0.0, 0.3])
@pytest.mark.parametrize(("pitch", "expected"), [(0.2, False), (0.45, True), (-0.9, False), (-1.15, True)])
def test_returns_at_the_edge_of_the_field_of_view_say_that_more_may_lie_beyond(pitch, expected, tilt):
    """Of the body's frame: a vehicle that pitches up looks higher."""
    scan = scan_of(rays((0.0,), 4.0, (pitch + tilt,)))
    scan = replace(scan, up=np.array([-math.sin(tilt), 0.0, -math.cos(tilt)]))
    [cluster] = Segmentation(PATTERN, CUT, SIZE).clusters(scan, everything(scan))
    assert cluster.surface_points.cut.tolist() == [expected]


def test_scans_of_one_moment_are_one_frame():
    scans = [scan_of([[3.0, 0.0, 0.0]], uav, time) for uav, time in ((0, 1.0), (1, 1.01), (2, 1.1), (3, 1.2))]
    assert [[scan.uav for scan in frame] for frame in frames(scans, 0.02)] == [[0, 1], [2], [3]]


def rays(yaws, distance, pitches=(-0.1, 0.0, 0.1)):
    return [
        [distance * np.cos(a) * np.cos(b), distance * np.sin(a) * np.cos(b), -distance * np.sin(b)]
        for a in yaws
        for b in pitches
    ]


SIDES = {
    "free to both sides": ([], rays((-0.15, 0.15), 10.0), True),
    "a wall behind both sides": (rays((-0.15, 0.15), 8.0), [], True),
    "a wall to one side": (rays((-0.15,), 4.2), rays((0.15,), 10.0), False),
    "edge of the rays": ([], rays((-0.15,), 10.0), False),
}


@pytest.mark.parametrize(("others", "free", "expected"), SIDES.values(), ids=SIDES)
def test_motion_of_a_small_cluster_is_seen_where_both_its_sides_are(others, free, expected):
    own = rays((0.0,), 4.0)
    scan = scan_of(own + others, free=free)
    rows = np.arange(len(scan.returns)) < len(own)
    [cluster], seen = Segmentation(PATTERN, CUT, SIZE).candidates(scan, rows, ~everything(scan), everything(scan))
    assert (cluster.number in seen) == expected


def test_cluster_mostly_unexplained_is_a_candidate_whatever_its_sides():
    scan = scan_of(rays((0.0,), 4.0) + rays((0.15,), 4.2))
    rows = np.arange(6) < 3
    for unexplained, expected in (([1, 1, 0, 0, 0, 0], True), ([1, 0, 0, 1, 1, 1], False)):
        mask = np.array(unexplained, dtype=bool)
        [cluster], seen = Segmentation(PATTERN, CUT, SIZE).candidates(scan, rows, mask, ~mask)
        assert (cluster.number in seen) == expected
        assert cluster.unexplained == sum(unexplained[:3]) and cluster.explained == 3 - sum(unexplained[:3])
        assert cluster.shifted(np.ones(3)).unexplained == cluster.unexplained
