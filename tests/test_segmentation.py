"""Segmentation of scans into clusters of returns."""

import numpy as np

from idc_controller.perception.placed_scan import PlacedScan
from idc_controller.perception.segmentation import Segmentation


def scan_of(points, uav=0, time=1.0):
    return PlacedScan(time, np.zeros(3), np.array(points, dtype=float).reshape(-1, 3), 0.05, 0.02, 0.003, uav=uav)


def test_returns_are_one_cluster_up_to_the_gap_of_their_distance():
    near = [[2.0, 0.0, 0.0], [2.0, 0.5, 0.0], [2.0, 1.0, 0.0], [2.0, 1.7, 0.0]]
    far = [[8.0, 0.0, 0.0], [8.0, 1.5, 0.0], [9.9, 4.0, 0.0]]
    [clusters] = Segmentation(0.134, 9.8).frames([scan_of(near + far)], 0.02)
    found = sorted(sorted(map(tuple, cluster.points.tolist())) for cluster in clusters)
    expected = [near[:3], near[3:], far[:2], far[2:]]
    assert found == sorted(sorted(map(tuple, group)) for group in expected)
    assert len({cluster.number for cluster in clusters}) == 4
    assert [c.surface_points.cut.any() for c in clusters] == [(c.points[:, 0] > 9.0).any() for c in clusters]
    variance = np.concatenate([cluster.pose_variance for cluster in clusters])
    distance = np.linalg.norm(np.concatenate([cluster.points for cluster in clusters]), axis=1)
    np.testing.assert_allclose(variance, 0.02**2 + (0.003 * distance) ** 2)


def test_scans_of_one_moment_are_one_frame():
    scans = [scan_of([[3.0, 0.0, 0.0]], uav, time) for uav, time in ((0, 1.0), (1, 1.01), (2, 1.1))]
    frames = Segmentation(0.134, 9.8).frames([*scans, scan_of([], 3, 1.2)], 0.02)
    assert [[cluster.uav for cluster in frame] for frame in frames] == [[0, 1], [2]]
