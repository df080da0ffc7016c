"""Detours of the whole formation round obstacles: geometry against an independent distance library."""

import math
from itertools import pairwise

import coal
import numpy as np
import pytest
from detours import detour_among

from idc_controller.errors import TrajectoryError
from idc_controller.geometry.free_space import BoundingCylinder, FreeSpace
from idc_controller.geometry.shapes import Pole, Sphere, Wall
from idc_controller.guidance.settings import DetourSettings
from idc_controller.guidance.straightening import straightened

FORMATION = BoundingCylinder(radius=1.1, above=3.75, below=0.25)
MARGIN = 0.5
START, GOAL = (0.0, 0.0, -5.0), (20.0, 0.0, -5.0)
HIGH = 15.0  # m, of what is not to be flown over


def pole(north, east, radius=0.3, height=HIGH):
    return Pole(radius, height), (north, east, -height / 2.0)


def wall(north, east, size_x, size_y, height=HIGH, yaw=0.0):
    return Wall(size=(size_x, size_y, height), yaw=yaw), (north, east, -height / 2.0)


def sphere(*position, radius=0.5):
    return Sphere(radius), position


def detour_of(obstacles, start=START, goal=GOAL, margin=MARGIN, highest=12.0, **others):
    detour = detour_among(obstacles, start, goal, FORMATION, margin, highest=highest, **others)
    if detour.waypoints is not None:
        assert detour.reason == ""
        np.testing.assert_allclose(detour.waypoints[[0, -1]], [start, goal])
        assert clearance_by_coal(obstacles, detour.waypoints) >= margin - 2e-3
    return detour


def clearance_by_coal(obstacles, waypoints, spacing=0.05):
    """Least distance on the detour, sampled, by a library that knows nothing of closed forms."""
    cylinder = coal.Cylinder(FORMATION.radius, FORMATION.above + FORMATION.below)
    least = math.inf
    for a, b in pairwise(waypoints):
        for fraction in np.linspace(0.0, 1.0, math.ceil(np.linalg.norm(b - a) / spacing) + 1):
            centre = a + fraction * (b - a) + [0.0, 0.0, (FORMATION.below - FORMATION.above) / 2.0]
            at = coal.Transform3s(np.eye(3), centre)
            for shape, position in obstacles:
                there = coal.Transform3s(shape.rotation, np.array(position))
                result = coal.DistanceResult()
                least = min(least, coal.distance(cylinder, at, shape.geometry(), there, coal.DistanceRequest(), result))
    return least


def side(detour):
    """East of the point of the detour that is farthest from the straight path."""
    return detour.waypoints[np.argmax(np.abs(detour.waypoints[:, 1])), 1]


def test_detour_without_obstacles_is_straight():
    assert detour_of([pole(10.0, 6.0)]).waypoints.tolist() == [list(START), list(GOAL)]


def test_detour_leads_over_wide_low_wall():
    detour = detour_of([wall(10.0, 0.0, 0.3, 30.0, height=6.0)])
    assert detour.waypoints is not None
    top = -detour.waypoints[:, 2].min()
    assert 6.0 + FORMATION.below + MARGIN <= top + 1e-6 <= 7.5
    assert np.abs(detour.waypoints[:, 1]).max() < 0.1
    assert len(detour.waypoints) <= 4


def test_detour_leads_round_shorter_side_of_high_wall():
    left, right = detour_of([wall(10.0, 2.0, 0.3, 8.0)]), detour_of([wall(10.0, -2.0, 0.3, 8.0)])
    assert side(left) < -2.0 - 1.1 - MARGIN + 1e-6 and side(right) > 2.0 + 1.1 + MARGIN - 1e-6
    assert left.length == pytest.approx(right.length, rel=0.02)
    shortest = 2.0 * math.hypot(10.0, 2.0 + 1.1 + MARGIN)
    assert shortest - 0.05 < left.length < 1.03 * shortest + 0.3


def test_detour_leads_under_high_sphere_and_over_low_sphere():
    """Only the height band of the formation matters: payload's bottom to discs' top."""
    assert len(detour_of([sphere(10.0, 0.0, -5.0 - 3.75 - 0.5 - 0.51)]).waypoints) == 2
    assert len(detour_of([sphere(10.0, 0.0, -5.0 + 0.25 + 0.5 + 0.51)]).waypoints) == 2
    assert len(detour_of([sphere(10.0, 0.0, -5.0 - 3.75 - 0.5 - 0.45)]).waypoints) > 2


def test_detour_leads_through_wide_gap_of_poles():
    half = 0.3 + 1.1 + MARGIN + 0.2
    closed = wall(10.0, 3.0 - half - 6.5, 0.3, 12.0)
    detour = detour_of([pole(10.0, 3.0 - half), pole(10.0, 3.0 + half), closed])
    at_poles = np.interp(10.0, detour.waypoints[:, 0], detour.waypoints[:, 1])
    assert 3.0 - 0.21 < at_poles < 3.0 + 0.21


def test_detour_leads_round_narrow_gap_of_poles():
    half = 0.3 + 1.1 + MARGIN - 0.1
    detour = detour_of([pole(10.0, -half), pole(10.0, half)])
    assert abs(np.interp(10.0, detour.waypoints[:, 0], detour.waypoints[:, 1])) > half


def test_gap_missed_by_coarse_grid_is_found():
    """0.34 m wider than it must be, in a wall across the whole region of the search."""
    half = 1.1 + MARGIN + 0.17
    walls = [wall(10.0, 0.75 - half - 10.0, 0.3, 20.0), wall(10.0, 0.75 + half + 10.0, 0.3, 20.0)]
    settings = DetourSettings(region_max=13.0)
    detour = detour_of(walls, settings=settings)
    assert detour.waypoints is not None
    assert np.interp(10.0, detour.waypoints[:, 0], detour.waypoints[:, 1]) == pytest.approx(0.75, abs=0.17)
    narrow = [wall(10.0, 0.75 - 1.59 - 10.0, 0.3, 20.0), wall(10.0, 0.75 + 1.59 + 10.0, 0.3, 20.0)]
    assert "too narrow" in detour_of(narrow, settings=settings).reason


def test_goal_in_closed_box_is_unreachable():
    box = [wall(16.0, 0.0, 0.3, 8.0), wall(24.0, 0.0, 0.3, 8.0), wall(20.0, 4.0, 8.0, 0.3), wall(20.0, -4.0, 8.0, 0.3)]
    detour = detour_of(box)
    assert detour.waypoints is None and detour.length == math.inf
    assert detour.reason == "every path from start to goal is closed or too narrow for the formation"
    # From above it can.
    assert detour_of(box, highest=20.0).waypoints is not None


@pytest.mark.parametrize(
    ("obstacle", "others", "reason"),
    [
        (sphere(20.0, 0.5, -5.0), {}, "the formation at the goal would meet the ball"),
        (sphere(20.0, 1.9, -5.0), {}, "would be 0.30 m from the ball, less than the margin of 0.5 m"),
        (sphere(20.0, 2.2, -5.0), {"growth": [0.2]}, "would be 0.40 m from the ball"),
        (sphere(9.0, 9.0, -5.0), {"goal": (20.0, 0.0, -13.0)}, "the goal, 13.00 m high, is not within 0.5 to 12 m"),
    ],
)
def test_goal_inside_obstacle_is_unreachable(obstacle, others, reason):
    detour = detour_among([obstacle], **({"start": START, "goal": GOAL, "formation": FORMATION, "margin": MARGIN,
                                          "highest": 12.0, "names": ["the ball"]} | others))  # fmt: skip
    assert detour.waypoints is None
    assert reason in detour.reason


def test_largest_region_limits_how_far_beside_the_straight_path_is_searched():
    """The end of the wall, passed at 13.6 m, is within a region of 2 x 15 m, but not within one of 2 x 12 m."""
    wide = [wall(10.0, 0.0, 0.3, 24.0)]
    assert abs(side(detour_of(wide, settings=DetourSettings(region_max=30.0)))) > 12.0 + 1.1 + MARGIN - 1e-6
    assert detour_of(wide, settings=DetourSettings(region_max=24.0)).waypoints is None


def test_detour_keeps_altitude_limits():
    low_wall = [wall(10.0, 0.0, 0.3, 12.0, height=6.0)]
    assert -detour_of(low_wall).waypoints[:, 2].min() > 6.0
    beside = detour_of(low_wall, highest=6.5)
    assert np.allclose(beside.waypoints[:, 2].min(), -5.0, atol=1.5)
    assert -beside.waypoints[:, 2].min() <= 6.5
    assert abs(side(beside)) > 6.0


def test_distance_does_not_decrease_from_start_within_margin():
    ball = sphere(1.9, 0.0, -5.0)
    detour = detour_among([ball], START, GOAL, FORMATION, MARGIN, highest=12.0)
    assert detour.waypoints is not None
    space = FreeSpace([ball], FORMATION, MARGIN, 0.5, 12.0)
    at_start = space.clearance(np.array([START]))[0, 0]
    assert at_start == pytest.approx(0.3)
    first, rest = detour.waypoints[:2], detour.waypoints[1:]
    assert clearance_by_coal([ball], first) >= at_start - 2e-3
    assert clearance_by_coal([ball], rest) >= MARGIN - 2e-3


def test_moving_obstacle_is_grown_by_its_uncertainty():
    ball = sphere(10.0, 2.0, -5.0)
    assert len(detour_among([ball], START, GOAL, FORMATION, 0.3).waypoints) == 2
    grown = detour_among([ball], START, GOAL, FORMATION, 0.3, growth=[0.5])
    assert clearance_by_coal([ball], grown.waypoints) >= 0.8 - 2e-3


@pytest.mark.parametrize("seed", range(6))
def test_detours_of_random_scenarios_keep_margin_and_repeat(seed):
    rng = np.random.default_rng(seed)
    obstacles = []
    for i in range(12):
        north, east, height = rng.uniform([3.5, -8.0, 3.0], [16.5, 8.0, 9.0])
        kind = (sphere(north, east, -height), pole(north, east), wall(north, east, 0.3, 3.0, height, rng.uniform(0, 3)))
        obstacles.append(kind[i % 3])
    detour = detour_of(obstacles, highest=14.0)
    assert detour.waypoints is not None
    assert len(detour.waypoints) <= 9
    assert detour.length < 32.0
    again = detour_of(obstacles, highest=14.0)
    assert np.array_equal(detour.waypoints, again.waypoints)


def test_path_in_free_space_is_straightened_among_a_limited_number_of_points():
    class Open:
        """Space without obstacles; counts the segments of which it is asked at once."""

        centres, most = (), 0

        def is_free(self, places):
            return np.ones(len(places), dtype=bool)

        def are_free_segments(self, begins, ends):
            self.most = max(self.most, len(begins))
            return np.ones(len(begins), dtype=bool)

    space, number = Open(), DetourSettings().straightened
    path = np.array([[0.0, 0.0, -3.0], [6.0, 5.0, -3.0], [12.0, 0.0, -4.0], [18.0, 5.0, -5.0], [24.0, 0.0, -3.0]])
    assert straightened(space, path, DetourSettings()) == pytest.approx(path[[0, -1]])
    assert 0.7 * number**2 / 2.0 < space.most <= number * (number - 1) / 2.0


def test_path_of_which_no_shorter_part_is_free_keeps_its_corners():
    class Closed:
        """Space in which no segment is free but the path that was found."""

        centres = ()

        def is_free(self, places):
            return np.ones(len(places), dtype=bool)

        def are_free_segments(self, begins, ends):
            return np.zeros(len(begins), dtype=bool)

    path = np.array([[0.0, 0.0, -3.0], [6.0, 5.0, -3.0], [12.0, 0.0, -4.0], [18.0, 5.0, -5.0], [24.0, 0.0, -3.0]])
    found = straightened(Closed(), path, DetourSettings())
    for corner in path:
        assert np.linalg.norm(found - corner, axis=1).min() < 1e-9
    assert (np.diff(found[:, 0]) > 0.0).all()


def test_clearance_equals_that_of_collision_library():
    rng = np.random.default_rng(5)
    shapes = [Sphere(0.7), Pole(0.4, 5.0), Wall(size=(3.0, 0.5, 2.0), yaw=0.7)]
    obstacles = [(shape, rng.uniform(-3.0, 3.0, 3)) for shape in shapes]
    places = rng.uniform(-9.0, 9.0, (200, 3))
    found = FreeSpace(obstacles, FORMATION, 0.0, -100.0, 100.0).clearance(places)
    for place, row in zip(places, found, strict=True):
        for obstacle, distance in zip(obstacles, row, strict=True):
            expected = clearance_by_coal([obstacle], np.array([place, place]))
            assert (distance if distance > 0 else 0.0) == pytest.approx(max(expected, 0.0), abs=1e-3)


def test_clearance_of_rectangle_is_a_lower_bound_and_exact_beside_its_edges():
    rng = np.random.default_rng(6)
    core, rounding = (0.9, 0.4), 0.3
    formation = BoundingCylinder(math.hypot(*core) + rounding, 3.75, 0.25, core, rounding)
    box = coal.Box(2.0 * core[0], 2.0 * core[1], 4.0)
    for _ in range(60):
        shape = Wall(size=(*rng.uniform(0.2, 3.0, 2), 4.0), yaw=rng.uniform(-2.0, 2.0))
        place = np.array([*rng.uniform(-4.0, 4.0, 2), 0.0])
        found = FreeSpace([(shape, place)], formation, 0.0, -100.0, 100.0).clearance(np.zeros((1, 3)))[0, 0]
        exact = coal.distance(
            box, coal.Transform3s.Identity(), shape.geometry(), coal.Transform3s(shape.rotation, place),
            coal.DistanceRequest(), coal.DistanceResult(),
        ) - rounding  # fmt: skip
        assert found <= exact + 1e-6 or exact < 0.0
        cylinder = FreeSpace([(shape, place)], BoundingCylinder(formation.radius, 3.75, 0.25), 0.0, -100.0, 100.0)
        assert found >= cylinder.clearance(np.zeros((1, 3)))[0, 0]
    beside = FreeSpace([(Wall((0.4, 8.0, 9.0)), (3.0, 0.0, 0.0))], formation, 0.0, -100.0, 100.0)
    assert beside.clearance(np.zeros((1, 3)))[0, 0] == pytest.approx(3.0 - 0.2 - 0.9 - 0.3)


def test_detour_leads_through_gap_that_only_the_narrow_side_fits():
    """Between two walls 2.6 m apart, with 0.5 m to each: too narrow for the cylinder of 1.1 m, which goes round."""
    walls = [(Wall((8.0, 20.0, 40.0)), np.array([8.0, side * (10.0 + 1.3), -5.0])) for side in (-1.0, 1.0)]
    slim = BoundingCylinder(1.1, 3.75, 0.25, (0.6, 0.3), 0.4)
    for formation, is_straight in ((slim, True), (BoundingCylinder(1.1, 3.75, 0.25), False)):
        detour = detour_among(walls, (0.0, 0.0, -5.0), (16.0, 0.0, -5.0), formation, 0.5)
        assert (detour.length == 16.0) == is_straight


def test_formation_of_parameters(parameters):
    formation = BoundingCylinder.of(parameters)
    assert [formation.radius, formation.above, formation.below] == pytest.approx([math.sqrt(0.5) + 0.3, 3.45, 0.25])
    assert BoundingCylinder.of(parameters, 0.2).radius == pytest.approx(formation.radius + 3.2 * math.sin(0.2))


@pytest.fixture
def parameters():
    from gcs.config import read_system
    from gcs.flight.stack import linear_model

    return linear_model(read_system(None)).parameters


def test_search_refuses_invalid_arguments():
    for wrong in (
        lambda: BoundingCylinder(-1.0, 1.0, 1.0),
        lambda: detour_of([], margin=-0.1),
        lambda: detour_of([], highest=0.2),
        lambda: detour_of([], goal=(0.0, math.nan, 0.0)),
        lambda: detour_of([sphere(1.0, math.inf, 0.0)]),
    ):
        with pytest.raises(TrajectoryError):
            wrong()
