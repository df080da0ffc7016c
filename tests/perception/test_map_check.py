"""Map check: vehicles whose detections of the map's standing obstacles are offset."""

from dataclasses import replace

import numpy as np
import pytest
from obstacle_scene import HERE, NOISE, Scene, box, hand_over, map_of, moving_tracks, outside, pole, sphere, wall

from gcs.config import RangeSensorConfig
from gcs.flight.stack import known_obstacles, sensor_rays
from gcs.mission.model import Obstacle
from idc_controller.geometry.shapes import Pole, Sphere, Wall
from idc_controller.perception import map_check
from idc_controller.perception.standing_obstacles import StandingObstacles
from idc_controller.perception.surfaces.flat import FlatSurface

EVERYONE = frozenset(range(4))
LONG = (pytest.mark.slow, pytest.mark.long)
UNKNOWN = np.array([0.0, 6.0, -6.0])
ON_THE_MAP = {
    "sphere": (Obstacle("a", (5.0, 0.0, -6.0), Sphere(0.5), True), sphere((5.0, 0.0, -6.0))),
    "pole": (Obstacle("a", (5.0, 0.0, -7.5), Pole(0.2, 15.0), True), pole((5.0, 0.0))),
    "wall": (Obstacle("a", (5.0, 0.0, -6.0), Wall((0.3, 5.0, 6.0), 0.3), True), wall((5.0, 0.0, -6.0))),
}


def look(known, true, off, until=6.0, seed=0, noise=1.0):
    """Yields time and map, every control step.

    ``off(t, uav)`` is the error of a vehicle's position; from 2 s on there is ``noise`` times the sensors' own.
    """
    m, scene, rng = map_of(known), Scene(seed), np.random.default_rng([seed, 17])
    for k in range(round(until * 20)):
        t = k / 20
        for found in scene.look(t, HERE, [true, sphere(UNKNOWN, name="other")]) if k % 2 == 0 else ():
            points = found.sample.points
            wrong = rng.normal(0.0, np.sqrt(noise**2 - 1.0) * NOISE * (t >= 2.0), points.shape)
            hand_over(m.placement, t, found.uav, (found.position + off(t, found.uav), found.quaternion), points + wrong)
        m.update(t)
        yield t, m


def assert_unknown_sphere_stands_in_its_place(m, t, within):
    """Its front is covered, nothing moves, and all pieces of it are ``within`` (m) of its centre."""
    assert not moving_tracks(m)
    assert outside(m, t, UNKNOWN[None] - [0.0, 0.5, 0.0], "piece")[0] < 0.1
    away = [np.linalg.norm(centre - UNKNOWN) for _, _, centre in m.seen.pieces]
    assert max(distance for distance in away if distance < 4.0) < within


def drift(vehicles, begin=2.0, rate=0.1):
    return lambda t, uav: np.full(3, rate * max(t - begin, 0.0) * (uav in vehicles))


@pytest.mark.parametrize("shape", ON_THE_MAP)
def test_offset_of_all_vehicles_is_detected_and_corrected(shape):
    known, true = ON_THE_MAP[shape]
    found = None
    for t, m in look(known, true, drift(EVERYONE)):
        found = t if found is None and m.map_offset_detected else found
        if found is None:
            assert not m.sensing_lost
    assert 2.5 < found < 6.0
    normal = np.array([np.cos(0.3), np.sin(0.3), 0.0]) if shape == "wall" else np.array([1.0, 0.0, 0.0])
    for offset in m.map_offsets.values():  # where it is observable: across a wall
        assert normal @ offset == pytest.approx(0.4 * normal.sum(), abs=0.1)
    if shape == "sphere":
        assert_unknown_sphere_stands_in_its_place(m, t, 0.8)


def test_detections_of_one_drifting_vehicle_are_not_used():
    known, true = ON_THE_MAP["sphere"]
    for t, m in look(known, true, drift({2}), until=10.0):
        assert not m.map_offset_detected, t
    assert set(m.map_offsets) == {2}
    assert_unknown_sphere_stands_in_its_place(m, t, 0.6)


def test_offset_of_one_vehicle_is_detected_and_ends():
    known, true = ON_THE_MAP["sphere"]
    offset = [
        set(m.map_offsets) for _, m in look(known, true, lambda t, uav: np.full(3, 0.5 * (uav == 1 and 2.0 <= t < 4.0)))
    ]
    assert offset[39] == set() and offset[55] == {1} and offset[-1] == set()


@pytest.mark.parametrize("noise", [1.0, 5.0])
@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=LONG) for seed in (1, 2))])
def test_noise_is_no_offset(noise, seed):
    known, true = ON_THE_MAP["sphere"]
    assert not any(m.map_offsets for _, m in look(known, true, lambda t, uav: np.zeros(3), 20.0, seed, noise))


def test_obstacle_that_never_agreed_with_the_map_is_not_compared():
    known, _ = ON_THE_MAP["sphere"]
    beside = sphere((5.0, 0.7, -6.0))
    assert not any(m.map_offsets for _, m in look(known, beside, lambda t, uav: np.zeros(3)))


def test_fit_to_an_offset_wall_begins_where_the_offset_so_far_places_it(monkeypatch):
    known, true = ON_THE_MAP["wall"]
    begins, offset = [], np.array([0.6, 0.2, 0.0])

    class Watched(FlatSurface):
        def fit(self, scan, predicted, iterations=3):
            begins.append(predicted - known.position)
            return super().fit(scan, predicted, iterations)

    monkeypatch.setattr(map_check, "surface_of", lambda _, shape, settings: Watched(shape, settings))
    *_, (_, m) = look(known, true, lambda t, uav: offset * (uav == 1 and t >= 2.0), until=3.5)
    assert np.array_equal(begins[0], np.zeros(3))
    np.testing.assert_allclose(begins[-1], m.map_offsets[1], atol=0.05)
    assert begins[-1][0] > 0.3


def constant(size):
    """Offset of ``size`` (m) north of the second vehicle's detections from 2 s on."""
    return lambda t, uav: np.array([size, 0.0, 0.0]) * (uav == 1 and t >= 2.0)


@pytest.mark.parametrize(
    ("size", "noise", "detected"), [(0.15, 1.0, set()), (0.3, 1.0, {1}), (0.3, 5.0, set())],
    ids=["below the limit", "above it", "within the scatter of the points"],
)  # fmt: skip
def test_offset_is_detected_beyond_its_limit_and_the_scatter_of_points(size, noise, detected):
    known, true = ON_THE_MAP["sphere"]
    found = [m.map_offsets for _, m in look(known, true, constant(size), until=4.0, noise=noise)]
    assert set().union(*found) == detected
    estimates = [offsets[1][0] for offsets in found if 1 in offsets]
    if estimates:  # averaged over the scans
        assert np.mean(estimates[10:]) == pytest.approx(size, abs=0.03) and np.std(estimates[10:]) < 0.025


def test_poor_fit_weighs_less_in_an_offset_and_a_good_one_no_more_than_its_noise(monkeypatch):
    known, true = ON_THE_MAP["wall"]

    def offsets_of(score):
        class Scored(FlatSurface):
            def fit(self, scan, predicted, iterations=3):
                return replace(super().fit(scan, predicted, iterations), score=score)

        monkeypatch.setattr(map_check, "surface_of", lambda _, shape, settings: Scored(shape, settings))
        *_, (_, m) = look(known, true, constant(0.6), until=3.0)
        return {uav: offset.tolist() for uav, offset in m.map_offsets.items()}

    assert offsets_of(0.01) == offsets_of(1.0) != offsets_of(1.2)
    assert offsets_of(1.0).keys() == {1}
    assert offsets_of(1e4) == {}


def field(seed, count, kinds=("sphere", "pole"), known_share=1.0):
    """Obstacles of several kinds on either side of the path of :func:`along`, and those of them on the map."""
    rng = np.random.default_rng([seed, count, 23])
    path = np.array([along(t) for t in np.arange(0.0, 13.0, 0.1)])[:, :2]
    known, true = [], []
    while len(true) < count:
        kind, place = kinds[len(true) % len(kinds)], rng.uniform([-14.0, -11.0], [14.0, 11.0])
        if np.hypot(*(path - place).T).min() < (3.5 if kind == "wall" else 2.3):
            continue
        name = f"{kind} {len(true)}"
        if kind == "sphere":
            body = sphere((*place, rng.uniform(-5.5, -1.7)), rng.uniform(0.24, 0.5), name)
        elif kind == "pole":
            body = pole(place, rng.uniform(0.2, 0.5), 8.0, name)
        elif kind == "wall":
            body = wall((*place, -3.0), (0.3, rng.uniform(1.0, 3.0), 6.0), rng.uniform(0.0, np.pi), name)
        else:
            body = box((*place, rng.uniform(-4.0, -1.0)), rng.uniform(0.4, 1.6, 3), rng.uniform(0.0, np.pi), name)
        true.append(body)
        if rng.random() < known_share:
            known.append(Obstacle(name, tuple(body.position_in_world), body.shape, True))
    return known, true


def along(t):
    return np.array([6.0 * np.sin(0.5 * t), -3.0 * np.sin(t), -4.2])


def fly(known, true, until, seed, off=lambda t, uav: np.zeros(3)):
    """Yields time and map, every control step, on the way along the path; ``off``: see :func:`look`."""
    m, scene = map_of(*known, rays=sensor_rays(RangeSensorConfig())), Scene(seed, sensor=RangeSensorConfig())
    for k in range(round(until * 20)):
        t = k / 20
        for found in scene.look(t, along(t), true) if k % 2 == 0 else ():
            pose = found.position + off(t, found.uav), found.quaternion
            hand_over(m.placement, t, found.uav, pose, found.sample.points)
        m.update(t)
        yield t, m


@pytest.mark.parametrize(
    ("seed", "count", "kinds", "known_share"),
    [
        (1, 10, ("sphere", "pole"), 1.0),
        pytest.param(2, 50, ("sphere", "pole"), 1.0, marks=pytest.mark.long),
        (5, 50, ("wall", "box", "sphere", "pole"), 1.0),
        pytest.param(3, 100, ("sphere", "pole"), 1.0, marks=LONG),
        pytest.param(7, 50, ("sphere", "pole"), 0.5, marks=pytest.mark.slow),
        pytest.param(4, 200, ("sphere", "pole"), 1.0, marks=LONG),
        pytest.param(8, 100, ("wall", "box", "sphere", "pole"), 0.5, marks=LONG),
    ],
)
def test_map_that_is_right_has_no_offset_however_many_obstacles_it_has(seed, count, kinds, known_share):
    known, true = field(seed, count, kinds, known_share)
    assert not set().union(*(m.map_offsets for _, m in fly(known, true, 12.0, seed)))


@pytest.mark.parametrize(
    ("vehicles", "count"),
    [
        ({1}, 10),
        (EVERYONE, 100),
        pytest.param(EVERYONE, 10, marks=pytest.mark.long),
        pytest.param({1}, 100, marks=pytest.mark.long),
    ],
)
def test_offset_is_detected_among_many_obstacles(count, vehicles):
    known, true = field(2, count)
    first = {}
    for t, m in fly(known, true, 5.0, 2, lambda t, uav: np.full(3, 0.5 * (uav in vehicles and t >= 4.0))):
        for uav in m.map_offsets:
            first.setdefault(uav, t)
    assert first.keys() == set(vehicles)
    assert 4.3 < max(first.values()) < 4.6
    for offset in m.map_offsets.values():
        assert offset[:2] == pytest.approx([0.5, 0.5], abs=0.1)


def two_spheres(t, moved):
    """Two spheres of the map; from 2 s on the one stands ``moved`` (m) beside its place."""
    return [sphere((5.0, moved * (t >= 2.0), -6.0), name="a"), sphere((-5.0, 0.0, -6.0), name="b")]


def test_obstacle_that_is_moved_is_no_offset_of_the_vehicles_that_detect_another_in_its_place():
    known = [Obstacle(name, place, Sphere(0.5), True) for name, place in (("a", (5.0, 0, -6)), ("b", (-5.0, 0, -6)))]
    m, scene = map_of(*known), Scene(3)
    for k in range(120):
        t = k / 20
        if k % 2 == 0:
            scene.feed(m, t, HERE, two_spheres(t, 0.6))
        m.update(t)
        assert not m.map_offsets, t
    assert outside(m, t, np.array([[5.0, 0.1, -6.0]]), "piece")[0] < 0.1  # where it stands now


def test_unknown_obstacle_beside_one_of_the_map_is_no_offset():
    """Near enough for its returns to be of one cluster with those of the other, which it hides from some."""
    known = [Obstacle("a", (5.0, 0.0, -7.5), Pole(0.2, 15.0), True)]
    true = [pole((5.0, 0.0)), box((4.4, 0.7, -5.0), (0.5, 0.5, 10.0), name="unknown")]
    m, scene = map_of(*known), Scene(4)
    for k in range(240):
        t = k / 20
        centre = np.array([1.5, 4.0 * np.cos(0.5 * t + 3.0), -6.0])
        if k % 2 == 0:
            scene.feed(m, t, centre, true)
        m.update(t)
        assert not m.map_offsets, t


def test_limit_of_an_area_is_nothing_that_can_be_detected():
    places = (("a", (5.0, 0.0, -6.0)), ("b", (5.0, 1.2, -6.0)), ("limit", (5.0, -1.0, -6.0)))
    known = known_obstacles([Obstacle(name, place, Sphere(0.5), True) for name, place in places])
    standing = StandingObstacles([o._replace(is_body=o.name != "limit") for o in known])
    found = standing.next_to(np.array([[4.4, 0.0, -6.0], [4.4, -1.0, -6.0], [4.4, 2.0, -6.0]]), HERE)
    assert found.distance == pytest.approx([0.1, 0.1, 0.5])
    assert found.body.tolist() == [0, 0, 1]
    assert found.body_distance == pytest.approx([0.1, np.hypot(0.6, 1.0) - 0.5, 0.5])
    assert found.others == pytest.approx([np.hypot(0.6, 1.2) - 0.5, np.hypot(0.6, 2.2) - 0.5, np.hypot(0.6, 2.0) - 0.5])


def test_return_that_two_obstacles_may_have_produced_is_no_evidence():
    """Two poles 0.9 m apart: whatever is detected of one is within reach of both, so that an offset is not found."""
    places = {"a": (5.0, 0.0), "b": (5.0, 0.9)}
    known = [Obstacle(name, (*place, -7.5), Pole(0.2, 15.0), True) for name, place in places.items()]
    m, scene, off = map_of(*known), Scene(6), np.array([0.5, 0.0, 0.0])
    for k in range(120):
        t = k / 20
        for found in scene.look(t, HERE, [pole(place, name=name) for name, place in places.items()]) if k % 2 else ():
            pose = found.position + off * (t >= 2.0), found.quaternion
            hand_over(m.placement, t, found.uav, pose, found.sample.points)
        m.update(t)
        assert not m.map_offsets, t
