"""The progress of a flight: a block at a terminal, lines elsewhere, and the flight as it is without."""

import argparse
import contextlib
import io
import re
import sys

import numpy as np
import pytest
from flights import HOP, MISSIONS, InProcessFlight, system_file
from rich.console import Console

from gcs.app.flight_log import FlightLog
from gcs.app.fly import ground_station
from gcs.app.logs import logging_to
from gcs.app.progress import FlightProgress
from gcs.flight.flight_status import BAD, OK, WARNING, Figure, FlightStatus
from gcs.mission.read import read_mission
from gcs.record.recorder import FlightRecorder
from idc_controller.geometry.formation import Formation

POLE, RADIUS = 5.0, 0.4
MISSION = f"""
{HOP}
[[obstacle]]
name = "pole"
shape = "pole"
position = [0.0, {POLE}]
radius = {RADIUS}
height = 10.0
known = true

[[fault]]
kind = "bias"
start = 4.0
vehicles = [2]
channel = "position"
axes = ["x"]
amount = 0.6

[[fault]]
kind = "packet_loss"
start = 2.0
vehicles = [3]
direction = "telemetry"
probability = 0.2
"""
ISOLATED = "vehicle 2: channel_isolated (position, velocity)"
CONTROL = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]")
QUIET = argparse.Namespace(verbose=0, quiet=0, log_file=None)


class Terminal(io.StringIO):
    """A file that says that it is a terminal."""

    def isatty(self):
        return True


class Flown:
    """A flight with what was printed, and the formation's hull."""

    def __init__(self, folder, *consoles):
        folder.mkdir()
        system_file(folder)
        (folder / "hop.toml").write_text(MISSION)
        mission = read_mission(folder / "hop.toml")
        with InProcessFlight(mission, folder / "run", obstacles=mission.obstacles) as flight:
            with contextlib.ExitStack() as entered:
                log = FlightLog(flight.station)
                shown = [entered.enter_context(FlightProgress(console)) for console in consoles]
                flight.fly(lambda _: (log.update(), *(progress.update(flight.flight) for progress in shown)))
            self.summary, self.alarms = flight.summary(), flight.flight.failsafes.alarms.alarms
        self.records = {path.name: path.read_bytes() for path in (folder / "run").iterdir()}
        self.outputs = [console.file.getvalue() for console in consoles]
        hull = Formation(mission.system.parameters()).hull_points(np.zeros((1, 3)))[0]
        self.clearance = POLE - RADIUS - hull[:, 1].max()


@pytest.fixture(scope="module")
def flights(tmp_path_factory):
    """The same flight at a terminal and with plain lines at once, and without any of them."""
    folder, terminal = tmp_path_factory.mktemp("progress"), Terminal()
    drawn = Console(file=terminal, width=80, highlight=False, force_terminal=True)
    plain = Console(file=io.StringIO(), width=80, highlight=False)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sys.stderr", terminal)
        with logging_to(QUIET):
            shown = Flown(folder / "shown", drawn, plain)
    return shown, Flown(folder / "without")


@pytest.mark.slow
def test_terminal_shows_phase_payload_clearance_and_links_within_its_width(flights):
    shown, _ = flights
    lines = [line.rstrip() for line in CONTROL.sub("", shown.outputs[0]).replace("\r", "\n").splitlines()]
    assert max(map(len, lines)) <= 80
    assert any(re.search(r"land .*━ +\d+ of 1\d s 0:\d\d:\d\d$", line) for line in lines)
    payload = re.compile(
        r"error +0\.\d\d m  tilt +0\.\d deg  speed +\d\.\d m/s  clearance \d\.\d\d m \(margin 0\.50 m\)$"
    )
    assert any(map(payload.match, lines))
    for first in (1, 3):
        figures = [rf"link {link}: loss +[\d.]+ %, +\d+ ms, +\d+ Hz" for link in (first, first + 1)]
        assert any(re.fullmatch("  ".join(figures), line) for line in lines)


@pytest.mark.slow
def test_terminal_prints_each_phase_and_each_alarm_once(flights):
    shown, _ = flights
    text = CONTROL.sub("", shown.outputs[0])
    assert text.count(ISOLATED) == 1
    for alarm in shown.alarms:
        assert f"{alarm.time:.2f} s: {alarm.source}: {alarm.code.code}" in text
    _, *rows = shown.records["phases.csv"].decode().splitlines()
    assert re.findall(r" s: phase ([a-z ]+)$", text, re.MULTILINE) == [row.split(",")[1] for row in rows]
    assert re.search(r"\x1b\[31m\d+\.\d\d s: vehicle 2: channel_isolated", shown.outputs[0])  # an error is red


@pytest.mark.slow
def test_plain_lines_have_no_control_sequences_and_figures_every_ten_seconds(flights):
    shown, _ = flights
    _, plain = shown.outputs
    assert "\x1b" not in plain and "\r" not in plain
    lines = plain.splitlines()
    assert max(map(len, lines)) <= 80
    status = [i for i, line in enumerate(lines) if line.startswith("   10.00 s  ")]
    assert len(status) == 1 and not any(line.startswith("   20.") for line in lines)
    time, end, error, clearance, loss = re.match(
        r"   10.00 s  (\d+) of (\d+) s; error ([\d.]+) m; tilt [\d.]+ deg; speed [\d.]+ m/s\n"
        r" +clearance ([\d.]+) m \(margin 0.50 m\)\n"
        r" +link 1: loss 0.0 %, \d+ ms, \d+ Hz; link 2: loss 0.0 %, \d+ ms, \d+ Hz\n"
        r" +link 3: loss ([\d.]+) %, \d+ ms, \d+ Hz; link 4: loss 0.0 %, \d+ ms, \d+ Hz",
        "\n".join(lines[status[0] :]),
    ).groups()
    assert float(time) == pytest.approx(9.0, abs=1.0)
    assert float(end) == pytest.approx(shown.summary["duration_s"], abs=4.0)  # spool-down comes after touchdown
    assert float(error) < 0.1 and float(clearance) == pytest.approx(shown.clearance, abs=0.05)
    assert float(loss) == pytest.approx(20.0, abs=8.0)


def test_ground_that_does_not_connect_says_what_it_waits_for_once_and_again_when_that_changes(tmp_path):
    mission = read_mission(MISSIONS / "hop.toml")
    console = Console(file=io.StringIO(), width=80, highlight=False)
    with FlightRecorder(tmp_path, 0.0) as recorder:
        flight = ground_station(mission, [None] * 4, recorder).flight
        progress, preflight = FlightProgress(console), flight.system.preflight
        for tenths in range(80):
            flight.time = flight.ground_time = now = 0.1 * tenths
            preflight.missing = "0 of 4" if now < 1.0 else "1 of 4" if now < 3.0 else f"{min(now, 5.0):.1f} of 4"
            progress.update(flight)
    assert console.file.getvalue().splitlines() == [
        "    0.00 s  connect",
        "    2.00 s  waits: 1 of 4",
        "    4.00 s  waits: 4.0 of 4",
        "    6.00 s  waits: 5.0 of 4",
    ]


def test_links_show_loss_latency_and_silence_by_their_limits(tmp_path):
    mission = read_mission(MISSIONS / "hop.toml")
    with FlightRecorder(tmp_path, 0.0) as recorder:
        flight = ground_station(mission, [None] * 4, recorder).flight
        status = FlightStatus(flight)
        assert status.links()[0] == Figure("link 1: no telemetry yet", WARNING)
        flight.ground_time = 2.0
        for link, lost, delay, heard in zip(
            flight.system.team.links, (0, 40, 0, 0), (0.001, 0.001, 0.2, 0.001), (2.0, 2.0, 2.0, 1.0), strict=True
        ):
            link.statistics.received, link.statistics.missing = 200 - lost, lost
            link.clock.add_answer(link.clock.request(0.0), 2.0 * delay)
            link.position_received_at = heard
        assert status.links() == [
            Figure("link 1: loss  0.0 %,   1 ms, 100 Hz", OK),
            Figure("link 2: loss 20.0 %,   1 ms,  80 Hz", WARNING),
            Figure("link 3: loss  0.0 %, 200 ms, 100 Hz", BAD),
            Figure("link 4: no telemetry for 1.0 s", BAD),
        ]


@pytest.mark.parametrize("is_terminal", [True, False])
def test_standard_error_of_a_file_is_not_drawn(monkeypatch, is_terminal):
    drawn, error = Terminal(), Terminal() if is_terminal else io.StringIO()
    monkeypatch.setattr("sys.stderr", error)
    with FlightProgress(Console(file=drawn, force_terminal=True)):
        print("a warning", file=sys.stderr)
    assert ("a warning" in drawn.getvalue(), "a warning" in error.getvalue()) == (is_terminal, not is_terminal)


@pytest.mark.slow
def test_records_do_not_depend_on_what_is_printed(flights):
    shown, without = flights
    timed = {"steps.csv", "summary.json"}  # compute times, and CPU
    assert shown.records.keys() == without.records.keys() > timed
    assert {name for name, content in without.records.items() if shown.records[name] != content} <= timed
