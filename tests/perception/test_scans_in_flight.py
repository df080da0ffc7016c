"""Scans of a whole flight, from the simulated rays over the wire to their places, against the true obstacles."""

from unittest.mock import patch

import numpy as np
import pytest
from flights import MISSIONS, InProcessFlight
from range_scene import return_variance

from gcs.mission.read import read_mission
from idc_controller.geometry.obstacles import Bodies
from idc_controller.perception.scan_placement import ScanPlacement
from vehicle_sim.world.range_sensor import RayBodies
from vehicle_sim.world.ray_cast_kernels import first_hits

pytestmark = pytest.mark.slow
LEVEL = (1.0, 0.0, 0.0, 0.0)


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """Scans between poles, until one sees the sphere that swings behind them; and what stands."""
    mission, scans, place = read_mission(MISSIONS / "pole_course.toml"), [], ScanPlacement.scans

    def recorded(self, *args, **kwargs):
        found = place(self, *args, **kwargs)
        scans.extend(found)
        return found

    folder = tmp_path_factory.mktemp("run")
    with (
        patch.object(ScanPlacement, "scans", recorded),
        InProcessFlight(mission, folder, obstacles=mission.obstacles) as flight,
    ):
        flight.fly(until=26.0)
    return scans, [obstacle for obstacle in mission.obstacles if obstacle.motion is None]


def test_every_vehicle_scans_at_its_rate_and_all_scans_are_complete(flown):
    scans, _ = flown
    for uav in range(4):
        times = np.array([scan.time for scan in scans if scan.uav == uav])
        np.testing.assert_allclose(np.diff(times), 0.1, atol=0.002)
        assert len(times) > 245
    assert all(len(scan.free_rays) for scan in scans)


def test_errors_of_returns_agree_with_their_covariances(flown):
    """Distances from the true surface, normalised: of variance 1."""
    scans, obstacles = flown
    bodies, centres = Bodies([o.shape for o in obstacles]), np.array([o.position for o in obstacles])
    normalised = []
    for scan in scans[::5]:
        points = scan.returns
        distance = bodies.distance(points, centres).min(axis=0)
        slopes = [bodies.distance(points + step, centres).min(axis=0) - distance for step in 1e-5 * np.eye(3)]
        normals = np.stack(slopes, axis=1)
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        variance = np.einsum("ni,nij,nj->n", normals, return_variance(scan), normals)
        normalised.append(distance**2 / variance)
    squares = np.concatenate(normalised)
    assert len(squares) > 10_000
    assert squares.mean() == pytest.approx(1.0, abs=0.1)
    assert np.mean(squares > 9.0) < 0.006  # of a normal variable 0.0027


def test_free_rays_meet_obstacles_as_often_as_returns_are_missed(flown):
    """And some graze edges that the poses' errors move."""
    scans, obstacles = flown
    bodies, returned, missed = RayBodies.of([(o.shape, o.position) for o in obstacles]), 0, 0
    for scan in scans:
        rays = scan.free_rays - scan.origin
        lengths = np.linalg.norm(rays, axis=1)
        first = first_hits(rays / lengths[:, None], np.array([*scan.origin, *LEVEL]), 30.0, *bodies)
        missed += int((first < lengths - 0.3).sum())
        returned += len(scan.returns)
    assert returned > 50_000
    assert 0.015 < missed / (returned + missed) < 0.035
