"""The pytest plugin: a user's test in a few lines, what is kept of it when it fails, and how it is repeated."""

import shlex
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from flights import HOP, system_file

from gcs.campaign.testing import fault
from gcs.errors import UnusableInput
from gcs.faults.values import Bias
from gcs.mission.model import Fault

pytestmark = pytest.mark.slow

pytest_plugins = ["pytester", "gcs.campaign.pytest_plugin"]

ROOT = Path(__file__).parents[2]


@pytest.fixture
def hop(tmp_path):
    system_file(tmp_path)
    path = tmp_path / "hop.toml"
    path.write_text(HOP)
    return path


def test_failed_test_shows_figures_alarms_and_replay_and_keeps_the_records(pytester, hop):
    """A test of another project, in another folder; its flight is flown, and is not within its limits."""
    pytester.makepyfile(f"""
        def test_flies(fly_with_faults):
            faults = [dict(kind="packet_loss", start=2.0, probability=0.3)]
            flight = fly_with_faults({str(hop)!r}, faults, limits=dict(position_rmse=1e-6, settle=0.0), seed=2)
            assert flight.within_limits
    """)
    result = pytester.runpytest_inprocess("-p", "gcs.campaign.pytest_plugin", "--fault-runs", "kept")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines([
        "*where False = <flight hop: completed, outside its limits (position_rmse * (limit 1e-06))>.within_limits",
        "*flights with faults*", "<flight hop: completed, outside its limits*", "  duration_s *, contacts 0,*",
        "  position_rmse * (limit 1e-06, not held)", "  * s warning: vehicle *: messages_lost: *",
        "  run folder kept/test_flies-*/1-hop",
    ])  # fmt: skip
    assert not [line for line in result.outlines if "/gcs/" in line]
    [replay] = [shlex.split(line) for line in result.outlines if line.startswith("  python -c ")]
    flown = []
    exec(replay[2], {"gcs": None, "__builtins__": {"__import__": lambda *_: called(flown), "print": lambda _: None}})
    [(mission, options)] = flown
    faults = [{"kind": "packet_loss", "start": 2.0, "probability": 0.3}]
    assert mission == str(hop)
    assert options == {"seed": 2, "faults": faults, "limits": {"position_rmse": 1e-6, "settle": 0.0}}
    [run_dir] = pytester.path.glob("kept/test_flies-*/1-hop")
    assert (run_dir / "truth.csv").exists()


def called(flown):
    """A module whose flights are noted."""
    return SimpleNamespace(fly=lambda mission, **options: flown.append((mission, options)))


# Without flying


def test_unusable_input_is_reported_without_the_code_of_the_package(pytester, hop):
    pytester.makepyfile(f"""
        def test_flies(fly_with_faults):
            fly_with_faults({str(hop)!r}, [dict(kind="packet_los", start=1.0)])
    """)
    result = pytester.runpytest_inprocess("-p", "gcs.campaign.pytest_plugin")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["E *there is no kind 'packet_los'*", "*flights with faults*", "hop: not flown"])
    assert not [line for line in result.outlines if "gcs/" in line]


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ({"faults": [Fault("packet_loss", 1.0)]}, "probability: missing key"),
        ({"faults": [Fault("partition", 1.0, vehicles=(9,))]}, "there is no vehicle 9"),
        ({"limits": {"speed": 1.0}}, "limits: speed: unknown key"),
    ],
)
def test_unusable_input_is_an_error(arguments, expected, fly_with_faults, hop):
    with pytest.raises(UnusableInput, match=expected):
        fly_with_faults(hop, **arguments)


def test_fault_of_parameters_has_their_kind_and_what_is_given():
    found = fault(Bias(channel="position", amount=0.5, axes=("x",)), 1.0, 2.0, vehicles=[2])
    assert (found.kind, found.start, found.duration, found.vehicles) == ("bias", 1.0, 2.0, (2,))


def test_invalid_fault_is_refused():
    with pytest.raises(TypeError, match="not the parameters of a kind"):
        fault(3)


def test_records_of_passed_test_are_removed(pytester, hop, monkeypatch):
    def fly(mission, faults, run_dir):
        assert mission.parent == pytester.path  # beside the test
        (run_dir / "sub").mkdir(parents=True)
        raise UnusableInput("not flown")

    monkeypatch.setattr("gcs.fly", fly, raising=False)
    pytester.makepyfile("""
        import pytest

        @pytest.mark.parametrize("passes", [True, False])
        def test_flies(passes, fly_with_faults):
            with pytest.raises(Exception, match="not flown"):
                fly_with_faults("hop.toml")
            assert passes
    """)
    for path in hop.parent.glob("*.toml"):
        (pytester.path / path.name).write_text(path.read_text())
    pytester.runpytest_inprocess("-p", "gcs.campaign.pytest_plugin", "-k", "True").assert_outcomes(passed=1)
    assert not (pytester.path / "fault-test-failures").exists()
    pytester.runpytest_inprocess("-p", "gcs.campaign.pytest_plugin").assert_outcomes(passed=1, failed=1)
    [kept] = (pytester.path / "fault-test-failures").iterdir()
    assert "False" in kept.name


def test_plugin_takes_no_time_to_start():
    """Whoever has the package installed has the plugin in every run of pytest."""
    code = (
        "import sys, pytest; before = set(sys.modules); import gcs.campaign.pytest_plugin; "
        "print(*set(sys.modules) - before)"
    )
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert set(run.stdout.split()) == {"gcs", "gcs.errors", "gcs.campaign", "gcs.campaign.pytest_plugin"}
