"""Mission files: what is flown, and what is refused with which reason."""
# ruff: noqa: E501 (the tables of cases: one case a line)

import json
import math
from itertools import islice
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

from gcs.config import UnusableFile, default_system_path
from gcs.mission import Lissajous, Mission, Pole, Route, Sphere, Wall, describe, read_mission
from gcs.mission.route import Circle, FlyTo, HoldForever, Land, Leg, TakeOff

MISSIONS = Path(__file__).parents[1] / "missions"
HOME = (47.397742, 8.545594, 488.0)
DEGREE = 111_194.0  # m of latitude, roughly

Row = tuple[float | str, ...]


def row(command: int, *params: float, frame: int = 3, north: float | None = None, alt: float = 5.0) -> Row:
    """frame, command, params: at ``north`` metres from home, or with latitude and longitude 0."""
    four = (*params, 0, 0, 0, 0)[:4]
    place = (0, 0) if north is None else (round(HOME[0] + north / DEGREE, 8), HOME[1])
    return (frame, command, *four, *place, alt)


TAKE_OFF = row(22)
A, B = row(16, north=10.0), row(16, north=20.0)
RETURN = row(20, alt=0)


def wpl(*rows: Row, home: str = f"0 16 0 0 0 0 {HOME[0]} {HOME[1]} {HOME[2]}") -> str:
    lines = ["QGC WPL 110", *(f"{i}\t0\t{r}\t1" for i, r in enumerate([home, *(" ".join(map(str, r)) for r in rows)]))]
    return "\n".join(lines).replace(" ", "\t").replace("QGC\tWPL\t", "QGC WPL ") + "\n"


def simple(r: Row, number: int) -> dict[str, Any]:
    return {
        "type": "SimpleItem", "autoContinue": True, "doJumpId": number, "frame": r[0], "command": r[1],
        "params": list(r[2:]),
    }  # fmt: skip


def plan(*rows: Row, **changes: Any) -> dict[str, Any]:
    document: dict[str, Any] = {
        "fileType": "Plan", "groundStation": "QGroundControl", "version": 1,
        "geoFence": {"circles": [], "polygons": [], "version": 2},
        "rallyPoints": {"points": [], "version": 2},
        "mission": {
            "version": 2, "items": [simple(r, i) for i, r in enumerate(rows, start=1)],
            "plannedHomePosition": list(HOME),
        },
    }  # fmt: skip
    for key, value in changes.items():
        table = document
        *path, last = key.split("__")
        for part in path:
            table = table[part]
        table[last] = value
    return document


def read(tmp_path: Path, content: str | bytes | dict[str, Any], name: str = "mission.waypoints") -> Mission:
    if isinstance(content, dict):
        content, name = json.dumps(content), "mission.plan"
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_mission(path)


def legs(mission: Mission, at_most: int = 50) -> list[Leg]:
    assert isinstance(mission.reference, Route)
    return list(islice(mission.reference.legs(), at_most))


def shape(mission: Mission, at_most: int = 50) -> list[tuple[Any, ...]]:
    """Legs without the lines they come from, rounded to the centimetre."""
    found: list[tuple[Any, ...]] = []
    for leg in legs(mission, at_most):
        place = leg.centre if isinstance(leg, Circle) else leg.position
        extra = {
            TakeOff: lambda g: (g.delay,), FlyTo: lambda g: (g.hold, g.speed), Circle: lambda g: (g.radius, g.turns, g.clockwise),
        }.get(type(leg), lambda g: ())(leg)  # fmt: skip
        found.append((type(leg).__name__, *(round(x, 2) + 0.0 for x in place), *extra))
    return found


def north(mission: Mission, at_most: int = 50) -> list[int]:
    """Metres north of home of the places flown to."""
    return [round(leg.position[0]) for leg in legs(mission, at_most) if isinstance(leg, FlyTo)]


def refusal(tmp_path: Path, content: str | bytes | dict[str, Any], name: str = "mission.waypoints") -> tuple[str, ...]:
    with pytest.raises(UnusableFile) as caught:
        read(tmp_path, content, name)
    for reason in caught.value.reasons:
        assert reason.startswith(f"{tmp_path}/mission."), reason
        assert "\n" not in reason
    return caught.value.reasons


def told(mission: Mission) -> str:
    console = Console(width=200)
    with console.capture() as capture:
        console.print(describe(mission))
    return capture.get()


# What is flown --------------------------------------------------------------------------------------------------


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
def test_writings_of_the_same_wpl(tmp_path: Path, change: Any) -> None:
    text = wpl(TAKE_OFF, A, RETURN)
    assert shape(read(tmp_path, change(text))) == shape(read(tmp_path, text))


def test_formats_agree(tmp_path: Path) -> None:
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
    (tmp_path / "system.toml").write_text(default_system_path().read_text())
    toml = '[mission]\nname = "x"\nsystem = "system.toml"\n[reference]\nkind = "waypoints"\nfile = "route.plan"\n'
    assert shape(read(tmp_path, toml, "mission.toml")) == shape(from_plan)


@pytest.mark.parametrize("name", ["mission.waypoints", "mission.txt", "mission.plan", "mission", "mission.toml"])
def test_format_by_content(tmp_path: Path, name: str) -> None:
    assert len(legs(read(tmp_path, wpl(TAKE_OFF, A, RETURN), name))) == 4
    assert len(legs(read(tmp_path, json.dumps(plan(TAKE_OFF, A, RETURN)), name))) == 4


@pytest.mark.parametrize(("frame", "alt"), [(0, 495.0), (5, 495.0), (3, 7.0), (6, 7.0), (10, 7.0), (11, 7.0)])
def test_frames(tmp_path: Path, frame: int, alt: float) -> None:
    mission = read(tmp_path, wpl(TAKE_OFF, row(16, north=10.0, alt=alt, frame=frame), RETURN))
    assert shape(mission)[1][3] == -7.0


def test_here_and_not_given(tmp_path: Path) -> None:
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


def test_no_take_off_and_no_landing_in_the_file(tmp_path: Path) -> None:
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


def test_autocontinue_off_holds(tmp_path: Path) -> None:
    text = wpl(TAKE_OFF, A, B, RETURN).replace("5.0\t1\n3", "5.0\t0\n3")
    mission = read(tmp_path, text)
    assert isinstance(legs(mission)[-1], HoldForever)
    assert any("autocontinue is off" in note for note in mission.notes)


@pytest.mark.parametrize("command", [80, 181, 183, 189, 195, 197, 200, 201, 203, 205, 206, 211, 530, 1000, 2000, 2500])
def test_devices_are_listed_as_left_out(tmp_path: Path, command: int) -> None:
    mission = read(tmp_path, wpl(TAKE_OFF, row(command, 1, frame=2, alt=0), A, RETURN))
    assert shape(mission) == shape(read(tmp_path, wpl(TAKE_OFF, A, RETURN)))
    assert [note for note in mission.notes if "row 2" in note and "left out" in note]


def test_heading_is_noted(tmp_path: Path) -> None:
    assert any(
        "heading 90 deg left out" in n for n in read(tmp_path, wpl(TAKE_OFF, row(16, 0, 0, 0, 90, north=9))).notes
    )


# Jumps ----------------------------------------------------------------------------------------------------------


def test_jump_repeats(tmp_path: Path) -> None:
    assert north(read(tmp_path, wpl(TAKE_OFF, A, B, row(177, 2, 2), RETURN))) == [10, 20, 10, 20, 10, 20, 0]


def test_jump_zero_times_is_not_taken(tmp_path: Path) -> None:
    mission = read(tmp_path, wpl(TAKE_OFF, A, B, row(177, 2, 0), RETURN))
    assert north(mission) == [10, 20, 0]
    assert any("not taken" in note for note in mission.notes)


def test_endless_jump_is_lazy(tmp_path: Path) -> None:
    mission = read(tmp_path, wpl(TAKE_OFF, A, B, row(177, 2, -1), RETURN))
    assert len(legs(mission, 10_001)) == 10_001
    assert north(mission, 6) == [10, 20, 10, 20, 10]
    assert any("row 5" in note and "never reached" in note for note in mission.notes)


def test_jump_goes_by_file_index_past_items_left_out(tmp_path: Path) -> None:
    camera = row(2000, frame=2, alt=0)
    assert north(read(tmp_path, wpl(camera, TAKE_OFF, camera, A, B, row(177, 5, 1), RETURN))) == [10, 20, 20, 0]
    # To an item that is left out: on with the next.
    assert north(read(tmp_path, wpl(TAKE_OFF, A, camera, B, row(177, 3, 1), RETURN))) == [10, 20, 20, 0]


def test_plan_jumps_by_do_jump_id(tmp_path: Path) -> None:
    document = plan(TAKE_OFF, A, B, row(177, 70, 1), RETURN)
    document["mission"]["items"][2]["doJumpId"] = 70
    assert north(read(tmp_path, document)) == [10, 20, 20, 0]


def test_jump_tags(tmp_path: Path) -> None:
    assert north(read(tmp_path, wpl(TAKE_OFF, A, row(600, 7, alt=0), B, A, row(601, 7, 2), RETURN))) == [
        10, 20, 10, 20, 10, 20, 10, 0,
    ]  # fmt: skip


def test_nested_jumps_keep_their_count(tmp_path: Path) -> None:
    mission = read(tmp_path, wpl(TAKE_OFF, A, B, row(177, 3, 1), row(177, 2, 1), RETURN))
    assert north(mission) == [10, 20, 20, 10, 20, 0]


def test_jump_forward(tmp_path: Path) -> None:
    mission = read(tmp_path, wpl(TAKE_OFF, row(177, 4, -1), A, B, RETURN))
    assert north(mission) == [20, 0]
    assert any("row 3" in note and "never reached" in note for note in mission.notes)


def test_a_lap_that_goes_nowhere_is_a_hold(tmp_path: Path) -> None:
    found = legs(read(tmp_path, wpl(TAKE_OFF, A, row(177, 2, -1))), 1000)
    assert isinstance(found[-1], HoldForever) and len(found) < 6
    assert isinstance(legs(read(tmp_path, wpl(TAKE_OFF, A, row(177, 2, 1_000_000_000))), 1000)[-1], Land)


# What is refused ------------------------------------------------------------------------------------------------

INF = (3, 16, 0, 0, 0, 0, "inf", 8.5, 5)


@pytest.mark.parametrize(
    ("content", "where", "reason"),
    [
        ("", "", "the file is empty"),
        ("\n \n", "", "the file is empty"),
        ("# nothing\n", "", "only comments"),
        ("QGC WPL 110\n", "", "home is missing"),
        ("QGC WPL 120\n0 1 0 16\n", "line 1", "version 120 is not supported"),
        ("QGC WPL\n0 1 0 16\n", "line 1", "expected 'QGC WPL 110'"),
        ("QGC PARAM 110\n", "line 1", "expected 'QGC WPL 110'"),
        ("0 1 0 16 0 0 0 0 47 8 488 1\n", "line 1", "expected 'QGC WPL 110'"),
        (wpl(), "", "there is no waypoint"),
        (wpl(RETURN), "", "there is no waypoint"),
        (wpl(TAKE_OFF, A).replace("\n1\t", "\n2\t"), "line 3", "index: 2, expected 1"),
        ("QGC WPL 110\n1 0 3 16 0 0 0 0 47 8 5 1\n", "line 2", "row 0, which is home, is missing"),
        (wpl(TAKE_OFF, A, home="0 22 0 0 0 0 47 8 15"), "line 2", "row 0 must be home"),
        (wpl(TAKE_OFF, A, home="0 16 0 0 0 0 0 0 0"), "line 2", "gives no place"),
        (wpl(TAKE_OFF, A, home="9 16 0 0 0 0 47 8 0"), "line 2", "frame 9, BODY_OFFSET_NED"),
        (wpl(TAKE_OFF, A, home="0 16 0 0 0 0 91 8 0"), "line 2", "latitude: 91 is outside"),
        (wpl(TAKE_OFF, A).replace("\t16\t", "\tWP\t", 2), "line 2", "command: 'WP' is not a number"),
        (wpl(TAKE_OFF, (3, 16, 0)), "line 4", "6 columns, expected 12"),
        (wpl(TAKE_OFF, (3, 16.5, *A[2:])), "line 4", "command: 16.5 is not a whole number"),
        (wpl(TAKE_OFF, INF), "line 4", "latitude: is not finite"),
        (wpl(TAKE_OFF, (3, 16, 0, 0, 0, 0, "1e999", 8, 5)), "line 4", "latitude: is not finite"),
        (wpl(TAKE_OFF, (3, 16, 0, 0, 0, 0, "nan", 8, 5)), "line 4", "one is given without the other"),
        (wpl(TAKE_OFF, (3, 16, 0, 0, 0, 0, 95, 8, 5)), "line 4", "latitude: 95 is outside"),
        (wpl(TAKE_OFF, (3, 16, 0, 0, 0, 0, 47, 188, 5)), "line 4", "longitude: 188 is outside"),
        (wpl(TAKE_OFF, (3, 16, 0, 0, 0, 0, 48, 9, 5)), "line 4", "km from home"),
        (wpl(TAKE_OFF, (3, 16, 0, 0, 0, 0, -47.4, -171.4, 5)), "line 4", "km from home"),
        (wpl(TAKE_OFF, row(16, north=10.0, alt=-1.0)), "line 4", "altitude: below ground: 1 m lower"),
        (wpl(TAKE_OFF, row(16, north=10.0, alt=100.0, frame=0)), "line 4", "altitude: below ground: 388 m lower"),
        (wpl(TAKE_OFF, row(16, north=10.0, alt=0.0)), "line 4", "on the ground"),
        (wpl(TAKE_OFF, row(16, north=10.0, alt=1e6)), "line 4", "nothing flies there"),
        (wpl(TAKE_OFF, A, row(21, north=10.0, alt=-7.0)), "line 5", "altitude: below ground"),
        (wpl(row(22, alt=0), A), "line 3", "how high to take off"),
        (wpl(row(22, alt=-3), A), "line 3", "altitude: below ground"),
        (wpl(TAKE_OFF, row(16, -2, north=10.0)), "line 4", "-2 s is negative"),
        (wpl(TAKE_OFF, row(16, north=10.0, frame=1)), "line 4", "frame 1, LOCAL_NED"),
        (wpl(TAKE_OFF, row(16, north=10.0, frame=99)), "line 4", "frame 99, is not supported"),
        (wpl(TAKE_OFF, row(16, north=10.0, frame=2)), "line 4", "has no coordinates"),
        (wpl(TAKE_OFF, A, home=f"3 16 0 0 0 0 {HOME[0]} {HOME[1]} 0").replace("2\t0\t3", "2\t0\t0"), "line 4", "how high home is"),
        (wpl(row(5001, 4, north=1.0), row(5001, 4, north=2.0)), "line 3", "a fence or rally point"),
        (wpl(row(5003, 4, north=1.0)), "line 3", "a fence or rally point"),
        (wpl(row(5100, north=1.0)), "line 3", "a fence or rally point"),
        (wpl(TAKE_OFF, row(31, north=1.0)), "line 4", "navigation by NAV_LOITER_TO_ALT"),
        (wpl(TAKE_OFF, row(84, north=1.0)), "line 4", "navigation by NAV_VTOL_TAKEOFF"),
        (wpl(TAKE_OFF, row(94, north=1.0)), "line 4", "navigation by NAV_PAYLOAD_PLACE"),
        (wpl(TAKE_OFF, row(213, north=1.0)), "line 4", "navigation by NAV_SET_YAW_SPEED"),
        (wpl(TAKE_OFF, row(77, north=1.0)), "line 4", "navigation by command 77"),
        (wpl(TAKE_OFF, row(115, 90), A), "line 4", "CONDITION_YAW is not supported"),
        (wpl(TAKE_OFF, row(207, 1), A), "line 4", "DO_FENCE_ENABLE is not supported"),
        (wpl(TAKE_OFF, row(208, 1), A), "line 4", "DO_PARACHUTE is not supported"),
        (wpl(TAKE_OFF, row(31999), A), "line 4", "command 31999 is not supported"),
        (wpl(TAKE_OFF, row(178, 1, 0), A), "line 4", "would never arrive"),
        (wpl(TAKE_OFF, row(178, 9, 1), A), "line 4", "param 1 (speed type): 9 is unknown"),
        (wpl(TAKE_OFF, row(18, 0, 0, 5, north=9.0)), "line 4", "param 1 (turns): 0 turns"),
        (wpl(TAKE_OFF, row(93, -1, 12, 30), A), "line 4", "until a time of day"),
        (wpl(TAKE_OFF, A, row(177, 9, 1)), "line 5", "param 1 (target): 9: there is no such item"),
        (wpl(TAKE_OFF, A, row(177, 0, 1)), "line 5", "param 1 (target): 0: is home"),
        (wpl(TAKE_OFF, A, row(177, 1.5, 1)), "line 5", "param 1 (target): 1.5 is not a whole number"),
        (wpl(TAKE_OFF, A, row(177, 1, -2)), "line 5", "param 2 (repeats): -2"),
        (wpl(TAKE_OFF, A, row(601, 3, 1)), "line 5", "param 1 (tag): 3: there is no such item"),
        (wpl(TAKE_OFF, row(600, 3), A, row(600, 3)), "line 6", "tag: 3 stands twice"),
        (wpl(TAKE_OFF, A, row(177, 3, -1)), "line 5", "a loop without a waypoint"),
        (wpl(TAKE_OFF, A, row(177, 3, 5)), "line 5", "a loop without a waypoint"),
        (wpl(TAKE_OFF, A, row(178, 1, 2), row(93, 1, alt=0), row(177, 3, -1)), "line 7", "a loop without a waypoint"),
        (wpl(TAKE_OFF, row(177, 3, -1), row(177, 2, -1), A), "line 5", "a loop without a waypoint"),
        (wpl(row(177, 3, -1), A, RETURN), "", "no waypoint is ever reached"),
        (wpl(row(16, alt=0), RETURN), "line 3", "still on the pad"),
        (wpl(RETURN, A), "line 4", "comes after the landing"),
        (wpl(TAKE_OFF, A, row(21, alt=0), TAKE_OFF, B), "line 6", "comes after the landing"),
    ],
)  # fmt: skip
def test_wpl_refused(tmp_path: Path, content: str, where: str, reason: str) -> None:
    reasons = refusal(tmp_path, content)
    assert any(reason in r and where in r for r in reasons), reasons


def survey(**changes: Any) -> dict[str, Any]:
    transects = {"version": 1, "Items": [simple(A, 1), simple(row(206, 25, frame=2), 2), simple(B, 3)]}
    item = {"type": "ComplexItem", "complexItemType": "survey", "version": 5, "TransectStyleComplexItem": transects}
    return {**item, **changes}


CIRCLE = {"circle": {"center": [HOME[0] + 30 / DEGREE, HOME[1]], "radius": 5.0}, "inclusion": False, "version": 1}


def area(half: float, **changes: Any) -> dict[str, Any]:
    """A square of 2 ``half`` about 30 m north of home."""
    to_lat, to_lon = 1 / DEGREE, 1 / (DEGREE * math.cos(math.radians(HOME[0])))
    corners = [(30 + half, half), (30 + half, -half), (30 - half, -half), (30 - half, half)]
    polygon = [[HOME[0] + n * to_lat, HOME[1] + e * to_lon] for n, e in corners]
    return {"polygon": polygon, "inclusion": False, "version": 1, **changes}


def item_with(**changes: Any) -> dict[str, Any]:
    return plan(mission__items=[simple(TAKE_OFF, 1), {**simple(A, 2), **changes}])


@pytest.mark.parametrize(
    ("document", "where", "reason"),
    [
        (plan(TAKE_OFF, A, fileType="Parameters"), "plan", "fileType"),
        (plan(TAKE_OFF, A, version=2), "plan", "version: 2 is not supported"),
        (plan(TAKE_OFF, A, version=None), "plan", "version: null is not supported"),
        (plan(TAKE_OFF, A, mission__version=1), "mission", "version: 1 is not supported"),
        (plan(TAKE_OFF, A, geoFence__version=1), "geoFence", "version: 1 is not supported"),
        (plan(TAKE_OFF, A, rallyPoints__version=1), "rallyPoints", "version: 1 is not supported"),
        (plan(TAKE_OFF, A, mission=None), "mission", "there is nothing to fly"),
        (plan(TAKE_OFF, A, mission=[]), "mission", "must be an object"),
        (plan(), "mission", "there is no waypoint"),
        (plan(TAKE_OFF, A, mission__items={}), "mission", "items: missing, or not a list"),
        (plan(TAKE_OFF, A, mission__plannedHomePosition=None), "mission", "plannedHomePosition: missing"),
        (plan(TAKE_OFF, A, mission__plannedHomePosition=[47, "8", 1]), "mission", "plannedHomePosition"),
        (plan(TAKE_OFF, A, mission__plannedHomePosition=[0, 0, 0]), "mission", "gives no place"),
        (plan(TAKE_OFF, A, mission__plannedHomePosition=[147, 8, 0]), "mission", "latitude: 147"),
        (plan(TAKE_OFF, row(31, north=2.0)), "item 2 (NAV_LOITER_TO_ALT)", "navigation by"),
        (plan(TAKE_OFF, row(5002, 3, north=2.0)), "item 2", "a fence or rally point"),
        (plan(TAKE_OFF, row(16, north=3.0, alt=-2)), "item 2 (NAV_WAYPOINT)", "altitude: below ground"),
        (plan(TAKE_OFF, A, row(177, 8, 1)), "item 3 (DO_JUMP)", "8: there is no such item"),
        (item_with(type="Simple"), "item 2", 'type: "Simple"'),
        (item_with(params=[0, 0, 0]), "item 2", "params: expected a list of 7"),
        (item_with(params=[0, 0, 0, 0, "47", 8, 5]), "item 2", 'params[4] (latitude): "47" is not a number'),
        (item_with(params=[0, 0, 0, 0, True, 8, 5]), "item 2", "params[4] (latitude): true is not a number"),
        (item_with(params=[0, 0, 0, 0, 10**400, 8, 5]), "item 2", "params[4] (latitude): is not finite"),
        (item_with(params=[0, 0, 0, 0, math.inf, 8, 5]), "item 2", "params[4] (latitude): is not finite"),
        (item_with(command=None), "item 2", "command: missing"),
        (item_with(command=16.5), "item 2", "command: 16.5 is not a whole number"),
        (item_with(frame="3"), "item 2", "frame"),
        (item_with(doJumpId=1), "item 2", "1 stands twice"),
        (item_with(autoContinue=1), "item 2", "autoContinue"),
        (plan(mission__items=[survey(version=6)]), "item 1", "version: 6 is not supported"),
        (plan(mission__items=[survey(TransectStyleComplexItem={"version": 9, "Items": [simple(A, 1)]})]), "item 1", "version: 9"),
        (plan(mission__items=[survey(complexItemType="StructureScan", version=2, TransectStyleComplexItem=None)]),
         "item 1", "a StructureScan is flown by the items stored with it"),
        (plan(mission__items=[survey(TransectStyleComplexItem={"version": 1, "Items": []})]), "item 1", "Items: missing"),
        (plan(mission__items=[survey(TransectStyleComplexItem={"version": 1, "Items": [3]})]), "item 1", "a list of SimpleItem"),
        (plan(mission__items=[survey(complexItemType="fwLandingPattern")]), "item 1", '"fwLandingPattern" is not supported'),
        (plan(mission__items=[survey(complexItemType=["survey"])]), "item 1", "is not supported"),
        (plan(TAKE_OFF, A, geoFence__circles=[{**CIRCLE, "version": 2}]), "geoFence", "version: 2"),
        (plan(TAKE_OFF, A, geoFence__circles=[{**CIRCLE, "circle": {"center": [47], "radius": 1}}]), "geoFence", "center"),
        (plan(TAKE_OFF, A, geoFence__circles=[{**CIRCLE, "inclusion": None}]), "geoFence", "inclusion"),
        (plan(TAKE_OFF, A, geoFence__polygons=[area(5, polygon=[[47, 8]])]), "geoFence", "3 to 500 corners"),
        (plan(TAKE_OFF, A, geoFence__polygons=[area(0)]), "geoFence", "has no area"),
        (plan(TAKE_OFF, A, geoFence__polygons=[area(9, inclusion=True)]), "geoFence", "home is outside"),
        (plan(TAKE_OFF, A, geoFence__polygons=[area(70, inclusion=True), area(80, inclusion=True)]), "geoFence", "at most one"),
        (plan(TAKE_OFF, row(16, north=110.0), geoFence__polygons=[area(70, inclusion=True)]), "item 2", "outside the fence"),
        (plan(TAKE_OFF, row(16, north=31.0), geoFence__circles=[CIRCLE]), "item 2", "inside fence circle 1"),
        (plan(TAKE_OFF, row(18, 1, 0, 10, north=20.0), geoFence__circles=[CIRCLE]), "item 2", "inside fence circle 1"),
        (plan(TAKE_OFF, row(16, north=31.0), geoFence__polygons=[area(5)]), "item 2", "inside fence polygon 1"),
    ],
)  # fmt: skip
def test_plan_refused(tmp_path: Path, document: dict[str, Any], where: str, reason: str) -> None:
    reasons = refusal(tmp_path, document)
    assert any(reason in r and where in r for r in reasons), reasons


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("{", "line 1: not valid JSON"),
        ('{\n"fileType": "Plan",\n}', "line 3: not valid JSON"),
        ('{"a": ' * 50_000, "nested too deeply"),
        ('{"a": ' + "9" * 5000 + "}", "not valid JSON"),
        ("[]", "not a plan"),
        ("hello", "line 1: not valid JSON"),
    ],
)
def test_malformed_json(tmp_path: Path, text: str, reason: str) -> None:
    assert any(reason in r for r in refusal(tmp_path, text, "mission.plan"))


def test_every_reason_is_collected(tmp_path: Path) -> None:
    bad = wpl(TAKE_OFF, row(16, north=10.0, alt=-1.0), row(31), row(177, 9, 1))
    assert len(refusal(tmp_path, bad)) == 3
    assert len(refusal(tmp_path, plan(TAKE_OFF, A, version=7, mission__version=7))) == 2


def test_too_many_rows(tmp_path: Path) -> None:
    assert any("more than 10000 rows" in r for r in refusal(tmp_path, wpl(*[A] * 10_005)))


def test_not_a_mission(tmp_path: Path) -> None:
    assert "neither QGC WPL" in refusal(tmp_path, "hello world\n", "mission.doc")[0]
    assert "not UTF-8" in refusal(tmp_path, b"QGC WPL 110\n\xff\xfe", "mission.txt")[0]
    with pytest.raises(UnusableFile, match="No such file"):
        read_mission(tmp_path / "none.plan")


# Plans: fences and surveys --------------------------------------------------------------------------------------


def test_survey_is_flown_by_its_stored_items(tmp_path: Path) -> None:
    mission = read(tmp_path, plan(mission__items=[survey()]))
    assert north(mission) == [10, 20, 0]
    assert legs(mission)[1].source == "item 1.1 (NAV_WAYPOINT)"
    assert any(note.startswith("item 1.2 (DO_SET_CAM_TRIGG_DIST)") for note in mission.notes)
    corridor = survey(complexItemType="CorridorScan", version=2)
    assert north(read(tmp_path, plan(mission__items=[corridor]))) == [10, 20, 0]


def test_fence(tmp_path: Path) -> None:
    triangle = area(5)
    del triangle["polygon"][0]
    document = plan(
        TAKE_OFF,
        A,
        RETURN,
        geoFence__circles=[CIRCLE],
        geoFence__polygons=[area(5), triangle, area(70, inclusion=True)],
    )
    mission = read(tmp_path, document)
    pole, box, *edges = mission.obstacles
    assert isinstance(pole, Pole) and isinstance(box, Wall)
    assert pole.position == pytest.approx((30.0, 0.0), abs=0.1)
    assert (pole.radius, pole.known, pole.motion) == (5.0, True, None)
    assert box.position[:2] == pytest.approx((30.0, 0.0), abs=0.1)
    assert box.size[:2] == pytest.approx((10.0, 10.0), abs=0.1)
    assert box.position[2] == -box.size[2] / 2
    assert len(edges) == 3
    assert all(isinstance(e, Wall) and math.dist(e.position[:2], (30.0, 0.0)) < 5.2 for e in edges)
    assert mission.boundary is not None and mission.boundary[0] == pytest.approx((100.0, 70.0), abs=0.5)


def test_ways_across_the_fence_are_noted(tmp_path: Path) -> None:
    behind = row(16, north=60.0)
    for fence in ({"geoFence__circles": [CIRCLE]}, {"geoFence__polygons": [area(5)]}):
        notes = read(tmp_path, plan(TAKE_OFF, behind, row(177, 2, -1), **fence)).notes
        assert [n for n in notes if n.startswith("item 2") and "leads across fence" in n]
        assert not read(tmp_path, plan(TAKE_OFF, A, RETURN, **fence)).notes


def test_walls_stand_inside_their_polygon(tmp_path: Path) -> None:
    for turn in (1, -1):  # either sense
        kite = area(5)
        kite["polygon"] = [*kite["polygon"], [HOME[0] + 28 / DEGREE, HOME[1] + 15 / DEGREE]][::turn]
        for wall in read(tmp_path, plan(TAKE_OFF, A, RETURN, geoFence__polygons=[kite])).obstacles:
            assert isinstance(wall, Wall)
            if abs(wall.position[0] - 35.0) < 0.2:  # the northern edge
                assert 34.8 < wall.position[0] < 34.99
                break
        else:
            pytest.fail("no northern edge")


def test_rally_points_are_left_out(tmp_path: Path) -> None:
    mission = read(tmp_path, plan(TAKE_OFF, A, RETURN, rallyPoints__points=[[47, 8, 1]]))
    assert mission.notes[0].startswith("rallyPoints: 1 left out")


# The project's own format ---------------------------------------------------------------------------------------

TOML = """
[mission]
name = "two spheres"
seed = 7

[reference]
kind = "lissajous"
amplitude = [6.0, 3.0]
angular_frequency = 0.5
altitude = 5.0
duration = 40.0

[[obstacle]]
name = "static"
shape = "sphere"
position = [-6.0, 0.0, -5.0]
radius = 0.5
known = true

[[obstacle]]
name = "moving"
shape = "pole"
position = [6.0, 0.0]
radius = 0.5
height = 15.0
known = false
motion = { kind = "harmonic", amplitude = [1.5, 0.0, 0.0], angular_frequency = 1.0, phase = 3.14159 }

[[fault]]
kind = "packet_loss"
vehicles = [2]
direction = "telemetry"
start = 20.0
duration = 5.0
probability = 0.3

[limits]
position_rmse = 0.05
settle = 10.0
payload_tilt_deg = 5.0
clearance = 0.3
"""
POINTS = (
    '[mission]\nname = "p"\n[reference]\nkind = "waypoints"\npoints = [[1, 2, -3], [4, 5, -6]]\nspeed = 2\nhold = 4\n'
)


def test_toml(tmp_path: Path) -> None:
    mission = read(tmp_path, TOML, "mission.toml")
    assert mission.reference == Lissajous((6.0, 3.0), 0.5, 5.0, 40.0)
    assert (mission.name, mission.seed) == ("two spheres", 7)
    static, moving = mission.obstacles
    assert isinstance(static, Sphere) and isinstance(moving, Pole)
    assert static.known and not moving.known
    assert moving.motion is not None and moving.motion.kind == "harmonic"
    (fault,) = mission.faults
    assert (fault.kind, fault.vehicles, fault.direction, fault.start, fault.duration) == (
        "packet_loss",
        (2,),
        "telemetry",
        20,
        5,
    )
    assert fault.settings == {"probability": 0.3}
    assert TOML.splitlines()[fault.line - 1] == "[[fault]]"
    assert mission.limits is not None and mission.limits.clearance == 0.3


def test_toml_points(tmp_path: Path) -> None:
    assert shape(read(tmp_path, POINTS, "mission.toml")) == [
        ("TakeOff", 0.0, 0.0, -3.0, 0.0),
        ("FlyTo", 1.0, 2.0, -3.0, 4.0, 2.0),
        ("FlyTo", 4.0, 5.0, -6.0, 4.0, 2.0),
        ("FlyTo", 0.0, 0.0, -6.0, 0.0, 2.0),
        ("Land", 0.0, 0.0, -0.3),
    ]


@pytest.mark.parametrize(
    ("text", "old", "new", "at", "reason"),
    [
        (TOML, 'name = "two spheres"', "", "[mission]", "mission.name: missing key"),
        (TOML, "seed = 7", "sead = 7", "seed", "mission.sead: unknown key"),
        (TOML, "seed = 7", "seed = -7", "seed", "mission.seed: "),
        (TOML, "seed = 7", 'system = "none.toml"', "seed", "mission.system: there is no file none.toml"),
        (TOML, 'kind = "lissajous"', 'kind = "circle"', 'kind = "liss', "reference.kind: 'circle' is none of"),
        (TOML, 'kind = "lissajous"', "", "[reference]", "reference.kind: missing key"),
        (TOML, "altitude = 5.0", "altitude = -5.0", "altitude", "reference.altitude: "),
        (TOML, "duration = 40.0", "duration = 0.0", "duration = 40", "reference.duration: "),
        (TOML, "duration = 40.0", "", "[reference]", "reference.duration: missing key"),
        (TOML, 'shape = "sphere"', 'shape = "cube"', "shape = ", "obstacle[1].shape: 'cube' is none of"),
        (TOML, 'shape = "sphere"', 'shape = "wall"', "radius", "obstacle[1].radius: unknown key"),
        (TOML, "height = 15.0", "", '[[obstacle]]\nname = "moving"', "obstacle[2].height: missing key"),
        (TOML, "height = 15.0", "height = nan", "height", "obstacle[2].height: "),
        (TOML, "phase = 3.14159", "fase = 3.14159", "motion", "obstacle[2].motion.fase: unknown key"),
        (TOML, "amplitude = [1.5, 0.0, 0.0]", "amplitude = [1.5, 0.0, 1.0]", "motion", "no vertical motion"),
        (TOML, 'name = "moving"', 'name = "static"', 'name = "moving"', "'static' stands 2 times"),
        (TOML, 'direction = "telemetry"', 'direction = "up"', "direction", "fault[1].direction: "),
        (TOML, "vehicles = [2]", "vehicles = [5]", "vehicles", "there is no vehicle 5: the team has 4"),
        (TOML, "start = 20.0", "", "[[fault]]", "fault[1].start: missing key"),
        (TOML, "clearance = 0.3", "clearence = 0.3", "clearance", "limits.clearence: unknown key"),
        (TOML, "[limits]", "[limit]", "[limits]", "limit: unknown key"),
        (TOML, "[[fault]]", "[fault]", "[[fault]]", "fault: "),
        (TOML, "[mission]", "[mission", "[mission]", "not valid TOML"),
        (POINTS, "[4, 5, -6]", "[4, 5, 6]", "points =", "z = 6 m is below ground"),
        (POINTS, "[4, 5, -6]", "[4, 5]", "points =", "reference.points[2]"),
        (POINTS, "[4, 5, -6]", "[4e9, 5, -6]", "points =", "more than 10 km"),
        (POINTS, "[[1, 2, -3], [4, 5, -6]]", "[]", "points =", "reference.points: needs at least 1"),
        (POINTS, "speed = 2", 'file = "x.plan"', "[reference]", "either file or points"),
        (POINTS, "points = [[1, 2, -3], [4, 5, -6]]", "", "[reference]", "either file or points"),
        (POINTS, "points = [[1, 2, -3], [4, 5, -6]]", 'file = "x.plan"', "hold", "goes with points"),
        (POINTS, "speed = 2", "speed = 0", "speed", "reference.speed: "),
    ],
)
def test_toml_refused(tmp_path: Path, text: str, old: str, new: str, at: str, reason: str) -> None:
    assert old in text
    line = text[: text.index(at)].count("\n") + 1
    reasons = refusal(tmp_path, text.replace(old, new, 1), "mission.toml")
    assert any(reason in r and f"line {line}: " in r for r in reasons), reasons


def test_toml_names_a_missing_or_wrong_waypoint_file(tmp_path: Path) -> None:
    text = '[mission]\nname = "p"\n[reference]\nkind = "waypoints"\nfile = "mission.txt"\n'
    assert "line 5: reference.file: there is no file" in refusal(tmp_path, text, "mission.toml")[0]
    (tmp_path / "mission.txt").write_text(wpl(TAKE_OFF, row(31)))
    assert "mission.txt: line 4" in refusal(tmp_path, text, "mission.toml")[0]


def test_speed_of_toml_is_capped(tmp_path: Path) -> None:
    mission = read(tmp_path, POINTS.replace("speed = 2", "speed = 20"), "mission.toml")
    assert isinstance(mission.reference, Route) and mission.reference.speed == 3.0
    assert mission.notes == ("reference.speed: 20 m/s capped to speed_max, 3 m/s",)


def test_which_system_file(tmp_path: Path) -> None:
    text = default_system_path().read_text()
    assert read(tmp_path, wpl(A)).system.payload.mass == 3.1  # packaged
    (tmp_path / "system.toml").write_text(text.replace("mass = 3.1", "mass = 3.2"))
    assert read(tmp_path, wpl(A)).system.payload.mass == 3.2  # beside
    assert read(tmp_path, POINTS, "mission.toml").system.payload.mass == 3.2
    (tmp_path / "heavy.toml").write_text(text.replace("mass = 3.1", "mass = 3.3"))
    named = POINTS.replace('name = "p"', 'name = "p"\nsystem = "heavy.toml"')
    assert read(tmp_path, named, "mission.toml").system.payload.mass == 3.3
    path = tmp_path / "mission.toml"
    assert read_mission(path, tmp_path / "system.toml").system.payload.mass == 3.2  # named on the command line


def test_points_that_end_where_they_end(tmp_path: Path) -> None:
    there = POINTS.replace("speed = 2", "speed = 2\nreturn_home = false")
    assert shape(read(tmp_path, there, "mission.toml"))[-2:] == [
        ("FlyTo", 4.0, 5.0, -6.0, 4.0, 2.0),
        ("Land", 4.0, 5.0, -0.3),
    ]
    back = POINTS.replace("speed = 2", "speed = 2\nreturn_home = true")
    assert shape(read(tmp_path, back, "mission.toml"))[-1] == ("Land", 0.0, 0.0, -0.3)
    file = '[mission]\nname = "p"\n[reference]\nkind = "waypoints"\nfile = "m.txt"\nreturn_home = true\n'
    assert "line 6: reference.return_home: goes with points" in refusal(tmp_path, file, "mission.toml")[0]


# The missions of this project -----------------------------------------------------------------------------------


def test_hover() -> None:
    mission = read_mission(MISSIONS / "hover.toml")
    assert [s[:4] for s in shape(mission)] == [("TakeOff", 0, 0, -5), ("FlyTo", 0, 0, -5), ("Land", 0, 0, -0.3)]
    assert shape(mission)[1][4] == 15.0


def test_figure_eight() -> None:
    mission = read_mission(MISSIONS / "figure_eight.toml")
    assert mission.reference == Lissajous((6.0, 3.0), 0.5, 5.0, 40.0)
    assert mission.limits is not None and mission.limits.position_rmse == 0.03


def test_square() -> None:
    mission = read_mission(MISSIONS / "square.waypoints")
    lap = [(10, 0, 0), (10, 10, 3), (0, 10, 0), (0, 0, 3)]
    flown = [(round(n), round(e), hold) for kind, n, e, _, hold, _ in shape(mission)[1:-1]]
    assert flown == lap * 2
    assert isinstance(legs(mission)[-1], Land)
    assert mission.notes == ()


def test_delivery() -> None:
    mission = read_mission(MISSIONS / "delivery.plan")
    assert isinstance(legs(mission)[-1], Land)
    assert math.hypot(*legs(mission)[-1].position[:2]) == pytest.approx(20.0, abs=0.5)
    assert {leg.speed for leg in legs(mission) if isinstance(leg, FlyTo)} == {1.0, 1.5, 2.0}
    assert mission.notes == ()


def test_fenced_delivery() -> None:
    mission = read_mission(MISSIONS / "fenced_delivery.plan")
    circle, polygon = mission.obstacles
    assert isinstance(circle, Pole) and circle.radius == 2.0 and circle.known
    assert isinstance(polygon, Wall) and polygon.size[:2] == pytest.approx((3.0, 5.0), abs=0.01)
    assert mission.boundary is not None and len(mission.boundary) == 4
    across = [note for note in mission.notes if "leads across fence" in note]
    assert len(across) == len(mission.notes) == 2


@pytest.mark.parametrize("name", ["hover.toml", "figure_eight.toml", "square.waypoints", "delivery.plan"])
def test_described(name: str) -> None:
    text = told(read_mission(MISSIONS / name))
    assert "home 47.3977420, 8.5455940, 488 m" in text
    assert ("figure eight of 12 x 6 m" if name == "figure_eight.toml" else " m, about ") in text


def test_description_tells_everything(tmp_path: Path) -> None:
    endless = plan(TAKE_OFF, A, B, row(177, 2, -1), RETURN, geoFence__circles=[CIRCLE])
    for content, name, expected in [
        (endless, "mission.plan", ["endless", "never reached", "pole 'fence circle 1'"]),
        (wpl(TAKE_OFF, row(17, north=5.0)), "mission.txt", ["holds until stopped"]),
        (
            wpl(row(93, 3), TAKE_OFF, row(18, 2, 0, 4, north=5.0)),
            "mission.txt",
            ["wait 3 s", "circle 2 x 4 m clockwise"],
        ),
        (TOML, "mission.toml", ["packet_loss from 20 s for 5 s, vehicles 2", "not on the map", "clearance 0.3 m"]),
    ]:
        text = told(read(tmp_path, content, name))
        for part in expected:
            assert part in text, part
