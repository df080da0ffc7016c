"""A flight with a live view is the flight without, whether a browser looks, goes away or never comes."""

import re
import subprocess
import sys

import pytest
from flights import HOP, system_file
from programs import ENVIRONMENT, PATIENCE, gcs_fly, swarm_process
from websockets.sync.client import connect

import gcs
from gcs.record.tables import ALARMS, ESTIMATE, FORCES, HORIZON, INNOVATIONS, MODES, PHASES, REFERENCE, TRUTH

pytestmark = pytest.mark.slow

RECORDS = (ALARMS, ESTIMATE, FORCES, HORIZON, INNOVATIONS, MODES, PHASES, REFERENCE, TRUTH)
VIEW = ("--view", "--speed", "1000", "--no-pictures")


@pytest.fixture(scope="module")
def mission(tmp_path_factory):
    folder = tmp_path_factory.mktemp("hop")
    system_file(folder)
    (folder / "hop.toml").write_text(HOP)
    return folder / "hop.toml"


def records_of(folder):
    return {name: (folder / name).read_bytes() for name in RECORDS}


@pytest.fixture(scope="module")
def plain(mission):
    """The records of the flight without a view, which has the same bytes by the command."""
    folder = mission.parent / "plain"
    assert gcs.fly(mission, run_dir=folder).completed
    return records_of(folder)


def address_of(stream):
    """The address of the web socket, as the program prints it."""
    for line in stream:
        if match := re.search(r"live view: http(://127\.0\.0\.1:\d+/)", line):
            return f"ws{match[1]}"
    raise AssertionError("no address of the view")


@pytest.mark.long
def test_records_are_the_same_to_the_byte_when_nobody_looks(mission, plain):
    folder = mission.parent / "unseen"
    assert gcs_fly(mission, folder, *VIEW)[0] == 0
    assert records_of(folder) == plain


def test_records_are_the_same_to_the_byte_when_a_browser_goes_and_another_stays(mission, plain):
    folder = mission.parent / "seen"
    command = [sys.executable, "-m", "gcs", "fly", str(mission), "--run-dir", str(folder), *VIEW]
    with subprocess.Popen(
        command, env=ENVIRONMENT, cwd=mission.parent, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    ) as flight:
        address = address_of(flight.stderr)
        with connect(address, max_size=None, open_timeout=PATIENCE) as stays:
            with connect(address, max_size=None, open_timeout=PATIENCE) as goes:
                goes.recv()
            *_, last = stays
        assert flight.wait(PATIENCE) == 0
    assert '"final":true' in last and '"outcome":"completed"' in last
    assert records_of(folder) == plain


def test_simulator_by_itself_is_seen_without_a_run_folder():
    with swarm_process("--view", "--base-port", 0, "--sdk-port", 0, "--ground-port", 0) as swarm:
        with connect(address_of(swarm.stderr), max_size=None, open_timeout=PATIENCE) as browser:
            assert "truth.uav4.position" in browser.recv()
            swarm.terminate()
            *_, last = browser
        assert swarm.wait(PATIENCE) == 0
    assert '"final":true' in last
