"""``gcs serve --sim``: MAVSDK and MAVProxy fly the team as one aircraft; what then happens is in the true motion."""

from __future__ import annotations

import contextlib
import math
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from client_swarm import FRAME
from mavproxy_client import mavproxy
from mavsdk.plugins.mission import MissionItem, MissionPlan
from mavsdk_client import first, fly
from programs import ENVIRONMENT, PATIENCE, base_port
from team_bench import Truth

pytestmark = pytest.mark.slow

CORNERS = [(5.0, 0.0, 2.0), (5.0, 4.0, 3.0)]
ASIDE = (2.0, 2.0, 3.0)


@contextlib.contextmanager
def served(folder: Path, *ports: int):
    """Serve a team of three to ports of clients; its process, when it listens."""
    clients = [word for port in ports for word in ("--client", f"127.0.0.1:{port}")]
    words = [sys.executable, "-m", "gcs", "serve", "--sim", "--vehicles", "3", "--speed", "4", "--run-dir", folder,
             "--listen", "127.0.0.1:0", *clients]  # fmt: skip
    with subprocess.Popen(
        [*map(str, words)], env=ENVIRONMENT, cwd=folder.parent, text=True, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    ) as process:  # fmt: skip
        try:
            line = process.stdout.readline()
            assert re.fullmatch(r"team: udp://127\.0\.0\.1:[1-9]\d*\n", line), line + process.stderr.read()
            while "ready" not in (line := process.stdout.readline()):
                assert line.startswith("sends to: udp://")
            yield process
        finally:
            if process.poll() is None:
                process.kill()


async def program(client):
    """Fly a mission with a pause and a go-to, and return."""
    action, mission, telemetry = client.action, client.mission, client.telemetry
    items = [MissionItem(*FRAME.geodetic(north, east, 0.0)[:2], up, 2.0, True) for north, east, up in CORNERS]
    await mission.set_return_to_launch_after_mission(True)
    await mission.upload_mission(MissionPlan(items))
    downloaded = await mission.download_mission()
    await first(telemetry.subscribe_health_all_ok(), lambda ok: ok)
    await action.arm()
    await mission.start_mission()
    await first(telemetry.subscribe_position_velocity_ned(), lambda found: found.position.north_m > 2.0)
    await mission.pause_mission()
    latitude, longitude, _ = FRAME.geodetic(*ASIDE[:2], 0.0)
    home = await first(telemetry.subscribe_home())
    await action.goto_location(latitude, longitude, home.absolute_altitude_m + ASIDE[2], math.nan)
    await client.is_at(ASIDE[0], ASIDE[1], -ASIDE[2])
    await mission.start_mission()
    await first(mission.subscribe_mission_progress(), lambda found: found.current == found.total)
    await first(telemetry.subscribe_armed(), lambda armed: not armed)
    return len(downloaded.mission_items)


def arm(client):
    """Arm as soon as the checks of the next flight have passed."""
    while client.command("arm throttle", r"COMMAND_ACK: COMPONENT_ARM_DISARM: (\w+)")[1] != "ACCEPTED":
        pass


@pytest.fixture(scope="module")
def session(tmp_path_factory):
    """One service: a flight by MAVSDK, one by MAVProxy, and one that Ctrl-C ends; exit status and what was said."""
    folder = tmp_path_factory.mktemp("served") / "run"
    sdk, proxy = base_port(), base_port()
    with served(folder, sdk, proxy) as process:
        items = fly(sdk, program)
        with mavproxy(proxy, folder.parent) as client:
            arm(client)
            client.command(
                "long DO_SET_MODE 1 4 2", "Mode TAKEOFF"
            )  # its command takeoff takes the height above the sea
            client.until("Mode LOITER")
            began = float(Truth(folder).time[-1])
            latitude, longitude, _ = FRAME.geodetic(*ASIDE[:2], 0.0)
            client.command(f"guided {latitude:.7f} {longitude:.7f} {ASIDE[2]}", "COMMAND_ACK: DO_REPOSITION: ACCEPTED")
            client.command("setspeed 1", "COMMAND_ACK: DO_CHANGE_SPEED: ACCEPTED")
            client.type("watch LOCAL_POSITION_NED")
            while Truth(folder, began).nearest(*ASIDE) > 0.3:
                client.until("< LOCAL_POSITION_NED {")
            client.type("watch")
            client.command("disarm", "Disarming denied: in the air")
            client.command("long NAV_LAND", "Mode LAND")
            client.until("DISARMED")
            arm(client)
            client.command("long DO_SET_MODE 1 4 2", "Mode TAKEOFF")
            client.until("Mode LOITER")
            process.send_signal(signal.SIGINT)
            printed = "\n".join(client.printed)
        out, errors = process.communicate(timeout=PATIENCE)
    return folder, items, printed, process.returncode, out, errors


def test_mavsdk_flies_a_mission_with_pause_and_go_to(session):
    folder, items, *_ = session
    flown = Truth(folder / "flight-1")
    assert items == len(CORNERS)
    assert max(flown.nearest(*corner) for corner in CORNERS) < 0.3 and flown.nearest(*ASIDE) < 0.3
    assert math.hypot(*flown.position[-1, :2]) < 0.3 and -flown.position[-1, 2] < 0.35
    assert flown.contacts.max() == 0 and flown.tilt.max() < 5.0


def test_mavproxy_flies_by_commands_and_is_refused_with_the_reason(session):
    folder, _, printed, *_ = session
    flown = Truth(folder / "flight-2")
    assert flown.nearest(*ASIDE) < 0.3
    assert -flown.position[-1, 2] < 0.35 and "Traceback" not in printed


def test_ctrl_c_in_flight_lands_and_closes_the_records(session):
    folder, _, _, status, out, errors = session
    assert status == 130 and "Traceback" not in errors and "leaked" not in errors
    assert [Path(line).name for line in out.splitlines()] == ["flight-1", "flight-2", "flight-3"]
    last = Truth(folder / "flight-3")
    assert last.position[:, 2].min() < -2.0 and -Truth(folder).position[-1, 2] < 0.35
    assert all((folder / f"flight-{number}/summary.json").exists() for number in (1, 2, 3))


def test_sigterm_on_the_ground_ends_at_once(tmp_path):
    with served(tmp_path / "run", base_port()) as process:
        process.send_signal(signal.SIGTERM)
        out, errors = process.communicate(timeout=PATIENCE)
    assert (process.returncode, out) == (0, "") and "Traceback" not in errors
