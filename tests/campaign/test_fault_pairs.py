"""Campaigns of faults alone and in ordered pairs: the sample, what is drawn, the file, the verdict, the report."""

import csv
from itertools import combinations, permutations
from pathlib import Path

import numpy as np
import pytest

from gcs.app.cli import main
from gcs.campaign.faults.campaign_file import read_campaign
from gcs.campaign.faults.fault_pairs import covering_sample
from gcs.campaign.faults.judgement import DISARMED, SAFE, meets, vehicles_armed_at_end
from gcs.campaign.faults.plans import FaultFlights
from gcs.campaign.result import Result
from gcs.record.modes import armed_at_end

MISSIONS = Path(__file__).parents[2] / "missions"
GRID = MISSIONS / "failsafe_grid.toml"
PHASES = {"arm", "spool_up", "climb", "hold", "fly", "land", "spool_down", "disarm"}
NAMES = {
    "ground lost", "telemetry of one lost", "commands of one lost", "link slow", "position of one lost",
    "position of all lost", "attitude of one off", "wind", "load lighter",
}  # fmt: skip
SMALL = """
[campaign]
name = "small"
missions = ["hop_north.toml"]
seeds = [7]
require = "safe and disarmed"

[pairs]
delays = [0.3, 1.0]
phases = {{ climb = 3.0, disarm = 0.0 }}

[[fault]]
name = "a"
kind = "partition"
{first}

[[fault]]
name = "b"
kind = "latency"
delay = 0.1
"""
WIND_ONLY = """
[campaign]
name = "wind"
missions = ["hop_north.toml"]
seeds = [7]

[pairs]
wind = [4.0]
phases = {{ climb = 3.0 }}

[[fault]]
{first}
kind = "wind"
velocity = [1.0, 0.0, 0.0]
"""


@pytest.fixture(scope="module")
def grid():
    return read_campaign(GRID)


def small(folder, first="one_vehicle = true", text=SMALL):
    for name in ("hop_north.toml", "system.toml"):
        (folder / name).write_text((MISSIONS / name).read_text())
    path = folder / "small.toml"
    path.write_text(text.format(first=first))
    return path


def test_grid_has_every_loss_alone_and_every_ordered_pair(grid):
    found = {(case.factors["first"], case.factors["second"]) for case in grid.cases}
    assert {*permutations(NAMES, 2)} | {(name, "") for name in NAMES} <= found
    assert all(first != second for first, second in found)
    assert 135 <= len(grid.cases) <= 165 and grid.require == DISARMED


def test_grid_has_every_loss_in_every_phase_at_its_start_and_within(grid):
    moments = {(phase, within) for phase in PHASES for within in (False, True)} - {("arm", True), ("disarm", True)}
    for place in ("first", "second"):
        found = {(case.factors[place], case.factors["phase"], case.factors["within"]) for case in grid.cases}
        assert {(name, *moment) for name in NAMES for moment in moments} <= found


def test_wind_of_flights_with_a_lighter_load_is_as_strong_as_can_be_flown_with_it(grid):
    speeds = {True: set(), False: set()}
    for case in grid.cases:
        light = "load lighter" in (case.factors["first"], case.factors["second"])
        speeds[light] |= {round(float(np.hypot(*swept.fault.settings["velocity"][:2])), 1)
                          for swept in case.faults if swept.fault.kind == "wind"}  # fmt: skip
        assert "wind 4" not in case.severity or not light
    assert speeds == {True: {2.5}, False: {4.0}}


def test_grid_covers_every_two_values_of_any_two_factors(grid):
    keys = ("first", "second", "phase", "delay", "wind")
    values = {
        "first": NAMES,
        "second": {"", *NAMES},
        "phase": PHASES,
        "delay": {0.0, 0.3, 1.0, 3.0},
        "wind": {0.0, 4.0},
    }
    impossible = {("first", "wind", "wind", 4.0), ("second", "wind", "wind", 4.0)}
    impossible |= {("second", "", "delay", delay) for delay in (0.3, 1.0, 3.0)}
    impossible |= {("first", name, "second", name) for name in NAMES}
    wanted = {(a, x, b, y) for a, b in combinations(keys, 2) for x in values[a] for y in values[b]}
    found = {(a, case.factors[a], b, case.factors[b]) for case in grid.cases for a, b in combinations(keys, 2)}
    assert found == wanted - impossible


def test_faults_of_a_case_are_placed_by_its_factors(grid):
    for case in grid.cases:
        factors, faults = case.factors, [swept.fault for swept in case.faults]
        steady = [fault for fault in faults if fault.start_phase is None]
        assert len(steady) == (factors["wind"] > 0)
        for fault in steady:
            assert (fault.kind, fault.start, fault.settings["rise"]) == ("wind", 0.0, 0.0)
            speed = 2.5 if "load lighter" in (factors["first"], factors["second"]) else factors["wind"]
            assert np.hypot(*fault.settings["velocity"][:2]) == pytest.approx(speed, abs=0.01)
        starts = sorted({fault.start_offset for fault in faults if fault not in steady})
        assert (starts[0] >= 0.1) if factors["within"] else (starts[0] == 0.0)
        assert starts[-1] == pytest.approx(starts[0] + (factors["delay"] if factors["second"] else 0.0))
        assert {fault.start_phase for fault in faults if fault not in steady} == {factors["phase"]}


def test_vehicles_are_drawn_and_seeds_are_those_of_the_flights(grid):
    drawn = [swept.fault.vehicles for case in grid.cases for swept in case.faults if swept.fault.vehicles]
    assert {*drawn} == {(1,), (2,), (3,), (4,)}
    assert [grid.seeds_of(case) for case in grid.cases] == [(4101 + i,) for i in range(len(grid.cases))]


def test_equal_seeds_give_equal_samples_and_others_other_ones(tmp_path, grid):
    assert read_campaign(GRID).cases == grid.cases
    for name in ("hop_north.toml", "system.toml"):
        (tmp_path / name).write_text((MISSIONS / name).read_text())
    (tmp_path / "other.toml").write_text(GRID.read_text().replace("seeds = [4101]", "seeds = [4102]"))
    other = read_campaign(tmp_path / "other.toml").cases
    assert [case.factors for case in other] != [case.factors for case in grid.cases]
    plans = [[plan.name for plan in FaultFlights(file).plans(tmp_path)] for file in (grid, read_campaign(GRID))]
    assert plans[0] == plans[1] and len({*plans[0]}) == len(grid.cases)


def test_sample_has_all_pairs_that_are_allowed_and_no_row_that_is_not():
    factors = [range(4), range(3), range(2), range(5)]

    def allowed(row):
        return row[0] != row[1] and (row[2] == 0 or row[3] != 4)

    rows = covering_sample(factors, allowed, np.random.default_rng(1))
    assert all(map(allowed, rows))
    for i, j in combinations(range(4), 2):
        possible = {(row[i], row[j]) for row in np.ndindex(4, 3, 2, 5) if allowed(row)}
        assert {(row[i], row[j]) for row in rows} == possible
    assert len(rows) < 4 * 5 + 5


@pytest.mark.parametrize(
    ("first", "text", "reason"),
    [
        ("start = 1.0", SMALL, "fault[1].start: [pairs] says when faults start"),
        ('start_phase = "climb"', SMALL, "fault[1].start_phase: [pairs] says when faults start"),
        ("start_between = [1.0, 2.0]", SMALL, "fault[1].start_between: [pairs] says when faults start"),
        ("one_vehicle = true\nvehicles = [2]", SMALL, "fault[1].one_vehicle: goes without vehicles"),
        ("wind_max = -1.0", SMALL, "fault[1].wind_max"),
        ("wind_max = 2.0\nstart = 1.0",
         SMALL.replace("[pairs]\ndelays = [0.3, 1.0]\nphases = {{ climb = 3.0, disarm = 0.0 }}\n", "")
         .replace("delay = 0.1", "delay = 0.1\nstart = 1.0"), "fault[1].wind_max: goes with [pairs]"),
        ("", SMALL.replace("climb = 3.0", "landing = 3.0"), "pairs.phases"),
        ("", SMALL.replace("delays = [0.3, 1.0]", "delays = []"), "pairs.delays: needs at least 1"),
        ('name = "b"', WIND_ONLY, "pairs: no combination can be flown"),
        ("", SMALL.replace("[0.3, 1.0]", str([0.1 * i for i in range(20)])).replace(
            "climb", ", ".join(f"{name} = 9.0" for name in ("arm", "fly", "land")) + ", climb"
        ) + "".join(f'[[fault]]\nname = "{i}"\nkind = "partition"\n' for i in range(60)), "more than 200000"),
        ("start = 1.0\none_vehicle = true", SMALL.replace("[pairs]", "[limits]\n[other]"), "unknown key"),
        ("start = 1.0\none_vehicle = true",
         SMALL.replace("[pairs]\ndelays = [0.3, 1.0]\nphases = {{ climb = 3.0, disarm = 0.0 }}\n", "")
         .replace("delay = 0.1", "delay = 0.1\nstart = 1.0"), "fault[1].one_vehicle: goes with [pairs]"),
    ],
)  # fmt: skip
def test_unusable_pairs_are_refused_with_their_line(tmp_path, capsys, first, text, reason):
    path = small(tmp_path, first, text)
    assert main(["faults", str(path), "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert reason in said and "line " in said and "Traceback" not in said
    assert not (tmp_path / "out").exists()


def test_vehicle_armed_at_the_end_and_false_completion_do_not_pass(tmp_path):
    landed = Result(outcome="aborted", contacts=0, landed=True, tilt_max_deg=3.0)
    assert meets(DISARMED, landed)
    for change in (
        {"armed_at_end": "2"},
        {"landed": False},
        {"contacts": 1},
        {"failures": "touchdown_speed"},
        {"lean_max_deg": 21.0},
    ):
        assert not meets(DISARMED, Result(**{**vars(landed), **change}))
    short = {**vars(landed), "failures": "arrival"}
    assert meets(DISARMED, Result(**short)) and not meets(DISARMED, Result(**{**short, "outcome": "completed"}))
    assert meets(SAFE, Result(**{**vars(landed), "armed_at_end": "2"}))
    rows = ["time_s,vehicle,mode,armed,failsafe", "0.0,1,HOLD,0,0", "0.0,2,HOLD,0,0", "1.0,1,OFFBOARD,1,0",
            "1.0,2,OFFBOARD,1,0", "9.0,1,HOLD,0,0"]  # fmt: skip
    assert vehicles_armed_at_end(tmp_path) == "unknown"
    assert not meets(DISARMED, Result(**{**vars(landed), "armed_at_end": "unknown"}))
    (tmp_path / "modes.csv").write_text("\n".join(rows) + "\n")
    assert armed_at_end(tmp_path) == [2] and vehicles_armed_at_end(tmp_path) == "2"


def test_report_has_a_row_for_each_value_of_each_factor(tmp_path):
    file = read_campaign(small(tmp_path))
    flights = FaultFlights(file)
    results = [
        Result(number=i, fault=case.name, severity=case.severity, seed=case.seed, outcome="aborted", passed=bool(i % 2))
        for i, case in enumerate(file.cases, start=1)
    ]
    [table], files = flights.report(results, tmp_path)
    assert [path.name for path in files] == ["results.csv", "timing.csv", "pairs.csv", "matrix.png"]
    values = [str(cell) for cell in table.columns[1]._cells]
    assert {"a", "b", "none", "climb", "disarm", "0.3 s", "1 s", "0 m/s"} == {*values}
    with (tmp_path / "pairs.csv").open() as lines:
        rows = [*csv.DictReader(lines)]
    assert [(row["first"], row["second"]) for row in rows] == [
        (case.factors["first"], case.factors["second"]) for case in file.cases
    ]
