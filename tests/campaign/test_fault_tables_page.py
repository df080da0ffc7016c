"""The tables of docs/faults.md: their missions, and the command that writes them."""

import json
import math
import subprocess
import tomllib
from pathlib import Path

import fault_tables_page
import numpy as np
import pytest
from fault_tables_page import DETECTION, FALSE_ALARMS, main
from page_tables import commit_of, renewed
from small_campaign import CAMPAIGN, SUMMARY, campaign_file, fly_nothing

from gcs.app import cli
from gcs.campaign.faults.campaign_file import read_campaign
from gcs.campaign.faults.detection_table import case_name
from gcs.campaign.faults.plans import FaultFlights
from gcs.campaign.result import Flown
from gcs.campaign.scenarios import field as fields
from gcs.campaign.scenarios.field import field
from gcs.config import UnusableFile, read_system
from gcs.errors import GcsError, UnusableInput
from gcs.mission.model import Mission
from gcs.mission.read import read_mission
from gcs.planning.schedule import Schedule
from gcs.record.run_folder import open_run_folder
from idc_controller.geometry.free_space import BoundingCylinder, FreeSpace

ROOT = Path(__file__).parents[2]
SCENARIOS = """
[[scenario]]
name = "30 obstacles, known"
kind = "field"
obstacles = 30
known = true

[[scenario]]
name = "forest"
kind = "forest"
"""
CLEAN = f"""
[campaign]
name = "no faults"
missions = ["short_figure.toml"]
seeds = [3, 7]
clean = true
{SCENARIOS}"""


@pytest.mark.parametrize("known", [True, False])
def test_field_keeps_clear_of_the_path(known):
    system = read_system(None)
    obstacles = field(5, 200, known, system)
    assert len(obstacles) == 200 and {o.known for o in obstacles} == {known}
    assert [o.shape.kind for o in obstacles[:4]] == ["sphere", "pole", "sphere", "pole"]
    path = Schedule(Mission("", Path(), 1, system, fields.figure(30.0))).positions
    space = FreeSpace([(o.shape, o.position) for o in obstacles], BoundingCylinder.of(system.parameters()), 0, 0, 100)
    assert space.clearance(path).min() > fields.CLEARANCE - 0.01
    places = np.array([o.position[:2] for o in obstacles])
    radii = np.array([o.shape.radius for o in obstacles])
    gaps = np.linalg.norm(places[:, None] - places, axis=2) - radii[:, None] - radii
    np.fill_diagonal(gaps, math.inf)
    assert gaps.min() >= fields.APART


def test_field_is_drawn_from_its_seed_and_the_same_on_the_map_or_not():
    system = read_system(None)
    first, other = field(1, 20, True, system), field(2, 20, True, system)
    assert [o.position for o in first] != [o.position for o in other]
    assert [o.position for o in first] == [o.position for o in field(1, 20, False, system)]


def test_field_without_place_for_its_obstacles_is_refused():
    with pytest.raises(GcsError, match="500 obstacles: no place for more than"):
        field(1, 500, True, read_system(None))


def test_scenarios_of_a_campaign_are_drawn_for_each_seed(tmp_path):
    file = read_campaign(campaign_file(tmp_path, CLEAN))
    assert list(file.missions) == ["short_figure", "30 obstacles, known", "forest"]
    missions = {}
    for plan in FaultFlights(file).plans(tmp_path / "out"):
        if plan.labels["mission"] != "short_figure":
            plan.mission.parent.mkdir(parents=True, exist_ok=True)
            plan.mission.write_text(plan.files[plan.mission])
            missions[plan.labels["mission"], plan.labels["seed"]] = read_mission(plan.mission)
    known = [missions["30 obstacles, known", seed] for seed in (3, 7)]
    assert [len(m.obstacles) for m in known] == [30, 30] and known[0].seed == 3 and known[0].limits.clearance == 1.0
    assert known[0].obstacles != known[1].obstacles
    assert missions["forest", 3].obstacles != missions["forest", 7].obstacles


def test_scenario_is_flown_with_the_faults_of_the_campaign(tmp_path):
    text = CAMPAIGN + SCENARIOS.split("\n\n")[0] + "\nduration = 40.0\n"
    plans = list(FaultFlights(read_campaign(campaign_file(tmp_path, text))).plans(tmp_path))
    assert [plan.labels["seed"] for plan in plans] == 3 * [3, 7, 3, 7]
    mission = tomllib.loads(plans[2].files[plans[2].mission])
    assert mission["reference"]["duration"] == 40.0
    assert len(mission["obstacle"]) == 30 and mission["fault"][0]["kind"] == "packet_loss"


@pytest.mark.parametrize(
    ("replaced", "by", "reason"),
    [
        ("obstacles = 30", "", "kind 'field' needs a number of obstacles"),
        ('kind = "forest"', 'kind = "forest"\nobstacles = 3', "obstacles: is of kind 'field' only"),
        ('kind = "forest"', 'kind = "forest"\nknown = false', "known: is of kind 'field' only"),
        ('name = "forest"', 'name = "short_figure"', "another mission is named 'short_figure'"),
        ("obstacles = 30", "obstacles = 301", "obstacles"),
        ('kind = "forest"', 'kind = "wood"', "kind"),
    ],
)
def test_wrong_scenario_is_refused(tmp_path, replaced, by, reason):
    with pytest.raises(UnusableFile, match=reason):
        read_campaign(campaign_file(tmp_path, CLEAN.replace(replaced, by)))


def test_every_case_of_the_detection_campaign_is_in_a_row():
    file = read_campaign(ROOT / "missions" / "detection.toml")
    named = {name for row in file.rows for name in row.faults}
    assert all({case.name, case_name(case.name, case.severity)} & named for case in file.cases)


def test_false_alarms_are_flown_with_0_to_200_obstacles_known_and_detected():
    file = read_campaign(ROOT / "missions" / "false_alarms.toml")
    assert [case.name for case in file.cases] == ["no fault"]
    names = {"0 obstacles", *(f"{count} obstacles, known" for count in (10, 50, 100, 200)), "200 obstacles, detected"}
    assert names <= file.missions.keys()


PAGE = f"""# Faults

<!-- {DETECTION} -->
old
<!-- end of {DETECTION} -->

<!-- {FALSE_ALARMS} -->
<!-- end of {FALSE_ALARMS} -->
The end.
"""


@pytest.fixture
def flown(monkeypatch):
    """Nothing is flown: 10 s into a fault an alarm is raised, without one none, and in the forest a false one."""
    names = []

    def fly(plan, run_dir):
        names.append(plan.name)
        open_run_folder("", run_dir)
        has_fault = "no-fault" not in plan.name
        rows = ["time_s,source,code,severity,text"]
        rows += ["18.0,vehicle 3,messages_lost,warning,x"] if has_fault else []
        rows += ["2.0,vehicle 1,innovation_bias,warning,x"] if "forest" in plan.name else []
        (run_dir / "alarms.csv").write_text("\n".join([*rows, ""]))
        faults = [{"number": 1, "kind": "packet_loss", "line": 1, "start": 5.0, "seen": 1, "disturbed": 1,
                   "occurrences": 1, "activations": [[5.0, None]]}]  # fmt: skip
        record = {"take_off_s": 3.0, "end_s": 36.0, "faults": faults if has_fault else []}
        (run_dir / "faults.json").write_text(json.dumps(record))
        return Flown(0, SUMMARY | {"duration_s": 36.0}, "", 1.0)

    fly_nothing(monkeypatch, fly)
    return names


def made(folder, text):
    (folder / "page.md").write_text(PAGE)
    (folder / "clean.toml").write_text(CLEAN)
    paths = [str(path) for path in (folder / "page.md", campaign_file(folder, text), folder / "clean.toml")]
    code = main([*paths, "--out", str(folder / "runs"), "--jobs", "2"])
    return code, (folder / "page.md").read_text()


def test_command_writes_both_tables_and_flies_what_is_missing(tmp_path, flown, monkeypatch):
    monkeypatch.setattr(fault_tables_page, "commit_of", lambda folder: "commit 0123abc")
    row = '[[row]]\nname = "all of them"\nfaults = ["slow", "loss"]\nmedian = 10.0\nworst = 10.0\n'
    code, page = made(tmp_path, CAMPAIGN + row)
    assert code == 0 and len(flown) == 12
    assert page.startswith("# Faults\n") and page.endswith("The end.\n") and "old" not in page
    assert page.count("page.md campaign.toml clean.toml` at commit 0123abc:\n\n| ") == 2
    assert "| all of them | link of all vehicles | 6 | 6 |  |  |  | `messages_lost` | 10 s | 10 s | 10 s |  |" in page
    assert "| forest | 2 | 0.020 | 2 | 2 | 100.0 | 314.8 | 2 innovation_bias |" in page
    assert "| short_figure, until the fault | 6 | 0.013 | 0 | 0 | 0.0 | 224.7 |  |" in page  # 8 s each
    assert "| all | 12 | 0.073 | 2 | 2 | 27.3 | 85.9 | 2 innovation_bias |" in page
    assert made(tmp_path, CAMPAIGN + row) == (0, page) and len(flown) == 12
    # Later than the limit of its row.
    code, page = made(tmp_path, CAMPAIGN + row.replace("worst = 10.0", "worst = 9.9"))
    assert code == 1 and len(flown) == 12 and "| all of them |" in page


def test_campaign_fails_by_a_row_beyond_its_limit(tmp_path, flown, capsys):
    row = '[[row]]\nname = "slow link"\nfaults = ["slow"]\nworst = 9.9\n'
    command = ["faults", str(campaign_file(tmp_path, CAMPAIGN + row)), "--out", str(tmp_path / "out")]
    assert cli.main(command) == 1
    said = capsys.readouterr().out
    assert "6 of 6 flights within their limits" in said
    assert "slow link: detected within 10 s (worst; limit 9.9 s)" in said
    campaign_file(tmp_path, CAMPAIGN + row.replace("9.9", "10.0"))
    assert cli.main(command) == 0 and len(flown) == 6
    [header, *rows] = (tmp_path / "out" / "detection.csv").read_text().splitlines()
    assert header.startswith("fault,true_source,flights,right,") and [r.split(",")[0] for r in rows] == [
        "slow link", "loss",
    ]  # fmt: skip


def test_commit_is_the_last_that_changed_what_is_flown(tmp_path):
    def git(*arguments):
        identity = ("-c", "user.name=x", "-c", "user.email=x@x", "-c", "commit.gpgsign=false")
        command = ["git", *identity, *arguments]
        return subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, text=True).stdout.strip()

    missions = tmp_path / "missions"
    missions.mkdir()
    assert commit_of(missions) == "an unknown commit"
    git("init", "-q")
    for name in ("missions/hop.toml", "page.md"):
        (tmp_path / name).write_text("1\n")
        git("add", name)
        git("commit", "-q", "-m", name)
    flown = git("log", "-1", "--format=%h", "HEAD~1")
    assert commit_of(missions) == f"commit {flown}"
    (tmp_path / "page.md").write_text("2\n")
    assert commit_of(missions) == f"commit {flown}"
    changed = set()
    for text in ("2\n", "3\n"):
        (missions / "hop.toml").write_text(text)
        changed.add(commit_of(missions))
    assert len(changed) == 2 and all(name.startswith(f"commit {flown} with changes ") for name in changed)


def test_page_without_a_place_for_a_table_is_refused():
    assert renewed(PAGE, DETECTION, "new\n").count("new") == 1
    with pytest.raises(UnusableInput, match="no place for the table of detection"):
        renewed(PAGE.replace("<!-- end of table of d", "<!-- end of table of ca"), DETECTION, "new\n")
