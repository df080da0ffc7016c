"""Feasibility of a mission: places that are not free, legs without a way, and what is led round."""

import re

import pytest

from gcs.app.preflight import preflight
from gcs.errors import UnusableInput
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
    assert (found.ways, found.notes) == ((), ())


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
        assert checked(tmp_path, walls).notes == ()
    else:
        with pytest.raises(UnusableInput, match="there is no way from the pad to the waypoint"):
            checked(tmp_path, walls)


def test_near_waypoint_that_may_be_missed_is_a_note(tmp_path):
    found = checked(tmp_path, pole(8.0, 1.2))
    assert [note.split(":")[0] for note in found.notes] == ["point 2", "end of mission"]  # the waypoint, the landing
    assert all("mast is 0.10 m from the formation there, 0.40 m are missing" in note for note in found.notes)


def test_curve_past_an_obstacle_is_a_note(tmp_path):
    found = preflight(read_mission("missions/figure_eight_spheres.toml"))
    assert found.notes == ("the curve: static is in the way: the safety filter or a detour leads round it",)
