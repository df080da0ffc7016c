"""Conditions of a search for a detour, its path, and the reason reported when there is none."""

from dataclasses import replace

import numpy as np
import pytest
from avoidance_scene import Scene, pole, straight, wall
from conflicts import first_conflict
from paper_system import system

from idc_controller.geometry.free_space import BoundingCylinder
from idc_controller.geometry.shapes import Wall
from idc_controller.guidance import navigator as navigator_module
from idc_controller.guidance.navigator import Navigator
from idc_controller.guidance.settings import NavigatorSettings
from idc_controller.trajectory.paths import Leg
from idc_controller.trajectory.settings import Limits
from idc_controller.trajectory.trajectory import RestTrajectory
from idc_controller.trajectory.waypoints import WaypointTrajectory

ACROSS = wall("barrier", 10.0, 0.0, (0.3, 6.0, 12.0))
CLOSED = wall("the long wall", 10.0, 0.0, (0.3, 400.0, 60.0))
HERE = np.array([6.5, 0.0, -5.0])


STAGES = 0.1 * np.arange(33)
TRACKED = RestTrajectory(HERE, 0.0)


def now(*obstacles):
    return Scene(obstacles).predict(np.zeros(1))


def formation():
    return BoundingCylinder.of(system(), float(np.radians(5.0)))


@pytest.fixture
def navigator():
    return Navigator(system(), NavigatorSettings(), Scene([]), STAGES)


class WatchedScene(Scene):
    """Keeps when its predictions were asked for: once a search."""

    def __init__(self, obstacles):
        super().__init__(obstacles)
        self.asked = []

    def predict(self, times):
        self.asked.append(times[0] - STAGES[0])
        return super().predict(times)


def held_up(navigator, obstacles, seconds, rate=0.3, progress=5.0, begin=0.0, mission=None):
    """Watch at 20 Hz; the progress at the end, and when detours were searched."""
    navigator.obstacles = scene = WatchedScene(obstacles)
    mission = mission or straight(18.0)
    for time in begin + 0.05 * np.arange(round(seconds / 0.05) + 1):
        progress = navigator.watch(time, progress, rate, mission, TRACKED)
        if navigator.detours:
            break
    return progress, scene.asked


def test_mission_is_followed_while_progress_continues(navigator):
    mission = straight(18.0)
    progress, searches = held_up(navigator, [ACROSS], 5.0, rate=0.9, mission=mission)
    assert not searches
    assert progress == 5.0
    assert navigator.followed(mission) is mission
    assert navigator.mission_progress(4.2) == 4.2
    assert navigator.hold_up.blocked(5.0) == ""


@pytest.mark.parametrize("obstacles", [[ACROSS], [pole("p", 10.0, 0.0)], [pole("a", 10.0, -1.0), pole("b", 10.0, 1.0)]])
def test_detour_keeps_margin_and_returns_to_mission(navigator, obstacles):
    mission = straight(18.0)
    progress, _ = held_up(navigator, obstacles, 0.6, mission=mission)
    detour = navigator.followed(mission)
    assert detour is not mission
    assert progress == pytest.approx(0.0)
    np.testing.assert_allclose(detour.position(0.0), HERE, atol=1e-9)
    detour.derivatives(np.array([200.0]), 0)
    resume = navigator.mission_progress(3.0)
    np.testing.assert_allclose(detour.position(detour.end), mission.position(resume), atol=1e-6)
    assert resume > 5.0
    path = detour.derivatives(np.linspace(0.0, detour.end, 300), 0)[0]
    s = navigator.settings
    # Corners are cut by 0.1 m; the rest of the margin remains.
    assert first_conflict(path, now(*obstacles), formation(), s.margin + s.spare - 0.12) is None
    # Beyond where it leads the mission is free.
    beyond = mission.derivatives(np.linspace(resume, mission.end, 50), 0)[0]
    assert first_conflict(beyond, now(*obstacles), formation(), s.margin) is None


def test_clearance_at_which_a_detour_was_held_up_is_not_tried_again_until_the_mission_is_resumed(
    navigator, monkeypatch
):
    tried = []

    def path(progress, mission, position, obstacles, formation, keep):
        tried.append(navigator.clearances.index((formation, keep)))
        return ways[tried[-1]]

    none = navigator_module._NoPath("none")
    monkeypatch.setattr(navigator, "_path", path)
    ways = [none, none, (np.array([HERE, HERE + np.array([0.0, 4.0, 0.0])]), 9.0)]
    held_up(navigator, [ACROSS], 0.6)
    assert (tried, navigator.detours) == ([0, 1, 2], 1)
    # Held up on that detour, and again: what was not flown stays.
    ways[2] = none
    for begin in (10.0, 20.0, 40.0):
        tried.clear()
        for time in begin + 0.05 * np.arange(20):
            navigator.watch(time, 1.0, 0.3, straight(18.0), TRACKED)
        assert tried == [0, 1]
    navigator.reset()
    tried.clear()
    for time in 60.0 + 0.05 * np.arange(20):
        navigator.watch(time, 5.0, 0.3, straight(18.0), TRACKED)
    assert tried == [0, 1, 2]


def test_mission_is_resumed_at_end_of_detour(navigator):
    mission = straight(18.0)
    held_up(navigator, [ACROSS], 0.6, mission=mission)
    detour, resume = navigator.followed(mission), navigator.mission_progress(0.0)
    detour.derivatives(np.array([200.0]), 0)
    assert navigator.advance(detour.end - 1.0) == detour.end - 1.0
    assert navigator.followed(mission) is detour
    assert navigator.advance(detour.end - 0.2) == resume
    assert navigator.followed(mission) is mission
    assert navigator.mission_progress(resume + 0.5) == resume + 0.5


def test_blocked_path_is_reported_with_blocking_obstacle_after_timeout(navigator):
    settings = navigator.settings
    # The bystander is nearer than the wall's centre, but not than the wall.
    obstacles = [pole("bystander", 6.5, 30.0), wall("the long wall", 10.0, 100.0, (0.3, 600.0, 60.0))]
    progress, searches = held_up(navigator, obstacles, settings.give_up)
    assert navigator.detours == 0
    assert progress == 5.0
    assert "the long wall" in navigator.hold_up.reason
    # Searches become rarer.
    gaps = np.diff(searches)
    assert np.all(np.diff(gaps) > -0.06)
    assert gaps[0] < 2.0 * settings.search_interval + 0.1
    assert len(searches) < 8
    since = searches[0]
    assert navigator.hold_up.blocked(since + settings.give_up - 0.1) == ""
    assert "the long wall" in navigator.hold_up.blocked(since + settings.give_up)


def hanging(name, east, size, bottom=0.0, growth=0.0):
    """A box 10 m north with its underside so high."""
    place = np.array([10.0, east, -bottom - size[2] / 2.0])
    return name, Wall(size), lambda t: np.tile(place, (len(t), 1)), growth


@pytest.mark.parametrize(("door", "growth"), [(0.8, 0.0), (1.7, 0.05), (2.6, 0.0)])
def test_narrowest_gap_is_named_in_reason_by_estimates(navigator, door, growth):
    """Two walls across the region of the search, with a door 2 m beside the mission; the growth is uncertainty."""
    edge = 100.0
    left, right = 2.0 - (edge + door) / 2.0, 2.0 + (edge + door) / 2.0
    walls = [hanging(name, y, (0.3, edge, 40.0), 0.0, growth) for name, y in (("left", left), ("right", right))]
    held_up(navigator, walls, 3.0)
    reason = navigator.hold_up.blocked(3.0 + navigator.settings.give_up)
    assert navigator.hold_up.blocked(4.0 + navigator.settings.give_up) == reason  # once
    assert f"; the narrowest gap is {door:.2f} m wide at " in reason
    assert reason.endswith("(left and right), 3.57 m are needed")
    north, east = (float(part.split()[-1]) for part in reason.split(" m wide at ")[1].split(" m ")[:2])
    assert (north, east) == pytest.approx((10.0, 2.0), abs=0.25)


def test_lintel_too_low_is_named_with_its_height(navigator):
    walls = [hanging("left", -53.0, (0.3, 100.0, 40.0)), hanging("right", 53.0, (0.3, 100.0, 40.0))]
    held_up(navigator, [*walls, hanging("lintel", 0.0, (0.3, 6.0, 36.0), bottom=4.0)], 3.0)
    reason = navigator.hold_up.blocked(3.0 + navigator.settings.give_up)
    assert "; the narrowest gap is 4.00 m high at " in reason
    assert reason.endswith("(lintel), 4.33 m are needed")


def test_detour_is_flown_and_reason_cleared_when_path_opens(navigator):
    held_up(navigator, [CLOSED], 3.0)
    assert navigator.hold_up.reason
    held_up(navigator, [ACROSS], 9.0, begin=3.05)
    assert navigator.detours == 1
    assert navigator.hold_up.reason == ""
    assert navigator.hold_up.blocked(100.0) == ""


def test_waypoint_inside_obstacle_is_named_in_reason(navigator):
    mission = straight(10.0)
    held_up(navigator, [wall("block", 10.0, 0.0, (3.0, 3.0, 8.0))], 3.0, mission=mission)
    assert navigator.detours == 0
    assert "block" in navigator.hold_up.reason
    assert "10.0 m north" in navigator.hold_up.reason


def test_detour_with_nothing_in_its_way_leads_back_to_where_the_mission_is(navigator):
    progress, _ = held_up(navigator, [], navigator.settings.patience + 0.1)
    assert navigator.detours == 1 and progress == 0.0
    assert navigator.mission_progress(3.0) == 5.0


def test_reset_discards_detour(navigator):
    mission = straight(18.0)
    held_up(navigator, [ACROSS], 0.6, mission=mission)
    navigator.reset()
    assert navigator.followed(mission) is mission
    assert navigator.mission_progress(7.0) == 7.0
    assert navigator.hold_up.blocked(1000.0) == ""


@pytest.mark.parametrize("north", [10.0, 40.0])
@pytest.mark.parametrize(("share", "stands"), [(0.0, True), (0.9, True), (1.1, False)])
def test_obstacle_that_drifts_less_than_the_limit_stands_at_its_waypoint(navigator, north, share, stands):
    drift = share * navigator.settings.standing / (STAGES[-1] - STAGES[0])
    name, shape, place, growth = wall("block", north, 0.0, (3.0, 3.0, 8.0))
    drifting = name, shape, lambda t: place(t) + np.outer(t, [0.0, drift, 0.0]), growth
    held_up(navigator, [drifting], 1.0, progress=north / 1.5 - 2.0, mission=straight(north))
    assert ("block stands at the waypoint" in navigator.hold_up.reason) == stands


class ThatMayLeave(WatchedScene):
    """Obstacles that may leave where they are."""

    def predict(self, times):
        return [replace(obstacle, may_leave=True) for obstacle in super().predict(times)]


def test_way_beyond_a_waypoint_is_searched_where_what_covers_that_may_leave(navigator, monkeypatch):
    waypoint = 10.0
    legs = [Leg(np.array([north, 0.0, -5.0]), 1.5) for north in (waypoint, 30.0)]
    mission = WaypointTrajectory([0.0, 0.0, -5.0], legs, Limits(1.5, 1.5, 2.0, 6.0))
    block = wall("block", waypoint, 0.0, (3.0, 3.0, 8.0))
    held_up(navigator, [block], 1.0, progress=waypoint / 1.5 - 2.0, mission=mission)
    assert "block stands at the waypoint" in navigator.hold_up.reason
    assert navigator.detours == 0
    monkeypatch.setitem(globals(), "WatchedScene", ThatMayLeave)
    held_up(navigator, [block], 1.0, progress=waypoint / 1.5 - 2.0, begin=20.0, mission=mission)
    assert navigator.detours == 1
    end = navigator.followed(mission).derivatives(np.array([99.0]), 0)[0, 0]
    assert end[0] > waypoint + 1.5
