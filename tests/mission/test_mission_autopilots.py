"""Mission files that PX4 and ArduPilot fly differently, or that other ground stations write: what is flown, and noted."""

# ruff: noqa: E501 (the tables of cases: one case a line)

from pathlib import Path
from typing import Any

import pytest
from mission_files import CIRCLE, HOME, RETURN, TAKE_OFF, A, B, Row, area, legs, plan, read, refusal, row, wpl

from gcs.mission.model import Mission
from gcs.mission.route import FlyTo, Gripper, HoldForever, Land, Stand, TakeOff

ORIGIN = f"{HOME[0]} {HOME[1]}"
ABSOLUTE = row(16, north=10.0, alt=493.0, frame=0)
LAND = row(21, north=0.0, alt=0.0)
ARDUPILOT, PX4 = {"mission__firmwareType": 3}, {"mission__firmwareType": 12}


def rows(*numbered: tuple[int, Row], autocontinue: int = 1, version: int = 110) -> str:
    """Return a WPL file of rows with any numbers."""
    lines = [f"{number} 0 {' '.join(map(str, r))} {autocontinue}" for number, r in numbered]
    return "\n".join([f"QGC WPL {version}", *lines, ""])


def home(*cells: float, at: str = ORIGIN) -> str:
    """Return row 0 of a frame, a command and an altitude, for :func:`wpl`."""
    frame, command, altitude = cells
    return f"{frame:g} {command:g} 0 0 0 0 {at} {altitude:g}"


def paused(document: dict[str, Any]) -> dict[str, Any]:
    for item in document["mission"]["items"]:
        item["autoContinue"] = False
    return document


def with_ids(document: dict[str, Any], *ids: int) -> dict[str, Any]:
    for item, number in zip(document["mission"]["items"], ids, strict=True):
        item["doJumpId"] = number
    return document


def flown(mission: Mission, at_most: int = 8) -> str:
    """Return ``up 5, 10@5, land 10``: metres north of home, and altitudes."""
    words = []
    for leg in legs(mission, at_most):
        north, altitude = (round(x, 1) + 0.0 for x in (leg.position[0], -leg.position[2]))  # type: ignore[union-attr]
        match leg:
            case TakeOff():
                words.append(f"up {altitude:g}")
            case FlyTo():
                words.append(f"{north:g}@{altitude:g}")
            case HoldForever():
                words.append("hold")
            case Land():
                words.append(f"land {north:g}")
            case Stand(seconds=seconds):
                words.append(f"stand {seconds:g}")
            case Gripper(action=action, gripper=gripper):
                words.append(f"{action.name.lower()} {gripper}")
    return ", ".join(words)


START = row(22, north=0.0)
SQUARE = "up 5, 10@5, 20@5, 0@5, land 0"
FIRST_ITEM = "home: no home row"
NO_PLACE = "home: row 0 gives no place: on the ground below"
NO_ALTITUDE = "home: altitude not given: 488 m"
NUMBERS = "index: rows are missing or repeated"
KEEPS = "altitude 0: keeps the altitude"


@pytest.mark.parametrize(
    ("content", "expected", "notes"),
    [
        # home
        (rows((0, START), (1, A), (2, B), (3, RETURN)), SQUARE, [FIRST_ITEM, NO_ALTITUDE]),
        (rows((0, TAKE_OFF), (1, row(16, north=0.0)), (2, A), (3, RETURN)), "up 5, 0@5, 10@5, 0@5, land 0", [FIRST_ITEM, NO_ALTITUDE]),
        (rows((0, row(16, north=0.0)), (1, A), (2, LAND)), "up 5, 10@5, 0@5, land 0", [FIRST_ITEM, "no take-off before it", NO_ALTITUDE]),
        (rows((1, START), (2, A), (3, B), (4, RETURN)), SQUARE, [FIRST_ITEM, NO_ALTITUDE]),
        (rows((0, START), (1, A), (2, B), (3, RETURN), version=120), SQUARE, [FIRST_ITEM, NO_ALTITUDE]),
        (wpl(START, A, B, RETURN, home=home(0, 16, 0, at="0 0")), SQUARE, [NO_PLACE, NO_ALTITUDE]),
        (wpl(START, A, B, RETURN, home=home(0, 0, 0, at="0 0")), SQUARE, [NO_PLACE, NO_ALTITUDE]),
        (wpl(START, A, B, RETURN, home=home(3, 16, 0)), SQUARE, [NO_ALTITUDE]),
        (wpl(START, A, B, RETURN, home=home(0, 0, 488)), SQUARE, []),
        (wpl(START, A, B, RETURN).replace("110", "120"), SQUARE, []),
        # numbers
        (rows((0, ABSOLUTE), (2, TAKE_OFF), (3, row(16, north=20.0)), (9, row(177, 3, 1)), (10, RETURN)), "up 5, 10@5, 10@5, 0@5, land 0", [NUMBERS]),
        (wpl(TAKE_OFF, A, B, RETURN).replace("\n3\t", "\n2\t"), SQUARE, [NUMBERS]),
        (wpl(TAKE_OFF, A, B, RETURN).replace("\n2\t", "\n7\t").replace("\n3\t", "\n7\t"), SQUARE, [NUMBERS]),
        (with_ids(plan(TAKE_OFF, A, B, RETURN), 1, 1, 1, 1), SQUARE, ["doJumpId: some appear twice"]),
        (with_ids(plan(TAKE_OFF, A, B, row(177, 3, 1), RETURN), 1, 3, 4, 1, 2), "up 5, 10@5, 20@5, 10@5, 20@5, 0@5, land 0", ["doJumpId: some"]),
        # altitude 0
        (wpl(TAKE_OFF, row(16, north=10.0, alt=0), row(16, north=20.0, alt=0), RETURN), SQUARE, [f"rows 2 and 3 (NAV_WAYPOINT): {KEEPS}"]),
        (plan(TAKE_OFF, row(82, north=10.0, alt=0), row(19, north=20.0, alt=0), RETURN, **ARDUPILOT), SQUARE, [f"items 2 and 3 (NAV_SPLINE_WAYPOINT, NAV_LOITER_TIME): {KEEPS}"]),
        (wpl(TAKE_OFF, row(16, north=10.0, alt=0, frame=0), B, RETURN), SQUARE, [KEEPS]),
        # landing below the ground, take-off within the pad
        (plan(TAKE_OFF, A, row(21, north=20.0, alt=-1)), "up 5, 10@5, 20@5, land 20", ["altitude -1 m left out"]),
        (wpl(TAKE_OFF, A, row(21, north=20.0, alt=400, frame=0)), "up 5, 10@5, 20@5, land 20", ["altitude 400 m left out"]),
        (plan(row(22, alt=0.2), A, RETURN), "up 0.4, 10@5, 0@5, land 0", ["altitude 0.2 m raised to 0.4 m"]),
        (wpl(row(22, alt=0), A, RETURN), "up 0.4, 10@5, 0@5, land 0", ["altitude 0 m raised to 0.4 m"]),
        (wpl(row(22, alt=488.1, frame=0), A, RETURN), "up 0.4, 10@5, 0@5, land 0", ["altitude 488.1 m raised to 0.4 m"]),
        # autocontinue
        (wpl(TAKE_OFF, A, B, RETURN).replace("\t1\n", "\t0\n"), SQUARE, ["rows 1, 2 and 3 (NAV_TAKEOFF, NAV_WAYPOINT): autocontinue is off: flown on"]),
        (paused(plan(TAKE_OFF, A, B, RETURN, **ARDUPILOT)), SQUARE, ["autocontinue is off: flown on"]),
        (paused(plan(TAKE_OFF, A, B, RETURN, **PX4)), "up 5, 0@5, hold", ["items 1, 2 and 3 (NAV_TAKEOFF, NAV_WAYPOINT): autocontinue is off: holds", "items 2, 3 and 4 (NAV_WAYPOINT, NAV_RETURN_TO_LAUNCH): never reached"]),
        (paused(plan(TAKE_OFF, A)), "up 5, 0@5, hold", ["items 1 and 2 (NAV_TAKEOFF, NAV_WAYPOINT): autocontinue is off: holds", "item 2 (NAV_WAYPOINT): never reached"]),
        (rows((0, START), (1, A), autocontinue=0), "up 5, 0@5, hold", [FIRST_ITEM, "rows 0 and 1 (NAV_TAKEOFF, NAV_WAYPOINT): autocontinue is off: holds", "row 1 (NAV_WAYPOINT): never reached", NO_ALTITUDE]),
        # after the landing
        (wpl(TAKE_OFF, A, RETURN, B), "up 5, 10@5, 0@5, land 0", ["row 4 (NAV_WAYPOINT): never reached"]),
        (plan(TAKE_OFF, A, row(21, alt=0), B, LAND), "up 5, 10@5, land 10, up 5, 20@5, 0@5, land 0", ["item 4 (NAV_WAYPOINT): no take-off before it: takes off to 5 m first"]),
        (plan(TAKE_OFF, A, row(21, alt=0), row(93, 5), LAND), "up 5, 10@5, land 10", ["items 4 and 5 (NAV_DELAY, NAV_LAND): never reached"]),
        (wpl(TAKE_OFF, LAND, TAKE_OFF, LAND), "up 5, land 0, up 5, land 0", []),
        (plan(TAKE_OFF, A, RETURN, row(93, 5), TAKE_OFF, B, RETURN), "up 5, 10@5, 0@5, land 0, stand 5, up 5, 20@5, 0@5", []),
        (wpl(TAKE_OFF, A, row(21, alt=0), row(178, 1, 1), row(177, 1, -1)), "up 5, 10@5, land 10, up 5, 10@5, land 10, up 5, 10@5", ["row 5 (DO_JUMP): repeats the items from line 3: row 1 (NAV_TAKEOFF) on until stopped"]),
        # grippers and winches
        (plan(row(211, 2, 0), TAKE_OFF, A, row(21, alt=0), row(93, 3), row(211, 1, 0), row(93, 4), TAKE_OFF, RETURN), "release 2, up 5, 10@5, land 10, stand 3, release 1, stand 4, up 5", []),
        (plan(TAKE_OFF, LAND, row(42600, 1, 4), TAKE_OFF, A, row(21, alt=0), row(42600, 1, 7)), "up 5, land 0, release 1, up 5, 10@5, land 10, grab 1", []),
        (plan(TAKE_OFF, A, row(42600, 1, 1), row(21, alt=0)), "up 5, 10@5, land 10", ["item 3 (DO_WINCH): action 1 left out"]),
        (plan(TAKE_OFF, row(94, north=10.0, alt=0), B, RETURN), "up 5, 10@5, land 10, release 0, stand 2, up 5, 20@5, 0@5", []),
        (plan(TAKE_OFF, row(94, 7, north=10.0, alt=6), B, RETURN), "up 5, 10@6, land 10, release 0, stand 2, up 6, 20@5, 0@5", []),
        (wpl(TAKE_OFF, A, row(177, 6, -1), RETURN, row(178, 1, 2), B, LAND), "up 5, 10@5, 20@5, 0@5, land 0", ["rows 4 and 5 (NAV_RETURN_TO_LAUNCH, DO_CHANGE_SPEED): never reached"]),
        # fence and rally points without content
        (plan(TAKE_OFF, A, B, RETURN, geoFence={"polygon": [], "version": 1}, rallyPoints={"points": []}), SQUARE, []),
        (plan(TAKE_OFF, A, B, RETURN, geoFence={}, rallyPoints={"points": [], "version": 7}), SQUARE, []),
        # left out
        (wpl(TAKE_OFF, A, row(115, 90), row(218, 28, 2), B, RETURN), SQUARE, ["rows 3 and 4 (CONDITION_YAW, DO_AUX_FUNCTION): left out"]),
        (plan(TAKE_OFF, *[row(2500)] * 43, A, B, RETURN), SQUARE, ["items 2, 3, 4 and 40 more (VIDEO_START_CAPTURE): left out"]),
        (plan(TAKE_OFF, row(31, 0, 50, north=10.0, alt=8), row(31, alt=5), RETURN), "up 5, 10@8, 10@5, 0@5, land 0", ["item 2 (NAV_LOITER_TO_ALT): radius 50 m left out"]),
        (wpl(TAKE_OFF, row(31, north=10.0, alt=0), B, RETURN), SQUARE, [KEEPS]),
        (wpl(TAKE_OFF, *(row(16, 0, 0, 0, yaw, north=10.0 * i) for i, yaw in ((1, 45), (2, 270), (0, 90))), RETURN), "up 5, 10@5, 20@5, 0@5, land 0", ["rows 2, 3 and 4 (NAV_WAYPOINT): heading 45 to 270 deg left out"]),
        # altitudes above mean sea level
        (wpl(row(22, alt=586, frame=0), A, RETURN, home=home(0, 16, 0)), "up 586, 10@5, 0@5, land 0", ["586 m above mean sea level, and home at 0 m: climbs 586 m"]),
        (plan(row(22, alt=700, frame=5), A, RETURN), "up 212, 10@5, 0@5, land 0", ["700 m above mean sea level, and home at 488 m: climbs 212 m"]),
        (plan(row(22, alt=500, frame=0), A, RETURN), "up 12, 10@5, 0@5, land 0", []),
        # endless
        (wpl(TAKE_OFF, A, B, row(177, 2, -1)), "up 5, 10@5, 20@5, 10@5, 20@5, 10@5, 20@5, 10@5", ["row 4 (DO_JUMP): repeats the items from line 4: row 2 (NAV_WAYPOINT) on until stopped"]),
        (plan(TAKE_OFF, row(600, 3), A, B, row(601, 3, -1)), "up 5, 10@5, 20@5, 10@5, 20@5, 10@5, 20@5, 10@5", ["repeats the items from item 3 (NAV_WAYPOINT)"]),
    ],
)  # fmt: skip
def test_mission_is_flown_and_noted(
    tmp_path: Path, content: str | dict[str, Any], expected: str, notes: list[str]
) -> None:
    mission = read(tmp_path, content)
    assert flown(mission) == expected
    assert len(mission.notes) == len(notes), mission.notes
    assert all(part in note for part, note in zip(notes, mission.notes, strict=True)), mission.notes


FENCE = {"geoFence__polygons": [area(5)], "geoFence__version": 2}
OLD = '{"MAV_AUTOPILOT": 12, "complexItems": [], "items": [], "plannedHomePosition": {}, "version": "1.0"}'


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (rows((0, TAKE_OFF), (1, row(203, north=9.0)), (2, RETURN)), ": home: no row gives a place"),
        (rows((0, ABSOLUTE), (1, row(203)), (2, row(200))), ": nothing to fly: there is no waypoint"),
        (rows((0, row(22, north=0.0, alt=15.0, frame=5)), (1, row(16, north=9.0, alt=15.0, frame=5))), ": rows 0 and 1 (NAV_TAKEOFF, NAV_WAYPOINT): altitude: is above mean sea level, but home has no altitude"),
        (plan(row(203), row(178, 1, 2), mission__plannedHomePosition=[0, 0, 0]), ": mission.items: nothing to fly: there is no waypoint"),
        (plan(row(203), row(2000)), ": mission.items: nothing to fly: there is no waypoint"),
        (wpl(row(5001, 3, north=1.0), row(5001, 3, north=5.0), row(5001, 3, north=9.0)), ": a fence, not a mission: nothing to fly"),
        (rows((0, row(5003, 9, north=1.0)), (1, row(5004, 9, north=1.0))), ": a fence, not a mission: nothing to fly"),
        (plan(**FENCE), ": a fence, not a mission: nothing to fly"),
        (plan(mission=None, geoFence__circles=[CIRCLE]), ": a fence, not a mission: nothing to fly"),
        (wpl(row(5100, north=1.0)), ": rally points, not a mission: nothing to fly"),
        (plan(TAKE_OFF, A, fileType="Mission"), ": an old .mission file of QGroundControl"),
        (OLD, ": an old .mission file of QGroundControl: open it there and save it as .plan"),
        (plan(TAKE_OFF, A, geoFence={"polygon": [[1, 2]], "version": 1}), ": geoFence: version 1 is not supported, only 2"),
        (plan(TAKE_OFF, A, geoFence={"circles": [CIRCLE]}), ": geoFence: version null is not supported, only 2"),
        (plan(TAKE_OFF, A, rallyPoints={"points": [[47, 8, 1]], "version": 1}), ": rallyPoints: version 1 is not supported, only 2"),
        (wpl(TAKE_OFF, A, B, row(177, 2, 1), RETURN).replace("\n3\t", "\n2\t"), ": line 6: row 4 (DO_JUMP): param 1 (target): 2: there are 2 such items"),
        (with_ids(plan(TAKE_OFF, A, B, row(177, 5, 1)), 1, 5, 5, 4), ": item 4 (DO_JUMP): param 1 (target): 5: there are 2 such items"),
        (wpl(TAKE_OFF, A, row(177, 3, 1)).replace("\n3\t", "\n4\t"), ": line 5: row 4 (DO_JUMP): param 1 (target): 3: there is no such item"),
        (plan(TAKE_OFF, row(16, north=10.0, alt=0), **PX4), ": item 2 (NAV_WAYPOINT): altitude: 0 m: on the ground, where the payload's centre is at 0.3 m"),
        (rows((0, START), (1, row(16, north=10.0, alt=0))), ": line 3: row 1 (NAV_WAYPOINT): altitude: 0 m: on the ground, where the payload's centre is at 0.3 m"),
        (plan(row(22, alt=-1), A), ": item 1 (NAV_TAKEOFF): altitude: below ground: 1 m lower than home"),
        (plan(TAKE_OFF, A, row(211, 1, 0), RETURN), ": item 3 (DO_GRIPPER): command: unloading in the air: the payload must land before it (NAV_LAND)"),
        (plan(TAKE_OFF, LAND, TAKE_OFF, row(42600, 1, 7), RETURN), ": item 4 (DO_WINCH): command: loading in the air"),
        (plan(TAKE_OFF, LAND, row(211, 3, 0), TAKE_OFF), ": item 3 (DO_GRIPPER): param 1 (gripper): 3: the system file has 1, 2"),
        (plan(TAKE_OFF, LAND, row(211, 1, 5), TAKE_OFF), ": item 3 (DO_GRIPPER): param 2 (action): 5 is neither 0, release, nor 1, grab"),
        (plan(TAKE_OFF, row(94, 2, north=9.0, alt=0), RETURN), ": item 2 (NAV_PAYLOAD_PLACE): param 1 (maximum descent): the ground is 4.70 m below (limit 2 m)"),
        (plan(TAKE_OFF, LAND, row(16, north=9.0, alt=None)), ": item 3 (NAV_WAYPOINT): altitude: the payload is on the ground, and no altitude is given to take off to"),
        (plan(TAKE_OFF, *[row(16, north=5.0, alt=-z) for z in (1, 9, 4, 2)]), ": items 2, 3, 4 and 1 more (NAV_WAYPOINT): altitude: below ground: 1 to 9 m lower than home"),
        (with_ids(plan(TAKE_OFF, A), 1, 10**30), ": item 2: doJumpId: must be less than 4294967296, found 1000000000000000000000000000000"),
    ],
)  # fmt: skip
def test_mission_is_refused_by_one_line(tmp_path: Path, content: str | dict[str, Any], reason: str) -> None:
    name = "mission.plan" if isinstance(content, dict) or content.startswith("{") else "mission.waypoints"
    (line,) = refusal(tmp_path, content, name)
    assert line.startswith(f"{tmp_path / name}{reason}"), line
