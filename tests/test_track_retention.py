"""Track retention: which tracks are deleted, kept or coast when their obstacles are not detected."""

import numpy as np
from obstacle_scene import (
    Scene,
    map_of,
    run,
    sphere,
)


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
