"""The standing map over scans with noise: nothing that stands is lost, what is gone is freed, what moves is found."""

from copy import deepcopy
from functools import cache

import numpy as np
import pytest
from range_scene import Box, Pole, Sensor, Sphere, is_occupied, is_seen_free, occupied

from idc_controller.perception.placed_scan import PlacedScan
from idc_controller.perception.settings import StandingMapSettings
from idc_controller.perception.standing_map import StandingMap

SETTINGS = StandingMapSettings()
PERIOD = 0.1


def team(place):
    """Places of four vehicles about a place."""
    return [np.array(place) + np.array([0.8 * i, 0.8 * j, 0.0]) for i in (-1, 1) for j in (-1, 1)]


def scans(sensor, bodies, place, begin, end, drift=(0.0, 0.0, 0.0)):
    """Scans of four vehicles with the true points that they hit; the pose of the first drifts (m/s)."""
    for k in range(round(begin / PERIOD), round(end / PERIOD)):
        now = [body.at(PERIOD * k) if isinstance(body, Sphere) else body for body in bodies]
        where = place(PERIOD * k) if callable(place) else place
        for vehicle, own in enumerate(team(where)):
            offset = np.array(drift) * PERIOD * k * (vehicle == 0)
            yield sensor.scan(now, own, PERIOD * k, offset)


def fill(standing, *args, **kwargs):
    hits = []
    for scan, hit in scans(*args, **kwargs):
        standing.add(scan)
        hits.append(hit)
    return np.concatenate(hits)


def test_pole_passed_by_grazing_rays_only_is_never_freed():
    """Rays that pass beside it and rays missed at it, from another side than it was hit from."""
    standing, sensor = StandingMap(), Sensor(np.random.default_rng(2), ground=0.0)
    pole = Pole((8.0, 0.0, -4.0), 0.1, 8.0)
    fill(standing, sensor, [pole], (0.0, 0.0, -4.0), 0.0, 10.0)
    before = occupied(standing)
    path = lambda t: (16.0 * (t - 10.0) / 10.0, -6.0, -4.0)  # noqa: E731
    hits = fill(standing, sensor, [pole], path, 10.0, 20.0)
    after = occupied(standing)
    lost = ~np.isin(before.numbers, after.numbers)
    assert (pole.distance(before.means[lost]) > 0.1).all() or lost.mean() < 0.3
    heights = np.unique(np.floor(hits[:, 2] / 0.5))
    held = np.unique(np.floor(after.means[:, 2] / 0.5))
    assert set(heights) <= set(held)


def rays_through(point, count=1):
    origin = np.zeros(3)
    return PlacedScan(0.0, origin, np.empty((0, 3)), 0.05, 0.03, 0.009, np.tile(2.0 * np.array(point), (count, 1)))


@pytest.mark.parametrize(("hits", "passes"), [(1, 4), (3, 14), (10, 7), (20, 5), (60, 4)])
def test_voxel_is_freed_by_as_many_scans_as_its_own_record_requires(hits, passes):
    """The more often it was hit, the surer each pass says that it is gone; one hit is undone by four passes."""
    needed = min(hits * SETTINGS.evidence_of_hit, SETTINGS.evidence_max)
    record = SETTINGS.prior_hits + SETTINGS.prior_passes + hits
    evidence = np.cumsum([np.log((record + k) / (SETTINGS.prior_passes + k)) for k in range(50)])
    assert np.argmax(evidence >= needed) + 1 == passes
    standing = StandingMap()
    point = np.array([[3.1, 0.1, 0.1]])
    for k in range(hits):
        standing.add(PlacedScan(PERIOD * k, np.zeros(3), point, 0.05, 0.03, 0.009))
    scans = 0
    while is_occupied(standing, point)[0]:
        standing.add(rays_through(point[0], count=5))
        scans += 1
    assert scans == passes
    assert is_seen_free(standing, point)[0]


def test_trail_of_a_moving_sphere_is_freed_behind_it():
    """Its returns are added as if they stood: they appeared in what was seen free and have not lasted."""
    wall = Box((9.0, 0.0, -4.0), (0.3, 30.0, 8.0))
    moving = Sphere((4.0, -13.0, -4.0), 0.5, (0.0, 1.0, 0.0))
    standing, sensor = StandingMap(), Sensor(np.random.default_rng(8), rays=1000, ground=0.0)
    fill(standing, sensor, [wall, moving], (0.0, 0.0, -4.0), 0.0, 16.0)

    def trail():
        return np.sum(np.abs(occupied(standing).means[:, 0] - 4.0) < 1.0)

    before = trail()
    assert before > 20
    fill(standing, sensor, [wall], (0.0, 0.0, -4.0), 16.0, 24.0)
    assert trail() < 0.3 * before


def test_scan_that_hits_a_voxel_frees_nothing_of_it():
    standing = StandingMap()
    point = np.array([[3.1, 0.1, 0.1]])
    for k in range(100):
        both = PlacedScan(PERIOD * k, np.zeros(3), point, 0.05, 0.03, 0.009, np.tile(2.0 * point, (5, 1)))
        standing.add(both)
    assert is_occupied(standing, point)[0]


SEEN = 12.0  # s for which what stands is seen before the sphere moves past


@cache
def seen_standing(drift):
    """What stands seen with drifting poses: bodies, map, sensor, unexplained returns and all."""
    bodies = [Sphere((5.0, -2.5, -4.0), 0.5), Box((9.0, 0.0, -4.0), (0.3, 30.0, 8.0))]
    standing, sensor, false, count = StandingMap(), Sensor(np.random.default_rng(5), ground=0.0), 0, 0
    for scan, _ in scans(sensor, bodies, (0.0, 0.0, -4.0), 0.0, SEEN, drift=(0.0, drift, 0.0)):
        unexplained = standing.unexplained(scan)
        false, count = false + np.sum(unexplained), count + len(unexplained)
        standing.add(scan)
    return bodies, standing, sensor, false, count


@pytest.mark.parametrize("drift", [0.0, 0.05])
@pytest.mark.parametrize("speed", [0.5, 1.0, 3.0])
def test_returns_of_moving_sphere_are_unexplained_and_of_standing_ones_are_not(speed, drift):
    """A sphere beside one that stands, with poses of one vehicle that drift."""
    bodies, standing, sensor, false, count = deepcopy(seen_standing(drift))
    start = np.array([5.5, -0.8, -4.0]) - np.array([0.0, speed, 0.0]) * SEEN
    moving = Sphere(tuple(start), 0.5, (0.0, speed, 0.0))
    first = None
    for scan, hit in scans(sensor, [*bodies, moving], (0.0, 0.0, -4.0), SEEN, SEEN + 3.0, drift=(0.0, drift, 0.0)):
        unexplained = standing.unexplained(scan)
        of_moving = np.abs(moving.at(scan.time).distance(hit)) < 1e-6
        false += np.sum(unexplained & ~of_moving)
        count += np.sum(~of_moving)
        if (unexplained & of_moving).any() and first is None:
            first = scan.time - SEEN
        standing.add(scan)
    assert first is not None and first <= 0.5
    assert count > 10_000
    assert false <= SETTINGS.false_alarm * count


def test_returns_of_what_moves_leave_no_points_but_free_what_they_pass():
    standing = StandingMap()
    scan = PlacedScan(0.0, np.zeros(3), np.array([[4.1, 0.1, 0.1], [0.1, 4.1, 0.1]]), 0.05, 0.03, 0.009)
    for _ in range(SETTINGS.free_passes):
        standing.add(scan, moving=np.array([True, False]))
    np.testing.assert_array_equal(is_occupied(standing, scan.returns), [False, True])
    assert is_seen_free(standing, scan.returns / 2.0).all()


def test_memory_follows_the_space_that_was_seen():
    standing, sensor = StandingMap(), Sensor(np.random.default_rng(6), rays=200)
    fill(standing, sensor, [], (0.0, 0.0, -4.0), 0.0, 20.0)
    blocks = standing._voxels.counts[0]
    # A ball of 11 m radius in blocks of 2 m, all that it cuts included.
    assert blocks < 4.19 * 13.0**3 / 8.0
    fill(standing, sensor, [], (0.0, 0.0, -4.0), 20.0, 30.0)
    assert standing._voxels.counts[0] < 1.2 * blocks


def test_map_keeps_what_it_holds_when_its_arrays_grow():
    standing, rng = StandingMap(), np.random.default_rng(7)
    points = rng.uniform(-300.0, 300.0, (40, 3))
    for point in points:
        for _ in range(2):
            standing.add(PlacedScan(0.0, point + np.array([8.0, 0.3, 0.2]), point[None], 0.05, 0.03, 0.009))
    assert is_occupied(standing, points).all()
    assert is_seen_free(standing, points + np.array([4.0, 0.15, 0.1])).all()
    assert len(occupied(standing).indices) == len(points)


def test_returns_that_are_no_numbers_are_rejected():
    standing = StandingMap()
    returns = np.array([[3.0, 0.0, 0.0], [np.nan, 0.0, 0.0], [np.inf, 0.0, 0.0]])
    standing.add(PlacedScan(0.0, np.zeros(3), returns, 0.05, 0.03, 0.009))
    assert len(occupied(standing).indices) == 1
