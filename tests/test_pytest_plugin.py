"""The pytest plugin: a user's test in a few lines, what is kept of it when it fails, and how it is repeated."""

import json
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from flights import HOP, system_file

from gcs.campaign import testing
from gcs.campaign.process_pool import FlownProcess
from gcs.campaign.testing import fault
from gcs.errors import GcsError, UnusableInput
from gcs.faults.link import PacketLoss
from gcs.faults.values import Bias
from gcs.mission.model import Fault
from gcs.mission.read import read_mission

pytestmark = pytest.mark.slow

pytest_plugins = ["pytester", "gcs.campaign.pytest_plugin"]

ROOT = Path(__file__).parents[1]
SUMMARY = {
    "outcome": "completed",
    "contacts": 0,
    "limits": {"position_rmse": {"value": 0.02, "limit": 0.03, "held": True}},
}


@pytest.fixture
def hop(tmp_path):
    system_file(tmp_path)
    path = tmp_path / "hop.toml"
    path.write_text(HOP)
    return path


# Flown


def test_flight_completes_with_a_tenth_of_all_datagrams_lost(fly_with_faults, hop):
    flight = fly_with_faults(
        hop,
        [PacketLoss(probability=0.1)],
        limits={"position_rmse": 0.1, "settle": 0.0, "payload_tilt_deg": 5.0},
        seed=4,
    )
    assert flight.within_limits and flight.summary["contacts"] == 0
    assert json.loads((flight.run_dir / "faults.json").read_text())["faults"][0]["disturbed"] > 50


def test_failed_test_keeps_its_flight(pytester, hop):
    """A test of another project, in another folder; its flight is flown, and is not within its limits."""
    pytester.makepyfile(f"""
        def test_flies(fly_with_faults):
            faults = [dict(kind="packet_loss", start=2.0, probability=0.05)]
            flight = fly_with_faults({str(hop)!r}, faults, limits=dict(position_rmse=1e-6, settle=0.0), seed=2)
            assert flight.within_limits
    """)
    result = pytester.runpytest_inprocess("-p", "gcs.campaign.pytest_plugin", "--fault-runs", "kept")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(
        ["*flights with faults*", "*seed 2: completed, outside its limits (position_rmse*", "  run folder kept/*"]
    )
    [replay] = [line.split() for line in result.outlines if line.startswith("  gcs fly ")]
    assert replay[2].startswith("kept/test_flies-") and replay[2].endswith("1-hop-seed2.toml")
    mission = read_mission(pytester.path / replay[2])
    assert mission.seed == 2 and mission.faults[0].settings == {"probability": 0.05}
    assert (pytester.path / replay[2]).with_suffix("").joinpath("truth.csv").exists()


# Without flying


@pytest.fixture
def flown(monkeypatch):
    """The missions that would have been flown."""
    missions = []

    def fly(mission, options, run_dir, worker):
        missions.append((read_mission(mission), options))
        run_dir.mkdir()
        return FlownProcess(0, SUMMARY, "", 1.0)

    monkeypatch.setattr(testing, "fly_process", fly)
    return missions


def test_faults_in_every_form(fly_with_faults, hop, flown):
    given = [
        PacketLoss(probability=0.2),
        fault(Bias(channel="position", amount=0.5, axes=("x",)), 1.0, 2.0, vehicles=[2]),
        Fault("partition", 3.0, direction="command"),
        {"kind": "latency", "start": 1.5, "delay": 0.1},
    ]
    flights = fly_with_faults(hop, given, seeds=(5, 6), controller="mpc")
    assert [flight.seed for flight in flights] == [5, 6] and all(flight.within_limits for flight in flights)
    (first, options), (second, _) = flown
    assert options == ("--controller", "mpc") and (first.seed, second.seed) == (5, 6)
    expected = [(f.kind, f.start, f.duration, f.vehicles, f.direction) for f in first.faults]
    assert expected == [
        ("packet_loss", 0.0, None, None, None), ("bias", 1.0, 2.0, (2,), None),
        ("partition", 3.0, None, None, "command"), ("latency", 1.5, None, None, None),
    ]  # fmt: skip
    assert fly_with_faults(hop).seed == read_mission(hop).seed


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ({"faults": [{"kind": "packet_los", "start": 1.0}]}, "there is no kind 'packet_los'"),
        ({"faults": [Fault("packet_loss", 1.0)]}, "probability: missing key"),
        ({"faults": [Fault("partition", 1.0, vehicles=(9,))]}, "there is no vehicle 9"),
        ({"limits": {"speed": 1.0}}, "limits.speed: unknown key"),
        ({"config": "no.toml"}, "no.toml: cannot be read"),
    ],
)
def test_unusable_input_is_reported(arguments, expected, fly_with_faults, hop, flown):
    with pytest.raises(UnusableInput, match=expected):
        fly_with_faults(hop, **arguments)
    assert flown == []


def test_unfinished_flight_is_an_error(fly_with_faults, hop, monkeypatch):
    monkeypatch.setattr(testing, "fly_process", lambda *_: FlownProcess(-9, {}, "no memory", 1.0))
    with pytest.raises(GcsError, match="not flown: no memory"):
        fly_with_faults(hop)
    assert "gcs fly" in fly_with_faults.log[0]


def test_invalid_fault_is_refused():
    with pytest.raises(TypeError, match="not the parameters of a kind"):
        fault(3)


def test_records_of_passed_test_are_removed(pytester, hop, flown):
    pytester.makepyfile("""
        import pytest

        @pytest.mark.parametrize("passes", [True, False])
        def test_flies(passes, fly_with_faults):
            assert fly_with_faults("hop.toml").run_dir.exists() and passes
    """)
    for path in hop.parent.glob("*.toml"):  # beside the test
        (pytester.path / path.name).write_text(path.read_text())
    pytester.runpytest_inprocess("-p", "gcs.campaign.pytest_plugin", "-k", "True").assert_outcomes(passed=1)
    assert not (pytester.path / "fault-test-failures").exists()
    pytester.runpytest_inprocess("-p", "gcs.campaign.pytest_plugin").assert_outcomes(passed=1, failed=1)
    [kept] = (pytester.path / "fault-test-failures").iterdir()
    assert "False" in kept.name


def test_plugin_is_installed_with_the_package():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert project["entry-points"]["pytest11"] == {"gcs.campaign.pytest_plugin": "gcs.campaign.pytest_plugin"}


def test_plugin_takes_no_time_to_start():
    """Whoever has the package installed has the plugin in every run of pytest."""
    code = (
        "import sys, pytest; before = set(sys.modules); import gcs.campaign.pytest_plugin; "
        "print(*set(sys.modules) - before)"
    )
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert set(run.stdout.split()) == {"gcs", "gcs.campaign", "gcs.campaign.pytest_plugin"}
