"""Signals that end the programs: in a flight the first is a request, a second Ctrl-C or SIGTERM ends control."""

import contextlib
import json
import os
import pty
import signal
import subprocess
import sys
import threading
from functools import partial

import pytest
from mission_files import MISSIONS
from programs import ENVIRONMENT, PATIENCE, swarm_process

from gcs.app.cli import main
from gcs.app.exit_status import ExitStatus
from gcs.app.output import output_that_may_end
from gcs.drivers.interrupt import SIGNALS, Interrupt
from gcs.drivers.participant import INTERRUPTED_TWICE

HANG_UP, CTRL_C, TERMINATE = signal.SIGHUP, signal.SIGINT, signal.SIGTERM


def send(number):
    os.kill(os.getpid(), number)


@pytest.mark.parametrize("first", SIGNALS)
@pytest.mark.parametrize("second", [CTRL_C, TERMINATE])
def test_signals_in_flight_are_requests_to_land_and_to_end_control(first, second):
    with Interrupt() as interrupt:
        interrupt.begin_flight()
        send(first)
        assert interrupt.requested and not interrupt.requested_again
        for _ in range(2):  # a third one would leave records open
            send(second)
            assert interrupt.requested_again


@pytest.mark.parametrize("first", SIGNALS)
def test_a_hang_up_is_never_the_second_signal(first):
    with Interrupt() as interrupt:
        interrupt.begin_flight()
        for number in (first, HANG_UP, HANG_UP):
            send(number)
        assert interrupt.requested and not interrupt.requested_again


def test_signal_that_compiled_code_reports_as_its_own_error_is_an_interrupt():
    with pytest.raises(KeyboardInterrupt), Interrupt():
        try:
            send(CTRL_C)
        except KeyboardInterrupt as error:
            raise SystemError("returned a result with an exception set") from error


def test_error_of_compiled_code_without_a_signal_is_passed_on():
    with pytest.raises(SystemError), Interrupt():
        raise SystemError


def test_service_that_is_interrupted_twice_says_so(monkeypatch, capsys, tmp_path):
    def run(*_, **__):
        send(CTRL_C)
        send(CTRL_C)

    monkeypatch.setattr("gcs.app.serve.run_in_real_time", run)
    main(["serve", "--connect", "--listen", "127.0.0.1:0", "--run-dir", str(tmp_path / "run")])
    assert INTERRUPTED_TWICE in capsys.readouterr().err


@pytest.mark.parametrize("number", SIGNALS)
def test_signal_before_the_flight_interrupts_and_after_it_does_nothing(number):
    with Interrupt() as interrupt:
        with pytest.raises(KeyboardInterrupt):
            send(number)
        interrupt.begin_flight()
        interrupt.end_flight()
        send(number)
        assert not interrupt.requested


def test_hang_up_stays_ignored_where_it_was():
    before = signal.signal(HANG_UP, signal.SIG_IGN)
    try:
        with Interrupt() as interrupt:
            interrupt.begin_flight()
            send(HANG_UP)
            assert not interrupt.requested
    finally:
        signal.signal(HANG_UP, before)


def test_handlers_of_before_are_restored():
    before = [signal.getsignal(number) for number in SIGNALS]
    with Interrupt():
        assert all(signal.getsignal(number) != handler for number, handler in zip(SIGNALS, before, strict=True))
    assert [signal.getsignal(number) for number in SIGNALS] == before


def test_no_handler_is_set_outside_the_main_thread():
    failed = []

    def use():
        try:
            with Interrupt():
                pass
        except ValueError as error:
            failed.append(error)

    thread = threading.Thread(target=use)
    thread.start()
    thread.join()
    assert not failed


@pytest.mark.parametrize("target", ["pipe", "terminal", "/dev/full"])
def test_output_that_cannot_be_written_is_lost_without_an_error(target, monkeypatch, capfd):
    if target == "pipe":
        reader, writer = os.pipe()
        os.close(reader)
    elif target == "terminal":
        reader, writer = pty.openpty()
        os.close(reader)
    else:
        writer = os.open(target, os.O_WRONLY)
    with os.fdopen(writer, "w") as stream:
        monkeypatch.setattr(sys, "stdout", stream)
        with output_that_may_end("stdout"):
            for _ in range(3):
                print("x" * 10_000)
                sys.stdout.flush()
        assert sys.stdout is stream
        print("still open", flush=True)  # and goes nowhere
    said = capfd.readouterr().err
    assert said == ("standard output cannot be written: No space left on device\n" if target == "/dev/full" else "")


def test_stream_that_was_closed_before_the_start_stays_closed(monkeypatch):
    monkeypatch.setattr(sys, "stderr", None)
    with output_that_may_end("stdout", "stderr"):
        print("lost", file=sys.stderr)  # goes nowhere, or to standard output
    assert sys.stderr is None


@pytest.mark.slow
@pytest.mark.parametrize("pace", ["--lockstep", pytest.param("--realtime", marks=pytest.mark.long)])
def test_closed_terminal_ends_the_simulator(pace, tmp_path):
    ground = () if pace == "--lockstep" else ("--ground-port", 0)
    with swarm_process(pace, "--base-port", 0, *ground, "--run-dir", tmp_path / "run") as running:
        for line in running.stdout:
            if line == "ready\n":
                break
        running.send_signal(HANG_UP)
        assert running.wait(PATIENCE) == ExitStatus.INTERRUPTED
        assert running.stderr.read() == ""
    assert (tmp_path / "run" / "truth.csv").read_text().endswith("\n")


@pytest.mark.slow
@pytest.mark.parametrize("end", ["terminal", pytest.param(TERMINATE, marks=pytest.mark.long)])
def test_flight_lands_when_its_terminal_is_closed_or_it_is_to_end(end, tmp_path):
    control, terminal = pty.openpty()
    mission = str(MISSIONS / "hop.toml")
    command = [sys.executable, "-m", "gcs", "fly", mission, "--run-dir", "run", "--no-pictures", "--log-file", "log"]
    with subprocess.Popen(
        command, env={**ENVIRONMENT, "TERM": "xterm"}, cwd=tmp_path, preexec_fn=partial(os.login_tty, terminal)
    ) as flight:
        os.close(terminal)
        seen = b""
        while b"climb" not in seen:
            seen += os.read(control, 65536)
        if end == "terminal":
            os.close(control)  # the kernel sends SIGHUP, and nothing can be written any more
        else:
            flight.send_signal(end)
            with contextlib.suppress(OSError):  # its end
                while os.read(control, 65536):
                    pass
            os.close(control)
        assert flight.wait(PATIENCE) == ExitStatus.INTERRUPTED
    log = (tmp_path / "log").read_text()
    assert "flight broken off: interrupted" in log and "Traceback" not in log
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    assert summary["landing"]["on_ground"] and not summary["completed"]
    assert (tmp_path / "run" / "truth.csv").read_text().endswith("\n")
