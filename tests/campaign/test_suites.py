"""Other people's scenarios: tests of Aerialist, lists in JSON lines, missions; what becomes of them, or why not."""

import json
import math

import numpy as np
import pytest

from gcs.campaign.engine import Campaign
from gcs.campaign.suites.plans import Suite, read_suite
from gcs.config import UnusableFile
from gcs.mission.read import read_mission
from idc_controller.geometry.shapes import Pole, Wall

HOME = (47.397738, 8.5455957)
NORTH, EAST = 111_180.0, 75_360.0
"""Metres for a degree there."""
TEST = """\
robot:
  port: ros # a comment
  params_file: tests/params.csv
  mission_file: tests/mission.plan
simulation:
  simulator: ros
  headless: true
  obstacles:
  - size:
      l: 4
      w: 10.5
      h: 18
    position:
      x: 12.5
      y: 20
      z: 0
      r: 30
  - shape: cylinder
    size: {l: 0, w: 0, h: 12, r: 0.5}
    position: {x: -3, y: 35.5}
mission:
  commands_file: tests/commands.csv
agent:
  engine: local
"""


def item(number, command, north, east, altitude):
    place = [HOME[0] + north / NORTH, HOME[1] + east / EAST, altitude]
    return {
        "type": "SimpleItem", "autoContinue": True, "command": command, "doJumpId": number, "frame": 3,
        "params": [0, 0, 0, None, *place],
    }  # fmt: skip


def plan_text(*items):
    items = items or (item(1, 22, 0.0, 0.0, 10), item(2, 21, 0.0, 53.0, 0))
    mission = {
        "cruiseSpeed": 15, "firmwareType": 12, "hoverSpeed": 5, "items": list(items), "vehicleType": 2, "version": 2,
        "plannedHomePosition": [*HOME, 488.0],
    }  # fmt: skip
    return json.dumps({"fileType": "Plan", "groundStation": "QGroundControl", "mission": mission, "version": 1})


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests" / "mission.plan").write_text(plan_text())
    return tmp_path


def test_file(folder, text=TEST, name="tests/case.yaml"):
    (folder / name).write_text(text)
    return folder / name


test_file.__test__ = False


def suite(*files, speed=2.5):
    return read_suite(files, None, speed, 7)


def mission_of(course, folder):
    for name, text in course.files.items():
        (folder / name).write_text(text)
    (folder / "mission.toml").write_text(course.text)
    return read_mission(folder / "mission.toml")


def refused(*files):
    with pytest.raises(UnusableFile) as error:
        suite(*files)
    return error.value.reasons


# Aerialist


def test_aerialist_test_becomes_a_mission_with_its_boxes_unknown(folder):
    [course] = suite(test_file(folder))
    mission = mission_of(course, folder)
    assert (course.name, course.kind, mission.seed, mission.reference.speed) == ("case", "aerialist", 7, 2.5)
    box, cylinder = mission.obstacles
    assert not box.known and not cylinder.known and mission.limits.clearance == 0.3
    # x north, y east, from the middle of the box; r from x towards y; the base on the ground.
    assert box.shape == Wall((4.0, 10.5, 18.0), pytest.approx(math.radians(30.0)))
    assert box.position == (12.5, 20.0, -9.0)
    assert cylinder.shape == Pole(0.5, 12.0) and cylinder.position == (-3.0, 35.5, -6.0)
    goal = list(mission.reference.legs())[-1].position
    assert goal[:2] == pytest.approx((0.0, 53.0), abs=0.2)
    assert course.passage.verdict == "passable"


def test_corner_of_a_turned_box_is_where_its_generator_draws_it(folder):
    """The competition turns a rectangle about its middle anticlockwise in a plane of x to the right and y up."""
    [course] = suite(test_file(folder))
    box = mission_of(course, folder).obstacles[0]
    turn = math.radians(30.0)
    corner = np.array([12.5 + 2.0 * math.cos(turn) - 5.25 * math.sin(turn),
                       20.0 + 2.0 * math.sin(turn) + 5.25 * math.cos(turn)])  # fmt: skip
    outline = box.shape.plan_view.outline() + np.array(box.position[:2])
    assert np.linalg.norm(outline - corner, axis=1).min() < 1e-6


def test_flat_list_of_numbers_and_names_of_earlier_versions_are_read(folder):
    text = """\
drone: {mission_file: mission.plan}
simulation:
  obstacles: [5, 6, 7,  10, 25, 1, 45,   2, 2, 20,  30, 5, 0, 0]
test: {speed: 1}
"""
    [course] = suite(test_file(folder, text))
    low, high = mission_of(course, folder).obstacles
    assert low.shape.size == (5.0, 6.0, 7.0) and low.position == (10.0, 25.0, -4.5)  # its base is 1 m up
    assert low.shape.yaw == pytest.approx(math.radians(45.0))
    assert high.position == (30.0, 5.0, -10.0)


def test_obstacles_are_placed_from_the_home_of_the_simulation_if_given(folder):
    home = f"  home_position: [{HOME[0] + 10.0 / NORTH}, {HOME[1] - 5.0 / EAST}, 488]\n"
    text = TEST.replace("  headless: true\n", home)
    box = mission_of(suite(test_file(folder, text))[0], folder).obstacles[0]
    assert box.position[:2] == pytest.approx((22.5, 15.0), abs=0.05)


def test_case_study_without_obstacles_is_read(folder):
    [course] = suite(test_file(folder, "robot: {mission_file: mission.plan}\nsimulation: {speed: 1}\n"))
    assert mission_of(course, folder).obstacles == () and course.passage.gap is None


@pytest.mark.parametrize("place", ["tests/mission.plan", "mission.plan", "somewhere/else/mission.plan"])
def test_plan_is_found_from_a_folder_above_or_beside_the_test(folder, place):
    [course] = suite(test_file(folder, TEST.replace("tests/mission.plan", place)))
    assert mission_of(course, folder).reference.speed == 2.5


@pytest.mark.parametrize(
    ("old", "new", "line", "reason"),
    [
        ("l: 4", "l: four", 10, 'simulation.obstacles[1].size.l: must be a valid number, found "four"'),
        ("h: 18", "h: 0", 12, "simulation.obstacles[1].size.h: must be greater than 0"),
        ("h: 18", "h: .inf", 12, "simulation.obstacles[1].size.h: "),
        ("x: 12.5", "x: 1.0e+6", 14, "simulation.obstacles[1].position.x: must be less than or equal to 10000"),
        ("      y: 20\n", "", 13, "simulation.obstacles[1].position.y: missing key"),
        ("y: 20", "east: 20", 15, "simulation.obstacles[1].position.east: unknown key"),
        ("l: 4", "l: 0", 9, "simulation.obstacles[1]: size: l and w of a box must be above 0 m"),
        ("r: 0.5", "r: 0", 18, "simulation.obstacles[2]: size.r: the radius of a cylinder"),
        ("shape: cylinder", "shape: cone", 18, "simulation.obstacles[2].shape: must be 'box' or 'cylinder'"),
        ("y: 35.5}", "y: 35.5, z: 2}", 18, "a cylinder stands on the ground, found 2 m"),
        ("tests/mission.plan", "tests/other.plan", 4, "robot.mission_file: there is no file tests/other.plan"),
        ("  mission_file: tests/mission.plan\n", "", 1, "robot.mission_file: missing key"),
        ("x: 12.5\n      y: 20", "x: 1\n      y: 2", 9, "from the team on its pad (limit 0.1 m)"),
        ("headless: true", "home_position: [47.4]", 7, "simulation.home_position"),
        ("headless: true", "home_position: [12.0, 8.0, 3.0]", 7, "km from home"),
        ("simulation:\n", "simulation: [\n", 7, "not valid YAML"),
        ("port: ros", "port: *ros", 2, "aliases (*) are not supported"),
        ("port: ros", "port: !!python/object:os.system ros", 2, "not valid YAML"),
        ("headless: true", "simulator: gazebo", 7, "simulation.simulator: appears twice"),
    ],
)
def test_unusable_test_is_refused_with_line_field_and_reason(folder, old, new, line, reason):
    assert old in TEST
    path = test_file(folder, TEST.replace(old, new, 1))
    reasons = refused(path)
    assert any(each.startswith(f"{path}: line {line}: ") and reason in each for each in reasons), reasons
    assert all("\n" not in each for each in reasons)


@pytest.mark.parametrize(
    "text", ["- 1\n- 2\n", "robot: 3\n", "just words\n", "simulation: {obstacles: 5}\n", "{}\n", ""]
)
def test_file_of_something_else_is_refused(folder, text):
    assert refused(test_file(folder, text))


def test_flat_list_of_another_length_is_refused(folder):
    text = "robot: {mission_file: mission.plan}\nsimulation:\n  obstacles: [1, 2, 3, 4, 5, 6]\n"
    [reason] = refused(test_file(folder, text))
    assert "line 3: simulation.obstacles: 6 numbers: l, w, h, x, y, z, r of each obstacle are 7" in reason


def test_plan_that_cannot_be_flown_is_named_with_its_item(folder):
    (folder / "tests" / "mission.plan").write_text(plan_text(item(1, 22, 0.0, 0.0, 10), item(2, 9999, 0.0, 5.0, 1)))
    assert any("mission.plan: item 2" in reason for reason in refused(test_file(folder)))


def test_small_file_of_many_aliases_is_refused_at_once(folder):
    rows = [
        "a0: &a0 [x, x, x, x, x, x, x, x]",
        *(f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 8)}]" for i in range(1, 30)),
    ]
    assert "aliases" in refused(test_file(folder, "\n".join(rows)))[0]


@pytest.mark.parametrize("opening", ["[", "{b: ", "- "])
def test_deeply_nested_file_is_refused_at_once(folder, opening):
    assert "nested more than 32 levels" in refused(test_file(folder, "a:\n " + opening * 20000))[0]


# Lists in JSON lines


LINE = {
    "name": "two", "points": [[20.0, 0.0, -5.0], [20.0, 10.0, -6.0]], "speed": 1.8,
    "poles": [{"north": 10.0, "east": 0.5, "radius": 0.2, "height": 12.0}],
    "boxes": [{"north": 10.0, "east": -6.0, "length": 2.0, "width": 3.0, "height": 4.0, "bottom": 5.0, "yaw_deg": 20}],
}  # fmt: skip


def list_file(folder, *lines):
    path = folder / "list.jsonl"
    path.write_text("".join(line if isinstance(line, str) else json.dumps(line) + "\n" for line in lines))
    return path


def test_each_line_of_a_list_becomes_a_mission(tmp_path):
    courses = suite(list_file(tmp_path, LINE, "\n", {"points": [[15.0, 0.0, -4.0]]}))
    assert [course.name for course in courses] == ["two", "list-3"]
    mission = mission_of(courses[0], tmp_path)
    pole, box = mission.obstacles
    assert (mission.name, mission.seed, mission.reference.speed) == ("two", 7, 1.8)
    assert pole.shape == Pole(0.2, 12.0) and pole.position == (10.0, 0.5, -6.0) and not pole.known
    assert box.shape == Wall((2.0, 3.0, 4.0), pytest.approx(math.radians(20.0))) and box.position == (10.0, -6.0, -7.0)
    assert list(mission.reference.legs())[-1].position[:2] == (20.0, 10.0)
    assert mission_of(courses[1], tmp_path).reference.speed == 2.5


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"points": []}, "points: needs at least 1, has 0"),
        ({"points": None}, "points: must be a valid"),
        ({"points": [[1.0, 2.0, 3.0]]}, "points[1]: z = 3 m is below ground"),
        ({"points": [[1e5, 2.0, -3.0]]}, "points[1]: [100000, 2, -3] is more than 10 km from home"),
        ({"speed": -1}, "speed: must be greater than 0, found -1"),
        ({"poles": [{"north": 1.0, "east": 0.5, "radius": 0.2}]}, "poles[1].height: missing key"),
        ({"poles": [{"north": 9.0, "east": 0.5, "radius": 0.0, "height": 3.0}]}, "poles[1].radius: must be greater"),
        ({"poles": [{"north": 1.0, "east": 0.5, "radius": 0.2, "height": 9.0}]}, "poles[1]: stands 0.00 m"),
        ({"towers": []}, "towers: unknown key"),
        ({"boxes": [{"north": "x"}]}, 'boxes[1].north: must be a valid number, found "x"'),
    ],
)
def test_unusable_line_is_refused_with_its_number_field_and_reason(tmp_path, change, reason):
    path = list_file(tmp_path, LINE, LINE | change)
    reasons = refused(path)
    assert any(each.startswith(f"{path}: line 2: {reason}") for each in reasons), reasons


@pytest.mark.parametrize("line", ["{\n", "[1]\n", "NaN\n", '"text"\n', "[" * 20000, '{"points": [[NaN, 0, -3]]}\n'])
def test_line_of_something_else_is_refused(tmp_path, line):
    assert "line 1: " in refused(list_file(tmp_path, line))[0]


def test_errors_of_all_files_are_reported_together(folder):
    first = test_file(folder, TEST.replace("h: 18", "h: 0"))
    second = list_file(folder, LINE | {"speed": 0})
    reasons = refused(first, second, folder / "absent.toml")
    assert [any(str(path) in reason for reason in reasons) for path in (first, second, folder / "absent.toml")] == [
        True
    ] * 3


# Campaign and command


def test_suite_writes_missions_with_their_plans_and_flies_a_mission_as_it_is(folder):
    own = folder / "own.toml"
    own.write_text('[mission]\nname = "own"\n\n[reference]\nkind = "waypoints"\npoints = [[9.0, 0.0, -4.0]]\n')
    courses = suite(test_file(folder), list_file(folder, LINE), own)
    campaign = Campaign(Suite(courses=tuple(courses), seed=7, speed=2.5), folder / "out")
    names = [plan.mission.name for plan in campaign.plans]
    assert names == ["0001-case.toml", "0002-two.toml", "own.toml"]
    assert campaign.plans[2].mission == own
    assert [plan.labels["kind"] for plan in campaign.plans] == ["aerialist", "list", "mission"]
    for plan in campaign.plans:
        assert read_mission(plan.mission).reference.speed > 0.0
    assert len(list((folder / "out" / "missions").glob("mission-*.plan"))) == 1


def test_mission_without_end_is_refused(tmp_path):
    path = tmp_path / "loop.plan"
    around = item(3, 177, 0.0, 0.0, 0)
    around["params"] = [1, -1, 0, 0, 0, 0, 0]
    path.write_text(plan_text(item(1, 22, 0.0, 0.0, 5), item(2, 16, 9.0, 0.0, 5), around))
    assert refused(path) == (f"{path}: the mission lasts longer than 3600 s",)


def test_plan_that_has_changed_makes_another_mission(folder):
    before = suite(test_file(folder))[0].text
    (folder / "tests" / "mission.plan").write_text(plan_text(item(1, 22, 0.0, 0.0, 9), item(2, 21, 0.0, 53.0, 0)))
    assert suite(test_file(folder))[0].text != before
