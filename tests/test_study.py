"""Studies: what is flown by which system file, the table, the picture, and going on after a cut."""

import csv
import dataclasses
from pathlib import Path

import pytest
from course_results import result_of

from gcs.app.cli import main
from gcs.campaign.courses import campaign as campaigns
from gcs.campaign.courses.flights import REQUIRED
from gcs.campaign.courses.moving import top_speed
from gcs.campaign.courses.text import system_text
from gcs.campaign.studies.figures import draw_study, worst
from gcs.campaign.studies.study import MOVING, STUDIES, STUDY_COLUMNS, StudyFlights, StudyOptions
from gcs.config import read_system
from gcs.errors import UnusableInput
from gcs.mission import read_mission

MISSIONS = Path(__file__).parents[1] / "missions"


def flights_of(name, folder, **options):
    return StudyFlights(StudyOptions(STUDIES[name], folder, missions=MISSIONS, **options))


def system_of(flight):
    options = flight.plan.options
    return read_system(Path(options[options.index("--config") + 1]) if "--config" in options else None)


@pytest.fixture
def flown(monkeypatch):
    """Nothing is flown: what would be is noted; those without avoidance collide."""
    plans = []

    def fly(plan, stop):
        plans.append(plan)
        if "mpc" in plan.options and plan.held_to.clearance:
            figures = {
                "passed": False,
                "failures": "contact",
                "contacts": 2,
                "outcome": "collided",
                "clearance_min_m": 0,
            }
            return result_of(plan.course, replay=plan.replay, **figures)
        return result_of(plan.course, replay=plan.replay)

    monkeypatch.setattr(campaigns, "fly_course", fly)
    return plans


# The system file


def test_a_system_file_with_other_values_is_the_same_otherwise(tmp_path):
    changes = {"avoidance.margin": 0.25, "sensors.payload_rates": 0.1, "avoidance.barrier_rates": [6.0, 6.0]}
    path = tmp_path / "system.toml"
    path.write_text(system_text(changes))
    config, default = read_system(path), read_system()
    assert (config.avoidance.margin, config.avoidance.barrier_rates) == (0.25, (6.0, 6.0))
    assert config.sensors == dataclasses.replace(default.sensors, payload_rates=0.1)
    assert dataclasses.replace(config, sensors=default.sensors, avoidance=default.avoidance) == default


def test_a_key_that_the_system_file_does_not_have_is_refused():
    with pytest.raises(KeyError):
        system_text({"avoidance.margins": 0.25})


# What is flown


@pytest.mark.parametrize("name", [name for name in STUDIES if STUDIES[name].missions != (MOVING,)])
def test_every_flight_can_be_flown(name, tmp_path):
    study, flights = STUDIES[name], flights_of(name, tmp_path, quick=True)
    assert flights.total == len(study.missions) * len(study.variants)
    for flight in flights.flights:
        config = None if "--config" not in flight.plan.options else flight.plan.options[-3]
        assert read_mission(flight.plan.mission, config).system == system_of(flight)
    names = [flight.plan.course.name for flight in flights.flights]
    assert len(set(names)) == len(names)


def test_margins_are_asked_for_and_held_to(tmp_path):
    flights = flights_of("margin", tmp_path, seeds=2).flights
    told = [(system_of(f).avoidance.margin, f.plan.held_to.clearance, f.plan.options[-1]) for f in flights]
    assert told == [(m, m, seed) for m in (0.25, 0.5, 0.75, 1.0) for seed in "12"]
    assert all(flight.plan.held_to.payload_tilt_deg == 5.0 for flight in flights)


def test_what_each_study_changes(tmp_path):
    def changed(name, get):
        return [get(flight) for flight in flights_of(name, tmp_path, quick=True, seeds=1).flights]

    masses = changed("mass", lambda f: system_of(f).true_parameters().m_0)
    assert masses == pytest.approx([0.9 * 3.1, 3.1, 1.1 * 3.1])
    sensors = changed("rate-noise", lambda f: system_of(f).sensors)
    assert all(s.payload_rates == s.payload_velocity for s in sensors)
    assert sensors[0].payload_rates == 0.008 and sensors[-1].payload_rates == 0.1
    assert changed("detection", lambda f: system_of(f).range_sensor.range) == [10.0, 7.0, 5.0, 3.0]
    barriers = [f.variant.label for f in flights_of("barrier", tmp_path).flights[::3]][:4]
    assert barriers == ["plain rows", "5 1/s", "3 1/s", "6, 6 1/s"]
    controllers = changed("controllers", lambda f: (f.mission, f.plan.options[1]))
    assert len(set(controllers)) == 9 and ("pole_course", "paper") in controllers


@pytest.mark.slow
def test_moving_obstacles_are_not_on_the_map(tmp_path):
    flights = flights_of("speed", tmp_path, quick=True).flights
    assert len(flights) == 8
    for flight in flights:
        obstacles = read_mission(flight.plan.mission).obstacles
        assert obstacles and all(o.motion is not None and not o.known for o in obstacles)
        fastest = max(top_speed(o.motion) for o in obstacles)
        assert 0.85 * flight.variant.fastest <= fastest <= flight.variant.fastest + 1e-3
    assert flights[0].plan.mission != flights[2].plan.mission


def test_studies_share_their_flights(tmp_path, flown):
    for name in ("margin", "mass", "controllers"):
        flights_of(name, tmp_path, quick=True).fly(lambda name: None, lambda result: None)
    assert len(flown) == 4 + 2 + 8
    shared = flights_of("mass", tmp_path, quick=True).rows[1]
    assert shared.result.kind == "1" and shared.columns()["variant"] == "1"


def test_a_mission_that_has_changed_is_flown_again(tmp_path, flown):
    missions = tmp_path / "missions"
    missions.mkdir()
    for path in MISSIONS.glob("*.toml"):
        (missions / path.name).write_text(path.read_text())
    options = StudyOptions(STUDIES["mass"], tmp_path / "out", quick=True, missions=missions)
    StudyFlights(options).fly(lambda name: None, lambda result: None)
    assert len(StudyFlights(options).rows) == 3
    path = missions / "figure_eight_spheres.toml"
    path.write_text(path.read_text().replace("radius = 0.5 ", "radius = 0.6 "))
    assert StudyFlights(options).rows == []


def test_a_folder_without_the_missions_is_refused(tmp_path):
    with pytest.raises(UnusableInput, match=r"figure_eight_spheres\.toml"):
        StudyFlights(StudyOptions(STUDIES["margin"], tmp_path / "out", missions=tmp_path))


# Results


def test_results_of_an_earlier_version_are_read(tmp_path, flown):
    flights = flights_of("mass", tmp_path, quick=True)
    flights.fly(lambda name: None, lambda result: None)
    path = flights.flights[0].result_path
    whole = campaigns.read_result(path)
    campaigns.write_json(path, {key: value for key, value in vars(whole).items() if key in REQUIRED})
    assert campaigns.read_result(path) == dataclasses.replace(whole, position_rmse_m=None)
    campaigns.write_json(path, {"number": 1})
    assert campaigns.read_result(path) is None


def test_the_command(tmp_path, flown, capsys):
    arguments = ["--quick", "--jobs", "1", "--out", str(tmp_path), "--missions", str(MISSIONS)]
    assert main(["study", "controllers", *arguments]) == 1
    said = capsys.readouterr().out
    assert "0.60 >= 0.45" in said and "0.00 >= 0.5" in said and said.count("1/1") == 7 and said.count("0/1") == 2
    assert f"gcs fly {MISSIONS / 'pole_course.toml'} --controller mpc --seed 1" in said
    with (tmp_path / "controllers.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert tuple(rows[0]) == STUDY_COLUMNS and len(rows) == 9
    assert {row["clearance_asked_m"] for row in rows} == {"", "0.5", "0.45"}
    assert (tmp_path / "controllers.png").stat().st_size > 10_000
    assert main(["study", "margin", *arguments]) == 0
    assert "0.60 >= 0.25" in capsys.readouterr().out
    assert len(flown) == 9 + 3


def test_an_interrupted_study_tells_what_there_is(tmp_path, flown, monkeypatch, capsys):
    from gcs.app.commands import study as study_command

    def interrupted(flights, console, what):
        def ended(result):
            raise KeyboardInterrupt

        flights.fly(lambda name: None, ended)

    monkeypatch.setattr(study_command, "fly_with_progress", interrupted)
    arguments = ["mass", "--quick", "--jobs", "1", "--out", str(tmp_path), "--missions", str(MISSIONS)]
    assert main(["study", *arguments]) == 130
    assert "interrupted with 2 flights to go" in capsys.readouterr().err
    assert len((tmp_path / "mass.csv").read_text().splitlines()) == 2


@pytest.mark.parametrize("wrong", [["weather"], ["margin", "--seeds", "0"], ["margin", "--jobs", "x"], []])
def test_arguments_that_mean_nothing(wrong, capsys):
    with pytest.raises(SystemExit) as exit_:
        main(["study", *wrong])
    assert exit_.value.code == 2


def test_nothing_known_is_drawn_and_told(tmp_path):
    flights = flights_of("rate-noise", tmp_path, quick=True)
    unknown = dict.fromkeys(("clearance_min_m", "tilt_max_deg", "contacts", "position_rmse_m", "delay_s"))
    for flight in flights.flights:
        flights._add(flight.plan, result_of(flight.plan.course, replay=flight.plan.replay, **unknown))
    assert draw_study(STUDIES["rate-noise"], flights.rows, tmp_path / "x.png").exists()
    assert worst(flights.results, "clearance_min_m", 2, min) == "-"
