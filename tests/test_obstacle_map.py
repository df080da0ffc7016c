"""Obstacle map: association across vehicles and time, merging, and predictions."""

import csv
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from flight_in_process import InProcessFlight, short_figure
from obstacle_scene import (
    HERE,
    MOTIONS,
    NOISE,
    REACH,
    SENSORS,
    Scene,
    detections_of,
    map_of,
    messages_of,
    nearest,
    pole,
    run,
    sphere,
    wall,
)

from gcs.flight import stack
from gcs.mission.model import Obstacle
from gcs.mission.read import read_mission
from idc_controller.estimation.measurements import Attitude, Position
from idc_controller.geometry.box import Box
from idc_controller.geometry.capsule import Capsule
from idc_controller.geometry.obstacles import Bodies
from idc_controller.geometry.pole import Pole
from idc_controller.geometry.sphere import Sphere
from idc_controller.perception import track_list
from idc_controller.perception.motion_imm import MotionModels
from idc_controller.perception.obstacle_map import ObstacleMap
from idc_controller.perception.scan_assembly import Cluster
from idc_controller.perception.settings import PerceptionSettings
from idc_controller.perception.track import Track
from idc_controller.perception.track_list import TrackList
from vehicle_sim.swarm import Swarm
from vehicle_sim.world.obstacle_bodies import Obstacle as WorldObstacle

FOUR = {
    "a": (lambda t: np.array([6.0, 0.0, -6.0]) + MOTIONS["harmonic"](t) * [0.5, 0, 0]),
    "b": (lambda t: np.array([0.0, 6.0, -6.0]) + MOTIONS["circle"](t)),
    "c": (lambda t: np.array([-6.0, 0.0, -5.0])),
    "d": (lambda t: np.array([0.0, -6.0, -7.0]) + MOTIONS["fast harmonic"](t)),
}


def four(t):
    return [sphere(place(t), 0.4, name) for name, place in FOUR.items()]


def test_map_has_one_track_for_each_obstacle_of_four_vehicles():
    counts = []
    m = map_of()
    run(m, four, 6.0, each=lambda t: counts.append(len(m.predict(np.array([t])))))
    assert counts[0] == 4  # four vehicles detect each at once
    assert set(counts) == {4}
    for place in FOUR.values():
        _, error = nearest(m, 5.95, place(5.95))
        assert error < 0.12
    names = [o.name for o in m.predict(np.array([6.0]))]
    assert len(set(names)) == 4


def test_track_of_one_vehicle_is_confirmed_by_two_scans():
    counts = []
    m = map_of()
    run(m, lambda t: [sphere((5.0, 0.0, -6.0))], 0.5, scene=Scene(0, uavs=1),
        each=lambda t: counts.append(len(m.predict(np.array([t])))))  # fmt: skip
    assert counts[0] == 0
    assert counts[2] == 1


def test_map_tracks_all_shapes_at_once():
    things = [
        pole((0.0, 6.0), 0.3, 12.0), wall((-6.0, 0.0, -4.0), (0.3, 5.0, 8.0), 0.2), sphere((6.0, 0.0, -6.0), 0.7),
        pole((4.0, -6.0), 0.2, 9.0, "other"),
    ]  # fmt: skip
    m = run(map_of(), lambda t: things, 3.0)
    found = sorted(o.shape.kind for o in m.predict(np.array([3.0])))
    assert found == ["pole", "pole", "sphere", "wall"]


def test_predictions_have_one_entry_for_each_time():
    m = run(map_of(Obstacle("known", (9.0, 9.0, -4.0), Pole(0.3, 8.0))), four, 1.0)
    times = 1.0 + 0.1 * np.arange(33)
    for o in m.predict(times):
        assert o.positions.shape == (33, 3)
        assert o.growth.shape == (33,)
        assert np.all((o.growth >= 0.0) & (o.growth <= 0.5))
        if o.name != "known":
            assert np.all(np.diff(o.growth) >= -1e-9)


@pytest.mark.parametrize("loss", [0.0, 0.3, 0.6])
def test_tracks_keep_their_obstacles_when_they_cross(loss):
    """Two pass each other at 3 m/s with 0.3 m between their surfaces, and two others at the same height behind."""

    def crossing(t):
        x = -4.5 + 1.5 * t
        return [
            sphere((5.0, x, -6.0), 0.4, "a"), sphere((6.1, -x, -6.0), 0.4, "b"),
            sphere((-5.0, x, -6.0), 0.4, "c"), sphere((-6.1, -x, -6.2), 0.4, "d"),
        ]  # fmt: skip

    m = map_of()
    names = {}

    def each(t):
        if t in (1.5, 5.5):
            for o in crossing(t):
                name, error = nearest(m, t, np.array(o.position_in_world))
                names.setdefault(o.name, []).append(name)
                assert error < (0.2 if loss < 0.5 else 0.35)

    run(m, crossing, 6.0, scene=Scene(3, loss=loss), each=each)
    for before, after in names.values():
        assert before == after
    assert len(m.tracks) == 4


def test_late_vehicle_joins_existing_track():
    """A vehicle that comes late, with a number of its own, joins the track of the others."""
    m = map_of()
    late, early = Scene(1), Scene(2, uavs=3)
    run(m, lambda t: [sphere((6.0, 0.0, -6.0))], 1.0, scene=early)
    run(m, lambda t: [sphere((6.0, 0.0, -6.0))], 2.0, begin=1.0, scene=late)
    assert len(m.tracks) == 1


class OneMisplaced(Scene):
    """A scene in which the first vehicle's reported position is wrong by ``off(time)`` (3,) (m)."""

    def __init__(self, off):
        super().__init__()
        self.off = off

    def look(self, time, centre, obstacles):
        first, *others = super().look(time, centre, obstacles)
        return [(0, first[1] + self.off(time), *first[2:]), *others]


@pytest.mark.parametrize("error", [2.0, 3.0])
def test_duplicate_tracks_are_merged(error):
    m = map_of()
    numbers = []

    def seen(t):
        numbers.append(len(m.tracks))
        return [sphere((6.0, 0.0, -6.0), 0.5)]

    run(m, seen, 1.0)
    (first,) = m.tracks
    # A bad pose begins a second track of the obstacle, which comes to the first one as the pose is corrected.
    run(m, seen, 4.0, begin=1.0, scene=OneMisplaced(lambda t: np.array([0.0, max(0.0, error - 2.0 * (t - 1.0)), 0.0])))
    assert max(numbers) == 2
    assert m.tracks == [first]


def test_overlaps_are_counted_in_a_row_and_stay_while_the_other_track_is_not_compared():
    tracks, ball = TrackList([], [], MotionModels(), PerceptionSettings()), [sphere((6.0, 0.0, -6.0))]
    for time in (1.0, 1.1):
        clusters = [Cluster(0, 0, part) for i, _, part in Scene(8).scans(time, HERE, ball) if i == 0]
        tracks.begin(clusters, time)
    first, second = tracks.tracks
    merge = partial(tracks.merge, clusters, [1] * len(clusters), standing=[])
    near, far = np.zeros((len(clusters), 2)), np.full((len(clusters), 2), 9.0)
    merge(near)
    assert second.overlaps == {first.name: 1}
    found, first.filter = first.filter, None
    merge(near)
    assert second.overlaps == {first.name: 1}
    first.filter = found
    merge(near)
    assert second.overlaps == {first.name: 2}
    merge(far)
    assert second.overlaps == {}


# Coming and going


def test_equal_seeds_give_equal_maps():
    maps = [run(map_of(), four, 3.0, scene=Scene(9)) for _ in range(2)]
    a, b = (m.predict(np.array([3.0, 4.0])) for m in maps)
    for one, other in zip(a, b, strict=True):
        np.testing.assert_array_equal(one.positions, other.positions)
        assert one.shape == other.shape


# Over the wire


@pytest.mark.slow
def test_map_in_flight_has_the_obstacles_the_vehicles_detect(tmp_path):
    """The whole loop: sensors, MAVLink, the ground's codec and clocks, the map, the records."""
    mission = read_mission(short_figure(tmp_path))
    obstacles = (
        Obstacle("ball", (4.0, 4.0, -3.5), Sphere(0.5), known=False),
        Obstacle("mast", (0.0, 6.0, -4.5), Pole(0.3, 9.0), known=False),
        Obstacle("known", (-5.0, 0.0, -3.0), Sphere(0.4)),
    )  # fmt: skip
    mission = replace(mission, obstacles=obstacles)
    with InProcessFlight(mission, tmp_path / "run") as flight:
        obstacle_map = stack.obstacle_map(mission)
        flown = flight.flight
        flown.system = flown.failsafes.system = replace(flown.system, obstacle_map=obstacle_map)
        flight.swarm.close()
        flight.swarm = Swarm(mission.system, seed=1, home=mission.home, obstacles=obstacles)
        flight.fly(until=6.0)
        predicted = {o.name: o for o in obstacle_map.predict(np.array([flight.now]))}
        assert obstacle_map.scans.discarded == 0
    assert len(predicted) == 3
    kinds = {o.shape.kind: o for name, o in predicted.items() if name != "known"}
    assert np.linalg.norm(kinds["sphere"].positions[0] - [4.0, 4.0, -3.5]) < 0.08
    assert np.linalg.norm(kinds["pole"].positions[0][:2] - [0.0, 6.0]) < 0.08
    with (tmp_path / "run" / "obstacles_estimate.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row["kind"] for row in rows} == {"sphere", "pole"}
    times = sorted({float(row["time_s"]) for row in rows})
    np.testing.assert_allclose(np.diff(times), 0.1, atol=1e-6)
    assert len(times) > 40


def test_new_track_begins_with_scatter_of_earlier_ones():
    """Scatter is of the sensors: an obstacle that was detected once has no information on it yet."""
    m, scene, rng = map_of(), Scene(3), np.random.default_rng(3)
    near, late = sphere((5.0, 3.0, -6.0)), sphere((5.0, -4.0, -6.0), 0.5, "late")
    scatter = []
    for k in range(40):
        for i, position, quaternion, scan in scene.look(0.1 * k, HERE, [near, late] if k >= 30 else [near]):
            m.scans.poses.add_measured(Attitude(0.1 * k, i, quaternion, np.zeros(3)))
            m.scans.poses.add_measured(Position(0.1 * k, i, position, np.zeros(3)))
            for message in messages_of(scan):
                x, y, z = rng.normal(0.0, 5 * NOISE, 3)
                message.x, message.y, message.z = message.x + x, message.y + y, message.z + z
                m.scans.add(detections_of(message), i, 0.1 * k)
        m.update(0.1 * k)
        scatter.append([track.filter.scatter**0.5 for track in m.tracks])
    assert len(scatter[29]) == 1 and scatter[29][0] > 3 * NOISE
    assert min(next(both for both in scatter if len(both) == 2)) > 3 * NOISE


@pytest.mark.parametrize(
    "shape",
    [
        Capsule(0.3, 1.5, roll=1.0, yaw=0.5), Box((0.4, 3.0, 0.4), roll=0.6, yaw=0.3),
        Box((1.0, 1.0, 1.0), roll=0.6, pitch=0.5),
    ],
    ids=["capsule", "beam", "cube"],
)  # fmt: skip
def test_prediction_covers_unknown_shape_that_no_surface_fits(shape):
    scene, obstacle = Scene(1), WorldObstacle("x", shape, (0.0, 0.0, -6.0))
    obstacle_map = ObstacleMap([], SENSORS, REACH)
    for step in range(60):
        time = 0.1 * step
        scene.feed(obstacle_map, time, np.array([time - 9.0, 0.5, -6.0]), [obstacle])
        obstacle_map.update(time)
    [found] = obstacle_map.predict(np.array([6.0]))
    points, normals = shape.surface_samples()
    visible = (points @ shape.rotation.T)[(normals @ shape.rotation.T)[:, 0] < 0.0] + [0.0, 0.0, -6.0]
    outside = Bodies([found.shape]).distance(visible, found.positions[:1])[0] - found.growth[0]
    assert outside.max() < 0.2


def test_clusters_of_one_surface_are_fitted_anew_with_each_that_joins(monkeypatch):
    """A fit that had been updated by the same points before would count them twice."""
    fitted = []

    class Watched(Track):
        def update(self, frames):
            fitted.append((self.name, len(frames), self.filter is None))
            super().update(frames)

    monkeypatch.setattr(track_list, "Track", Watched)
    m = map_of()
    Scene(0).feed(m, 0.0, HERE, [sphere((0.0, 6.0, -6.0))])
    m.update(0.0)
    assert fitted == [*(("", members, True) for members in (1, 2, 3, 4)), ("track 1", 4, True)]
