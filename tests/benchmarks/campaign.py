"""Throughput of a campaign's parallel flights against a single flight's speed; `make benchmark-campaign`.

    python tests/benchmarks/campaign.py [--flights N]

Flies the same mission one at a time and on all cores, by the campaigns' processes. The speed of a single flight is that
of the flights one at a time from take-off to their end: simulated over wall time, without start and summary. The
throughput of parallel flights is all they flew over the wall time of the whole campaign, start of its processes,
summaries and all; its share of cores x single-flight speed is printed (wall time: the machine must be idle). Beside
it the CPU time of a flight's start and end, by a program of its own and in the campaign.
"""

import argparse
import resource
import sys
import tempfile
import time
from functools import partial
from pathlib import Path

from measure import ROOT, fly, mission_text, write
from rich.console import Console
from rich.table import Table

sys.path.insert(0, str(ROOT))

import gcs
from gcs.campaign.executors import WorkerProcesses, all_cores, carry_out


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--flights", type=int, default=4, help="flights for each core (default: %(default)s)")
    options = parser.parse_args()
    cores = all_cores()
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        mission = write(folder, "figure", mission_text(ROOT, "figure_eight.toml", 20.0, altitude=3.0))
        one, spent, single = flown(mission, folder, options.flights, jobs=1)
        parallel, _, _ = flown(mission, folder, options.flights * cores, jobs=cores)
        in_flight = fly(ROOT, mission)
    table = Table("", "", title=f"{options.flights} flights for each of {cores} cores")
    table.add_row("a single flight", f"{single:.2f} simulated s per s")
    table.add_row("one at a time, with start and end", f"{one:.2f}")
    table.add_row(f"{cores} at a time, with start and end", f"{parallel:.2f}")
    table.add_row("of cores x a single flight", f"{100.0 * parallel / (cores * single):.0f} %")
    table.add_row("start and end of a flight by itself", f"{in_flight['start_and_end_s']:.2f} s of CPU")
    table.add_row("in the campaign", f"{spent - in_flight['spent_s']:.2f} s of {spent:.2f} s")
    Console(width=100).print(table)


def flown(mission, folder, count, jobs):
    """Fly ``count`` times.

    Return simulated time per wall time of all, the CPU time of one (s), and simulated per wall time from take-off to
    the end (mean).
    """
    summaries = []

    def ended(seed, figures):
        if not (figures and figures["completed"]):
            sys.exit(f"{mission}, seed {seed}: {figures and figures['reason']}")
        summaries.append(figures)

    begin, before = time.monotonic(), children()
    with WorkerProcesses(jobs) as executor:
        carry_out(executor, partial(figures_of, mission, folder / str(jobs)), range(1, count + 1), ended)
    wall = time.monotonic() - begin
    durations = [summary["duration_s"] for summary in summaries]
    in_air = sum(summary["duration_s"] / summary["real_time_factor"] for summary in summaries)
    return sum(durations) / wall, (children() - before) / count, sum(durations) / in_air


def figures_of(mission, folder, seed):
    return gcs.fly(mission, seed=seed, run_dir=folder / str(seed)).figures


def children():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


if __name__ == "__main__":
    main()
