"""Track retention: which tracks of moving obstacles are deleted, kept or coast when they are not detected."""

import numpy as np
from obstacle_scene import HERE, Scene, map_of, moving_tracks, outside, run, sphere


def crossing(t):
    return np.array([5.0, 4.0 - 1.5 * t, -6.0])


def test_track_is_deleted_in_field_of_view_and_coasts_before():
    m, scene = map_of(), Scene(0)
    run(m, lambda t: [sphere(crossing(t))], 3.0, scene=scene)
    assert len(moving_tracks(m)) == 1
    run(m, lambda t: [], 3.6, begin=3.0, scene=scene)
    assert len(moving_tracks(m)) == 1
    run(m, lambda t: [], 4.5, begin=3.6, scene=scene)
    assert m.tracks == []
    assert m.take_deleted_tracks() and m.take_deleted_tracks() == []


def test_obstacle_in_a_single_scan_never_moves():
    m, scene, moving = map_of(), Scene(0), set()
    run(m, lambda t: [], 3.0, scene=scene)
    run(m, lambda t: [sphere((5.0, 0.0, -6.0))] if t < 3.05 else [], 5.0, begin=3.0, scene=scene,
        each=lambda t: moving.update(moving_tracks(m)))  # fmt: skip
    assert moving == set() and m.tracks == []


def test_moving_track_out_of_range_coasts_and_is_deleted_and_what_stands_is_kept():
    def things(t):
        return [sphere((-5.0, 3.0, -6.0), name="stands"), sphere(crossing(t))]

    def leaving(t):
        return np.add(HERE, [-6.0 * max(t - 3.0, 0.0), 0.0, 0.0])

    m, scene = map_of(), Scene(0)
    run(m, things, 4.5, scene=scene, centre=leaving)
    [track] = moving_tracks(m)
    [predicted] = [o for o in m.predict(np.array([4.5])) if o.name == track]
    assert np.linalg.norm(predicted.positions[0] - crossing(4.5)) < 0.7
    run(m, things, 8.0, begin=4.5, scene=scene, centre=leaving)
    assert m.tracks == []
    assert outside(m, 8.0, np.array([[-4.6, 2.7, -6.0]]))[0] < 0.1


def test_nothing_is_deleted_when_telemetry_of_all_vehicles_times_out():
    m = map_of()
    run(m, lambda t: [sphere(crossing(t)), sphere((-5.0, 0.0, -6.0), name="stands")], 3.0)
    before, names = m.seen.pieces, moving_tracks(m)
    assert len(names) == 1 and before
    for k in range(60, 90):
        m.update(k / 20)
    assert m.seen.pieces == before and moving_tracks(m) == names
