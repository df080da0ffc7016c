"""Fault campaigns: what is flown, once, and going on after a kill."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pandas
import pytest
from flights import HOP
from small_campaign import CAMPAIGN, OUTSIDE, SUMMARY, campaign_file, flown_in, fly_nothing

from gcs.app.cli import main
from gcs.campaign.engine import Campaign
from gcs.campaign.faults.campaign_file import read_campaign
from gcs.campaign.faults.plans import FaultFlights
from gcs.campaign.folder import folder_lock
from gcs.campaign.result import Flown
from gcs.errors import UnusableInput
from gcs.record.run_folder import open_run_folder

pytestmark = pytest.mark.slow


@pytest.fixture
def flown(monkeypatch):
    """Nothing is flown: the flights are noted, and those of the second severity are outside their limits."""
    names = []

    def fly(plan, run_dir):
        names.append(plan.name)
        open_run_folder("", run_dir)
        bad = "0.3" in plan.name
        return Flown(int(bad), SUMMARY | (OUTSIDE if bad else {}), "", 1.0)

    fly_nothing(monkeypatch, fly)
    return names


def campaign_in(folder, text=CAMPAIGN, **options):
    return Campaign(FaultFlights(read_campaign(campaign_file(folder, text))), folder / "out", **options)


def test_campaign_flies_every_flight_once(tmp_path, flown):
    campaign = flown_in(campaign_in(tmp_path))
    assert sorted(flown) == sorted(flight.name for flight in campaign.plans)
    assert [result.number for result in campaign.results] == [1, 2, 3, 4, 5, 6]
    assert [result.outcome for result in campaign.results[1:4]] == ["completed"] * 3
    assert [result.within_limits for result in campaign.results[1:4]] == [True, False, False]
    # Of those within limits only the results are kept.
    kept = sorted(path.name for path in (tmp_path / "out" / "flights").iterdir())
    assert kept == sorted(result.name for result in campaign.results if result.run_dir) and len(kept) == 2
    flown_in(campaign_in(tmp_path))
    assert len(flown) == 6


def test_campaign_resumes_after_an_interrupt(tmp_path, flown):
    def interrupted(result):
        if result.number == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        flown_in(campaign_in(tmp_path), interrupted)
    assert not [*(tmp_path / "out" / "flights").glob(".*")]
    (tmp_path / "out" / "flights" / ".half-flown").mkdir()
    again = campaign_in(tmp_path)
    assert [result.number for result in again.results] == [1, 2, 3]
    flown_in(again)
    assert [flown.count(flight.name) for flight in again.plans[:3]] == [1, 1, 1]
    assert len(again.results) == 6 and not (tmp_path / "out" / "flights" / ".half-flown").exists()


def test_grown_campaign_flies_only_what_is_new(tmp_path, flown):
    flown_in(campaign_in(tmp_path))
    grown = CAMPAIGN.replace("[0.1, 0.3]", "[0.05, 0.1, 0.3]").replace("[3, 7]", "[3, 7, 8]")
    campaign = flown_in(campaign_in(tmp_path, grown))
    assert len(flown) == 6 + 12 - 6 and len(set(flown)) == 12
    assert [(r.level, r.severity) for r in campaign.results[3:9:3]] == [(2, "probability 0.1"), (3, "probability 0.3")]


def test_campaign_flies_changed_mission_again(tmp_path, flown):
    flown_in(campaign_in(tmp_path))
    path = campaign_file(tmp_path)
    system = tmp_path / "system.toml"
    system.write_text(system.read_text().replace("link_length = 3.2", "link_length = 3.1"))
    assert Campaign(FaultFlights(read_campaign(path)), tmp_path / "out").results == []


def test_folder_is_refused_to_another_campaign_or_process(tmp_path, flown):
    campaign = campaign_in(tmp_path)
    with pytest.raises(UnusableInput, match="was begun with faults a test, not another"):
        campaign_in(tmp_path, CAMPAIGN.replace("a test", "another"))
    with folder_lock(tmp_path / "out"), pytest.raises(UnusableInput, match="another process is flying there"):
        flown_in(campaign)
    assert flown == []


def test_command_flies_and_reports(tmp_path, flown, capsys, pictures):
    path, out = str(campaign_file(tmp_path)), tmp_path / "out"
    assert main(["faults", path, "--out", str(out), "--jobs", "2"]) == 1
    said = capsys.readouterr().out
    assert "4 of 6 flights within their limits" in said
    for name in flown:
        assert (f"gcs fly {out}/missions/{name}.toml --controller idc" in said) == ("0.3" in name)
    cells = {"probability 0.1\n2 of 2", "probability 0.3\n0 of 2", "2 of 2"}
    assert cells | {"loss", "slow", "within limits", "outside limits"} <= set(pictures["matrix.png"])
    assert (out / "matrix.png").is_file()
    assert main(["faults", str(campaign_file(tmp_path, CAMPAIGN.replace(", 0.3", ""))), "--out", str(out)]) == 0
    assert len(flown) == 6


def test_campaign_passes_safe_landings_where_file_requires_no_more(tmp_path, flown, monkeypatch, capsys):
    landing = {"on_ground": True, "speed_mps": 0.5, "tilt_deg": 1.5}
    aborted = SUMMARY | {"completed": False, "outcome": "aborted", "limits": {}, "landing": landing}
    ends = {"0.1": aborted, "0.3": aborted | OUTSIDE, "slow": aborted | {"outcome": "collided", "contacts": 1}}

    def fly(plan, run_dir):
        return Flown(1, next(end for name, end in ends.items() if name in plan.name), "", 1.0)

    fly_nothing(monkeypatch, fly)
    for require, passed in (("safe", 2), ("within limits", 0)):  # what is on record is judged anew
        text = CAMPAIGN.replace("seeds =", f'require = "{require}"\nseeds =')
        assert main(["faults", str(campaign_file(tmp_path, text)), "--out", str(tmp_path / "out"), "--parquet"]) == 1
        assert f"{passed} of 6 flights" in capsys.readouterr().out
        frame = pandas.read_parquet(tmp_path / "out" / "results.parquet")
        assert frame["passed"].tolist() == [passed > 0] * 2 + [False] * 4
        assert frame["outcome"].tolist() == ["aborted"] * 4 + ["collided"] * 2
    assert frame["touchdown_mps"].tolist() == [0.5] * 6 and frame["landed"].all()
    assert frame["end_tilt_deg"].tolist() == [1.5] * 6


def test_interrupted_command_exits_130(tmp_path, flown, monkeypatch, capsys):
    def interrupted(campaign, executor, console):
        raise KeyboardInterrupt

    monkeypatch.setattr("gcs.app.campaigns.fly_with_progress", interrupted)
    assert main(["faults", str(campaign_file(tmp_path)), "--out", str(tmp_path / "out")]) == 130
    assert "interrupted with 6 flights to go" in capsys.readouterr().err


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
severity = {{ probability = {severities} }}
"""


@pytest.mark.parametrize(
    ("severities", "jobs", "kills"),
    [([0.1], "1", [1]), pytest.param([0.05, 0.1], "2", [1, 2], marks=pytest.mark.long)],
    ids=["once", "twice"],
)
def test_campaign_killed_completes_without_flying_twice(severities, jobs, kills, tmp_path):
    """Real flights; the campaign is killed when one has ended; two at a time, and again after two more."""
    path, out = campaign_file(tmp_path, REAL.format(severities=severities)), tmp_path / "out"
    count = 3 * len(severities)
    (tmp_path / "hop.toml").write_text(HOP)
    command = [sys.executable, "-m", "gcs", "faults", str(path), "--out", str(out), "--jobs", jobs, "--keep", "all"]
    reported, kept = [], {}
    for ended in kills:
        with subprocess.Popen(
            command, stdout=subprocess.PIPE, text=True, env={**os.environ, "PYTHONUNBUFFERED": "1"}
        ) as cut:
            reported += [cut.stdout.readline().partition(":")[0] for _ in range(ended)]  # a line a flight
            cut.send_signal(signal.SIGKILL)
            cut.wait(60)
        results = {result.stem: result.stat().st_mtime_ns for result in (out / "results").glob("*.json")}
        assert kept.items() <= results.items() and set(reported) <= set(results) and len(results) < count
        kept = results
    again = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert again.returncode == 0, again.stdout + again.stderr
    assert f"{count} of {count} flights within their limits" in again.stdout
    frame = pandas.read_csv(out / "results.csv", keep_default_na=False)
    assert frame["number"].tolist() == [*range(1, count + 1)] and (frame["notes"] == "").all()
    assert (frame["true_source"] == "link of all vehicles").all() and (frame["isolation"] == "right").all()
    reported += [line.partition(":")[0] for line in again.stdout.splitlines() if line.startswith("loss-")]
    # One that had ended when the campaign was killed, but had not been reported yet, is not reported later.
    assert len(reported) == len(set(reported)) >= count - 2 and set(reported) <= set(frame["name"])
    results = {result.stem: result.stat().st_mtime_ns for result in (out / "results").glob("*.json")}
    assert kept.items() <= results.items() and set(results) == set(frame["name"])
    names = {entry.name for entry in (out / "flights").iterdir()}
    folders = pandas.read_csv(out / "timing.csv")["run_dir"]
    assert names == set(frame["name"]) and all(json.loads((Path(d) / "faults.json").read_text()) for d in folders)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_signal_ends_the_command_with_the_results_so_far(tmp_path, flown, monkeypatch, capsys, number):
    def signalled(campaign, executor, console):
        campaign.fly(executor, lambda result: os.kill(os.getpid(), number))

    monkeypatch.setattr("gcs.app.campaigns.fly_with_progress", signalled)
    assert main(["faults", str(campaign_file(tmp_path)), "--out", str(tmp_path / "out")]) == 130
    assert "interrupted with 5 flights to go" in capsys.readouterr().err
    assert len([*(tmp_path / "out" / "results").glob("*.json")]) == 1
