"""Fault campaigns: the file, and the flights that it lists."""

import dataclasses
import tomllib
from pathlib import Path

import numpy as np
import pytest
from flights import short_figure
from small_campaign import CAMPAIGN, campaign_file, flights

from gcs.app.cli import main
from gcs.campaign.engine import Campaign
from gcs.campaign.faults.base_mission import read_base
from gcs.campaign.faults.campaign_file import read_campaign
from gcs.campaign.faults.plans import FaultFlights
from gcs.config import UnusableFile
from gcs.mission.model import Fault, Limits
from gcs.mission.read import read_mission

MISSIONS = Path(__file__).parents[2] / "missions"


def test_campaign_plans_every_case_in_every_mission_with_every_seed(tmp_path):
    found = flights(tmp_path, CAMPAIGN.replace('.toml"]', f'.toml", "{MISSIONS}/square.waypoints"]'))
    assert len(found) == 3 * 2 * 2 and [flight.number for flight in found] == list(range(1, 13))
    labels = [tuple(f.labels[key] for key in ("fault", "severity", "mission", "seed")) for f in found[:5]]
    assert labels == [
        ("loss", "probability 0.1", "short_figure", 3), ("loss", "probability 0.1", "short_figure", 7),
        ("loss", "probability 0.1", "square", 3), ("loss", "probability 0.1", "square", 7),
        ("loss", "probability 0.3", "short_figure", 3),
    ]  # fmt: skip
    assert len({flight.name for flight in found}) == 12


def test_campaign_writes_a_mission_file_for_each_flight(tmp_path):
    file = read_campaign(campaign_file(tmp_path, CAMPAIGN + "\n[limits]\nclearance = 0.4\n"))
    campaign = Campaign(FaultFlights(file), tmp_path / "out")
    missions = [read_mission(tmp_path / "out" / "missions" / f"{f.name}.toml") for f in campaign.plans]
    base = read_mission(tmp_path / "short_figure.toml")
    for mission, flight in zip(missions, campaign.plans, strict=True):
        assert (mission.seed, mission.limits) == (flight.labels["seed"], Limits(clearance=0.4))
        assert (mission.system, mission.reference) == (base.system, base.reference)
    assert [m.faults[0].settings for m in missions[::2]] == [
        {"probability": 0.1},
        {"probability": 0.3},
        {"delay": 0.05},
    ]
    assert (missions[4].faults[0].start, missions[4].faults[0].duration) == (4.0, 2.0)


@pytest.mark.parametrize("name", ["square.waypoints", "fenced_delivery.plan", "pole_course.toml"])
def test_mission_made_of_another_differs_only_in_name_seed_and_faults(name, tmp_path):
    base = read_base(MISSIONS / name)
    for file, text in base.files.items():
        (tmp_path / file).write_text(text, encoding="utf-8")
    fault = Fault("packet_loss", 1.0, vehicles=(1, 2), settings={"probability": 0.2})
    (tmp_path / "made.toml").write_text(base.text('a "new"\x7f \N{DUCK}', 5, [fault]))
    made, read = read_mission(tmp_path / "made.toml"), read_mission(MISSIONS / name)
    assert (made.seed, dataclasses.replace(made.faults[0], line=1)) == (5, fault)
    assert made.name == 'a "new"\x7f \N{DUCK}'
    same = dataclasses.replace(made, name=read.name, path=read.path, seed=read.seed, faults=read.faults)
    assert same == read


def test_mission_keeps_its_own_faults(tmp_path):
    own = '[[fault]]\nkind = "wind"\nstart = 1.0\nvelocity = [1.0, 0.0, 0.0]\n'
    path = short_figure(tmp_path, 2.0)
    path.write_text(path.read_text() + own)
    faults = tomllib.loads(read_base(path).text("made", 1, [Fault("partition", 2.0)]))["fault"]
    assert [fault["kind"] for fault in faults] == ["wind", "partition"]


def test_fault_tables_of_one_name_make_one_case(tmp_path):
    text = CAMPAIGN + '[[fault]]\nname = "slow"\nkind = "jitter"\nstart = 4.0\nseverity = { spread = [0.01, 0.02] }\n'
    slow = [case for case in read_campaign(campaign_file(tmp_path, text)).cases if case.name == "slow"]
    assert [[f.kind for f in case.faults_for(3)] for case in slow] == [["latency", "jitter"]] * 2
    assert [case.faults_for(3)[1].settings for case in slow] == [{"spread": 0.01}, {"spread": 0.02}]
    assert slow[0].kind == "latency + jitter"


def test_fault_starts_are_drawn_per_seed(tmp_path):
    found = flights(tmp_path, CAMPAIGN.replace("start = 5.0", "start_between = [5.0, 9.0]"))[:4]
    starts = [tomllib.loads(flight.files[flight.mission])["fault"][0]["start"] for flight in found]
    assert starts[:2] == starts[2:] and starts[0] != starts[1]  # the same at every severity
    assert all(5.0 <= start <= 9.0 for start in starts)


def test_campaign_plans_fault_free_flights_and_counted_seeds(tmp_path):
    counted = CAMPAIGN.replace("seeds = [3, 7]", "first_seed = 10\nseed_count = 3\nclean = true")
    found = flights(tmp_path, counted)
    assert [tuple(f.labels[key] for key in ("fault", "seed", "kind")) for f in found[:4]] == [
        ("no fault", 10, ""), ("no fault", 11, ""), ("no fault", 12, ""), ("loss", 10, "packet_loss"),
    ]  # fmt: skip
    assert "[[fault]]" not in found[0].files[found[0].mission]


def test_example_campaign_makes_valid_missions(tmp_path):
    file = read_campaign(MISSIONS / "telemetry_faults.toml")
    campaign = Campaign(FaultFlights(file), tmp_path / "out")
    assert len(campaign.plans) == 34
    for flight in campaign.plans[::5]:
        read_mission(tmp_path / "out" / "missions" / f"{flight.name}.toml")


SWEEP = "{ probability = [0.1, 0.3] }"


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("seeds = [3, 7]", "seeds = [3]\ncolour = 1", "line 6: campaign.colour: unknown key"),
        ("seeds = [3, 7]", "", "line 2: campaign: needs either seeds or seed_count"),
        ("seeds = [3, 7]", "seeds = [3, 3]", "line 5: campaign.seeds: 3 appears 2 times"),
        ("seeds = [3, 7]", "seeds = [3]\nseed_count = 2", "line 6: campaign.seed_count: seeds are listed already"),
        ("seeds = [3, 7]", "seeds = []", "line 5: campaign.seeds: needs at least 1"),
        ("seeds = [3, 7]", 'seeds = [3]\ncontroller = "pid"', "line 6: campaign.controller: must be 'idc'"),
        ("short_figure.toml", "long_figure.toml", "line 4: campaign.missions[1]: there is no file long_figure.toml"),
        ("packet_loss", "paket_loss", "line 9: fault[1].kind: there is no kind 'paket_loss': did you mean 'packet"),
        (SWEEP, "{ probability = [0.1, 3] }", "line 11: fault[1].probability: must be"),
        (SWEEP, "{ share = [0.1] }", "line 11: fault[1].share: unknown key"),
        (SWEEP, "{ probability = 0.1 }", "line 11: fault[1].severity.probability: must"),
        (SWEEP, "{ probability = [] }", "line 11: fault[1].severity.probability: needs at least"),
        (SWEEP, "{ probability = [0.1, 0.1] }", "'loss': probability 0.1 appears twice"),
        (SWEEP, "{ start = [1.0] }", "line 11: fault[1].severity.start: start appears in the"),
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
def test_campaign_file_is_refused_with_line_and_reason(old, new, reason, tmp_path, capsys):
    assert old in CAMPAIGN
    path = campaign_file(tmp_path, CAMPAIGN.replace(old, new))
    with pytest.raises(UnusableFile) as raised:
        read_campaign(path)
    found = raised.value.reasons
    assert any(reason in line and line.startswith(str(path)) for line in found), found
    assert main(["faults", str(path), "--out", str(tmp_path / "out")]) == 2
    assert reason in capsys.readouterr().err and not (tmp_path / "out").exists()


def test_campaign_file_is_refused_with_reasons_of_its_mission(tmp_path):
    path = campaign_file(tmp_path)
    mission = tmp_path / "short_figure.toml"
    mission.write_text(mission.read_text().replace("altitude", "height"))
    with pytest.raises(UnusableFile) as raised:
        read_campaign(path)
    assert any("short_figure.toml: line" in reason for reason in raised.value.reasons)


def test_mission_made_of_another_takes_the_mesh_of_an_obstacle_along(tmp_path):
    base = read_base(MISSIONS / "unknown_rock.toml")
    for file, text in base.files.items():
        (tmp_path / file).write_text(text, encoding="utf-8")
    (tmp_path / "made.toml").write_text(base.text("made"))
    made, read = (read_mission(path).obstacles[0] for path in (tmp_path / "made.toml", MISSIONS / "unknown_rock.toml"))
    corners = [np.array(sorted(obstacle.shape.file.corners)) for obstacle in (made, read)]
    np.testing.assert_allclose(*corners, atol=1e-9)
