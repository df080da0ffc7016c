"""Mission files that cannot be flown: every reason, and where it stands."""

# ruff: noqa: E501 (the tables of cases: one case a line)

import math
from pathlib import Path
from typing import Any

import pytest
from mission_files import CIRCLE, HOME, RETURN, TAKE_OFF, A, area, plan, refusal, row, simple, survey, wpl

from gcs.config import UnusableFile
from gcs.mission.read import read_mission

BEYOND = [[HOME[0] + 0.001, HOME[1] + 0.002], [HOME[0] + 0.001, HOME[1] + 0.003], [HOME[0] + 0.002, HOME[1] + 0.002]]
INF = (3, 16, 0, 0, 0, 0, "inf", 8.5, 5)


@pytest.mark.parametrize(
    ("content", "where", "reason"),
    [
        ("", "", "the file is empty"),
        ("# nothing\n", "", "only comments"),
        ("QGC WPL 110\n", "", "home is missing"),
        ("QGC WPL 100\n0 1 0 16\n", "line 1", "version 100 is not supported"),
        ("QGC WPL 120\n0 1 0 16\n", "line 2", "4 columns, expected 12"),
        ("QGC WPL\n0 1 0 16\n", "line 1", "expected 'QGC WPL 110'"),
        ("QGC PARAM 110\n", "line 1", "expected 'QGC WPL 110'"),
        (wpl(), "", "there is no waypoint"),
        (wpl(RETURN), "", "there is no waypoint"),
        (wpl(TAKE_OFF, RETURN, home="0 16 0 0 0 0 0 0 0"), "", "home: no row gives a place"),
        (wpl(TAKE_OFF, A, home="9 16 0 0 0 0 47 8 0"), "line 2", "frame 9, BODY_OFFSET_NED"),
        (wpl(TAKE_OFF, A, home="0 16 0 0 0 0 91 8 0"), "line 2", "latitude: 91 is outside"),
        (wpl(TAKE_OFF, A).replace("\t16\t", "\tWP\t", 1), "line 2", "command: 'WP' is not a number"),
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
        (wpl(TAKE_OFF, row(16, north=10.0, alt=0.1)), "line 4", "on the ground"),
        (wpl(TAKE_OFF, row(16, north=10.0, alt=1e6)), "line 4", "m above home (limit 10000 m)"),
        (wpl(row(22, alt=math.nan), A), "line 3", "altitude: not given"),
        (wpl(row(22, alt=-3), A), "line 3", "altitude: below ground"),
        (wpl(TAKE_OFF, row(16, -2, north=10.0)), "line 4", "-2 s is negative"),
        (wpl(TAKE_OFF, row(16, north=10.0, frame=1)), "line 4", "frame 1, LOCAL_NED"),
        (wpl(TAKE_OFF, row(16, north=10.0, frame=99)), "line 4", "frame 99, is not supported"),
        (wpl(TAKE_OFF, row(16, north=10.0, frame=2)), "line 4", "has no coordinates"),
        (wpl(TAKE_OFF, A, home=f"3 16 0 0 0 0 {HOME[0]} {HOME[1]} 0").replace("2\t0\t3", "2\t0\t0"), "line 4", "home has no altitude"),
        (wpl(TAKE_OFF, row(5003, 4, north=1.0)), "line 4", "a fence or rally point"),
        (wpl(TAKE_OFF, row(84, north=1.0)), "line 4", "(NAV_VTOL_TAKEOFF): command: navigation that is not supported"),
        (wpl(TAKE_OFF, row(77, north=1.0)), "line 4", "(command 77): command: navigation that is not supported"),
        (wpl(TAKE_OFF, row(207, 1), A), "line 4", "(DO_FENCE_ENABLE): command: not supported"),
        (wpl(TAKE_OFF, row(31999), A), "line 4", "(command 31999): command: not supported"),
        (wpl(TAKE_OFF, row(93, "nan"), A), "line 4", "param 1: not given: a delay in seconds is needed"),
        (wpl(TAKE_OFF, row(93, -1), A), "line 4", "param 1: not given: a delay in seconds is needed"),
        (wpl(TAKE_OFF, row(178, 1, 0), A), "line 4", "would never arrive"),
        (wpl(TAKE_OFF, row(178, 9, 1), A), "line 4", "param 1 (speed type): 9 is unknown"),
        (wpl(TAKE_OFF, row(18, 0, 0, 5, north=9.0)), "line 4", "param 1 (turns): 0 turns"),
        (wpl(TAKE_OFF, row(93, -1, 12, 30), A), "line 4", "a time of day is not supported"),
        (wpl(TAKE_OFF, A, row(177, 9, 1)), "line 5", "param 1 (target): 9: there is no such item"),
        (wpl(TAKE_OFF, A, row(177, 0, 1)), "line 5", "param 1 (target): 0: is home"),
        (wpl(TAKE_OFF, A, row(177, 1.5, 1)), "line 5", "param 1 (target): 1.5 is not a whole number"),
        (wpl(TAKE_OFF, A, row(177, 1, -2)), "line 5", "param 2 (repeats): -2"),
        (wpl(TAKE_OFF, A, row(601, 3, 1)), "line 5", "param 1 (tag): 3: there is no such item"),
        (wpl(TAKE_OFF, row(600, 3), A, row(600, 3), row(601, 3, 1)), "line 7", "param 1 (tag): 3: there are 2 such items"),
        (wpl(TAKE_OFF, A, row(177, 3, -1)), "line 5", "a loop without a waypoint"),
        (wpl(TAKE_OFF, A, row(178, 1, 2), row(93, 1, alt=0), row(177, 3, -1)), "line 7", "a loop without a waypoint"),
        (wpl(TAKE_OFF, row(177, 3, -1), row(177, 2, -1), A), "line 5", "a loop without a waypoint"),
        (wpl(row(177, 3, -1), A, RETURN), "", "no waypoint is ever reached"),
        (wpl(row(16, alt=0), RETURN), "line 3", "still on the pad"),
    ],
)  # fmt: skip
def test_wpl_refused(tmp_path: Path, content: str, where: str, reason: str) -> None:
    reasons = refusal(tmp_path, content)
    assert any(reason in r and where in r for r in reasons), reasons


def item_with(**changes: Any) -> dict[str, Any]:
    return plan(mission__items=[simple(TAKE_OFF, 1), {**simple(A, 2), **changes}])


@pytest.mark.parametrize(
    ("document", "where", "reason"),
    [
        (plan(TAKE_OFF, A, fileType="Parameters"), "", "fileType"),
        (plan(TAKE_OFF, A, version=2), "", "version: 2 is not supported"),
        (plan(TAKE_OFF, A, mission__version=1), "mission", "version: 1 is not supported"),
        (plan(TAKE_OFF, A, mission=None), "mission", "must be a table, found null"),
        (plan(), "mission", "there is no waypoint"),
        (plan(TAKE_OFF, A, mission__plannedHomePosition=None), "mission", "plannedHomePosition: must be a valid array"),
        (plan(TAKE_OFF, A, mission__plannedHomePosition=[47, "8", 1]), "mission", "plannedHomePosition"),
        (plan(TAKE_OFF, A, mission__plannedHomePosition=[0, 0, 0]), "mission", "gives no place"),
        (plan(TAKE_OFF, A, mission__plannedHomePosition=[147, 8, 0]), "mission", "latitude: 147"),
        (plan(TAKE_OFF, row(5002, 3, north=2.0)), "item 2", "a fence or rally point"),
        (item_with(type="Simple"), "item 2", "type: 'Simple' is none of"),
        (item_with(params=[0, 0, 0]), "item 2", "params: needs at least 7, has 3"),
        (item_with(params=[0, 0, 0, 0, "47", 8, 5]), "item 2", 'params[5]: must be a valid number, found "47"'),
        (item_with(params=[0, 0, 0, 0, math.inf, 8, 5]), "item 2", "params[5]: is not finite"),
        (item_with(command=None), "item 2", "command: must be a valid integer, found null"),
        (plan(mission__items=[survey(version=6)]), "item 1", "version: 6 is not supported"),
        (plan(mission__items=[survey(TransectStyleComplexItem={"version": 9, "Items": [simple(A, 1)]})]), "item 1", "version: 9"),
        (plan(mission__items=[survey(complexItemType="StructureScan", version=2, TransectStyleComplexItem=None)]),
         "item 1", "TransectStyleComplexItem: must be a table, found null"),
        (plan(mission__items=[survey(TransectStyleComplexItem={"version": 1, "Items": []})]), "item 1", "Items: needs at least 1"),
        (plan(mission__items=[survey(TransectStyleComplexItem={"version": 1, "Items": [3]})]), "item 1", "Items[1]: must be a table, found 3"),
        (plan(mission__items=[survey(complexItemType="fwLandingPattern")]), "item 1", "'fwLandingPattern' is none of"),
        (plan(TAKE_OFF, A, geoFence__circles=[{**CIRCLE, "version": 2}]), "geoFence", "version: 2"),
        (plan(TAKE_OFF, A, geoFence__circles=[{**CIRCLE, "circle": {"center": [47], "radius": 1}}]), "geoFence", "center"),
        (plan(TAKE_OFF, A, geoFence__circles=[{**CIRCLE, "inclusion": None}]), "geoFence", "inclusion"),
        (plan(TAKE_OFF, A, geoFence__polygons=[area(5, polygon=[[47, 8]])]), "geoFence", "needs at least 3, has 1"),
        (plan(TAKE_OFF, A, geoFence__polygons=[area(0)]), "geoFence", "has no area"),
        (plan(TAKE_OFF, A, geoFence__polygons=[area(9, inclusion=True)]), "geoFence", "home is outside"),
        (plan(TAKE_OFF, A, mission__firmwareType=3, geoFence__polygons=[area(70, inclusion=True), area(5, polygon=BEYOND, inclusion=True)]),
         "geoFence", "the 2 areas have nothing in common"),
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
def test_malformed_json_is_refused(tmp_path: Path, text: str, reason: str) -> None:
    assert any(reason in r for r in refusal(tmp_path, text, "mission.plan"))


def test_mission_with_several_errors_reports_every_reason(tmp_path: Path) -> None:
    bad = wpl(TAKE_OFF, row(16, north=10.0, alt=-1.0), row(84), row(177, 9, 1))
    assert len(refusal(tmp_path, bad)) == 3
    assert len(refusal(tmp_path, plan(TAKE_OFF, A, version=7, mission__version=7))) == 2


def test_mission_with_too_many_rows_is_refused(tmp_path: Path) -> None:
    assert any("more than 10000 rows" in r for r in refusal(tmp_path, wpl(*[A] * 10_005)))


def test_file_of_other_content_is_refused(tmp_path: Path) -> None:
    assert "neither QGC WPL" in refusal(tmp_path, "hello world\n", "mission.doc")[0]
    assert "not UTF-8" in refusal(tmp_path, b"QGC WPL 110\n\xff\xfe", "mission.txt")[0]
    with pytest.raises(UnusableFile, match="No such file"):
        read_mission(tmp_path / "none.plan")
