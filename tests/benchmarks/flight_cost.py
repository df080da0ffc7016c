"""The cost of one flight by `gcs fly`, both programs: prints one line of JSON.

    PYTHONPATH=TREE python tests/benchmarks/flight_cost.py MISSION [--vehicles N] [--memory] [--until S]

CPU time from take-off to the end of the flight, or to S seconds after it, per simulated second; apart from it that of
starting up both programs, imports included, and of the summary (`start_and_end_s`). The compute times of the control
steps are CPU times here, so that other work on the machine does not count. The tree that is measured is
that of PYTHONPATH; of it, only what `gcs fly` prepares and flies a mission with is used.
"""

import argparse
import contextlib
import json
import math
import os
import resource
import sys
import tempfile
import time
from pathlib import Path

MEMORY_INTERVAL = 10.0  # simulated s


def cpu_clock(pid):
    """Return the identifier of the clock of a process's CPU time (clock_getcpuclockid)."""
    return (~pid << 3) | 2


class Enough(Exception):
    """What is measured of the flight is over."""


class Meter:
    """CPU time and memory of this process and of those that it started; called after every exchange of the flight."""

    def __init__(self, memory, until):
        self.memory, self.until = [] if memory else None, until
        self.begin = self.end = None
        self.clocks, self.pids = [], []

    def __call__(self, flight):
        if self.begin is None:
            if math.isnan(flight.takeoff_time):
                return
            children = Path(f"/proc/self/task/{os.getpid()}/children").read_text().split()
            self.pids = [os.getpid(), *map(int, children)]
            self.clocks = [cpu_clock(pid) for pid in self.pids]
            self.begin = (flight.time, self.cpu())
        # The simulator ends after the ground: its last reading is that of the last exchange.
        with contextlib.suppress(OSError):
            self.end = (flight.time, self.cpu())
        if self.memory is not None and flight.time - (self.memory or [[-math.inf]])[-1][0] >= MEMORY_INTERVAL:
            self.memory.append([flight.time, *map(resident, self.pids)])
        if self.duration >= self.until:
            raise Enough

    def cpu(self):
        return sum(map(time.clock_gettime, self.clocks))

    @property
    def duration(self):
        return self.end[0] - self.begin[0]

    @property
    def spent(self):
        return self.end[1] - self.begin[1]


def ended_children():
    """Return the CPU time of the processes that this one started and that have ended (s)."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def resident(pid):
    """Return the resident memory of a process (MB)."""
    for line in Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1]) / 1024.0
    return math.nan


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mission", type=Path)
    parser.add_argument("--vehicles", type=int)
    parser.add_argument("--memory", action="store_true", help="sample the memory of both processes")
    parser.add_argument("--until", type=float, default=math.inf, help="s after take-off at which the flight is cut off")
    options = parser.parse_args()
    time.perf_counter = time.thread_time
    try:  # as the command does
        from gcs.app.imports import importing

        with importing():
            from gcs.app.fly_options import FlyOptions, prepare
    except ImportError:  # in trees before these modules
        from gcs.app.fly import FlyOptions, prepare

        importing = contextlib.nullcontext

    meter, summary = Meter(options.memory, options.until), {}
    with tempfile.TemporaryDirectory() as folder:
        flown = FlyOptions(options.mission, vehicles=options.vehicles, seed=1, run_dir=Path(folder) / "run")
        mission = prepare(flown)
        with importing():
            from gcs.app.fly import fly
        with contextlib.suppress(Enough):
            result = fly(flown, mission, meter)
            summary = result.summary
            if not summary["completed"]:
                sys.exit(f"{options.mission}: {summary['outcome']}: {result.reason}")
    print(
        json.dumps(
            {
                "ms_per_second": 1e3 * meter.spent / meter.duration,
                "duration_s": meter.duration,
                "spent_s": meter.spent,
                "start_and_end_s": time.process_time() + ended_children() - meter.spent,
                "step_ms": summary.get("step_time_ms"),
                "parts_ms": summary.get("step_parts_ms"),
                "memory_mb": meter.memory,
            }
        )
    )


if __name__ == "__main__":
    main()
