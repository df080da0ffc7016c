"""The two programs as processes of their own."""

import contextlib
import json
import os
import re
import socket
import subprocess
import sys
from pathlib import Path

# Importable from any folder, installed or not.
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2]), "OPENBLAS_NUM_THREADS": "1"}
PATIENCE = 120.0  # s of wall time for what takes a few


def gcs_fly(mission, folder, *options):
    """A flight by the command itself: (exit code, summary)."""
    command = [sys.executable, "-m", "gcs", "fly", str(mission), "--run-dir", str(folder), "--json", *map(str, options)]
    done = subprocess.run(command, env=ENVIRONMENT, cwd=folder.parent, capture_output=True, text=True, timeout=500)
    assert "Traceback" not in done.stderr and "leaked" not in done.stderr, done.stderr
    return done.returncode, json.loads(done.stdout) if done.stdout else done.stderr


class GcsProcess:
    """The command itself, followed by the phases that it prints."""

    def __init__(self, mission, folder, *options):
        command = [sys.executable, "-m", "gcs", "fly", mission, "--run-dir", folder, "--no-pictures", *options]
        self.folder = folder
        self.process = subprocess.Popen(
            [*map(str, command)], env=ENVIRONMENT, cwd=folder.parent, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            text=True,
        )  # fmt: skip
        self.output = []

    def until_phase(self, phase):
        for line in self.process.stdout:
            self.output.append(line)
            if re.match(rf"\s*[\d.]+ s  {phase}$", line.rstrip()):
                return
        raise AssertionError("".join(self.output) + self.process.stderr.read())

    def end(self):
        """(exit code, standard error)"""
        out, errors = self.process.communicate(timeout=PATIENCE)
        self.output.append(out)
        assert "Traceback" not in errors, errors
        return self.process.returncode, errors

    def child(self):
        """Process id of the vehicle-sim that it started."""
        children = Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children").read_text().split()
        assert len(children) == 1
        return int(children[0])


def swarm_process(*arguments):
    command = [sys.executable, "-m", "vehicle_sim", *map(str, arguments)]
    return subprocess.Popen(command, env=ENVIRONMENT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def addresses_of(process):
    """Addresses that the simulator prints until it is ready: {"clock" or "vehicle 1" ...: url}."""
    urls = {}
    for line in process.stdout:
        if line.strip() == "ready":
            return urls
        who, _, url = line.strip().partition(": ")
        urls[who] = url
    raise AssertionError(process.stderr.read())


_BASE_PORTS = iter(range(20_000 + 500 * int(os.environ.get("PYTEST_XDIST_WORKER", "gw0")[2:]), 30_000, 10))


def base_port():
    """A port that with the one below it and the three above is free, of a range that only this worker's tests use.

    The system gives out no ports of this range by itself (it begins at 32768).
    """
    for base in _BASE_PORTS:
        with contextlib.ExitStack() as opened, contextlib.suppress(OSError):
            for port in range(base - 1, base + 4):
                opened.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)).bind(("127.0.0.1", port))
            return base
    raise AssertionError("no free ports")


@contextlib.contextmanager
def process(*arguments):
    """A vehicle-sim of its own, with the addresses that it prints: (process, clock or None, vehicles)."""
    command = [sys.executable, "-m", "vehicle_sim", *map(str, arguments)]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, text=True, env=ENVIRONMENT) as started:
        try:
            announced = []
            for line in started.stdout:
                if line == "ready\n":
                    break
                announced.append(re.fullmatch(r"(clock|vehicle \d): udp://([\d.]+):(\d+)\n", line).groups())
            else:
                raise AssertionError(started.stderr.read())
            addresses = {who: (host, int(port)) for who, host, port in announced}
            clock = addresses.pop("clock", None)
            assert [*addresses] == [f"vehicle {i}" for i in range(1, len(addresses) + 1)]
            yield started, clock, list(addresses.values())
        finally:
            if started.poll() is None:
                started.kill()
