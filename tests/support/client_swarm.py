"""A ``vehicle-sim`` in real time for client programs, and what its vehicles truly did."""

from __future__ import annotations

import contextlib
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from programs import PATIENCE, base_port, process

from gcs.mavlink.services.local_frame import LocalFrame
from gcs.mission.model import DEFAULT_HOME
from gcs.record.reader import read_table

FRAME = LocalFrame(DEFAULT_HOME)
GROUND = -0.02  # m, z of a vehicle that stands on the ground


class ClientSwarm:
    """The ports of a swarm and its records so far: true motion is in its file before any message tells of it."""

    def __init__(self, run_dir: Path, listening: int, sdk: int) -> None:
        self.run_dir, self.listening, self.sdk = run_dir, listening, sdk

    def sdk_port(self, vehicle: int) -> int:
        """Return the port to which a vehicle sends its streams."""
        return self.sdk + vehicle - 1

    def now(self) -> float:
        """Return the time of the last record (s)."""
        return float(read_table(self.run_dir / "truth.csv")["time_s"][-1])

    def payload_moved(self) -> float:
        """Return how far the payload was at most from where it began (m)."""
        table = read_table(self.run_dir / "truth.csv")
        places = np.stack([table[f"payload_{axis}_m"] for axis in "xyz"], axis=1)
        return float(np.linalg.norm(places - places[0], axis=1).max())

    def track(self, vehicle: int, since: float = 0.0, until: float = np.inf) -> Track:
        """Return what a vehicle truly did between two times (s)."""
        table = read_table(self.run_dir / "truth.csv")
        return Track(table[(table["time_s"] >= since) & (table["time_s"] <= until)], f"uav{vehicle}_")

    def modes(self, vehicle: int, since: float = 0.0, until: float = np.inf) -> list[str]:
        """Return the modes that a vehicle entered between two times (s), each once in a row."""
        return self._changes("mode", vehicle, since, until)

    def armed(self, vehicle: int, since: float = 0.0, until: float = np.inf) -> list[bool]:
        """Return whether a vehicle was armed (True) or disarmed between two times (s), each once in a row."""
        return [bool(armed) for armed in self._changes("armed", vehicle, since, until)]

    def _changes(self, column: str, vehicle: int, since: float, until: float) -> list[Any]:
        table = read_table(self.run_dir / "modes.csv")
        table = table[table["vehicle"] == vehicle]
        found = table[(table["time_s"] >= since) & (table["time_s"] <= until)][column].tolist()
        return [value for i, value in enumerate(found) if i == 0 or value != found[i - 1]]


class Track:
    """True motion of one vehicle, a row each 20 ms: NED position (m, of the local frame), attitude, thrust (N)."""

    def __init__(self, table: Any, prefix: str) -> None:
        self.time = table["time_s"]
        self.position = np.stack([table[f"{prefix}{axis}_m"] for axis in "xyz"], axis=1)
        self.thrust = table[f"{prefix}thrust_n"]
        w, x, y, z = (table[f"{prefix}q{axis}"] for axis in "wxyz")
        self.roll = np.degrees(np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)))
        self.pitch = np.degrees(np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0)))
        self.yaw = np.degrees(np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)))

    @property
    def height(self) -> Any:
        """Heights above the ground (m)."""
        return GROUND - self.position[:, 2]

    @property
    def velocity(self) -> Any:
        """Mean NED velocities over 0.2 s (m/s), a row each 20 ms."""
        return (self.position[10:] - self.position[:-10]) / (self.time[10:] - self.time[:-10])[:, None]

    def nearest(self, north: float, east: float, up: float) -> float:
        """Return the least distance from a place (m)."""
        return float(np.linalg.norm(self.position - (north, east, GROUND - up), axis=1).min())


@contextlib.contextmanager
def client_swarm(folder: Path, *options: str) -> Iterator[ClientSwarm]:
    """Launch a swarm that sends to ports of its own; it must end without an error."""
    listening, sdk = base_port(), base_port()
    words = ["--base-port", listening, "--sdk-port", sdk, "--ground-port", 0, "--run-dir", folder, "--quiet"]
    with process(*words, *options) as (simulator, _, _):
        yield ClientSwarm(folder, listening, sdk)
        simulator.send_signal(signal.SIGTERM)
        assert simulator.wait(PATIENCE) == 0
        assert simulator.stderr.read() == ""
