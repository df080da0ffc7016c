"""Studies: what is flown by which system file, the table, the picture, and going on after a cut."""

import csv
import dataclasses
from pathlib import Path

import pytest
from scenario_results import result_of
from small_campaign import InThisThread, flown_in

from gcs.app.cli import main
from gcs.campaign import engine
from gcs.campaign.engine import Campaign
from gcs.campaign.folder import shown
from gcs.campaign.result import Result
from gcs.campaign.scenarios.moving import top_speed
from gcs.campaign.studies.plans import StudyFlights
from gcs.campaign.studies.report import draw_study
from gcs.campaign.studies.study import MOVING, STUDIES, STUDY_COLUMNS
from gcs.campaign.tables import extreme, flight_columns
from gcs.campaign.toml_text import system_text
from gcs.config import read_system
from gcs.errors import UnusableInput
from gcs.mission.read import read_mission

MISSIONS = Path(__file__).parents[1] / "missions"


def campaign_of(name, folder, missions=MISSIONS, **options):
    return Campaign(StudyFlights(STUDIES[name], missions=missions, **options), folder)


def system_of(plan):
    return read_system(plan.config)


@pytest.fixture
def flown(monkeypatch):
    """Nothing is flown: what would be is noted; those without avoidance collide."""
    plans = []

    def fly(plan, folder):
        plans.append(plan)
        collides = plan.controller == "mpc" and plan.labels["clearance_asked_m"]
        figures = (
            {"failures": "contact", "contacts": 2, "outcome": "collided", "clearance_min_m": 0} if collides else {}
        )
        return result_of(**figures)

    monkeypatch.setattr(engine, "fly_plan", fly)
    monkeypatch.setattr("gcs.app.campaigns.WorkerProcesses", InThisThread)
    return plans


# The system file


def test_changed_system_file_differs_in_given_values_only(tmp_path):
    changes = {"avoidance.margin": 0.25, "sensors.payload_rates": 0.1, "avoidance.barrier_rates": [6.0, 6.0]}
    path = tmp_path / "system.toml"
    path.write_text(system_text(changes))
    config, default = read_system(path), read_system()
    assert (config.avoidance.margin, config.avoidance.barrier_rates) == (0.25, (6.0, 6.0))
    assert config.sensors == dataclasses.replace(default.sensors, payload_rates=0.1)
    assert dataclasses.replace(config, sensors=default.sensors, avoidance=default.avoidance) == default


def test_unknown_key_of_system_file_is_refused():
    with pytest.raises(UnusableInput, match=r"did you mean 'avoidance\.margin'"):
        system_text({"avoidance.margins": 0.25})


# What is flown


@pytest.mark.parametrize("name", [name for name in STUDIES if STUDIES[name].missions != (MOVING,)])
def test_study_plans_valid_missions(name, tmp_path):
    study, plans = STUDIES[name], campaign_of(name, tmp_path, quick=True).plans
    assert len(plans) == len(study.missions) * len(study.variants)
    for plan in plans:
        assert read_mission(plan.mission, plan.config).system == system_of(plan)
    assert len({plan.name for plan in plans}) == len(plans)


def test_margin_study_changes_margin_and_clearance_limit(tmp_path):
    plans = campaign_of("margin", tmp_path, seeds=2).plans
    found = [(system_of(p).avoidance.margin, p.labels["clearance_asked_m"], p.seed) for p in plans]
    assert found == [(m, m, seed) for m in (0.25, 0.5, 0.75, 1.0) for seed in (1, 2)]
    assert all(plan.labels["tilt_limit_deg"] == 5.0 for plan in plans)


def test_each_study_changes_its_parameter(tmp_path):
    def changed(name, get):
        return [get(plan) for plan in campaign_of(name, tmp_path, quick=True, seeds=1).plans]

    masses = changed("mass", lambda p: system_of(p).true_parameters().m_0)
    assert masses == pytest.approx([0.9 * 3.1, 3.1, 1.1 * 3.1])
    sensors = changed("rate-noise", lambda p: system_of(p).sensors)
    assert all(s.payload_rates == s.payload_velocity for s in sensors)
    assert sensors[0].payload_rates == 0.008 and sensors[-1].payload_rates == 0.1
    assert changed("detection", lambda p: system_of(p).range_sensor.range) == [10.0, 7.0, 5.0, 3.0]
    barriers = [p.labels["variant"] for p in campaign_of("barrier", tmp_path).plans[::3]][:4]
    assert barriers == ["plain rows", "5 1/s", "3 1/s", "6, 6 1/s"]
    controllers = changed("controllers", lambda p: (p.labels["mission"], p.controller))
    assert len(set(controllers)) == 9 and ("pole_course", "paper") in controllers


@pytest.mark.slow
def test_speed_study_has_fast_obstacles_off_the_map(tmp_path):
    plans = campaign_of("speed", tmp_path, quick=True).plans
    assert len(plans) == 8
    variants = {variant.label: variant for variant in STUDIES["speed"].variants}
    for plan in plans:
        obstacles = read_mission(plan.mission).obstacles
        assert obstacles and all(o.motion is not None and not o.known for o in obstacles)
        highest, fastest = variants[plan.labels["variant"]].fastest, max(top_speed(o.motion) for o in obstacles)
        assert 0.85 * highest <= fastest <= highest + 1e-3
    assert plans[0].mission != plans[2].mission


def test_studies_in_one_folder_share_flights(tmp_path, flown):
    for name in ("margin", "mass", "controllers"):
        flown_in(campaign_of(name, tmp_path, quick=True))
    assert len(flown) == 4 + 2 + 8
    shared = campaign_of("mass", tmp_path, quick=True).results[1]
    assert shared.kind == "1" and shared.variant == "1"


def test_study_flies_changed_mission_again(tmp_path, flown):
    missions = tmp_path / "missions"
    missions.mkdir()
    for path in MISSIONS.glob("*.toml"):
        (missions / path.name).write_text(path.read_text())
    flown_in(campaign_of("mass", tmp_path / "out", missions, quick=True))
    assert len(campaign_of("mass", tmp_path / "out", missions, quick=True).results) == 3
    path = missions / "figure_eight_spheres.toml"
    path.write_text(path.read_text().replace("radius = 0.5 ", "radius = 0.6 "))
    assert campaign_of("mass", tmp_path / "out", missions, quick=True).results == []


def test_study_without_its_missions_is_refused(tmp_path):
    with pytest.raises(UnusableInput, match=r"figure_eight_spheres\.toml"):
        campaign_of("margin", tmp_path / "out", tmp_path)


# Results


def test_command_flies_and_reports(tmp_path, flown, capsys, pictures):
    arguments = ["--quick", "--out", str(tmp_path), "--missions", str(MISSIONS)]
    assert main(["study", "controllers", *arguments]) == 1
    printed = capsys.readouterr().out
    assert "0.60 >= 0.45" in printed and "0.00 >= 0.5" in printed
    assert printed.count("1/1") == 7 and printed.count("0/1") == 2
    assert f"gcs fly {shown(MISSIONS / 'pole_course.toml')} --controller mpc --seed 1" in printed
    with (tmp_path / "controllers.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert tuple(rows[0]) == flight_columns(STUDY_COLUMNS) and len(rows) == 9
    assert {row["clearance_asked_m"] for row in rows} == {"", "0.5", "0.45"}
    assert (tmp_path / "controllers.png").is_file()
    texts = pictures["controllers.png"]
    assert {"least clearance, hull to surface (m)", "limit"} <= set(texts)
    assert any(text.startswith("controllers: ") and text.endswith("(9 flights)") for text in texts)
    assert main(["study", "margin", *arguments]) == 0
    assert "0.60 >= 0.25" in capsys.readouterr().out
    assert len(flown) == 9 + 3


def test_interrupted_study_reports_what_there_is(tmp_path, flown, monkeypatch, capsys):
    def interrupted(campaign, executor, console):
        def ended(result):
            raise KeyboardInterrupt

        campaign.fly(executor, ended)

    monkeypatch.setattr("gcs.app.campaigns.fly_with_progress", interrupted)
    arguments = ["mass", "--quick", "--out", str(tmp_path), "--missions", str(MISSIONS)]
    assert main(["study", *arguments]) == 130
    assert "interrupted with 2 flights to go" in capsys.readouterr().err
    assert len((tmp_path / "mass.csv").read_text().splitlines()) == 2


@pytest.mark.parametrize("wrong", [["weather"], ["margin", "--seeds", "0"], ["margin", "--jobs", "x"], []])
def test_command_refuses_arguments_out_of_range(wrong):
    assert main(["study", *wrong]) == 2


def test_study_is_drawn_when_no_figure_is_known(tmp_path):
    variant = STUDIES["rate-noise"].variants[0].label
    results = [Result(mission=STUDIES["rate-noise"].missions[0], variant=variant)]
    assert draw_study(STUDIES["rate-noise"], results, tmp_path / "x.png").exists()
    assert extreme(results, "clearance_min_m", min, 2) == "-"
