"""Track retention: which tracks are deleted, kept or coast when their obstacles are not detected."""

from types import SimpleNamespace

import numpy as np
import pytest
from obstacle_scene import (
    Scene,
    map_of,
    run,
    sphere,
)

from idc_controller.perception.settings import PerceptionSettings
from idc_controller.perception.track_list import TrackList


def test_track_is_deleted_in_field_of_view_and_single_detection_never_confirmed():
    m = map_of()
    run(m, lambda t: [sphere((5.0, 0.0, -6.0))], 1.0)
    assert len(m.predict(np.array([1.0]))) == 1
    run(m, lambda t: [], 1.8, begin=1.0)
    assert len(m.predict(np.array([1.8]))) == 1  # still predicted while it coasts briefly
    run(m, lambda t: [], 2.5, begin=1.8)
    assert m.predict(np.array([2.5])) == []
    m = map_of()
    counts = []
    run(m, lambda t: [sphere((5.0, 0.0, -6.0))] if t < 0.05 else [], 1.0, scene=Scene(0, uavs=1),
        each=lambda t: counts.append(len(m.predict(np.array([t])))))  # fmt: skip
    assert set(counts) == {0}
    assert m.tracks == []


def leaving(t):
    return np.array([-max(t - 1.0, 0.0) * 3.0, 0.0, -6.0])


def test_out_of_range_static_track_is_kept_and_moving_one_deleted():
    def things(t):
        return [sphere((5.0, 0.0, -6.0), 0.5, "stands"), sphere((5.0, -2.0 + 1.5 * t, -6.0), 0.4, "moves")]

    m = map_of()
    run(m, things, 12.0, centre=leaving)
    (left,) = m.predict(np.array([12.0, 13.0]))
    assert np.linalg.norm(left.positions[0] - [5.0, 0.0, -6.0]) < 0.1
    assert left.growth[0] < 0.1  # as certain as when it was last detected


def test_moving_track_coasts_after_it_left_the_range():
    m = map_of()
    run(m, lambda t: [sphere((5.0 + 1.8 * t, 0.0, -6.0))], 4.0)  # out of range after 3 s
    (o,) = m.predict(np.array([4.0]))
    assert np.linalg.norm(o.positions[0] - [5.0 + 1.8 * 4.0, 0.0, -6.0]) < 0.5
    run(m, lambda t: [], 6.0, begin=4.0)
    assert m.predict(np.array([6.0])) == []


def test_no_track_is_deleted_when_telemetry_of_all_vehicles_times_out():
    m = map_of()
    run(m, lambda t: [sphere((5.0, 0.0, -6.0))], 1.0)
    for k in range(20, 60):
        m.update(k / 20)
    assert len(m.predict(np.array([3.0]))) == 1


RETENTION = PerceptionSettings().retention
NOW = 100.0


def track(undetected, **changes):
    """A confirmed track of a moving obstacle, detected last ``undetected`` s before now."""
    usual = {"is_confirmed": True, "is_static": False, "is_retained": False, "is_deleted": False, "map_shape": None}
    return SimpleNamespace(name="it", last_detected=NOW - undetected, **(usual | changes))


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
    ],
)
def test_track_that_is_not_detected_is_kept_for_its_time(changes, in_view, limit):
    """Reported where a vehicle would have detected a confirmed one."""
    assert retained(track(0.99 * limit, **changes), in_view) == (True, [])
    assert retained(track(1.01 * limit, **changes), in_view) == (False, ["it"] if limit is IN_VIEW else [])


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
