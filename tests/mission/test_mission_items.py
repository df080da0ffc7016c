"""Waypoint files and plans: what is flown."""

import json
from pathlib import Path
from typing import Any

import pytest
from mission_files import HOME, MISSIONS, RETURN, TAKE_OFF, A, B, legs, north, plan, read, row, shape, wpl

from gcs.mission.route import Circle, FlyTo, HoldForever


def test_plain_mission(tmp_path: Path) -> None:
    mission = read(tmp_path, wpl(TAKE_OFF, row(16, 3, north=10.0), RETURN))
    assert shape(mission) == [
        ("TakeOff", 0.0, 0.0, -5.0, 0.0),
        ("FlyTo", 10.0, 0.0, -5.0, 3.0, 1.5),
        ("FlyTo", 0.0, 0.0, -5.0, 0.0, 1.5),
        ("Land", 0.0, 0.0, -0.3),
    ]
    assert legs(mission)[1].source == "line 4: row 2 (NAV_WAYPOINT)"
    assert (mission.home.latitude, mission.home.longitude, mission.home.altitude) == HOME
    assert mission.name == "mission"
    assert mission.notes == ()


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.replace("\t", " "),
        lambda text: text.replace("\t", "   \t "),
        lambda text: text.replace("\n", "\r\n"),
        lambda text: "\ufeff" + text,
        lambda text: text.rstrip("\n"),
        lambda text: text + "\n\n",
        lambda text: "# planned by hand\n\n" + text.replace("\n2\t", "\n  # the corner\n2\t"),
        lambda text: text.replace("\t1\n2", "\t1 # up\n2"),
        lambda text: text.replace("QGC WPL 110", "QGC  WPL\t110  "),
    ],
    ids=["spaces", "mixed", "CRLF", "BOM", "no last newline", "blank lines", "comments", "inline comment", "header"],
)
def test_variants_of_wpl_text_are_read_alike(tmp_path: Path, change: Any) -> None:
    text = wpl(TAKE_OFF, A, RETURN)
    assert shape(read(tmp_path, change(text))) == shape(read(tmp_path, text))


def test_wpl_and_plan_formats_agree(tmp_path: Path) -> None:
    rows = [
        TAKE_OFF,
        row(178, 1, 2.5, -1, alt=0),
        row(16, 2, north=10.0),
        row(18, 2, 0, -8, north=20.0),
        row(177, 3, 1),
        RETURN,
    ]
    from_wpl, from_plan = read(tmp_path, wpl(*rows)), read(tmp_path, plan(*rows))
    assert shape(from_wpl) == shape(from_plan)
    assert len(shape(from_wpl)) == 9
    (tmp_path / "route.plan").write_text(json.dumps(plan(*rows)))
    (tmp_path / "system.toml").write_text((MISSIONS / "system.toml").read_text())
    toml = '[mission]\nname = "x"\nsystem = "system.toml"\n[reference]\nkind = "waypoints"\nfile = "route.plan"\n'
    assert shape(read(tmp_path, toml, "mission.toml")) == shape(from_plan)


@pytest.mark.parametrize("name", ["mission.waypoints", "mission.txt", "mission.plan", "mission", "mission.toml"])
def test_format_is_detected_by_content(tmp_path: Path, name: str) -> None:
    assert len(legs(read(tmp_path, wpl(TAKE_OFF, A, RETURN), name))) == 4
    assert len(legs(read(tmp_path, json.dumps(plan(TAKE_OFF, A, RETURN)), name))) == 4


@pytest.mark.parametrize(("frame", "alt"), [(0, 495.0), (5, 495.0), (3, 7.0), (6, 7.0), (10, 7.0), (11, 7.0)])
def test_coordinate_frames_are_converted(tmp_path: Path, frame: int, alt: float) -> None:
    mission = read(tmp_path, wpl(TAKE_OFF, row(16, north=10.0, alt=alt, frame=frame), RETURN))
    assert shape(mission)[1][3] == -7.0


def test_unset_coordinates_are_the_current_position(tmp_path: Path) -> None:
    document = plan(TAKE_OFF, A, row(19, 4, alt=0), row(16, alt=8), RETURN)
    document["mission"]["items"][2]["params"] = [4, None, None, None, None, None, None]
    mission = read(tmp_path, document)
    assert shape(mission)[2:4] == [("FlyTo", 10.0, 0.0, -5.0, 4.0, 1.5), ("FlyTo", 10.0, 0.0, -8.0, 0.0, 1.5)]
    nan = wpl(TAKE_OFF, A, (3, 19, 4, "nan", "NaN", "nan", "nan", "nan", "nan"), row(16, alt=8), RETURN)
    assert shape(read(tmp_path, nan)) == shape(mission)


def test_take_off_flies_to_its_place_and_lands_at_the_landing_waypoint(tmp_path: Path) -> None:
    mission = read(tmp_path, wpl(row(22, north=4.0), row(21, north=9.0, alt=0)))
    assert [s[:4] for s in shape(mission)] == [
        ("TakeOff", 0.0, 0.0, -5.0), ("FlyTo", 4.0, 0.0, -5.0), ("FlyTo", 9.0, 0.0, -5.0), ("Land", 9.0, 0.0, -0.3),
    ]  # fmt: skip


def test_take_off_and_landing_are_added_when_missing(tmp_path: Path) -> None:
    mission = read(tmp_path, wpl(A))
    assert [s[:4] for s in shape(mission)] == [
        ("TakeOff", 0.0, 0.0, -5.0), ("FlyTo", 10.0, 0.0, -5.0), ("FlyTo", 0.0, 0.0, -5.0), ("Land", 0.0, 0.0, -0.3),
    ]  # fmt: skip
    assert any("no take-off before it" in note for note in mission.notes)
    assert any("no landing in the file" in note for note in mission.notes)


def test_loiter_unlimited_ends_the_flight(tmp_path: Path) -> None:
    mission = read(tmp_path, wpl(TAKE_OFF, row(17, north=10.0), B))
    assert isinstance(legs(mission)[-1], HoldForever)
    assert any("row 3" in note and "never reached" in note for note in mission.notes)


@pytest.mark.parametrize(("radius", "clockwise"), [(8.0, True), (-8.0, False)])
def test_loiter_turns(tmp_path: Path, radius: float, clockwise: bool) -> None:
    mission = read(tmp_path, wpl(TAKE_OFF, row(18, 2.25, 0, radius, north=20.0), RETURN))
    entry, circle, back = legs(mission)[1:4]
    assert isinstance(entry, FlyTo) and isinstance(circle, Circle) and isinstance(back, FlyTo)
    assert entry.position == pytest.approx((12.0, 0.0, -5.0), abs=0.05)
    assert (circle.turns, circle.radius, circle.clockwise) == (2.25, 8.0, clockwise)
    # From south of the centre a clockwise quarter leads west.
    assert circle.end(entry.position) == pytest.approx((20.0, -8.0 if clockwise else 8.0, -5.0), abs=0.05)


def test_delays(tmp_path: Path) -> None:
    mission = read(tmp_path, wpl(row(93, 4), TAKE_OFF, row(93, 2, alt=0), row(112, 1, alt=0), RETURN))
    assert shape(mission)[0] == ("TakeOff", 0.0, 0.0, -5.0, 4.0)
    assert [s[4] for s in shape(mission)[1:3]] == [2.0, 1.0]


def test_speed(tmp_path: Path) -> None:
    fast, default = row(178, 1, 9, -1), row(178, 1, -2, -1)
    mission = read(tmp_path, wpl(TAKE_OFF, row(178, 0, 2), A, row(178, 1, -1), B, fast, A, default, B, RETURN))
    assert [leg.speed for leg in legs(mission) if isinstance(leg, FlyTo)][:4] == [2.0, 2.0, 3.0, 1.5]
    assert any("9 m/s capped to speed_max, 3 m/s" in note for note in mission.notes)


def test_spline_and_gate_are_flown_through(tmp_path: Path) -> None:
    mission = read(tmp_path, wpl(TAKE_OFF, row(82, north=10.0), row(4501, north=20.0), RETURN))
    assert north(mission) == [10, 20, 0]
    assert [leg.spline for leg in legs(mission) if isinstance(leg, FlyTo)] == [True, False, False]


@pytest.mark.parametrize("command", [80, 181, 183, 189, 195, 197, 200, 201, 203, 205, 206, 530, 1000, 2000, 2500])
def test_device_commands_are_listed_as_unsupported(tmp_path: Path, command: int) -> None:
    mission = read(tmp_path, wpl(TAKE_OFF, row(command, 1, frame=2, alt=0), A, RETURN))
    assert shape(mission) == shape(read(tmp_path, wpl(TAKE_OFF, A, RETURN)))
    assert [note for note in mission.notes if "row 2" in note and "left out" in note]


@pytest.mark.parametrize("command", [16, 17, 21], ids=["waypoint", "loiter", "land"])
def test_heading_is_noted(tmp_path: Path, command: int) -> None:
    mission = read(tmp_path, wpl(TAKE_OFF, A, row(command, 0, 0, 0, 90, north=9, alt=0 if command == 21 else 5)))
    assert [note for note in mission.notes if "row 3" in note and "heading 90 deg left out" in note]


@pytest.mark.parametrize(("kind", "direction"), [(2, "climb"), (3, "descent")])
def test_speed_across_the_plane_is_left_out_with_its_direction(tmp_path: Path, kind: int, direction: str) -> None:
    mission = read(tmp_path, wpl(TAKE_OFF, row(178, kind, 2.0), A, RETURN))
    assert shape(mission) == shape(read(tmp_path, wpl(TAKE_OFF, A, RETURN)))
    assert [note for note in mission.notes if f"{direction} speed left out" in note]


@pytest.mark.parametrize(("speed", "flown"), [(3.0, 3.0), (3.01, 3.0), (0.01, 0.01), (-1.0, 1.5), (-2.0, 1.5)])
def test_speed_is_flown_up_to_the_largest_and_special_values_are_none(
    tmp_path: Path, speed: float, flown: float
) -> None:
    mission = read(tmp_path, wpl(TAKE_OFF, row(178, 1, speed), A, RETURN))
    assert next(leg.speed for leg in legs(mission) if isinstance(leg, FlyTo)) == flown
    assert any("capped" in note for note in mission.notes) == (speed > 3.0)


@pytest.mark.parametrize(
    ("frame", "altitude", "noted"),
    [
        (3, 0.0, False),
        (3, 0.5, False),
        (3, 0.51, True),
        (3, -0.5, False),
        (3, -0.51, True),
        (3, -7.0, True),
        (0, HOME[2], False),
        (0, HOME[2] + 0.51, True),
        (0, 0.0, False),  # not given
    ],
)
def test_payload_lands_on_the_ground_whatever_small_altitude_is_given(
    tmp_path: Path, frame: int, altitude: float, noted: bool
) -> None:
    land = row(21, north=9.0, alt=altitude, frame=frame)
    mission = read(tmp_path, wpl(TAKE_OFF, A, land))
    assert shape(mission) == shape(read(tmp_path, wpl(TAKE_OFF, A, row(21, north=9.0, alt=0.0))))
    assert any("the payload lands on it" in note for note in mission.notes) == noted
