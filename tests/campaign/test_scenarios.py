"""Random obstacle scenarios: what is generated can be flown and repeats; a campaign keeps its results and resumes."""

import dataclasses

import numpy as np
import pytest
from conflicts import first_conflict
from scenario_results import result_of
from small_campaign import InThisThread, flown_in, judged

from gcs.app.cli import main
from gcs.campaign import engine, flight
from gcs.campaign.engine import Campaign
from gcs.campaign.flight import fly_plan
from gcs.campaign.result import Flown, Result
from gcs.campaign.scenarios import generator as scenarios
from gcs.campaign.scenarios.generator import DEFAULT_KINDS, KINDS, generate
from gcs.campaign.scenarios.moving import MOTIONS, displacement, motion_for, top_speed
from gcs.campaign.scenarios.plans import Scenarios
from gcs.campaign.scenarios.report import from_bad_end, report
from gcs.config.flight_settings import DEFAULTS
from gcs.errors import UnusableInput
from gcs.mission.model import Lissajous
from gcs.mission.read import read_mission
from gcs.planning.schedule import Schedule, arrival
from gcs.record.run_folder import open_run_folder
from gcs.record.tables import truth_columns
from idc_controller.geometry.free_space import BoundingCylinder
from idc_controller.geometry.obstacles import PredictedObstacle

pytestmark = pytest.mark.slow

FORMATION = BoundingCylinder(1.0, 3.45, 0.25)


def read(scenario, folder):
    path = folder / f"{scenario.name}.toml"
    path.write_text(scenario.text)
    return read_mission(path)


# Generator


@pytest.mark.parametrize("kind", KINDS)
def test_generator_repeats_scenario_of_same_seed(kind):
    assert generate(3, 17, kind) == generate(3, 17, kind)
    assert generate(3, 17, kind).text != generate(3, 18, kind).text != generate(4, 18, kind).text


@pytest.mark.parametrize("kind", DEFAULT_KINDS)
@pytest.mark.parametrize("number", [1, *(pytest.param(number, marks=pytest.mark.long) for number in (2, 3))])
def test_generated_scenario_can_be_flown(kind, number, tmp_path):
    mission = read(generate(11, number, kind), tmp_path)
    schedule = Schedule(mission)
    assert mission.obstacles and mission.limits.clearance == 0.3 and mission.limits.payload_tilt_deg == 6.0
    path_length = np.linalg.norm(np.diff(schedule.positions, axis=0), axis=1).sum()
    if isinstance(mission.reference, Lissajous):
        assert kind in ("spheres", "moving")
    else:
        assert 15.0 < path_length < 30.0 + 6.0
        assert 1.0 <= mission.reference.speed <= 1.5
        assert np.linalg.norm(schedule.goal[:2]) > 12.0
    standing = [o for o in mission.obstacles if o.motion is None]
    moving = [o for o in mission.obstacles if o.motion is not None]
    for end in (schedule.positions[0], schedule.goal):  # clear by 3 m
        column = np.array([[*end[:2], z] for z in np.arange(schedule.goal[2], 0.0, 0.5)])
        assert first_conflict(column, [standing_there(o) for o in standing], FORMATION, 3.0) is None
    if kind != "moving":  # an obstacle is on the path
        obstacles = [standing_there(o) for o in standing] + [moving_there(o, schedule) for o in moving]
        assert first_conflict(schedule.positions, obstacles, FORMATION, 1.0) is not None
    for obstacle in moving:
        assert top_speed(obstacle.motion) <= 2.0 + 1e-3
        assert first_conflict(schedule.positions, [moving_there(obstacle, schedule)], FORMATION, 0.0) is not None
        late = np.arange(schedule.landing, schedule.landing + 20.0, 0.1)
        places = np.array(obstacle.position) + displacement(obstacle.motion, late)
        assert np.linalg.norm(places[:, :2] - schedule.goal[:2], axis=1).min() > 3.0


def standing_there(obstacle):
    return PredictedObstacle(obstacle.name, obstacle.shape, np.array([obstacle.position]), np.zeros(1))


def moving_there(obstacle, schedule):
    places = np.array(obstacle.position) + displacement(obstacle.motion, schedule.times)
    return PredictedObstacle(obstacle.name, obstacle.shape, places, np.zeros(len(places)))


def test_generator_draws_all_kinds_of_obstacles_and_motions(tmp_path):
    found = set()
    for number in range(1, 21):
        for obstacle in read(generate(1, number, ("moving", "mixed")[number % 2]), tmp_path).obstacles:
            found |= {obstacle.shape.kind, obstacle.known, obstacle.motion.kind if obstacle.motion else None}
    assert found == {"sphere", "pole", "wall", True, False, None, *MOTIONS}


@pytest.mark.parametrize("kind", MOTIONS)
@pytest.mark.parametrize("fastest", [0.5, 2.0, 5.0])
def test_motion_keeps_to_highest_speed(kind, fastest):
    random = np.random.default_rng(1)
    speeds = [top_speed(motion_for(kind, random, 20.0, np.array([1.0, 0.0, 0.0]), fastest)) for _ in range(20)]
    assert max(speeds) <= fastest + 1e-3
    assert max(speeds) > 0.6 * fastest


def test_harmonic_motion_is_fastest_when_the_payload_passes():
    random = np.random.default_rng(2)
    for _ in range(10):
        motion = motion_for("harmonic", random, 17.0, np.array([1.0, 0.0, 0.0]), 2.0)
        np.testing.assert_allclose(motion.mover()(17.0), 0.0, atol=1e-3)


# Schedule


def test_arrival_is_final_entry_into_goal_radius():
    times = np.arange(6.0)
    north = np.array([0.0, 5.0, 4.9, 7.0, 5.2, 5.0])
    positions = np.column_stack([north, np.zeros(6), np.full(6, -4.0)])
    goal = np.array([5.0, 0.0, -9.0])
    assert arrival(times, positions, goal, 0.5) == 4.0
    assert arrival(times[:4], positions[:4], goal, 0.5) is None
    assert arrival(times[:0], positions[:0], goal, 0.5) is None


# Flights and their results


@pytest.fixture
def campaign(tmp_path):
    """The scenarios 1 and 2, with poles."""
    return Campaign(Scenarios(count=2, seed=1, kinds=("poles",), controller="mpc"), tmp_path)


SUMMARY = {
    "completed": True, "outcome": "completed", "contacts": 0, "clearance_min_m": 0.5, "uav_separation_min_m": 0.9,
    "payload_tilt_max_deg": {"roll": 1.0, "pitch": 2.5, "yaw": None}, "duration_s": 60.0, "real_time_factor": 5.0,
    "step_time_ms": {"p50": 2.0, "p99": 5.0, "max": 6.0}, "solver": {"infeasible_steps": 3},
}  # fmt: skip


def record(campaign, plan, late=0.0, stop_short=False):
    """A run folder in which the payload flew the nominal trajectory, so much later."""
    schedule = Schedule(read_mission(plan.mission))
    open_run_folder("", campaign.run_dir(plan))
    columns = truth_columns(3)
    spool_up = 1.2  # s after the records begin
    rows = []
    for time in np.arange(0.0, schedule.landing + 10.0 + late, 0.02):
        on_trajectory = time - spool_up - late - DEFAULTS.takeoff_landing.spool_up_time + schedule.start
        position = np.array([np.interp(on_trajectory, schedule.times, axis) for axis in schedule.positions.T])
        if stop_short:
            position = position * 0.8
        values = dict.fromkeys(columns, 0.0) | dict(zip(columns[1:4], position, strict=True)) | {"time_s": time}
        values |= {name: 1.0 for name in columns if name.endswith("_qw")}
        values |= {f"uav{i}_thrust_n": 14.0 for i in (1, 2, 3) if time >= spool_up}
        rows.append(",".join(f"{values[name]:.6f}" for name in columns))
    (campaign.run_dir(plan) / "truth.csv").write_text("\n".join([",".join(columns), *rows]) + "\n")


def test_flight_on_time_passes(campaign):
    plan = campaign.plans[0]
    record(campaign, plan)
    result = judged(campaign, plan, Flown(0, SUMMARY, "", 12.3))
    assert result.passed and result.failures == "" and result.reason == ""
    assert result.delay_s == pytest.approx(0.0, abs=0.05)
    assert result.goal_error_m < 0.01
    assert (result.tilt_max_deg, result.clearance_min_m, result.contacts) == (2.5, 0.5, 0)
    assert result.replay == f"gcs fly {plan.mission} --controller mpc"


def test_delay_and_missed_goal_fail(campaign):
    late, short = campaign.plans
    record(campaign, late, late=3.0)
    assert judged(campaign, late, Flown(0, SUMMARY, "", 1.0)).delay_s == pytest.approx(3.0, abs=0.05)
    record(campaign, short, stop_short=True)
    result = judged(campaign, short, Flown(0, SUMMARY, "", 1.0))
    assert (result.passed, result.failures, result.delay_s) == (False, "arrival", None)
    assert result.goal_error_m > 2.0


@pytest.mark.parametrize(
    ("figures", "failures"),
    [
        (
            {"contacts": 2, "outcome": "collided", "completed": False, "clearance_min_m": 0.0},
            "collided contact clearance",
        ),
        ({"clearance_min_m": 0.29}, "clearance"),
        ({"payload_tilt_max_deg": {"roll": 6.1}}, "tilt"),
        ({"uav_separation_min_m": 0.74}, "separation"),
        ({"completed": False, "outcome": "aborted"}, "aborted"),
    ],
)
def test_flight_outside_a_limit_fails(campaign, figures, failures):
    plan = campaign.plans[0]
    record(campaign, plan)
    result = judged(campaign, plan, Flown(1, SUMMARY | figures, "a closed wall", 1.0))
    assert (result.passed, result.failures, result.reason) == (False, failures, "a closed wall")


def test_flight_that_could_not_start_fails_with_its_reason(campaign):
    broken = dataclasses.replace(campaign.plans[0], controller="none")
    result = fly_plan(broken, campaign.out / "flights")
    assert not result.passed and result.exit_code == 2 and result.run_dir == ""
    assert "controller 'none' is none of" in result.reason


# Campaign


FAILED = {"failures": "clearance", "clearance_min_m": 0.1}


@pytest.fixture
def flown(monkeypatch):
    """Scenarios are not flown: their numbers are noted, and every fourth fails."""
    numbers = []

    def fly(plan, folder):
        numbers.append(plan.number)
        (folder / f".{plan.name}").mkdir()
        return result_of(run_dir=str(folder / f".{plan.name}"), **({} if plan.number % 4 else FAILED))

    monkeypatch.setattr(engine, "fly_plan", fly)
    monkeypatch.setattr("gcs.app.campaigns.WorkerProcesses", InThisThread)
    return numbers


def campaign_in(folder, **changes):
    scenarios = Scenarios(**({"count": 6, "seed": 5, "kinds": ("poles", "moving")} | changes))
    return Campaign(scenarios, folder / "out")


def test_what_has_changed_is_flown_again(tmp_path, flown, monkeypatch):
    flown_in(campaign_in(tmp_path))
    (tmp_path / "out" / "missions" / "0002-moving.toml").write_text("another")
    assert len(campaign_in(tmp_path).results) == 6  # it is written anew
    monkeypatch.setattr(scenarios, "HELD_TO", dataclasses.replace(scenarios.HELD_TO, clearance=0.2))
    assert campaign_in(tmp_path).results == []
    monkeypatch.undo()
    monkeypatch.setattr(flight, "code_digest", lambda: "of another code")
    assert campaign_in(tmp_path).results == []


@pytest.mark.parametrize("change", [{"seed": 6}, {"kinds": ("poles",)}, {"controller": "mpc"}, {"fastest": 3.0}])
def test_folder_of_another_campaign_is_refused(tmp_path, change):
    campaign_in(tmp_path, count=1)
    with pytest.raises(UnusableInput, match="was begun with"):
        campaign_in(tmp_path, count=1, **change)


def test_folder_of_something_else_is_refused(tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "thesis.tex").touch()
    with pytest.raises(UnusableInput, match="neither empty nor the folder of a campaign"):
        campaign_in(tmp_path)


def test_each_scenario_is_flown_with_every_combination_of_settings(tmp_path, flown, capsys):
    out = str(tmp_path / "out")
    grid = ["--set", "avoidance.margin=0.4,0.5", "--set", "avoidance.barrier_rates=[],[6.0, 6.0]"]
    main(["courses", "--count", "1", "--kinds", "poles", "--out", out, *grid])
    printed = capsys.readouterr().out
    assert "4 of 4 scenarios passed" in printed and len(flown) == 4
    assert '"avoidance.margin=0.4 avoidance.barrier_rates=[6.0, 6.0]"' in (tmp_path / "out/results.csv").read_text()
    campaign = campaign_in(tmp_path / "again", count=1, kinds=("poles",), grid={"avoidance.margin": [0.4, 0.5]})
    assert [plan.settings for plan in campaign.plans] == [{"avoidance.margin": 0.4}, {"avoidance.margin": 0.5}]
    assert len({plan.name for plan in campaign.plans}) == len({plan.key for plan in campaign.plans}) == 2
    assert campaign.plans[1].replay.endswith("0001-poles.toml --controller idc --set avoidance.margin=0.5")


def test_command_flies_and_reports(tmp_path, flown, capsys, pictures):
    out = str(tmp_path / "out")
    assert main(["courses", "--count", "3", "--kinds", "poles", "--out", out]) == 0
    printed = capsys.readouterr().out
    assert "3 of 3 scenarios passed" in printed and "0003-poles" in printed
    assert main(["courses", "--count", "4", "--kinds", "poles", "--out", out]) == 1
    printed = capsys.readouterr().out
    assert "3 of 4 scenarios passed" in printed and f"gcs fly {out}/missions/0004-poles.toml" in printed
    assert (tmp_path / "out" / "distribution.png").is_file()
    texts = pictures["distribution.png"]
    assert texts.count("scenarios") >= 3 and "4 scenarios, 3 passed" in texts
    assert any(text.startswith("limit ") for text in texts) and any(text.startswith("worst ") for text in texts)
    assert main(["courses", "--count", "4", "--kinds", "walls", "--out", out]) == 2
    assert "was begun with kinds" in capsys.readouterr().err


def test_distribution_counts_from_the_bad_end():
    values = np.arange(101.0)
    assert from_bad_end(values, high_is_bad=False) == [0.0, 1.0, 5.0, 50.0]
    assert from_bad_end(values, high_is_bad=True) == [100.0, 99.0, 95.0, 50.0]


def test_report_is_written_when_no_figure_is_known(tmp_path):
    _, files = report(
        [Result(number=1, name="0001-poles", kind="poles", failures="failed", outcome="failed")], tmp_path, 0.75
    )
    assert all(path.exists() for path in files)
