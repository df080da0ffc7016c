"""Obstacles of the mission on the obstacle map: predicted from the start, tracked where they move."""

import numpy as np
import pytest
from obstacle_scene import map_of, moving_tracks, nearest, outside, pole, run, sphere, wall

from gcs.mission.model import Obstacle
from gcs.mission.motion import HarmonicMotion
from idc_controller.geometry.obstacles import Region
from idc_controller.geometry.shapes import Pole, Sphere, Wall


def test_standing_obstacles_of_the_map_are_predicted_from_the_start_and_not_seen_once_more():
    known = (
        Obstacle("ball", (5.0, 0.0, -6.0), Sphere(0.5)), Obstacle("mast", (0.0, 6.0, -6.0), Pole(0.3, 12.0)),
        Obstacle("house", (-6.0, 0.0, -4.0), Wall((0.3, 5.0, 8.0), np.radians(12.0))),
    )  # fmt: skip
    m = map_of(*known, Obstacle("secret", (0.0, -5.0, -6.0), Sphere(0.5), known=False))
    before = m.predict(np.array([0.0, 1.0]))
    assert [o.name for o in before] == ["ball", "mast", "house"]
    true = [
        sphere((5.0, 0.0, -6.0), 0.5, "ball"), pole((0.0, 6.0), 0.3, 12.0, "mast"),
        wall((-6.0, 0.0, -4.0), (0.3, 5.0, 8.0), np.radians(12.0), "house"),
    ]  # fmt: skip
    run(m, lambda t: true, 3.0)
    assert m.tracks == [] and m.seen.pieces == []
    for a, b in zip(before, m.predict(np.array([3.0, 4.0])), strict=True):
        assert a.shape == b.shape
        np.testing.assert_array_equal(a.positions, b.positions)
        assert not b.growth.any()
    run(m, lambda t: [*true, sphere((0.0, -5.0, -6.0), 0.5, "secret")], 5.0, begin=3.0)
    assert outside(m, 5.0, np.array([[0.0, -4.5, -6.0]]), "piece")[0] < 0.1
    assert all(np.linalg.norm(centre - [0.0, -5.0, -6.0]) < 0.6 for _, _, centre in m.seen.pieces)


def test_track_is_kept_when_its_obstacle_passes_one_of_the_map():
    m = map_of(Obstacle("house", (6.0, 0.0, -4.0), Wall((0.3, 6.0, 8.0))))
    house = wall((6.0, 0.0, -4.0), (0.3, 6.0, 8.0), 0.0, "house")
    errors, names = [], set()

    def ball(t):
        return np.array([4.6, -5.0 + 1.5 * t, -6.0])

    def each(t):
        if 2.0 < t < 5.0:
            name, error = nearest(m, t, ball(t))
            names.add(name)
            errors.append(error)

    run(m, lambda t: [house, sphere(ball(t), 0.4, "ball")], 5.2, each=each)
    assert len(names) == 1
    assert max(errors) < 0.25
    assert m.predict(np.array([5.2]))[0].name == "house"


def test_moving_obstacle_of_the_map_keeps_its_shape_and_is_tracked():
    def place(t):
        return np.array([6.0 + 1.5 * np.sin(t), 0.0, -6.0])

    motion = HarmonicMotion((1.5, 0.0, 0.0), 1.0)
    m = map_of(Obstacle("swing", (6.0, 0.0, -6.0), Sphere(0.45), motion=motion))
    (before,) = m.predict(np.array([0.0]))
    np.testing.assert_array_equal(before.positions[0], [6.0, 0.0, -6.0])
    assert before.growth[0] == 0.5
    errors = []

    def each(t):
        (o,) = [o for o in m.predict(np.array([t])) if o.name == "swing"]
        assert o.shape.radius == 0.45
        if t > 1.5:
            errors.append(np.linalg.norm(o.positions[0] - place(t)))

    run(m, lambda t: [sphere(place(t), 0.45)], 7.0, each=each)
    assert np.sqrt(np.mean(np.square(errors))) < 0.15
    assert moving_tracks(m) == ["swing"]


def test_moving_obstacle_of_the_map_is_deleted_until_detected_where_it_is_missing():
    m = map_of(Obstacle("swing", (6.0, 0.0, -6.0), Sphere(0.45), motion=HarmonicMotion((1.5, 0.0, 0.0), 1.0)))
    run(m, lambda t: [], 2.0)
    assert m.predict(np.array([2.0])) == []
    run(m, lambda t: [sphere((6.5, 0.5, -6.0), 0.45)], 3.0, begin=2.0)
    assert "swing" in [o.name for o in m.predict(np.array([3.0]))]


@pytest.mark.parametrize(("shape", "reach"), [(Sphere(0.5), 0.5), (Pole(0.2, 9.0), 0.2), (Wall((6.0, 8.0, 3.0)), 5.0)])
@pytest.mark.parametrize("bearing", [0.0, 2.0, 4.0])
def test_known_obstacle_is_predicted_as_far_as_it_reaches_into_the_region(shape, reach, bearing):
    for beyond in (-0.01, 0.01):
        away = (3.0 + reach + beyond) * np.array([np.cos(bearing), np.sin(bearing), 0.0])
        known = map_of(Obstacle("a", tuple(np.array([20.0, -10.0, -5.0]) + away), shape, True))
        region = Region(np.array([20.0, -10.0, -9.0]), 3.0)
        found = [o.name for o in known.predict(np.zeros(3), region)]
        assert found == (["a"] if beyond < 0.0 else [])
        assert [o.name for o in known.predict(np.zeros(3))] == ["a"]
