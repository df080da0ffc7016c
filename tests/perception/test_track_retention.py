"""Track retention: which tracks of moving obstacles are deleted, kept or coast when they are not detected."""

from types import SimpleNamespace

import numpy as np
import pytest
from obstacle_scene import HERE, Scene, map_of, moving_tracks, outside, pole, run, sphere

from idc_controller.perception.settings import PerceptionSettings
from idc_controller.perception.track import Detections
from idc_controller.perception.track_list import TrackList


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


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.long) for seed in (1, 2))])
def test_forest_that_stands_does_not_keep_its_tracks(seed):
    """Before it has been seen for long, what is bounded may move; afterwards the map explains it."""
    places = np.random.default_rng(seed).uniform(-9.0, 9.0, (40, 2))
    trees = [pole((north, east, 0.0), radius=0.15) for north, east in places if np.hypot(north, east) > 2.0]
    m = map_of()
    run(m, lambda t: trees, 6.0, scene=Scene(seed))
    assert len(m.tracks) < 2 * len(trees)
    assert moving_tracks(m) == []


@pytest.mark.parametrize(
    ("changes", "since", "kept"),
    [
        ({"seems_to_stand": True}, 1.0, False),
        ({"seems_to_stand": True}, 3.0, True),
        ({"seems_to_stand": False}, 1.0, True),
        ({"is_static": True, "seems_to_stand": False}, 3.0, False),
        ({"is_static": True, "seems_to_stand": False, "is_bound_to_region": True}, 3.0, True),
        ({"is_static": True, "seems_to_stand": False, "is_bound_to_region": True}, 1.0, False),
        ({"seems_to_stand": False, "is_bound_to_region": True}, 1.0, True),
        ({"seems_to_stand": True, "map_shape": "sphere"}, 1.0, True),
    ],
)
def test_track_is_absorbed_by_what_has_stood_there_or_where_it_has_come_to_rest(changes, since, kept):
    """``since``: when the map first held its points."""
    it = track(0.0, **changes)
    it.detections.points = np.zeros((4, 3))
    tracks = TrackList([it], [], None, PerceptionSettings())
    tracks.absorb(lambda points, before: np.full(len(points), since < before), 2.0)
    assert bool(tracks.tracks) is kept


RETENTION = PerceptionSettings().retention
NOW = 100.0


def track(undetected, **changes):
    """A confirmed track of a moving obstacle, detected last ``undetected`` s before now."""
    usual = {
        "is_confirmed": True, "is_obstacle": True, "is_static": False, "has_moved": True, "is_retained": False,
        "is_deleted": False, "map_shape": None, "is_bound_to_region": False,
    }  # fmt: skip
    return SimpleNamespace(name="it", detections=Detections(last=NOW - undetected), **(usual | changes))


def retained(it, in_view=False, sensing_lost=False):
    """(Whether it is kept, names that are reported)."""
    tracks = TrackList([it], [], None, PerceptionSettings())
    reported = tracks.retain(NOW, sensing_lost, lambda _: in_view)
    return tracks.tracks == [it], reported


TENTATIVE, IN_VIEW, OUT_OF_VIEW = RETENTION.tentative_time, RETENTION.delete_after, RETENTION.forget_after


@pytest.mark.parametrize(
    ("changes", "in_view", "limit"),
    [
        ({"is_confirmed": False}, True, TENTATIVE),
        ({"is_confirmed": False}, False, TENTATIVE),
        ({"is_confirmed": False, "is_static": True}, False, TENTATIVE),
        ({}, True, IN_VIEW),
        ({"is_static": True}, True, IN_VIEW),
        ({}, False, OUT_OF_VIEW),
        ({"is_static": True, "has_moved": False}, False, OUT_OF_VIEW),
    ],
)
def test_track_that_is_not_detected_is_kept_for_its_time(changes, in_view, limit):
    """Reported where a vehicle would have detected a confirmed one."""
    assert retained(track(0.99 * limit, **changes), in_view) == (True, [])
    assert retained(track(1.01 * limit, **changes), in_view) == (False, ["it"] if limit is IN_VIEW else [])


def test_time_out_of_view_does_not_count_as_time_without_a_detection_in_view():
    it, now = track(0.0), NOW
    tracks = TrackList([it], [], None, PerceptionSettings())
    for until, in_view in ((1.5, False), (1.9, True)):
        while now < NOW + until:
            assert tracks.retain(now, False, lambda _, seen=in_view: seen) == [] and tracks.tracks == [it]
            now += 0.05
    # In view again for as long as it takes, had it not been forgotten: out of view it is predicted too far.
    assert it.detections.missed(NOW + 1.5 + 0.99 * IN_VIEW, True) < IN_VIEW
    assert it.detections.missed(NOW + 1.5 + 1.01 * IN_VIEW, True) == pytest.approx(1.01 * IN_VIEW + 0.05, abs=0.06)


def test_body_below_the_elevations_of_all_rays_is_out_of_view():
    m, scene = map_of(), Scene(0)
    run(m, lambda t: [sphere(crossing(t))], 2.5, scene=scene)
    [it] = [track for track in m.tracks if track.name in moving_tracks(m)]
    assert m._in_field_of_view(it)
    # By the formation's rays, which end 70 deg below the horizon.
    centre = it.centre(2.5)
    for beside, in_view in ((3.0, True), (0.5, False)):
        scene.feed(m, 2.5, np.add(centre, [beside, 0.0, -5.0]), [])
        m.update(2.5)
        assert m._in_field_of_view(it) is in_view


def test_track_that_does_not_count_as_an_obstacle_is_deleted_without_a_report():
    assert retained(track(1.01 * IN_VIEW, is_obstacle=False), in_view=True) == (False, [])


@pytest.mark.parametrize(
    ("changes", "in_view"),
    [
        ({"is_static": True}, False),
        ({"is_retained": True}, True),
        ({"map_shape": "a sphere"}, False),
        ({"map_shape": "a sphere", "is_deleted": True}, True),
    ],
    ids=["stands out of view", "retained", "of the map, out of view", "of the map, reported before"],
)
def test_track_is_kept_for_ever(changes, in_view):
    assert retained(track(1e3, **changes), in_view) == (True, [])


def test_obstacle_of_the_map_that_is_gone_is_reported_once_and_stays_to_be_found_again():
    it = track(1e3, map_shape="a sphere")
    tracks = TrackList([it], [], None, PerceptionSettings())
    assert [tracks.retain(NOW + k, False, lambda _: True) for k in range(2)] == [["it"], []]
    assert tracks.tracks == [it] and it.is_deleted


@pytest.mark.parametrize(("share", "restored"), [(0.99, True), (1.01, False)])
def test_track_deleted_shortly_before_sensing_is_lost_is_restored(share, restored):
    it, young = track(1.01 * IN_VIEW), track(0.0, is_confirmed=False)
    tracks = TrackList([it, young], [], None, PerceptionSettings())
    assert tracks.retain(NOW, False, lambda _: True) == ["it"] and tracks.tracks == [young]
    assert tracks.retain(NOW + share * RETENTION.restorable, True, lambda _: True) == []
    assert tracks.tracks == ([young, it] if restored else [young])
    assert it.is_retained is restored and not it.is_deleted and not young.is_retained
    # Restored, it is kept once a sensor is back, until it is detected again.
    assert tracks.retain(NOW + 50.0, False, lambda _: True) == []
    assert tracks.tracks == ([it] if restored else [])


def test_nothing_is_deleted_while_sensing_is_lost():
    for it in (track(1e3), track(1e3, is_confirmed=False), track(1e3, map_shape="a sphere")):
        assert retained(it, in_view=True, sensing_lost=True) == (True, [])
        assert it.is_retained is it.is_confirmed
