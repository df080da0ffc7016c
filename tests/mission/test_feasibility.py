"""Feasibility of a mission: places that are not free, legs without a way, and what is led round."""

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

from gcs.app.cli import main
from gcs.campaign.scenarios.generator import KINDS, generate
from gcs.errors import UnusableInput
from gcs.flight.feasibility import preflight
from gcs.mission.read import read_mission

MISSION = """
[mission]
name = "feasibility"

[reference]
kind = "waypoints"
points = {points}
speed = 1.0
return_home = {back}
"""
POLE = """
[[obstacle]]
name = "mast"
shape = "pole"
position = [{north}, {east}]
radius = 0.3
height = 20.0
known = {known}
"""
WALL = """
[[obstacle]]
name = "wall {yaw:g} {north:g} {east:g}"
shape = "wall"
position = [{north}, {east}, -15.0]
size = [{length}, 0.2, 30.0]
yaw_deg = {yaw}
"""


def pole(north, east, known=True):
    return POLE.format(north=north, east=east, known=str(known).lower())


def wall(north, east, yaw, length=8.0):
    return WALL.format(north=north, east=east, yaw=yaw, length=length)


ROOM = wall(8, 4, 0) + wall(8, -4, 0) + wall(4, 0, 90) + wall(12, 0, 90)
"""Walls 8 m long and 30 m high round (8, 0)."""


def checked(folder, obstacles, points="[[0.0, 0.0, -4.0], [8.0, 0.0, -4.0]]", back="false"):
    path = folder / "mission.toml"
    path.write_text(MISSION.format(points=points, back=back) + obstacles)
    return preflight(read_mission(path))


@pytest.mark.parametrize(
    ("obstacles", "reason"),
    [
        (pole(0.2, 0.1), "pad: mast reaches 0.90 m into the formation there"),
        (
            pole(8.0, 0.5),
            "point 2: the waypoint at 8.0 m north, 0.0 m east, 4.0 m high cannot be reached: mast reaches",
        ),
        (ROOM, "point 2: there is no way from the pad to the waypoint: it is blocked by wall 90 4 0"),
    ],
    ids=["pad", "waypoint", "leg"],
)
def test_what_cannot_be_flown_is_refused_with_its_place(tmp_path, obstacles, reason):
    with pytest.raises(UnusableInput) as refused:
        checked(tmp_path, obstacles)
    assert f"mission.toml: {reason}" in refused.value.reasons[0]


def test_missing_metres_are_those_for_the_margin(tmp_path):
    with pytest.raises(UnusableInput, match=r"reaches 0\.60 m into the formation there, 1\.10 m are missing"):
        checked(tmp_path, pole(8.0, 0.5))


def test_obstacle_that_is_not_on_the_map_is_not_looked_at(tmp_path):
    found = checked(tmp_path, pole(0.2, 0.1, known=False) + pole(4.0, 0.0, known=False).replace("mast", "mast 2"))
    assert (found.ways, found.notes) == ([], [])


def test_what_is_led_round_is_a_note_with_the_length_of_the_way(tmp_path):
    (way,) = checked(tmp_path, pole(4.0, 0.5)).ways
    led = "point 2: mast is in the way: the safety filter or a detour leads round it, (.*) m in place of 8.0 m"
    assert 8.05 < float(re.fullmatch(led, way)[1]) < 9.0


def test_way_back_is_looked_at_too(tmp_path):
    ways = checked(tmp_path, pole(4.0, 0.5), back="true").ways
    assert [way.split(":")[0] for way in ways] == ["point 2", "end of mission"]


@pytest.mark.parametrize(("gap", "passes"), [(2.6, True), (1.2, False)])
def test_gap_is_passed_where_the_formation_fits(tmp_path, gap, passes):
    side = 60.0
    middle = gap / 2.0 + side / 2.0
    walls = wall(4, middle, 90, side) + wall(4, -middle, 90, side)
    if passes:
        assert checked(tmp_path, walls).notes == []
    else:
        with pytest.raises(UnusableInput, match="there is no way from the pad to the waypoint"):
            checked(tmp_path, walls)


def test_near_waypoint_that_may_be_missed_is_a_note(tmp_path):
    found = checked(tmp_path, pole(8.0, 1.2))
    assert [note.split(":")[0] for note in found.notes] == ["point 2", "end of mission"]  # the waypoint, the landing
    assert all("mast is 0.10 m from the formation there, 0.40 m are missing" in note for note in found.notes)


def test_curve_past_an_obstacle_is_a_note(tmp_path):
    found = preflight(read_mission("missions/figure_eight_spheres.toml"))
    assert found.notes == ["the curve: static is in the way: the safety filter or a detour leads round it"]


MISSIONS = [
    path
    for path in sorted(Path("missions").iterdir())
    if path.suffix in (".plan", ".waypoints") or (path.suffix == ".toml" and "\n[mission]" in path.read_text())
]


@pytest.mark.parametrize("mission", MISSIONS, ids=lambda path: path.name)
def test_every_mission_of_the_repository_is_accepted(mission):
    preflight(read_mission(mission))


@pytest.mark.slow
@pytest.mark.parametrize("number", [*range(10), *(pytest.param(n, marks=pytest.mark.long) for n in range(10, 200))])
def test_course_is_refused_where_it_cannot_be_passed_alone(tmp_path, number):
    scenario = generate(3601, number, KINDS[number % len(KINDS)])
    path = tmp_path / "course.toml"
    path.write_text(scenario.text)
    mission = read_mission(path)
    known = replace(mission, obstacles=tuple(replace(obstacle, known=True) for obstacle in mission.obstacles))
    if scenario.passage is not None and scenario.passage.verdict == "impassable":
        with pytest.raises(UnusableInput, match="there is no way from"):
            preflight(known)
    else:
        preflight(known)


@pytest.mark.parametrize(
    ("points", "note"),
    [
        ("[[0.0, 0.0, -5000.0]]", "point 1: 5000 m above home: most rules let fly up to 120 m"),
        ("[[0.0, 0.0, -5.0], [900.0, 0.0, -5.0]]", "point 2: 900 m from home: beyond about 500 m it is out of sight"),
        ("[[47.39774, 8.54559, -5.0], [47.39776, 8.54561, -5.0]]", "all waypoints lie within 1 cm of each other"),
        ("[[47.0, 8.0, -5.0], [47.0, 9.0, -5.0]]", None),
        ("[[0.0, 0.0, -120.0], [499.0, 0.0, -5.0]]", None),
    ],
    ids=["altitude", "distance", "degrees", "far but apart", "limits"],
)
def test_what_no_team_flies_is_a_note(tmp_path, points, note):
    notes = checked(tmp_path, "", points).notes
    assert [text[: len(note or "")] for text in notes[:1]] == ([] if note is None else [note])


def test_long_hold_is_a_note(tmp_path):
    path = tmp_path / "mission.toml"
    path.write_text(MISSION.format(points="[[0.0, 0.0, -4.0]]", back="true") + "hold = 1e12\n")
    (note,) = preflight(read_mission(path)).notes
    assert note.endswith("a charge lasts less than 30 min with a load")


@pytest.fixture
def printed(capsys):
    def run(*arguments):
        status = main(["check", *map(str, arguments)])
        return status, capsys.readouterr().out

    return run


def test_json_has_legs_notes_and_reasons(tmp_path, printed):
    status, out = printed("missions/fenced_delivery.plan", "--json")
    found = json.loads(out)
    assert (status, found["accepted"], found["reasons"], found["end"]) == (0, True, [], "landing")
    assert [leg["action"] for leg in found["legs"]] == ["take off", "fly to", "fly to", "fly to, hold 3 s", "land"]
    assert found["legs"][1] | {"time": 0} == {
        "number": 2, "action": "fly to", "north": pytest.approx(24.0, abs=0.01), "east": pytest.approx(0.0, abs=0.01),
        "altitude": 5.0, "speed": 1.5, "length": pytest.approx(24.0, abs=0.01), "time": 0,
        "source": "item 3 (NAV_WAYPOINT)",
    }  # fmt: skip
    assert len(found["notes"]) == 2 and found["length_m"] == pytest.approx(67.5, abs=0.5)
    (tmp_path / "wrong.toml").write_text("[mission]\n")
    status, out = printed(tmp_path / "wrong.toml", "--json")
    assert status == 2 and not json.loads(out)["accepted"] and json.loads(out)["reasons"]


def test_nothing_is_cut_at_80_columns(monkeypatch, printed):
    monkeypatch.setenv("COLUMNS", "80")
    status, out = printed("missions/fenced_delivery.plan")
    assert status == 0 and "\N{HORIZONTAL ELLIPSIS}" not in out
    assert max(map(len, out.splitlines())) <= 80
    for command in ("NAV_TAKEOFF", "NAV_WAYPOINT", "NAV_LOITER_TIME", "NAV_LAND"):
        assert command in out
