"""CPU cost of a flight with its live view, and a browser's connection to it, against the same flight without.

    python tests/benchmarks/view.py [--rounds 5] [--speed 20]

The flights alternate in one run. The cost is that of the ground station and the simulator, from their start to their
end, as `summary.json` has it; the view is a program beside them, whose own cost is printed, too. Exit status 1 where
the flight costs more than 5 % above it in the median of the rounds.
"""

import argparse
import json
import re
import resource
import statistics
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path

from measure import ROOT, mission_text, write
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

LIMIT = 1.05
DURATION = 10.0  # s of the figure eight between two spheres


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--speed", type=float, default=20.0, help="simulated seconds a second (default: %(default)g)")
    options = parser.parse_args()
    ratios, beside = [], []
    with tempfile.TemporaryDirectory() as scratch:
        mission = write(scratch, "two_spheres", mission_text(ROOT, "figure_eight_spheres.toml", DURATION))
        for k in range(options.rounds):
            cost = {}
            for view in (True, False) if k % 2 else (False, True):
                cost[view], others = flown(mission, Path(scratch) / f"{k} {view}", view, options.speed)
                beside += [others] if view else []
            ratios.append(cost[True] / cost[False])
            print(f"round {k + 1}: {cost[True]:.2f} s with the view, {cost[False]:.2f} s without", flush=True)
    median = statistics.median(ratios)
    print(f"{median:.3f} of the CPU time without a view ({min(ratios):.3f} to {max(ratios):.3f}); the limit is {LIMIT}")
    print(f"the view itself: {statistics.median(beside):.2f} s of CPU a flight")
    return int(median > LIMIT)


def flown(mission, folder, view, speed):
    """Return the CPU time (s) of a flight, and that of the view beside it."""
    command = [sys.executable, "-m", "gcs", "fly", mission, "--run-dir", folder, "--no-pictures"]
    command += ["--view", "--speed", speed] if view else []
    before = children()
    with subprocess.Popen(
        [*map(str, command)], cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    ) as flight:
        if view:
            address = re.search(r"http://\S+", flight.stderr.readline())[0].replace("http", "ws")
            with (
                connect(address, max_size=None, open_timeout=None) as browser,
                suppress(ConnectionClosed),
            ):
                for _ in browser:
                    pass
        errors = flight.stderr.read()
    if flight.returncode:
        sys.exit(errors)
    cost = json.loads((folder / "summary.json").read_text())["cpu_s"]
    return cost, children() - before - cost


def children():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


if __name__ == "__main__":
    sys.exit(main())
