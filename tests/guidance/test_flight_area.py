"""Fences as areas: what is inside, ways round notches, holes and exclusions, and places of rest."""

import math
import re
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import shapely
from avoidance_scene import avoidance, fly
from braking_path import path_of
from detours import detour_among, gap_among
from mission_files import RETURN, TAKE_OFF, A, plan, polygon, read, refusal, row
from paper_system import system
from standing_obstacles import StandingObstacles

from gcs.config import read_system
from gcs.mission.fence import Exclusion, boundary_of, boundary_walls, excluded_polygon
from gcs.record.run_data import RunData
from idc_controller.geometry.free_space import BoundingCylinder, FlightArea
from idc_controller.guidance.navigator import Navigator
from idc_controller.guidance.resting_place import RestingPlace
from idc_controller.guidance.settings import NavigatorSettings
from idc_controller.trajectory.paths import Circle, Leg
from idc_controller.trajectory.settings import Limits
from idc_controller.trajectory.stop_plan import Braking
from idc_controller.trajectory.trajectory import RestTrajectory
from idc_controller.trajectory.waypoints import WaypointTrajectory

STAGES = 0.1 * np.arange(33)
FORMATION = BoundingCylinder.of(system(), math.radians(5.0))
MARGIN = 0.5
NOTCHED = ((-4.0, -4.0), (-4.0, 24.0), (20.0, 24.0), (20.0, 14.0), (4.0, 14.0), (4.0, 6.0), (20.0, 6.0), (20.0, -4.0))
LONG = tuple((60.0 if north == 20.0 else north, east) for north, east in NOTCHED)
SQUARE = ((-15.0, -6.0), (-15.0, 36.0), (15.0, 36.0), (15.0, -6.0))
WEST = ((-5.0, -5.0), (-5.0, 14.0), (15.0, 14.0), (15.0, -5.0))
EAST = ((4.0, 8.0), (15.0, 8.0), (15.0, 30.0), (-5.0, 30.0), (-5.0, 20.0), (4.0, 20.0))
PENTAGON = tuple((9.0 * math.cos(a), 14.0 + 9.0 * math.sin(a)) for a in np.arange(5) * math.tau / 5)


def fence(boundary=(), *excluded):
    """Obstacles (name, shape, place) along the edges of an area, and the area."""
    exclusions: list[Exclusion] = [excluded_polygon(f"fence polygon {i}", ring) for i, ring in enumerate(excluded, 1)]
    bodies = [*boundary_walls(boundary), *(o for exclusion in exclusions for o in exclusion.obstacles)]
    return [(o.name, o.shape, np.array(o.position)) for o in bodies], FlightArea(boundary, excluded)


def leg(*places):
    return WaypointTrajectory(
        places[0], [Leg(np.array(place), 1.5) for place in places[1:]], Limits(1.5, 1.5, 2.0, 6.0)
    )


def least_to_edges(path, area):
    """Distance (m) of places (P, 3) to the nearest edge of an area."""
    edges = [edge for ring in (*area.boundary, *area.excluded) for edge in pairwise([*ring, ring[0]])]
    return shapely.distance(shapely.points(path[:, :2]), shapely.MultiLineString(edges)).min()


def navigated(obstacles, area, here, mission, seconds=0.7):
    """The navigator, held up ``here`` for so long."""
    navigator = Navigator(system(), NavigatorSettings(margin=MARGIN), StandingObstacles(obstacles), STAGES, area)
    for time in 0.05 * np.arange(round(seconds / 0.05) + 1):
        navigator.watch(time, 5.0, 0.3, mission, RestTrajectory(here, 0.0))
        if navigator.detours:
            break
    return navigator


def test_area_holds_its_edges_and_what_an_odd_number_of_rings_encloses():
    hole = ((5.0, 5.0), (5.0, 9.0), (9.0, 9.0), (9.0, 5.0))
    island = ((6.0, 6.0), (6.0, 8.0), (8.0, 8.0), (8.0, 6.0))
    area = FlightArea((SQUARE, hole, island), (((-9.0, 0.0), (-9.0, 4.0), (-5.0, 2.0)),))
    places = [(0, 0), (5.5, 7), (7, 7), (5, 7), (-8, 2), (-9, 2), (16, 0), (15, 0)]
    assert area.contains(np.array(places, dtype=float)).tolist() == [True, False, True, True, False, True, False, True]
    assert [area.is_hole(ring) for ring in area.boundary] == [False, True, False]
    assert FlightArea(excluded=(hole,)).contains(np.array([[7.0, 7.0], [1e4, 0.0]])).tolist() == [False, True]


def test_walls_stand_on_the_outer_side_of_every_ring():
    area = FlightArea((SQUARE, PENTAGON))
    walls = boundary_walls(area.boundary)
    assert not area.contains(np.array([wall.position for wall in walls])).any()
    assert [wall.name for wall in walls] == [f"the fence (boundary edge {i})" for i in range(1, 10)]


def test_boundary_of_one_area_has_its_own_corners_and_several_are_joined_or_intersected():
    assert boundary_of([NOTCHED], common=False) == (NOTCHED,)
    (joined,) = boundary_of([WEST, EAST], common=False)
    (common,) = boundary_of([WEST, EAST], common=True)
    inside = np.array([[0.0, 0.0], [8.0, 10.0], [0.0, 25.0], [0.0, 17.0]])
    assert FlightArea((joined,)).contains(inside).tolist() == [True, True, True, False]
    assert FlightArea((common,)).contains(inside).tolist() == [False, True, False, False]
    lid = ((18.0, -4.0), (18.0, 24.0), (24.0, 24.0), (24.0, -4.0))
    rings = boundary_of([NOTCHED, lid], common=False)
    assert [FlightArea(rings).is_hole(ring) for ring in rings] == [False, True]
    beside = tuple((north + 24.0 + 1e-7, east) for north, east in lid)  # which only a slit separates from the lid
    assert len(boundary_of([lid, tuple((n - 18.0, e) for n, e in beside)], common=False)) == 1


def test_inclusion_areas_of_px4_are_alternatives_and_those_of_ardupilot_conditions(tmp_path: Path) -> None:
    near, far = (polygon((s, -9), (s, 9), (e, 9), (e, -9)) for s, e in ((-9.0, 15.0), (5.0, 40.0)))
    fenced = {"geoFence__polygons": [near, far]}
    assert len(read(tmp_path, plan(TAKE_OFF, A, row(16, north=30.0), RETURN, **fenced)).boundary[0]) > 3
    reasons = refusal(tmp_path, plan(TAKE_OFF, A, row(16, north=30.0), RETURN, mission__firmwareType=3, **fenced))
    assert any("home is outside" in reason for reason in reasons)
    assert any(re.match(r".*: items 1, (2, )?3\b.*outside the fence", reason) for reason in reasons), reasons


def test_waypoint_in_the_middle_of_a_wide_exclusion_is_refused(tmp_path: Path) -> None:
    wide = polygon(
        *((30.0 + 9.0 * math.cos(a), 9.0 * math.sin(a)) for a in np.arange(5) * math.tau / 5), inclusion=False
    )
    (reason,) = refusal(tmp_path, plan(TAKE_OFF, row(16, north=30.0), RETURN, geoFence__polygons=[wide]))
    assert "item 2" in reason and "inside fence polygon 1, which the fence excludes" in reason
    mission = read(tmp_path, plan(TAKE_OFF, row(16, north=50.0), RETURN, geoFence__polygons=[wide]))
    assert [len(ring) for ring in mission.excluded] == [5]


@pytest.mark.parametrize(
    ("boundary", "excluded", "start", "here", "end", "length"),
    [
        ((NOTCHED,), (), (16.0, 0.0), (16.0, 4.0), (16.0, 20.0), 39.0),
        ((LONG,), (), (56.0, 0.0), (56.0, 4.0), (56.0, 20.0), 115.0),
        ((), (PENTAGON,), (0.0, 0.0), (0.0, 3.5), (0.0, 30.0), 32.5),
        ((SQUARE,), (PENTAGON,), (0.0, 0.0), (0.0, 3.5), (0.0, 30.0), 32.5),
        ((SQUARE, PENTAGON), (), (0.0, 0.0), (0.0, 3.5), (0.0, 30.0), 32.5),
        (boundary_of([WEST, EAST], common=False), (), (0.0, 0.0), (0.0, 12.0), (0.0, 26.0), 20.0),
    ],
    ids=["notch", "farther than regions reach", "pentagon", "pentagon in a square", "hole", "two areas"],
)
def test_detour_leads_round_what_the_fence_forbids(boundary, excluded, start, here, end, length):
    obstacles, area = fence(boundary, *excluded)
    here = np.array([*here, -5.0])
    mission = leg((*start, -5.0), (*end, -5.0), (*start, -5.0))
    navigator = navigated(obstacles, area, here, mission)
    assert navigator.detours == 1, navigator.hold_up.reason
    detour = navigator.followed(mission)
    detour.derivatives([500.0], 0)
    path = detour.derivatives(np.linspace(0.0, detour.end, 800), 0)[0]
    assert area.contains(path).all()
    assert least_to_edges(path, area) > 0.8 + MARGIN - 0.12  # the formation's half width, and corners cut
    assert np.linalg.norm(np.diff(path, axis=0), axis=1).sum() == pytest.approx(length, rel=0.15)


def test_detour_ends_at_a_waypoint_shortly_behind_what_the_fence_forbids():
    obstacles, area = fence((), PENTAGON)
    mission = leg((0.0, 0.0, -5.0), (0.0, 26.0, -5.0), (0.0, 0.0, -5.0))
    detour = navigated(obstacles, area, np.array([0.0, 3.5, -5.0]), mission).followed(mission)
    detour.derivatives([500.0], 0)
    assert detour.position(detour.end) == pytest.approx([0.0, 26.0, -5.0], abs=0.15)


def test_notch_up_to_a_gap_narrower_than_the_formation_is_named_with_its_width():
    bay = ((-5.0, -5.0), (-5.0, 29.0), (5.0, 29.0), (5.0, 13.0), (-3.8, 13.0), (-3.8, 11.0), (5.0, 11.0), (5.0, -5.0))
    obstacles, area = fence((bay,))
    navigator = navigated(obstacles, area, np.array([0.0, 9.0, -5.0]), leg((0, 0, -5.0), (0, 24.0, -5.0)), seconds=3.0)
    reason = navigator.hold_up.blocked(3.0 + navigator.settings.give_up)
    assert navigator.detours == 0
    assert "blocked by the fence (boundary edge 6); the narrowest gap is 1.20 m wide at -4.4 m north" in reason
    assert reason.endswith("3.57 m are needed")


def test_gap_outside_the_area_is_none():
    """Between the two parts of a fence there is a way only where nothing may fly."""
    apart = tuple((north, east + 20.0) for north, east in WEST)
    obstacles, area = fence((WEST, apart))
    bodies, names = [(shape, place) for _, shape, place in obstacles], [name for name, _, _ in obstacles]
    start, goal = np.array([0.0, 0.0, -5.0]), np.array([0.0, 20.0, -5.0])
    altitudes = {"lowest": 0.5, "highest": 12.0}
    assert detour_among(bodies, start, goal, FORMATION, MARGIN, area=area, **altitudes).waypoints is None
    gap = gap_among(bodies, start, goal, FORMATION, MARGIN, area=area, names=names, **altitudes)
    assert gap is not None and gap.width == 0.0 and gap.names[0].startswith("the fence")
    outside = detour_among(bodies, start, [0.0, 14.5, -5.0], FORMATION, 0.0, area=area, **altitudes)
    assert "outside the fence" in outside.reason


def test_area_that_nothing_comes_near_leaves_detours_as_they_are():
    pole = excluded_polygon("block", ((-3.0, 8.0), (-3.0, 9.0), (3.0, 9.0), (3.0, 8.0))).obstacles[0]
    obstacle = (pole.name, pole.shape, np.array(pole.position))
    around = tuple((3.0 * north, 3.0 * east) for north, east in SQUARE)
    walls, area = fence((around,), tuple((north + 30.0, east) for north, east in PENTAGON))
    here, mission = np.array([0.0, 5.0, -5.0]), leg((0.0, 0.0, -5.0), (0.0, 20.0, -5.0))
    within, everywhere = (navigated([obstacle, *walls], each, here, mission) for each in (area, None))
    assert within.detours and within.mission_progress(0.0) == everywhere.mission_progress(0.0)
    times = np.linspace(0.0, 30.0, 300)
    paths = [navigator.followed(mission).derivatives(times) for navigator in (within, everywhere)]
    assert (paths[0] == paths[1]).all()


@pytest.mark.parametrize("beyond", [0.05, 0.2, 0.5, 1.0])
def test_team_without_set_points_comes_to_rest_inside_the_area(beyond):
    state = np.array([[0.0, 0.0, -5.0], [2.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    edge = path_of(Braking(), state)(Braking().duration(state[1]))[0] - beyond
    obstacles, area = fence((((-9.0, -9.0), (-9.0, 9.0), (edge, 9.0), (edge, -9.0)),))
    chosen = RestingPlace(read_system().parameters(), StandingObstacles(obstacles), area=area)(0.0, state)
    assert area.contains(path_of(chosen, state)(chosen.duration(state[1]))[None])[0]


@pytest.mark.parametrize("edge", [-4.0, -1.5], ids=["along", "over"])
def test_circle_along_and_over_an_edge_is_flown_inside(edge):
    obstacles, area = fence((((edge, -5.0), (edge, 17.0), (12.0, 17.0), (12.0, -5.0)),))
    walls = [(name, shape, lambda t, place=place: np.tile(place, (len(t), 1)), 0.0) for name, shape, place in obstacles]
    legs = [Leg(np.array([2.0, 3.0, -5.0]), 1.5), Circle([0.0, 6.0, -5.0], 3.0, 1.0, 1.0), Leg([3.0, 0.0, -5.0], 1.5)]
    mission = WaypointTrajectory([3.0, 0.0, -5.0], legs, Limits(1.5, 1.5, 2.0, 6.0))
    flown = fly(avoidance(walls, margin=MARGIN, area=area), mission, 90.0)
    assert math.isfinite(flown.ends_at), flown.avoidance.guidance.navigator.hold_up.reason
    assert area.contains(flown.path[0]).all()
    assert min(flown.clearance(every=10).values()) > 0.4
    assert flown.path[0, -1] == pytest.approx([3.0, 0.0, -5.0], abs=0.1)


def test_fence_of_a_run_has_the_walls_of_every_ring():
    run = SimpleNamespace(manifest={"mission": {"boundary": [list(map(list, SQUARE))]}}, time=np.zeros(3))
    tracks = RunData.fence.func(run)
    assert [track.name for track in tracks] == [wall.name for wall in boundary_walls((SQUARE,))]
    assert all(track.position.shape == (3, 3) for track in tracks)
