"""Scenarios of boxes, forests, rooms, overhangs, and of what stops and goes: ranges, free ends, and the way."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest
import shapely
from detours import detour_among

from gcs.campaign.flight import FlightPlan
from gcs.campaign.result import Flown
from gcs.campaign.scenarios.boxes import boxes
from gcs.campaign.scenarios.forest import APART, DENSITIES, forest
from gcs.campaign.scenarios.generator import generate
from gcs.campaign.scenarios.judgement import judge, named_gap, names_the_gap
from gcs.campaign.scenarios.moving import STOP_AND_GO_HOLDS, STOP_AND_GO_SPEEDS, displacement, top_speed
from gcs.campaign.scenarios.passage import Passage, Passages, passage_of, places_of
from gcs.campaign.scenarios.rooms import rooms
from gcs.config import read_system
from gcs.mission.motion import WaypointsMotion
from gcs.mission.read import read_mission
from gcs.planning.schedule import Schedule
from idc_controller.geometry.free_space import FreeSpace
from idc_controller.geometry.shapes import Pole, Sphere, Wall
from idc_controller.guidance.narrowest_gap import Gap

KINDS = ("boxes", "forest", "rooms", "overhang")
SYSTEM = read_system(None)
PASSAGES = Passages(SYSTEM)
SEEDS = [1, 2, *(pytest.param(number, marks=pytest.mark.long) for number in (3, 4, 5))]


@cache
def generated(seed, number, kind):
    """The scenario that several tests look at."""
    return generate(seed, number, kind)


def read(scenario, folder):
    path = folder / f"{scenario.name}.toml"
    path.write_text(scenario.text)
    return read_mission(path)


@pytest.fixture(params=SEEDS)
def number(request):
    return request.param


@pytest.fixture(params=KINDS)
def course(request, number, tmp_path):
    scenario = generated(21, number, request.param)
    return scenario, read(scenario, tmp_path)


@pytest.mark.slow
def test_generated_course_is_a_mission_of_unknown_standing_obstacles(course):
    scenario, mission = course
    assert mission.obstacles and mission.limits.clearance == 0.3
    assert all(not o.known and o.motion is None for o in mission.obstacles)
    assert generate(21, scenario.number, scenario.kind) == scenario
    assert generate(22, scenario.number, scenario.kind).text != scenario.text
    assert 1.0 <= mission.reference.speed <= 2.5


@pytest.mark.slow
def test_generated_course_leaves_pad_waypoints_and_goal_free_and_the_path_not(course):
    _, mission = course
    bodies = [(o.shape, o.position) for o in mission.obstacles]
    schedule = Schedule(mission)
    places = places_of(mission)
    columns = [[*end[:2], z] for end in (places[0], schedule.goal) for z in np.arange(schedule.goal[2], 0.0, 0.5)]
    space = FreeSpace(bodies, PASSAGES.formation, 3.0 - 1e-3, 0.0, 100.0)
    assert space.is_free(np.array([*columns, *places])).all()
    assert FreeSpace(bodies, PASSAGES.formation, 0.0, 0.0, 100.0).clearance(schedule.positions).min() < 1.05


@pytest.mark.slow
def test_generated_course_has_a_way_or_none_as_it_says(course):
    scenario, mission = course
    passage = scenario.passage
    assert passage_of(mission) == passage  # the file holds all of it
    assert passage.verdict in ("passable", "impassable")
    assert f"# For the formation {passage}." in scenario.text
    if scenario.kind in ("boxes", "overhang"):
        assert passage.verdict == "passable"
    bodies = [(o.shape, np.array(o.position)) for o in mission.obstacles]
    places = places_of(mission)
    highest = max(-p[2] for p in places) + SYSTEM.guidance.navigator.climb
    detours = [
        detour_among(bodies, a, b, PASSAGES.formation, 0.7, lowest=0.35, highest=highest).waypoints
        for a, b in pairwise(places)
    ]
    assert all(detour is not None for detour in detours) == (passage.verdict == "passable")


def test_boxes_keep_to_their_sizes_and_do_not_meet():
    counts = set()
    for seed in range(60):
        layout = boxes(np.random.default_rng(seed), PASSAGES)
        counts.add(len(layout.obstacles))
        assert 1 <= len(layout.points) <= 3 and layout.speed == 2.5
        outlines = []
        for box in layout.obstacles:
            assert isinstance(box.shape, Wall)
            length, width, height = box.shape.size
            assert 2.0 <= min(length, width) <= max(length, width) <= 20.0 and 5.0 <= height <= 25.0
            assert box.position[2] == pytest.approx(-height / 2.0, abs=1e-3)
            outlines.append(shapely.affinity.translate(box.shape.plan_view.core, *box.position[:2]))
        for i, outline in enumerate(outlines):
            assert all(outline.distance(other) > 0.4 for other in outlines[:i])
            assert outline.distance(shapely.LineString([p[:2] for p in layout.places])) <= 6.01
    assert {1, 2, 3, 4, 5} <= counts | {0}


def test_forest_has_the_stated_density_and_trunks():
    densities, crowned = [], 0
    for seed in range(25):
        layout = forest(np.random.default_rng(seed), PASSAGES)
        trunks = [o for o in layout.obstacles if isinstance(o.shape, Pole)]
        crowns = [o for o in layout.obstacles if isinstance(o.shape, Sphere)]
        crowned += bool(crowns)
        assert len(trunks) + len(crowns) == len(layout.obstacles)
        assert all(0.08 <= o.shape.radius <= 0.35 and 4.0 <= o.shape.height <= 25.0 for o in trunks)
        places = np.array([o.position[:2] for o in trunks])
        between = np.linalg.norm(places[:, None] - places, axis=2)[~np.eye(len(places), dtype=bool)]
        assert between.min() >= APART - 1e-3
        area = shapely.MultiPoint(places).minimum_rotated_rectangle.area
        densities.append(len(trunks) / area)
        stems = {tuple(o.position[:2]): o for o in trunks}
        for crown in crowns:  # on top of its trunk
            trunk = stems[tuple(crown.position[:2])]
            top = trunk.shape.height
            assert top - crown.shape.radius <= -crown.position[2] <= top + crown.shape.radius
    assert crowned > 20
    assert 0.75 * DENSITIES[0] <= min(densities) and max(densities) <= 1.25 * DENSITIES[1]  # of the bounding rectangle
    assert min(densities) < 0.07 and max(densities) > 0.1


def test_rooms_enclose_start_and_goal_and_have_corridors_dead_ends_and_closed_doors():
    verdicts, lintels = [], 0
    for seed in range(30):
        layout = rooms(np.random.default_rng(seed), PASSAGES)
        if not layout.obstacles:
            continue
        walls = [
            shapely.affinity.translate(o.shape.plan_view.core.buffer(0.01), *o.position[:2]) for o in layout.obstacles
        ]
        assert all(min(o.shape.size) <= 0.4 for o in layout.obstacles)
        tops = [-o.position[2] + o.shape.size[2] / 2.0 for o in layout.obstacles]
        assert tops == pytest.approx([18.0] * len(tops), abs=2e-3)
        lintels += sum(o.name.startswith("lintel") for o in layout.obstacles)
        outer = shapely.convex_hull(shapely.union_all(walls))
        assert all(outer.contains(shapely.Point(place[:2])) for place in layout.places)
        verdicts.append(layout.passable)
    assert 3 <= verdicts.count(False) <= 15
    assert lintels > 5


@pytest.mark.slow
def test_movers_stop_and_go_on_a_collision_course(number, tmp_path):
    mission = read(generate(21, number, "stop_and_go"), tmp_path)
    schedule = Schedule(mission)
    assert 1 <= len(mission.obstacles) <= 3
    for obstacle in mission.obstacles:
        motion = obstacle.motion
        assert isinstance(motion, WaypointsMotion) and motion.repeat and not obstacle.known
        assert STOP_AND_GO_SPEEDS[0] <= motion.speed <= STOP_AND_GO_SPEEDS[1]
        assert 2.0 <= motion.acceleration <= 5.0
        assert STOP_AND_GO_HOLDS[0] <= motion.hold <= STOP_AND_GO_HOLDS[1]
        assert 0.9 * motion.speed <= top_speed(motion) <= motion.speed + 1e-3  # it does reach its speed
        places = np.array(obstacle.position) + displacement(motion, schedule.times)
        away = np.linalg.norm((places - schedule.positions)[:, :2], axis=1)
        assert away.min() < 0.6  # the undisturbed payload, or a UAV, would meet it


# Judgement


GAP = Gap(-0.3, 1.96, (3.0, -4.0, -5.0), ("wall 1", "wall 2"))


@pytest.mark.parametrize(
    ("reason", "named", "agrees"),
    [
        (f"the path is blocked by wall 1; the narrowest gap is {GAP}, 3.97 m are needed", 1.96, True),
        ("the narrowest gap is 2.20 m wide at -3.1 m north", 2.2, True),
        ("the narrowest gap is 1.60 m high at -3.1 m north", 1.6, False),
        ("the path to the rest of the mission is blocked by wall 1", None, False),
        ("wall 1 stands at the waypoint 1.0 m north", None, False),
    ],
)
def test_gap_named_in_a_reason_is_compared_with_the_true_one(reason, named, agrees):
    assert named_gap(reason) == named
    assert names_the_gap(Passage("impassable", GAP), reason) == agrees
    assert not names_the_gap(None, reason)


def test_waypoint_in_an_obstacle_may_be_named_in_place_of_a_gap():
    passage = Passage("impassable", Gap(-1.0, 0.4, (3.0, -4.0, -5.0), ("wall 1",), is_at_waypoint=True))
    assert names_the_gap(passage, "wall 1 stands at the waypoint 3.0 m north")
    assert not names_the_gap(passage, "the path is blocked by wall 1")


@pytest.mark.parametrize(
    ("verdict", "outcome", "reason", "failures"),
    [
        ("passable", "aborted", f"the narrowest gap is {GAP}", "aborted arrival"),
        ("impassable", "aborted", f"the narrowest gap is {GAP}", ""),
        ("marginal", "aborted", f"the narrowest gap is {GAP}", ""),
        ("impassable", "aborted", "the narrowest gap is 2.80 m wide at 0.0 m north", "gap"),
        ("impassable", "aborted", "vehicle 2 was lost", "gap"),
        ("impassable", "collided", f"the narrowest gap is {GAP}", "collided contact clearance arrival"),
        ("impassable", "completed", "", "arrival"),
    ],
)
def test_impassable_course_passes_when_broken_off_with_its_narrowest_gap(tmp_path, verdict, outcome, reason, failures):
    scenario = generated(21, 1, "stop_and_go")
    mission = tmp_path / "mission.toml"
    mission.write_text(scenario.text)
    hit = outcome == "collided"
    summary = {
        "completed": outcome == "completed", "outcome": outcome, "contacts": 4 * hit, "uav_separation_min_m": 0.9,
        "clearance_min_m": 0.0 if hit else 0.5, "payload_tilt_max_deg": {"roll": 1.0},
    }  # fmt: skip
    flown = Flown(1, summary, reason, 1.0)
    plan = FlightPlan(1, "mission", mission, dict)
    columns = judge(read(scenario, tmp_path).limits, Passage(verdict, GAP), plan, flown, tmp_path / "none")
    assert columns["failures"] == failures
    assert (columns["passage"], columns["gap_m"]) == (verdict, 1.96)


def test_formation_at_its_narrowest_decides_what_is_impassable():
    for width, verdict in ((2.3, "impassable"), (3.0, "marginal"), (4.5, "passable")):
        layout = rooms_with(width)
        assert PASSAGES.between(((0.0, 0.0, -5.0), (20.0, 0.0, -5.0)), layout).verdict == verdict


def rooms_with(door):
    from gcs.mission.model import Obstacle

    edge = 8.0 - door / 2.0
    sizes = {
        (0.0, -8.0): (30.0, 0.4), (0.0, 8.0): (30.0, 0.4), (-15.0, 0.0): (0.4, 16.4),
        (10.0, -8.0 + edge / 2.0): (0.4, edge), (10.0, 8.0 - edge / 2.0): (0.4, edge),
    }  # fmt: skip
    return [
        Obstacle(f"wall {i}", (*place, -9.0), Wall((*size, 18.0)), False)
        for i, (place, size) in enumerate(sizes.items())
    ]
