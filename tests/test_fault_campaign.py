"""Fault campaigns: the file, what is flown, going on after a kill, statistics and tables."""

import dataclasses
import json
import os
import signal
import subprocess
import sys
import tomllib
from pathlib import Path

import pandas
import pytest
from flight_in_process import HOP, short_figure
from scipy.stats import binomtest

from gcs.cli import main
from gcs.config import UnusableFile
from gcs.errors import UnusableInput
from gcs.fault_campaign import campaign as campaigns
from gcs.fault_campaign.base_mission import read_base
from gcs.fault_campaign.campaign import FaultCampaign, FaultCampaignOptions
from gcs.fault_campaign.campaign_file import read_campaign
from gcs.fault_campaign.outcome import draw_matrix, outcome_table
from gcs.fault_campaign.result import COLUMNS, NOT_FLOWN, VERDICTS, evaluate, stop_time, team_stop
from gcs.fault_campaign.sweep import flights_of
from gcs.fault_campaign.tables import interval, rates_of, write_tables
from gcs.mission import Fault, read_mission
from gcs.mission.model import Limits
from gcs.side_by_side import Ended, sole_flyer

MISSIONS = Path(__file__).parents[1] / "missions"
CAMPAIGN = """
[campaign]
name = "a test"
missions = ["short_figure.toml"]
seeds = [3, 7]

[[fault]]
name = "loss"
kind = "packet_loss"
start = 5.0
severity = { probability = [0.1, 0.3] }

[[fault]]
name = "slow"
kind = "latency"
start = 4.0
duration = 2.0
delay = 0.05
"""


def campaign_file(folder, text=CAMPAIGN):
    short_figure(folder, 2.0, 1.5)
    path = folder / "campaign.toml"
    path.write_text(text)
    return path


def flights(folder, text=CAMPAIGN):
    return list(flights_of(read_campaign(campaign_file(folder, text))))


# The file


def test_every_case_in_every_mission_with_every_seed(tmp_path):
    found = flights(tmp_path, CAMPAIGN.replace('.toml"]', f'.toml", "{MISSIONS}/square.waypoints"]'))
    assert len(found) == 3 * 2 * 2 and [flight.number for flight in found] == list(range(1, 13))
    told = [(f.case.name, f.case.severity, f.mission, f.seed) for f in found[:5]]
    assert told == [
        ("loss", "probability 0.1", "short_figure", 3), ("loss", "probability 0.1", "short_figure", 7),
        ("loss", "probability 0.1", "square", 3), ("loss", "probability 0.1", "square", 7),
        ("loss", "probability 0.3", "short_figure", 3),
    ]  # fmt: skip
    assert len({flight.name for flight in found}) == 12


def test_each_flight_is_a_mission_file(tmp_path):
    file = read_campaign(campaign_file(tmp_path, CAMPAIGN + "\n[limits]\nclearance = 0.4\n"))
    campaign = FaultCampaign(file, FaultCampaignOptions(tmp_path / "out"))
    missions = [read_mission(tmp_path / "out" / "missions" / f"{f.name}.toml") for f in campaign.flights]
    base = read_mission(tmp_path / "short_figure.toml")
    for mission, flight in zip(missions, campaign.flights, strict=True):
        assert (mission.seed, mission.limits) == (flight.seed, Limits(clearance=0.4))
        assert (mission.system, mission.reference) == (base.system, base.reference)
    assert [m.faults[0].settings for m in missions[::2]] == [
        {"probability": 0.1},
        {"probability": 0.3},
        {"delay": 0.05},
    ]
    assert (missions[4].faults[0].start, missions[4].faults[0].duration) == (4.0, 2.0)


@pytest.mark.parametrize("name", ["square.waypoints", "fenced_delivery.plan", "pole_course.toml"])
def test_a_mission_made_of_another_is_the_same_otherwise(name, tmp_path):
    base = read_base(MISSIONS / name)
    base.write_files(tmp_path)
    fault = Fault("packet_loss", 1.0, vehicles=(1, 2), settings={"probability": 0.2})
    (tmp_path / "made.toml").write_text(base.text('a "new"\x7f \N{DUCK}', 5, [fault]))
    made, read = read_mission(tmp_path / "made.toml"), read_mission(MISSIONS / name)
    assert (made.seed, dataclasses.replace(made.faults[0], line=1)) == (5, fault)
    assert made.name == 'a "new"\x7f \N{DUCK}'
    same = dataclasses.replace(made, name=read.name, path=read.path, seed=read.seed, faults=read.faults)
    assert same == read


def test_a_mission_keeps_its_own_faults(tmp_path):
    own = '[[fault]]\nkind = "wind"\nstart = 1.0\nvelocity = [1.0, 0.0, 0.0]\n'
    path = short_figure(tmp_path, 2.0)
    path.write_text(path.read_text() + own)
    faults = tomllib.loads(read_base(path).text("made", 1, [Fault("partition", 2.0)]))["fault"]
    assert [fault["kind"] for fault in faults] == ["wind", "partition"]


def test_tables_of_one_name_are_flown_together(tmp_path):
    text = CAMPAIGN + '[[fault]]\nname = "slow"\nkind = "jitter"\nstart = 4.0\nseverity = { spread = [0.01, 0.02] }\n'
    slow = [flight for flight in flights(tmp_path, text) if flight.case.name == "slow"][::2]
    assert [[f.kind for f in flight.case.faults_for(3)] for flight in slow] == [["latency", "jitter"]] * 2
    assert [flight.case.faults_for(3)[1].settings for flight in slow] == [{"spread": 0.01}, {"spread": 0.02}]
    assert slow[0].case.kind == "latency + jitter"


def test_starts_are_drawn_for_every_seed(tmp_path):
    found = flights(tmp_path, CAMPAIGN.replace("start = 5.0", "start_between = [5.0, 9.0]"))[:4]
    starts = [flight.case.faults_for(flight.seed)[0].start for flight in found]
    assert starts[:2] == starts[2:] and starts[0] != starts[1]  # the same at every severity
    assert all(5.0 <= start <= 9.0 for start in starts)


def test_flights_without_a_fault_and_counted_seeds(tmp_path):
    counted = CAMPAIGN.replace("seeds = [3, 7]", "first_seed = 10\nseed_count = 3\nclean = true")
    found = flights(tmp_path, counted)
    assert [(f.case.name, f.seed, f.case.kind) for f in found[:4]] == [
        ("no fault", 10, ""), ("no fault", 11, ""), ("no fault", 12, ""), ("loss", 10, "packet_loss"),
    ]  # fmt: skip
    assert "[[fault]]" not in found[0].text


def test_the_example_can_be_flown(tmp_path):
    file = read_campaign(MISSIONS / "telemetry_faults.toml")
    campaign = FaultCampaign(file, FaultCampaignOptions(tmp_path / "out"))
    assert campaign.total == 34
    for flight in campaign.flights[::5]:
        read_mission(tmp_path / "out" / "missions" / f"{flight.name}.toml")


SWEEP = "{ probability = [0.1, 0.3] }"


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("seeds = [3, 7]", "seeds = [3]\ncolour = 1", "line 6: campaign.colour: unknown key"),
        ("seeds = [3, 7]", "", "line 2: campaign: needs either seeds or seed_count"),
        ("seeds = [3, 7]", "seeds = [3, 3]", "line 5: campaign.seeds: 3 stands 2 times"),
        ("seeds = [3, 7]", "seeds = [3]\nseed_count = 2", "line 6: campaign.seed_count: seeds are listed already"),
        ("seeds = [3, 7]", "seeds = []", "line 5: campaign.seeds: needs at least 1"),
        ("seeds = [3, 7]", 'seeds = [3]\ncontroller = "pid"', "line 6: campaign.controller: input should be 'idc'"),
        ("short_figure.toml", "long_figure.toml", "line 4: campaign.missions[1]: there is no file long_figure.toml"),
        ("packet_loss", "paket_loss", "line 9: fault[1].kind: there is no kind 'paket_loss': did you mean 'packet"),
        (SWEEP, "{ probability = [0.1, 3] }", "line 11: fault[1].probability: input should be"),
        (SWEEP, "{ share = [0.1] }", "line 11: fault[1].share: unknown key"),
        (SWEEP, "{ probability = 0.1 }", "line 11: fault[1].severity.probability: input should"),
        (SWEEP, "{ probability = [] }", "line 11: fault[1].severity.probability: needs at least"),
        (SWEEP, "{ probability = [0.1, 0.1] }", "'loss': probability 0.1 stands twice"),
        (SWEEP, "{ start = [1.0] }", "line 11: fault[1].severity.start: start stands in the"),
        (SWEEP, "{ kind = ['bias'] }", "line 11: fault[1].severity.kind: kind cannot be swept"),
        (SWEEP, "{ probability = [0.1, 0.3], duration = [1.0] }", "lists of different lengths"),
        ("delay = 0.05", "delay = 0.05\nevery = 1.0", "fault[2].every: 1 s is not more than the duration"),
        ("delay = 0.05", "delay = 0.05\nvehicles = [9]", "fault[2].vehicles: there is no vehicle 9"),
        ("delay = 0.05", "", "line 13: fault[2].delay: missing key"),
        ("delay = 0.05", "delay = 0.05\nstart_between = [1, 2]", "fault[2].start_between: goes without start"),
        ("start = 5.0", "start_between = [5.0, 2.0]", "line 10: fault[1].start_between: 5 s is not before 2 s"),
        ("start = 5.0", "", "line 7: fault[1].start: missing key"),
        ('name = "slow"\n', "", "fault[2].name: missing key"),
        ("[[fault]]", "[[error]]", "error: unknown key"),
        ("delay = 0.05", "delay = 0.05\n[limits]\nspeed = 1.0", "limits.speed: unknown key"),
        ("[campaign]", "[campaign", "line 2: not valid TOML"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told_with_its_line(old, new, told, tmp_path, capsys):
    assert old in CAMPAIGN
    path = campaign_file(tmp_path, CAMPAIGN.replace(old, new))
    with pytest.raises(UnusableFile) as raised:
        read_campaign(path)
    assert any(told in reason and reason.startswith(str(path)) for reason in raised.value.reasons), raised.value.reasons
    assert main(["faults", str(path), "--out", str(tmp_path / "out")]) == 2
    assert told in capsys.readouterr().err and not (tmp_path / "out").exists()


def test_what_is_wrong_with_a_mission_is_told(tmp_path):
    path = campaign_file(tmp_path)
    mission = tmp_path / "short_figure.toml"
    mission.write_text(mission.read_text().replace("altitude", "height"))
    with pytest.raises(UnusableFile) as raised:
        read_campaign(path)
    assert any("short_figure.toml: line" in reason for reason in raised.value.reasons)


# The campaign

SUMMARY = {
    "completed": True, "outcome": "completed", "contacts": 0, "clearance_min_m": None, "uav_separation_min_m": 0.9,
    "payload_tilt_max_deg": {"roll": 1.0, "pitch": 2.5, "yaw": None}, "duration_s": 20.0,
    "position_rmse_m": {"total": 0.02}, "limits": {"position_rmse": [0.02, 0.03, True]},
}  # fmt: skip
OUTSIDE = {"limits": {"position_rmse": [0.2, 0.03, False]}}


@pytest.fixture
def flown(monkeypatch):
    """Nothing is flown: the flights are noted, and those of the second severity are outside their limits."""
    names = []

    def fly(mission, options, run_dir, stop):
        names.append(mission.stem)
        run_dir.mkdir()
        bad = "0.3" in mission.stem
        return Ended(int(bad), SUMMARY | (OUTSIDE if bad else {}), "", 1.0)

    monkeypatch.setattr(campaigns, "fly_process", fly)
    return names


def campaign_in(folder, text=CAMPAIGN, **options):
    return FaultCampaign(read_campaign(campaign_file(folder, text)), FaultCampaignOptions(folder / "out", **options))


def nothing(_):
    pass


def test_every_flight_is_flown_once(tmp_path, flown):
    campaign = campaign_in(tmp_path, jobs=2)
    campaign.fly(nothing, nothing)
    assert sorted(flown) == sorted(flight.name for flight in campaign.flights)
    assert [result.number for result in campaign.results] == [1, 2, 3, 4, 5, 6]
    assert [result.outcome for result in campaign.results[1:4]] == ["within limits", "outside limits", "outside limits"]
    # Of those within limits only the results are kept.
    kept = sorted(path.name for path in (tmp_path / "out" / "flights").iterdir())
    assert kept == sorted(result.name for result in campaign.results if result.run_dir) and len(kept) == 2
    campaign_in(tmp_path).fly(nothing, nothing)
    assert len(flown) == 6


def test_a_campaign_goes_on_where_it_was_cut_off(tmp_path, flown):
    def interrupted(result):
        if result.number == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        campaign_in(tmp_path, jobs=1).fly(nothing, interrupted)
    (tmp_path / "out" / "flights" / ".half-flown").mkdir()
    again = campaign_in(tmp_path, jobs=1)
    assert [result.number for result in again.results] == [1, 2, 3]
    again.fly(nothing, nothing)
    assert [flown.count(flight.name) for flight in again.flights[:3]] == [1, 1, 1]
    assert len(again.results) == 6 and not (tmp_path / "out" / "flights" / ".half-flown").exists()


def test_a_campaign_that_has_grown_flies_what_is_new(tmp_path, flown):
    campaign_in(tmp_path).fly(nothing, nothing)
    grown = CAMPAIGN.replace("[0.1, 0.3]", "[0.05, 0.1, 0.3]").replace("[3, 7]", "[3, 7, 8]")
    campaign = campaign_in(tmp_path, grown)
    campaign.fly(nothing, nothing)
    assert len(flown) == 6 + 12 - 6 and len(set(flown)) == 12
    assert [(r.level, r.severity) for r in campaign.results[3:9:3]] == [(2, "probability 0.1"), (3, "probability 0.3")]


def test_a_mission_that_has_changed_is_flown_again(tmp_path, flown):
    campaign_in(tmp_path).fly(nothing, nothing)
    path = campaign_file(tmp_path)
    system = tmp_path / "system.toml"
    system.write_text(system.read_text().replace("link_length = 3.2", "link_length = 3.1"))
    assert FaultCampaign(read_campaign(path), FaultCampaignOptions(tmp_path / "out")).results == []


def test_a_folder_is_of_one_campaign_and_one_process(tmp_path, flown):
    campaign = campaign_in(tmp_path)
    with pytest.raises(UnusableInput, match="was begun with faults a test, not another"):
        campaign_in(tmp_path, CAMPAIGN.replace("a test", "another"))
    with sole_flyer(tmp_path / "out"), pytest.raises(UnusableInput, match="another process is flying there"):
        campaign.fly(nothing, nothing)
    assert flown == []


def test_the_command(tmp_path, flown, capsys):
    path, out = str(campaign_file(tmp_path)), tmp_path / "out"
    assert main(["faults", path, "--out", str(out), "--jobs", "2"]) == 1
    said = capsys.readouterr().out
    assert "4 of 6 flights within their limits" in said
    for name in flown:
        assert (f"gcs fly {out}/missions/{name}.toml --controller idc" in said) == ("0.3" in name)
    assert (out / "matrix.png").stat().st_size > 10_000
    assert main(["faults", str(campaign_file(tmp_path, CAMPAIGN.replace(", 0.3", ""))), "--out", str(out)]) == 0
    assert len(flown) == 6


def test_a_campaign_may_require_a_safe_landing_alone(tmp_path, flown, monkeypatch, capsys):
    landing = {"on_ground": True, "speed_mps": 0.5, "tilt_deg": 1.5}
    aborted = SUMMARY | {"completed": False, "outcome": "aborted", "limits": {}, "landing": landing}
    ends = {"0.1": aborted, "0.3": aborted | OUTSIDE, "slow": aborted | {"outcome": "collided", "contacts": 1}}

    def fly(mission, options, run_dir, stop):
        return Ended(1, next(end for name, end in ends.items() if name in mission.stem), "", 1.0)

    monkeypatch.setattr(campaigns, "fly_process", fly)
    for require, passed in (("safe", 2), ("within limits", 0)):  # what is on record is judged anew
        text = CAMPAIGN.replace("seeds =", f'require = "{require}"\nseeds =')
        assert main(["faults", str(campaign_file(tmp_path, text)), "--out", str(tmp_path / "out")]) == 1
        assert f"{passed} of 6 flights" in capsys.readouterr().out
        frame = pandas.read_parquet(tmp_path / "out" / "results.parquet")
        assert frame["passed"].tolist() == [passed > 0] * 2 + [False] * 4
        assert frame["outcome"].tolist() == ["aborted"] * 4 + ["collided"] * 2
    assert frame["touchdown_mps"].tolist() == [0.5] * 6 and frame["landed"].all()
    assert frame["end_tilt_deg"].tolist() == [1.5] * 6


def test_an_interrupt_keeps_the_results(tmp_path, flown, monkeypatch, capsys):
    def interrupted(campaign, console, what, line):
        campaign._fly(campaign.flights[0], None)
        raise KeyboardInterrupt

    monkeypatch.setattr("gcs.fault_campaign.command.show_progress", interrupted)
    assert main(["faults", str(campaign_file(tmp_path)), "--out", str(tmp_path / "out")]) == 130
    assert "interrupted with 6 flights to go" in capsys.readouterr().err


def test_neither_a_campaign_nor_the_kinds(capsys):
    assert main(["faults"]) == 2
    assert "name what to do" in capsys.readouterr().err


# Results


def results(tmp_path, within, outside=0, **figures):
    flight = flights(tmp_path)[0]
    made = [evaluate(flight, Ended(0, SUMMARY, "", 1.0), tmp_path / "none", "gcs fly x") for _ in range(within)]
    made += [evaluate(flight, Ended(1, SUMMARY | OUTSIDE, "", 1.0), tmp_path / "none", "gcs fly x")] * outside
    return [dataclasses.replace(result, **figures) for result in made]


def test_rates_have_wilson_intervals(tmp_path):
    [rates] = rates_of(results(tmp_path, 7, 3))
    assert (rates.flights, rates.within_limits, rates.safe, rates.safe_rate) == (10, 7, 10, 1.0)
    # Wilson (1927), by hand: z = 1.96, n = 10, p = 0.7.
    assert (rates.within_limits_low, rates.within_limits_high) == pytest.approx((0.3968, 0.8922), abs=1e-4)
    assert interval(0, 5) == pytest.approx(tuple(binomtest(0, 5).proportion_ci(method="wilson")))
    [hit] = rates_of(results(tmp_path, 1, contacts=2))
    assert hit.safe == 0


def test_the_tables_say_the_same(tmp_path):
    made = results(tmp_path, 2, 1)
    made.append(dataclasses.replace(made[0], clearance_min_m=0.25, contacts=None, outcome=NOT_FLOWN, level=2))
    table, parquet, rates = write_tables(made, tmp_path)
    frame = pandas.read_parquet(parquet)
    assert tuple(frame.columns) == COLUMNS and len(frame) == 4
    assert frame["clearance_min_m"].isna().tolist() == [True, True, True, False]
    assert frame["seed"].dtype == "Int64" and frame["within_limits"].tolist() == [True, True, False, True]
    some = ["fault", "seed", "within_limits", "clearance_min_m", "contacts", "tilt_max_deg", "replay"]
    read = pandas.read_csv(table)
    pandas.testing.assert_frame_equal(read[some].astype(frame[some].dtypes), frame[some])
    assert pandas.read_csv(rates)["flights"].tolist() == [3, 1]


def test_all_outcomes_are_drawn_and_told(tmp_path):
    [result] = results(tmp_path, 1)
    made = [dataclasses.replace(result, outcome=o, level=i % 3 + 1, notes="x") for i, o in enumerate(VERDICTS)]
    assert draw_matrix("a test", made, tmp_path).stat().st_size > 5_000
    outcome_table(made, [])


def test_time_to_the_stop_of_the_team(tmp_path):
    faults = [{"activations": [[5.0, None]]}]
    (tmp_path / "faults.json").write_text(json.dumps({"take_off_s": 3.0, "end_s": 20.0, "faults": faults}))
    assert team_stop(tmp_path, 1) == (None, None)
    rows = ["1.0,1,OFFBOARD,1,0", "1.0,2,OFFBOARD,1,0", "8.45,2,AUTO.LOITER,1,1", "8.5,1,AUTO.LOITER,1,1"]
    (tmp_path / "modes.csv").write_text("\n".join(["time_s,vehicle,mode,armed,failsafe", *rows, ""]))
    assert team_stop(tmp_path, 1) == (0.5, 0.05)
    faults.insert(0, {"kind": "wind", "activations": [[0.0, None]]})  # not what they stopped for
    (tmp_path / "faults.json").write_text(json.dumps({"take_off_s": 3.0, "end_s": 20.0, "faults": faults}))
    assert team_stop(tmp_path, 2) == (0.5, 0.05)


def test_time_to_the_stop(tmp_path):
    faults = [{"activations": [[5.0, 6.0]]}, {"activations": []}, {"activations": [[4.0, None]]}]
    (tmp_path / "faults.json").write_text(json.dumps({"take_off_s": 3.0, "end_s": 20.0, "faults": faults}))
    assert stop_time({"broken_off_s": 9.25}, tmp_path, 3) == 2.25
    faults[:0] = [{"activations": [[1.0, None]]}]  # the mission's own
    (tmp_path / "faults.json").write_text(json.dumps({"take_off_s": 3.0, "end_s": 20.0, "faults": faults}))
    assert stop_time({"broken_off_s": 9.25}, tmp_path, 3) == 2.25
    assert stop_time({"broken_off_s": 6.5}, tmp_path, 3) is None  # for another reason
    assert stop_time({"broken_off_s": None}, tmp_path, 3) is None
    assert stop_time({"broken_off_s": 6.25}, tmp_path / "none", 3) is None


# Flown


REAL = """
[campaign]
name = "real"
missions = ["hop.toml"]
seeds = [1, 2, 3]

[limits]
position_rmse = 0.1
settle = 0.0

[[fault]]
name = "loss"
kind = "packet_loss"
start = 1.0
severity = { probability = [0.05, 0.1] }
"""


def test_killed_twice_in_the_middle_it_is_complete_and_none_is_flown_twice(tmp_path):
    """Six real flights, two at a time; the campaign is killed when one has ended, and again after two more."""
    path, out = campaign_file(tmp_path, REAL), tmp_path / "out"
    (tmp_path / "hop.toml").write_text(HOP)
    command = [sys.executable, "-m", "gcs", "faults", str(path), "--out", str(out), "--jobs", "2", "--keep", "all"]
    told, kept = [], {}
    for ended in (1, 2):
        with subprocess.Popen(
            command, stdout=subprocess.PIPE, text=True, env={**os.environ, "PYTHONUNBUFFERED": "1"}
        ) as cut:
            told += [cut.stdout.readline().partition(":")[0] for _ in range(ended)]  # a line a flight
            cut.send_signal(signal.SIGKILL)
            cut.wait(60)
        results = {result.stem: result.stat().st_mtime_ns for result in (out / "results").glob("*.json")}
        assert kept.items() <= results.items() and set(told) <= set(results) and len(results) < 6
        kept = results
    again = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert again.returncode == 0, again.stdout + again.stderr
    assert "6 of 6 flights within their limits" in again.stdout
    frame = pandas.read_parquet(out / "results.parquet")
    assert frame["number"].tolist() == [1, 2, 3, 4, 5, 6] and (frame["notes"] == "").all()
    told += [line.partition(":")[0] for line in again.stdout.splitlines() if line.startswith("loss-")]
    # One that had ended when the campaign was killed, but not been told yet, is not told later.
    assert len(told) == len(set(told)) >= 4 and set(told) <= set(frame["name"])
    results = {result.stem: result.stat().st_mtime_ns for result in (out / "results").glob("*.json")}
    assert kept.items() <= results.items() and set(results) == set(frame["name"])
    names = {entry.name for entry in (out / "flights").iterdir()}
    assert names == set(frame["name"]) and all(
        json.loads((Path(d) / "faults.json").read_text()) for d in frame["run_dir"]
    )
