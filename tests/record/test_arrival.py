"""Arrival at waypoints and landing place, and what is in the way, on records that are written by hand."""

from __future__ import annotations

import json
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from flights import system_file
from truth_rows import write_state

from gcs.app.exit_status import ExitStatus
from gcs.app.fly import flight_result
from gcs.flight.alarms import AlarmLog
from gcs.mission.read import read_mission
from gcs.mission.targets import Target, targets_of
from gcs.record.arrival import closest_in_order
from gcs.record.run_data import read_run
from gcs.record.run_folder import open_run_folder, write_manifest
from idc_controller.geometry.shapes import Pole
from vehicle_sim.world.obstacle_bodies import Obstacle
from vehicle_sim.world.truth_log import TruthLog
from vehicle_sim.world.world_state import UavState, WorldState

LEVEL, REST = (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
GROUND, PAD = -0.25, -0.30  # m, the centre of a payload that stands there
CORNERS = np.array([[x, y, -3.4] for x in (-0.5, 0.5) for y in (-0.5, 0.5)])

MISSION = """
[mission]
name = "there"

[reference]
kind = "waypoints"
points = {points}
return_home = {home}
{limits}
"""


def mission_in(folder, points, limits="", home=False):
    system_file(folder)
    path = folder / "there.toml"
    path.write_text(MISSION.format(points=points, limits=limits, home=str(home).lower()))
    return read_mission(path)


def path_through(*places):
    """Rows 0.05 m apart on straight lines: (T, 3)."""
    rows = []
    for a, b in pairwise(places):
        number = max(int(np.ceil(np.linalg.norm(np.subtract(b, a)) / 0.05)), 1)
        rows += [np.array(a) + (np.array(b) - a) * k / number for k in range(number)]
    return np.array([*rows, *[np.array(places[-1], dtype=float)] * 5])


def fly(folder, mission, path, contacts=(), obstacles=(), reason="", completed=True, interrupted=False, landed=True):
    """The result of a flight along ``path`` (T, 3), thirty rows a second."""
    folder = open_run_folder("", folder)
    write_manifest(folder, command=[], seed=1, mission=mission, system=mission.system, start="then")
    with TruthLog(folder, 4) as log:
        for k, place in enumerate(path):
            moving = 0 < k < len(path) - 4
            uavs = tuple(UavState(tuple(place + c), LEVEL, REST, REST, 14.5 * moving, False) for c in CORNERS)
            state = WorldState(k / 30.0, tuple(place), LEVEL, REST, REST, uavs)
            write_state(log, state, int(k in contacts), obstacles)
    failsafes = SimpleNamespace(time=1.0 if reason else np.nan, interrupted=interrupted, alarms=AlarmLog())
    flown = SimpleNamespace(
        completed=completed and not reason,
        landed=landed,
        takeoff_time=0.0,
        reason=reason,
        failsafes=failsafes,
        is_redirected=False,
    )
    return flight_result(folder, mission, SimpleNamespace(flight=flown), 9.0, 1.0)


def straight(end):
    """From the pad to ``end`` (north, east) at 4 m, and down there."""
    return path_through((0, 0, PAD), (0, 0, -4), (*end, -4), (*end, GROUND))


@pytest.mark.parametrize("limits", ["", "[limits]\npayload_tilt_deg = 5.0\n"])
@pytest.mark.parametrize(("short", "status"), [(0.29, ExitStatus.DONE), (0.31, ExitStatus.OUTSIDE_LIMITS)])
def test_flight_is_completed_when_it_has_come_to_its_last_waypoint(tmp_path, limits, short, status):
    # The landing is where it was planned: the waypoint alone was missed.
    path = path_through((0, 0, PAD), (0, 0, -4), (8 - short, 0, -4), (0, 0, -4), (0, 0, GROUND))
    result = fly(tmp_path / "run", mission_in(tmp_path, [[8.0, 0.0, -4.0]], limits, home=True), path)
    summary = result.summary
    assert result.exit_code == status
    assert summary["completed"] == (status == ExitStatus.DONE)
    assert summary["outcome"] == ("completed" if summary["completed"] else "failed")
    assert summary["limits"]["arrival"] == {
        "value": pytest.approx(short, abs=1e-6), "limit": 0.3, "held": status == ExitStatus.DONE,
    }  # fmt: skip
    assert summary["reason"] == result.reason == ("" if summary["completed"] else "waypoint 1 missed by 0.31 m")


@pytest.mark.parametrize(("off", "completed"), [(0.29, True), (0.31, False)])
def test_flight_is_completed_when_it_has_landed_at_its_place(tmp_path, off, completed):
    path = path_through((0, 0, PAD), (0, 0, -4), (8, 0, -4), (8, off, -4), (8, off, GROUND))
    summary = fly(tmp_path / "run", mission_in(tmp_path, [[8.0, 0.0, -4.0]]), path).summary
    assert summary["completed"] == completed
    assert summary["reason"] == ("" if completed else "the landing place missed by 0.31 m")


def test_tolerance_of_arrival_is_the_mission_s(tmp_path):
    mission = mission_in(tmp_path, [[8.0, 0.0, -4.0]], "[limits]\narrival = 0.7\n")
    assert fly(tmp_path / "run", mission, straight((7.4, 0.0))).exit_code == ExitStatus.DONE


def test_obstacle_and_fence_in_the_way_of_a_waypoint_are_named(tmp_path):
    pole = Obstacle("mast", Pole(0.3, 12.0), (9.4, 0.0, -6.0))
    mission = mission_in(tmp_path, [[4.0, 0.0, -4.0], [8.0, 0.0, -4.0]])
    result = fly(tmp_path / "pole", mission, straight((7.4, 0.0)), obstacles=[pole])
    # The discs of the first two vehicles reach 0.3 m beyond them, half a metre ahead of the payload.
    assert result.exit_code == ExitStatus.OUTSIDE_LIMITS
    missed = "waypoint 2 missed by 0.60 m: mast is 0.30 m from the formation there, 0.60 m are kept, 0.30 m are missing"
    assert result.reason == f"{missed}; 1 more missed"

    fenced = mission_in(tmp_path, [[8.0, 0.0, -4.0]])
    object.__setattr__(fenced, "boundary", (((-5.0, -5.0), (-5.0, 5.0), (8.04, 5.0), (8.04, -5.0)),))
    result = fly(tmp_path / "fence", fenced, straight((6.93, 0.0)))
    assert result.reason.startswith(
        "waypoint 1 missed by 1.07 m: the fence (boundary edge 3) is in the way of the formation there"
    )
    assert result.summary["clearance_min_m"] == pytest.approx(8.04 - 6.93 - 0.8, abs=1e-6)
    far = fly(tmp_path / "far", mission, straight((7.4, 0.0)))
    assert far.reason == "waypoint 2 missed by 0.60 m; 1 more missed" and far.summary["clearance_min_m"] is None


def test_clearance_counts_from_lift_off_to_touch_down(tmp_path):
    """Of a stub near the landing place, which only the descent comes near to."""
    mission = mission_in(tmp_path, [[8.0, 0.0, -4.0]])
    low = Obstacle("stub", Pole(0.2, 0.4), (8.0, 1.0, -0.2))
    summary = fly(tmp_path / "run", mission, straight((8.0, 0.0)), obstacles=[low]).summary
    # From the payload's lower edge the hull leans out to the rim of the discs, 0.3 m farther and 3.65 m higher.
    expected = (1.0 - 0.5 - 0.2 - 0.3 * 0.4 / 3.65) * np.cos(np.arctan(0.3 / 3.65))
    assert summary["clearance_min_m"] == pytest.approx(expected, abs=1e-5)
    run = tmp_path / "after"
    path = np.vstack([straight((8.0, 0.0)), np.tile([8.0, 0.6, GROUND], (10, 1))])  # pushed there on the ground
    assert fly(run, mission, path, obstacles=[low]).summary["clearance_min_m"] == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize(
    ("options", "outcome", "reason"),
    [
        ({"reason": "interrupted", "interrupted": True}, "interrupted", "interrupted"),
        ({"reason": "the path is blocked by mast"}, "aborted", "the path is blocked by mast"),
        ({"contacts": (60, 61)}, "collided", "contact at 2.0 s: the ground, or each other"),
        ({"landed": False, "completed": False, "reason": "no message"}, "aborted", "no message"),
    ],
)
def test_outcomes_are_distinct(tmp_path, options, outcome, reason):
    mission = mission_in(tmp_path, [[8.0, 0.0, -4.0]])
    result = fly(tmp_path / "run", mission, straight((8.0, 0.0)), **options)
    written = json.loads((tmp_path / "run" / "summary.json").read_text())
    assert (written["outcome"], written["reason"]) == (outcome, reason)
    assert result.exit_code == (ExitStatus.INTERRUPTED if options.get("interrupted") else ExitStatus.OUTSIDE_LIMITS)
    assert "arrival" not in written["limits"] or outcome == "collided"


def test_flight_cut_off_in_the_air_is_lost(tmp_path):
    mission = mission_in(tmp_path, [[8.0, 0.0, -4.0]])
    path = straight((8.0, 0.0))[:100]
    result = fly(tmp_path / "run", mission, path, reason="vehicle-sim was killed", landed=False)
    assert result.summary["outcome"] == "lost"
    assert result.reason.endswith("the records end at 3.3 s; vehicle-sim was killed")


def test_obstacle_that_the_ground_calls_by_a_number_is_identified(tmp_path):
    mission = mission_in(tmp_path, [[8.0, 0.0, -4.0]])
    poles = [Obstacle("far", Pole(0.3, 12.0), (0.0, 9.0, -6.0)), Obstacle("mast", Pole(0.3, 12.0), (0.0, 2.0, -6.0))]
    reason = "the path is blocked by piece 7"
    result = fly(tmp_path / "a", mission, straight((8.0, 0.0)), obstacles=poles, reason=reason)
    # Broken off after 1 s, above the pad.
    assert result.reason == f"{reason} (nearest then: mast, 0.90 m from the formation)"
    assert result.summary["outcome"] == "aborted"
    result = fly(tmp_path / "b", mission, straight((8.0, 0.0)), obstacles=poles, reason="the path is blocked by mast")
    assert result.reason == "the path is blocked by mast"


def test_contact_names_what_was_touched(tmp_path):
    mission = mission_in(tmp_path, [[8.0, 0.0, -4.0]])
    pole = Obstacle("mast", Pole(0.3, 12.0), (9.1, 0.0, -6.0))
    path = straight((8.0, 0.0))
    first = int(np.argmax(path[:, 0] > 7.99))
    result = fly(tmp_path / "run", mission, path, contacts=range(first, first + 9), obstacles=[pole])
    assert result.summary["outcome"] == "collided"
    assert result.reason == f"contact at {first / 30.0:.1f} s: mast"


def place(name, *position):
    return Target(name, position)


def test_waypoints_are_passed_in_their_order():
    a, b, c = place("a", 5.0, 0.0, -4.0), place("b", 10.0, 0.0, -4.0), place("c", 5.0, 0.1, -4.0)
    path = path_through((0, 0, -4), (10, 0, -4), (0, 0, -4))
    rows, distances = closest_in_order(path, [a, b, c], 0.3)
    assert path[rows][:, 0] == pytest.approx([5.0, 10.0, 5.0], abs=0.051)
    assert distances == pytest.approx([0.0, 0.0, 0.1], abs=1e-6)
    # Passed in another order than asked: the one that costs least counts as missed.
    _, distances = closest_in_order(path_through((0, 0, -4), (10, 0, -4)), [a, b, c], 0.3)
    assert distances[:2] == pytest.approx([0.0, 0.0], abs=1e-6) and distances[2] == pytest.approx(5.0, abs=0.051)


def test_missed_waypoint_is_not_reached_on_the_way_back():
    """Its place is passed in the end, but after the one that comes next."""
    path = path_through((0, 0, -4), (5, 0.8, -4), (10, 0, -4), (5, 0, -4), (0, 0, -4))
    targets = [place("a", 5.0, 0.0, -4.0), place("b", 10.0, 0.0, -4.0)]
    _, distances = closest_in_order(path, targets, 0.3)
    assert distances[0] == pytest.approx(0.79, abs=0.02) and distances[1] == pytest.approx(0.0, abs=1e-6)


def test_distance_is_that_of_the_way_between_two_rows():
    _, [distance] = closest_in_order(np.array([[0.0, 0.2, 0.0], [4.0, 0.2, 0.0]]), [place("a", 2.0, 0.0, 0.0)], 0.3)
    assert distance == pytest.approx(0.2)
    assert closest_in_order(np.zeros((3, 3)), [], 0.3)[1].size == 0


def test_targets_have_the_numbers_of_the_file(tmp_path):
    file = tmp_path / "square.waypoints"
    rows = [(16, 0), (22, 4), (16, 4), (18, 4), (20, 0)]
    text = ["QGC WPL 110"]
    for i, (command, altitude) in enumerate(rows):
        p1, radius = (1, 3) if command == 18 else (0, 0)
        text.append(f"{i} 0 {0 if i == 0 else 3} {command} {p1} 0 {radius} 0 47.4 {8.5 + 1e-4 * i} {altitude} 1")
    file.write_text("\n".join(text) + "\n")
    targets = targets_of(read_mission(file))
    assert [target.name for target in targets.waypoints] == [
        "take-off altitude (row 1)", "waypoint 1", "waypoint 2", "waypoint 3", "end of the circle about waypoint 3",
        "waypoint 4",
    ]  # fmt: skip
    assert targets.landing == (0.0, 0.0) and targets.waypoints[0].is_climb


def test_curve_is_to_be_left_for_where_it_began(tmp_path):
    mission = tmp_path / "curve.toml"
    mission.write_text(
        '[mission]\nname = "c"\n[reference]\nkind = "lissajous"\namplitude = [6.0, 3.0]\nangular_frequency = 0.5\n'
        "altitude = 2.0\nduration = 5.0\n"
    )
    system_file(tmp_path)
    mission = read_mission(mission)
    up = path_through((0.4, 0, PAD), (0.4, 0, -2), (6, 0, -2), (0.4, 0, -2), (0.4, 0, PAD))
    assert fly(tmp_path / "run", mission, up).exit_code == ExitStatus.DONE
    low = path_through((0.4, 0, PAD), (0.4, 0, -1.5), (0.4, 0, PAD))
    assert fly(tmp_path / "low", mission, low).reason == "the curve's altitude missed by 0.50 m"


def test_records_without_truth_are_judged_by_the_estimate(tmp_path):
    mission = mission_in(tmp_path, [[8.0, 0.0, -4.0]])
    fly(tmp_path / "run", mission, straight((7.5, 0.0)))
    run = read_run(tmp_path / "run")
    rows = ["time_s,payload_x_m,payload_y_m,payload_z_m,payload_qw,payload_qx,payload_qy,payload_qz,"
            "payload_vx_mps,payload_vy_mps,payload_vz_mps,payload_wx_radps,payload_wy_radps,payload_wz_radps,"
            "disturbance_x_n,disturbance_y_n,disturbance_z_n"]  # fmt: skip
    rows += [",".join(map(str, [k / 20.0, *p, 1, *[0] * 12])) for k, p in enumerate(run.payload_position.tolist())]
    folder = tmp_path / "estimate"
    folder.mkdir()
    (folder / "estimate.csv").write_text("\n".join([*rows, ""]))
    failsafes = SimpleNamespace(time=np.nan, interrupted=False, alarms=AlarmLog())
    flown = SimpleNamespace(
        completed=True, landed=True, takeoff_time=0.0, reason="", failsafes=failsafes, is_redirected=False
    )
    result = flight_result(folder, mission, SimpleNamespace(flight=flown), 9.0, 1.0)
    assert result.summary["source"] == "estimate" and result.reason.startswith("waypoint 1 missed by 0.50 m")


def test_passage_at_the_tolerance_itself_counts_in_both_directions():
    rng = np.random.default_rng(1)
    for _ in range(300):
        path = np.cumsum(rng.normal(size=(30, 3)), axis=0)
        target = Target("waypoint", tuple(rng.normal(size=3)))
        [row], [away] = closest_in_order(path, [target], 0.0)
        [_], [again] = closest_in_order(path, [target], away)
        assert 0 <= row < len(path) - 1 and again <= away
