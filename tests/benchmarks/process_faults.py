"""Flights in real time of which a process is killed or suspended on the way: how the payload is set down.

    python tests/benchmarks/process_faults.py [--speed 1] [--seed 1] [--json] [FAULT ...]

Starts `vehicle-sim` and `gcs fly --connect` for the figure eight, a process each. When the payload, by the truth that
the simulator records, flies faster than 3 m/s, one process is killed (SIGKILL), or suspended (SIGSTOP) for 5 s and
continued. The flight ends when, by that truth, all rotors have stopped and the payload rests. Printed are figures of
the whole flight, from the truth. Exit status 1 where one is outside the limits of :data:`LIMITS`.

On a machine that is too busy for real time the ground lands before the fault: such a flight is repeated at half the
speed, and at half of that. Exit status 2 where none comes to the fault.
"""

import argparse
import json
import os
import signal
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parent / "support"), str(HERE.parents[1])]

from programs import PATIENCE, GcsProcess, process  # noqa: E402

from gcs.record.growing import GrowingTables  # noqa: E402
from gcs.record.landing import landing_figures, onsets  # noqa: E402
from gcs.record.run_data import read_run  # noqa: E402
from gcs.record.summary import payload_tilt_max  # noqa: E402
from gcs.record.tables import TRUTH  # noqa: E402

MISSION = HERE.parents[1] / "missions" / "figure_eight.toml"
MOVING = 3.0  # m/s
SUSPENDED = 5.0  # s of simulated time
RESTING = 2.0  # s without thrust and motion
LONGEST = 200.0  # s of simulated time after which a flight is taken for stuck
POLL = 0.1  # s
FAULTS = {
    "ground_killed": "ground killed",
    "ground_suspended": "ground suspended",
    "simulator_suspended": "simulator suspended",
}
LIMITS = {"touchdown_mps": 1.0, "tilt_deg": 15.0, "separation_m": 0.6, "contacts": 0}
"""Least separation; the others are at most."""


class FlightEndedError(Exception):
    """The flight ended before its fault."""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("faults", nargs="*", metavar="FAULT", help=f"{', '.join(FAULTS)} (default: all)")
    parser.add_argument("--speed", type=float, default=1.0, help="of simulated time (default: %(default)g)")
    parser.add_argument("--seed", type=int, default=1, help="of the sensors' noise (default: %(default)s)")
    parser.add_argument("--json", action="store_true", help="print JSON only")
    options = parser.parse_args()
    if unknown := set(options.faults) - set(FAULTS):
        parser.error(f"{min(unknown)}: not one of {', '.join(FAULTS)}")
    results = {}
    for name in options.faults or FAULTS:
        for speed in (options.speed, options.speed / 2.0, options.speed / 4.0):
            try:
                with tempfile.TemporaryDirectory() as folder:
                    results[name] = flown(name, Path(folder), speed, options.seed)
                break
            except FlightEndedError as ended:
                print(f"{FAULTS[name]}, speed {speed:g}: the flight ended before:\n{ended}", file=sys.stderr)
        else:
            return 2
    print(json.dumps(results) if options.json else text_of(results))
    return int(not all(row["within_limits"] for row in results.values()))


def flown(name, folder, speed, seed):
    """Fly with a fault; return the figures of the flight."""
    world, run = folder / "world", folder / "run"
    ports = ("--base-port", 0, "--sdk-port", 0, "--ground-port", 0)
    given = ("--speed", speed, "--seed", seed)
    with process("--realtime", "--mission", MISSION, "--run-dir", world, *ports, *given) as (simulator, _, vehicles):
        urls = [f"udp://{host}:{port}" for host, port in vehicles]
        ground = GcsProcess(MISSION, run, "--realtime", *given, "--connect", *urls)
        truth = Truth(world)
        try:
            while truth.speed() < MOVING:
                if ground.process.poll() is not None:
                    raise FlightEndedError("".join(ground.process.communicate()))
                time.sleep(POLL)
            begin = truth.time()
            inject(name, ground.process, simulator, SUSPENDED / speed)
            while not (truth.rests() and ground.process.poll() is not None) and truth.time() < begin + LONGEST:
                time.sleep(POLL)
        finally:
            ground.process.kill()
            ground.process.communicate()
        simulator.terminate()
        simulator.wait(PATIENCE)
    summary = run / "summary.json"
    reason = json.loads(summary.read_text())["reason"] if summary.exists() else ""
    return {"speed": speed, "fault_s": begin, **figures(world), "ground_reason": reason}


def inject(name, ground, simulator, duration):
    """Kill a process, or suspend it for ``duration`` (s)."""
    if name == "ground_killed":
        ground.kill()
        return
    suspended = {"ground_suspended": ground, "simulator_suspended": simulator}[name]
    suspended.send_signal(signal.SIGSTOP)
    os.waitid(os.P_PID, suspended.pid, os.WSTOPPED | os.WNOWAIT)
    time.sleep(duration)
    suspended.send_signal(signal.SIGCONT)


class Truth:
    """The true motion, while the simulator records it."""

    def __init__(self, folder):
        self._tables = GrowingTables(folder)

    def _rows(self):
        self._tables.grow()
        return self._tables[TRUTH]

    def time(self):
        """Return the simulated time (s) on record."""
        rows = self._rows()
        return float(rows["time_s"][-1]) if len(rows) else 0.0

    def speed(self):
        """Return the payload's speed (m/s)."""
        rows = self._rows()
        return float(speeds(rows)[-1]) if len(rows) else 0.0

    def rests(self):
        """Return True if nothing has moved for a while."""
        rows = self._rows()
        late = rows[rows["time_s"] >= rows["time_s"][-1] - RESTING]
        thrusts = [late[name] for name in late.dtype.names if name.endswith("_thrust_n")]
        return not np.any(thrusts) and speeds(late).max() < 0.01


def speeds(rows):
    """Return the payload's speed (m/s) in each row."""
    return np.sqrt(sum(rows[f"payload_v{axis}_mps"] ** 2 for axis in "xyz"))


def figures(world):
    """Return the figures of a flight, and whether they are within the limits."""
    run = read_run(world)
    landing, tilt = landing_figures(run), payload_tilt_max(run)
    found = {
        "on_ground": landing["on_ground"],
        "touchdown_mps": landing["speed_mps"],
        "tilt_deg": max(tilt["roll"], tilt["pitch"]),
        "separation_m": float(np.nanmin(run.uav_separation())),
        "contacts": onsets(run.contacts),
    }
    within = found["on_ground"] and found["separation_m"] >= LIMITS["separation_m"]
    within = within and all(found[name] <= limit for name, limit in LIMITS.items() if name != "separation_m")
    return {**found, "within_limits": bool(within)}


def text_of(results):
    """Return the lines for people."""
    titles = f"{'at':>8}{'touchdown':>12}{'tilt':>10}{'separation':>12}{'contacts':>10}  within limits"
    lines = [f"{'fault':22}{'speed':>6}{titles}"]
    for name, row in results.items():
        touchdown = f"{row['touchdown_mps']:.2f} m/s" if row["on_ground"] else "none"
        lines += [
            f"{FAULTS[name]:22}{row['speed']:6g}{row['fault_s']:6.1f} s{touchdown:>12}{row['tilt_deg']:6.1f} deg"
            f"{row['separation_m']:10.2f} m{row['contacts']:10}  {'yes' if row['within_limits'] else 'NO'}"
        ]
        if row["ground_reason"]:
            lines += [f"    {row['ground_reason']}"]
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
