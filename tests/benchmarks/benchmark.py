"""Speed of flights relative to an anchor, flown in turns on one core; `make benchmark`.

    python tests/benchmarks/benchmark.py              five rounds, about a quarter of an hour
    python tests/benchmarks/benchmark.py --quick      one round of shorter flights, not written to the history
    python tests/benchmarks/benchmark.py --long       the memory over an hour of simulated flight

CPU time of both programs per simulated second, from take-off to the end of the flight. A ratio of 1 means as fast as
the anchor (`anchor.py`; ANCHOR_PYTHON names a Python with gym-pybullet-drones), 2 twice as fast. Adds a row to
`history.csv`, with the size of the project and the number of calls of a control step (`growth.py`).
"""

import argparse
import csv
import math
import os
import platform
import subprocess
import sys
import tempfile
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from growth import calls_of_a_control_step, size
from measure import FLIGHTS, HERE, ROOT, anchor, fly, mission_text, obstacles, use_one_core, write, write_missions
from rich.console import Console
from rich.table import Table

HISTORY = HERE / "history.csv"
TEAMS = (3, 4, 6, 8, 12)
OBSTACLES = (50, 100, 200)
CONSOLE = Console(width=110)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--long", action="store_true")
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    rounds, duration = (1, 5.0) if options.quick else (options.rounds, 20.0)
    memory_minutes = 60.0 if options.long else 1.0 if options.quick else 10.0
    use_one_core()
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        row = {"date": f"{datetime.now(UTC):%Y-%m-%d}", "commit": commit(), **machine()}
        row |= ratios(folder, rounds, duration)
        row |= exponents(folder, 5.0)
        row |= memory(folder, memory_minutes)
        row |= grown()
    if not options.quick:
        add_to_history(row)


def ratios(folder, rounds, duration):
    """Fly in turns with the anchor, which is measured before and after each flight."""
    missions = write_missions(ROOT, folder, duration)
    flown, speeds = {name: [] for name in FLIGHTS}, {name: [] for name in FLIGHTS}
    anchors = [anchor()]
    for _ in range(rounds):
        for name in FLIGHTS:
            flight = fly(ROOT, missions[name])
            anchors.append(anchor())
            around = (anchors[-2]["ms_per_second"] + anchors[-1]["ms_per_second"]) / 2.0
            flown[name].append(flight)
            speeds[name].append(around / flight["ms_per_second"])
            CONSOLE.print(f"{name}: {flight['ms_per_second']:.0f} ms per simulated second, {speeds[name][-1]:.2f}")
    anchor_ms, anchor_step = of_all(anchors, "ms_per_second"), of_all(anchors, "step_ms", "p50")
    table = Table("", "CPU ms per simulated s", "speed: median", "min", "max", title=f"speed, {anchors[0]['loop']} = 1")
    for name in FLIGHTS:
        table.add_row(name, f"{of_all(flown[name], 'ms_per_second'):.0f}", *map("{:.2f}".format, spread(speeds[name])))
    table.add_row(anchors[0]["loop"], f"{anchor_ms:.0f}", "1")
    CONSOLE.print(table)
    step_times(flown, anchors, control_period())
    row = {"anchor": anchors[0]["loop"], "anchor_ms_per_second": round(anchor_ms, 1)}
    row["anchor_step_p50_ms"] = round(anchor_step, 2)
    for name in FLIGHTS:
        for what, value in zip(("median", "min", "max"), spread(speeds[name]), strict=True):
            row[f"{name}_{what}"] = round(value, 3)
    for name in FLIGHTS:
        for what in ("p50", "p99", "max"):
            row[f"{name}_step_{what}_ms"] = round(of_all(flown[name], "step_ms", what), 2)
    return row


def step_times(flown, anchors, period):
    """Print the whole control step and its parts (CPU time)."""
    table = Table("", "p50 ms", "p99", "max", "p50 % of period", "p99 %", title=f"control step, {period:.0f} ms period")
    for name, flights in flown.items():
        p50, p99, largest = (of_all(flights, "step_ms", what) for what in ("p50", "p99", "max"))
        shares = (f"{100.0 * p50 / period:.1f}", f"{100.0 * p99 / period:.1f}")
        table.add_row(name, f"{p50:.2f}", f"{p99:.2f}", f"{largest:.2f}", *shares)
    p50, p99, largest = (of_all(anchors, "step_ms", what) for what in ("p50", "p99", "max"))
    table.add_row(f"{anchors[0]['loop']}, physics included", f"{p50:.2f}", f"{p99:.2f}", f"{largest:.2f}")
    CONSOLE.print(table)
    table = Table("p50 ms", *flown, title="parts of the control step")
    for part in flown[FLIGHTS[0]][0]["parts_ms"]:
        table.add_row(part, *(f"{of_all(flights, 'parts_ms', part, 'p50'):.2f}" for flights in flown.values()))
    CONSOLE.print(table)


def exponents(folder, duration):
    """Fit the growth of the cost with the vehicles, and of what obstacles add to it with their number."""
    text = mission_text(ROOT, "figure_eight.toml", duration, altitude=3.0)
    teams = [normalised(write(folder, "team", text), "--vehicles", n) for n in TEAMS]
    by_obstacles = [normalised(write(folder, "field", text + obstacles(n))) for n in OBSTACLES]
    table = Table("", "cost per simulated s, anchor = 1", title="growth of the cost")
    for n, cost in zip(TEAMS, teams, strict=True):
        table.add_row(f"{n} vehicles", f"{cost:.2f}")
    for n, cost in zip(OBSTACLES, by_obstacles, strict=True):
        table.add_row(f"4 vehicles, {n} obstacles", f"{cost:.2f}")
    slope = float(np.polyfit(np.log(TEAMS), np.log(teams), 1)[0])
    added = np.array(by_obstacles) - teams[TEAMS.index(4)]
    slope_obstacles = float(np.polyfit(np.log(OBSTACLES), np.log(added), 1)[0]) if (added > 0.0).all() else math.nan
    table.add_row("exponent in vehicles", f"{slope:.2f}")
    table.add_row("exponent of what obstacles add", f"{slope_obstacles:.2f}")
    CONSOLE.print(table)
    return {"vehicles_exponent": round(slope, 2), "obstacles_exponent": round(slope_obstacles, 2)}


def normalised(mission, *options):
    """Return the cost of a flight in that of the anchor, measured before and after it."""
    before, flight, after = anchor(), fly(ROOT, mission, *options), anchor()
    return flight["ms_per_second"] / ((before["ms_per_second"] + after["ms_per_second"]) / 2.0)


def memory(folder, minutes):
    """Fit the growth of both processes' memory over the second half of a flight."""
    mission = write(folder, "long", mission_text(ROOT, "figure_eight.toml", 60.0 * minutes, altitude=3.0))
    samples = np.array(fly(ROOT, mission, "--memory")["memory_mb"])
    late = samples[samples[:, 0] > samples[-1, 0] / 2.0]
    table = Table("", "at take-off, MB", "at the end", "MB per hour", title=f"memory over {minutes:.0f} min")
    row = {"memory_minutes": minutes}
    for column, name in ((1, "ground"), (2, "world")):
        growth = float(np.polyfit(late[:, 0] / 3600.0, late[:, column], 1)[0])
        table.add_row(name, f"{samples[0, column]:.1f}", f"{samples[-1, column]:.1f}", f"{growth:.1f}")
        row[f"{name}_mb_per_hour"] = round(growth, 1)
    CONSOLE.print(table)
    return row


def grown():
    """Return the size of the project and the calls of a control step; print them beside those of the last row."""
    row = {**size(ROOT), "step_calls": calls_of_a_control_step()}
    last = history()[-1] if HISTORY.exists() else {}
    table = Table("", "now", f"at {last.get('commit', '-')}", title="size of the project")
    for name, value in row.items():
        table.add_row(name, str(value), last.get(name, ""))
    CONSOLE.print(table)
    return row


def history():
    with HISTORY.open(newline="") as file:
        return list(csv.DictReader(file))


def spread(values):
    return float(np.median(values)), min(values), max(values)


def of_all(measured, *keys):
    """Return the median of a figure."""
    figures = []
    for figure in measured:
        for key in keys:
            figure = figure[key]
        figures.append(figure)
    return float(np.median(figures))


def control_period():
    from gcs.config import read_system

    return 1e3 / read_system(ROOT / "missions" / "system.toml").rates.control


def commit():
    """Return the short name of the commit that is measured, with a plus sign if files are changed."""
    git = ["git", "-C", str(ROOT)]
    name = subprocess.run([*git, "rev-parse", "--short", "HEAD"], capture_output=True, text=True).stdout.strip()
    changed = subprocess.run([*git, "status", "--porcelain", "-uno"], capture_output=True, text=True).stdout.strip()
    return name + ("+" if changed else "")


def machine():
    return {"machine": platform.machine(), "cores": os.cpu_count(), "python": platform.python_version()}


def add_to_history(row):
    """Add a row to the history; a column that is new is empty in earlier rows."""
    rows = history() if HISTORY.exists() else []
    columns = list(dict.fromkeys([*(name for earlier in rows for name in earlier), *row]))
    with HISTORY.open("w", newline="") as file:
        writer = csv.DictWriter(file, columns, restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows([*rows, row])
    CONSOLE.print(f"added to {HISTORY.relative_to(ROOT)}")


if __name__ == "__main__":
    sys.exit(main())
