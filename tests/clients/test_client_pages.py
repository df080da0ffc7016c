"""The pages of docs/clients do what they say: their commands are run, on ports of the test's own."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from client_swarm import FRAME, GROUND, client_swarm
from mavproxy_client import started
from programs import ENVIRONMENT, PATIENCE

PAGES = Path(__file__).parents[2] / "docs" / "clients"

_BLOCK = re.compile(r"^```(?P<language>\w*)\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL)


def blocks(page):
    """(language, text) of each block of a page."""
    return [block.groups() for block in _BLOCK.finditer((PAGES / page).read_text(encoding="utf-8"))]


def options(command):
    """The options of a vehicle-sim on a page."""
    name, *words = shlex.split(command)
    assert name == "vehicle-sim"
    return words


@pytest.mark.slow
@pytest.mark.parametrize("page", ["mavsdk.md", "pymavlink.md"])
def test_program_of_page_flies_as_the_page_says(page, tmp_path):
    (_, simulator), (_, program) = [block for block in blocks(page) if block[0] in ("sh", "python")]
    with client_swarm(tmp_path / "run", *options(simulator)) as swarm:
        assert program.count("14540") == 1
        (tmp_path / "fly.py").write_text(program.replace("14540", str(swarm.sdk_port(1))), encoding="utf-8")
        done = subprocess.run(
            [sys.executable, "fly.py"], cwd=tmp_path, env=ENVIRONMENT, capture_output=True, text=True, timeout=PATIENCE
        )
        assert done.returncode == 0, done.stderr
        assert done.stdout.splitlines()[-1] == "landed"
        track = swarm.track(1)
    assert track.height.max() > 1.8 and track.height[-1] < 0.05
    assert "It prints `landed`" in (PAGES / page).read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.long  # the same commands: tests/clients/test_mavproxy.py
def test_commands_of_the_page_of_mavproxy_fly_as_it_says(tmp_path):
    (_, simulator), (_, command), (_, typed) = [block for block in blocks("mavproxy.md") if block[0]]
    printed = {"param show": r"MPC_XY_CRUISE +5", "arm": "ARMED", "takeoff": "Mode LOITER", "long": "DISARMED"}
    with client_swarm(tmp_path / "run", *options(simulator)) as swarm:
        assert command.count("14540") == 1
        words = shlex.split(command.replace("14540", str(swarm.sdk_port(1))))
        with started(words, tmp_path) as program:
            for line in typed.splitlines():
                program.type(line)
                for begin, pattern in printed.items():
                    if line.startswith(begin):
                        program.until(pattern)
                if line.startswith("guided"):
                    latitude, longitude, height = map(float, line.split()[1:])
                    north, east, _ = FRAME.local(latitude, longitude, FRAME.altitude)
                    program.type("watch GLOBAL_POSITION_INT")
                    while swarm.track(1).nearest(north, east, height) > 0.3:
                        program.until("< GLOBAL_POSITION_INT {")
        track = swarm.track(1)
        assert track.height.max() > 2.7 and track.position[-1, 2] == pytest.approx(GROUND, abs=0.05)
        assert swarm.modes(1) == ["AUTO.LOITER", "AUTO.TAKEOFF", "AUTO.LOITER", "AUTO.RTL", "AUTO.LOITER"]
    assert (north, east) == pytest.approx((2.0, 0.0), abs=0.1)


def test_every_page_is_linked_from_the_index_and_the_readme():
    pages = {path.name for path in PAGES.glob("*.md")}
    for document, folder in (
        (PAGES.parent / "clients.md", "clients"),
        (PAGES.parents[1] / "README.md", "docs/clients"),
    ):
        found = re.findall(rf"\]\({folder}/([\w.]+)\)", document.read_text(encoding="utf-8"))
        assert {*found} == pages


@pytest.mark.parametrize("page", ["qgroundcontrol.md", "mavros.md"])
def test_page_of_a_program_that_was_not_run_says_so(page):
    assert "was not run with `vehicle-sim`" in (PAGES / page).read_text(encoding="utf-8")
