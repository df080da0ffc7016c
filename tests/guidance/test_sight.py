"""Speed by sight: the formation stops before what was not seen, leaves time at corners, loses nothing in the open."""

import math

import numpy as np
import pytest
from avoidance_scene import STEP, avoidance, straight
from paper_system import system
from range_scene import is_occupied, is_seen_free

from gcs.config import SystemConfig
from gcs.flight.stack import closing_speed_limit, reaction_time, tilted_formation
from idc_controller.guidance.settings import SightSettings
from idc_controller.guidance.sight import SensorView, SpeedBySight
from idc_controller.perception.placed_scan import PlacedScan
from idc_controller.perception.settings import StandingMapSettings
from idc_controller.perception.sight_kernels import first_hidden, unseen_cells
from idc_controller.perception.standing_map import StandingMap

FORMATION = tilted_formation(SystemConfig())
OFFSETS = system().p - np.outer(system().l, [0.0, 0.0, 1.0])
VIEW = SensorView(OFFSETS, 10.0, math.radians(-70.0), math.radians(30.0))
REACTION = reaction_time(SystemConfig(), FORMATION)
EVERYWHERE = 1e9


class Ahead:
    """Sight to the north: free up to ``seen`` (m), the way in sight up to ``corner`` (m); ``above``: nothing is."""

    has_sight = True
    lowest_seen = 0.7

    def __init__(self, seen=EVERYWHERE, corner=EVERYWHERE, above=-EVERYWHERE):
        self.seen, self.corner, self.above = seen, corner, above

    def unseen(self, time, path, body):
        reaches = (path[1:, 0] + body[0] > self.seen) | (path[1:, 2] - body[1] < self.above)
        before = np.flatnonzero(reaches)
        middles = path[before + 1] + [0.0, 0.0, -1.0]
        if self.seen < EVERYWHERE:
            middles[:, 0] = self.seen + 0.25
        else:
            middles[:, 2] = path[before + 1, 2] - body[1] + 0.25
        return before, middles

    def first_hidden(self, path, sensors, heights):
        return int(np.append(np.flatnonzero(path[:, 0] > self.corner), len(path))[0])


def by_sight(sight, **settings):
    return SpeedBySight(sight, SightSettings(**settings), FORMATION, VIEW, REACTION)


def flown(sight, speed, length, duration, each=lambda time, place: None):
    """Place and velocity (K, 2) north at every step of a flight by ``sight``."""
    both = avoidance([], speed=speed, by_sight=by_sight(sight))
    mission, states, place = straight(length, speed), [], np.zeros(3)
    for time in STEP * np.arange(round(duration / STEP)):
        each(time, place)
        trajectory = both.step(time, mission)
        place, velocity = trajectory.derivatives(np.array([time + STEP]), 1)[:, 0]
        states.append((place[0], velocity[0]))
    return np.array(states), both


@pytest.mark.parametrize("seed", range(6))
def test_formation_stops_before_unseen_space_from_any_speed(seed):
    rng = np.random.default_rng(seed)
    speed, ends = rng.uniform(0.5, 3.0), rng.uniform(4.0, 8.0)
    sight = Ahead()
    needed = FORMATION.radius + speed * (0.4 + 0.5 * (speed / 1.5 + SightSettings().stopping_delay)) + 1.5

    def look(time, place):
        if time < ends:
            sight.seen = place[0] + needed

    states, both = flown(sight, speed, 100.0, ends + 12.0, look)
    before = states[: int(ends / STEP) - 10, 1].max()
    assert before == pytest.approx(speed, rel=0.1)
    hull = states[:, 0] + FORMATION.radius
    assert hull.max() <= sight.seen
    assert np.abs(states[-20:, 1]).max() < 0.2
    assert both.guidance.sight.reason == "unseen"


def test_way_that_stays_unseen_ends_the_mission():
    _, both = flown(Ahead(seen=12.0), 2.0, 100.0, 40.0)
    assert "not seen free" in both.guidance.blocked(40.0)
    assert both.guidance.detours == 0


def test_space_that_comes_into_sight_is_entered():
    sight = Ahead(seen=8.0)

    def look(time, place):
        sight.seen = 8.0 if time < 15.0 else EVERYWHERE

    states, both = flown(sight, 1.5, 20.0, 40.0, look)
    assert states[-1, 0] == pytest.approx(20.0, abs=0.1)
    assert both.guidance.blocked(40.0) == ""


@pytest.mark.parametrize("speed", [1.5, 2.5])
def test_nothing_is_lost_in_the_open(speed):
    states, both = flown(Ahead(), speed, 30.0, 5.0 + 30.0 / speed)
    assert states[:, 1].max() == pytest.approx(speed, rel=1e-6)
    assert both.guidance.rate == 1.0


def test_corner_is_passed_at_a_speed_that_leaves_time_to_give_way():
    sight = Ahead(corner=15.0)
    limit, settings = by_sight(sight), SightSettings()

    def look(time, place):
        if place[0] >= 14.0:
            sight.corner = EVERYWHERE

    states, _ = flown(sight, 2.5, 40.0, 30.0, look)
    near = (states[:, 0] > 8.0) & (states[:, 0] < 14.0)
    allowed = np.maximum((15.0 - states[near, 0]) / REACTION - settings.closing_speed, limit.slow)
    # The plan follows the reference with some delay.
    assert (states[near, 1] <= allowed + 0.45).all(), (states[near, 1] - allowed).max()
    assert states[near, 1].min() < 1.0
    assert states[states[:, 0] > 20.0, 1].max() >= 2.5


def test_space_above_the_field_of_view_is_entered_slowly_but_entered():
    place, climb = np.array([0.0, 0.0, -5.0]), np.array([0.0, 0.0, -2.0])

    class Climb:
        rate = 1.0

        def derivatives(self, times, order):
            return np.array([place + np.outer(times, climb), np.tile(climb, (len(times), 1))])

    found = by_sight(Ahead(above=-5.0 - FORMATION.above - 0.6)).limit(0.0, Climb(), Climb())
    assert found.reason == "blind"
    assert found.rate == pytest.approx(SightSettings().blind_speed / 2.0)


def test_without_scans_the_speed_is_not_limited():
    sight = Ahead(seen=0.0)
    sight.has_sight = False
    states, both = flown(sight, 1.5, 10.0, 12.0)
    assert states[-1, 0] == pytest.approx(10.0, abs=0.05)
    assert both.guidance.sight.reason == ""


def test_own_speed_leaves_time_to_give_way_to_what_comes_into_range():
    states, both = flown(Ahead(), 3.0, 30.0, 15.0)
    fastest = by_sight(Ahead()).fastest
    assert states[:, 1].max() == pytest.approx(fastest, abs=0.05) and fastest < 2.8
    assert both.guidance.sight.reason == "range"


def test_limits_in_closing_speed_as_documented():
    """docs/safety.md: closing speed, its three times, and the way to stop."""
    limit = by_sight(Ahead())
    assert pytest.approx(0.7 + 0.1 + 2.2, abs=0.05) == REACTION
    assert closing_speed_limit(SystemConfig()) == pytest.approx(3.1, abs=0.05)
    # Sight that speeds need: way to stop, with the formation's body beside the sensors.
    for speed, distance in ((1.5, 2.5), (2.5, 5.1), (3.0, 6.6)):
        assert limit.speed_within(distance) == pytest.approx(speed, rel=0.02)


def seen_about(settings, rng, rays=4000, hit=None):
    """A map that looked from the origin to all sides."""
    seen = StandingMap(settings)
    ways = rng.normal(size=(rays, 3))
    ends = 6.0 * ways / np.linalg.norm(ways, axis=1)[:, None]
    returns = np.empty((0, 3)) if hit is None else np.ascontiguousarray(hit)
    seen.add(PlacedScan(0.0, np.zeros(3), returns, 0.05, 0.02, 0.003, ends, 0))
    return seen


@pytest.mark.parametrize("seed", range(3))
def test_unseen_cells_are_those_of_the_plain_formula(seed):
    rng = np.random.default_rng(seed)
    settings = StandingMapSettings()
    seen = seen_about(settings, rng, rays=150, hit=rng.uniform(2.0, 3.0, (5, 3)))
    path = np.linspace([0.0, 0.0, -1.0], [4.5, 1.0, -2.0], 30)
    body = np.array([1.2, 1.0, 0.8, 0.4])
    before, middles = seen.unseen(path, body, 10_000)
    found = np.empty((10_000, 4))
    plain = unseen_cells.py_func(seen._voxels, seen._rules, path, body, found)
    assert plain == len(before) > 0
    np.testing.assert_array_equal(found[:plain, 0], before)
    np.testing.assert_array_equal(found[:plain, 1:], middles)
    # Cells in view, plainly: a voxel of theirs was seen free or is at a point.
    offsets = settings.voxel * (np.array(np.meshgrid(*3 * [[-0.5, 0.5]])).reshape(3, -1).T)
    for middle in middles:
        assert not is_seen_free(seen, middle + offsets).any()
        assert not is_occupied(seen, middle + offsets).any()
    # They are ahead, not where the body is; and above the least height.
    inside = (np.hypot(*middles[:, :2].T) <= 1.2) & (middles[:, 2] >= -2.0) & (middles[:, 2] <= -0.2)
    assert not inside.any()
    assert (middles[:, 2] <= -0.4).all()


def test_what_was_looked_at_from_near_is_seen_and_what_lies_beyond_is_not():
    seen = seen_about(StandingMapSettings(), np.random.default_rng(1), rays=60_000)
    path = np.linspace([0.0, 0.0, -3.0], [8.0, 0.0, -3.0], 33)
    before, middles = seen.unseen(path, np.array([1.0, 1.0, 1.0, 0.0]), 100)
    assert np.hypot(*middles.T[:2]).min() > 4.0
    assert 3.0 < path[before[0], 0] < 5.5


def test_way_behind_a_wall_is_hidden():
    rng = np.random.default_rng(0)
    wall = np.column_stack([np.full(4000, 3.0), rng.uniform(-2.0, 2.0, (4000, 2))])
    seen = seen_about(StandingMapSettings(), rng, hit=wall)
    path, heights = np.linspace([0.5, 0.0, 0.0], [6.0, 0.0, 0.0], 23), np.zeros(1)
    index = seen.first_hidden(path, np.zeros((1, 3)), heights)
    assert 3.0 <= path[index, 0] <= 3.8
    plain = first_hidden.py_func(seen._voxels, path, np.zeros((1, 3)), heights, 0.25)
    assert plain == index
    # Another sensor sees round it.
    assert seen.first_hidden(path, np.array([[0.0, 0.0, 0.0], [4.5, 5.0, 0.0]]), heights) == len(path)
