"""The summary of a flight for the terminal."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from gcs.record.outcome import Outcome
from gcs.record.summary import within_limits

_COLOUR_OF_OUTCOME = {Outcome.COMPLETED: "green", Outcome.INTERRUPTED: "yellow", Outcome.ABORTED: "yellow"}
_DIGITS = {"m": 3, "deg": 1, "m/s": 2, "": 0}
"""Digits after the point by unit."""


def print_summary(
    console: Console,
    summary: Mapping[str, Any],
    run_dir: Path | str,
    files: Sequence[Path] = (),
    *,
    details: bool = False,
) -> None:
    """Print what ``gcs fly`` prints at the end: the result in one line, figures with their limits, the folder.

    ``details``: those that developers read, too.
    """
    console.print(_result(summary), soft_wrap=True)  # whole, however narrow the terminal
    console.print(_figures(summary))
    if details:
        console.print(_details(summary))
    if summary["source"] == "estimate":
        console.print(Text("The swarm kept no truth here: figures are the ground's own estimate.", "yellow"))
    console.print(Text(f"Records   {run_dir}"), soft_wrap=True)
    if files:
        console.print(Text("Report    " + "  ".join(path.name for path in files)), soft_wrap=True)


def _result(summary: Mapping[str, Any]) -> Text:
    outcome, held = summary["outcome"], True
    title = Text("").append("Flight ", "bold").append(outcome, f"bold {_COLOUR_OF_OUTCOME.get(outcome, 'red')}")
    if summary["limits"]:
        held = within_limits(summary)
        verdict = ("within its limits", "green") if held else ("OUTSIDE its limits", "bold red")
        if "incomplete_records" in summary:
            verdict = ("limits not judged, the records are incomplete", "yellow")
        title.append(", ").append(*verdict)
    if exceeded := void_guarantee(summary):
        title.append(f", {'but' if held else 'and'} {exceeded}", "bold red")
    title.append(f": {_number(summary['duration_s'], 1, 's')}")
    if summary["real_time_factor"] is not None:
        title.append(f", {_number(summary['real_time_factor'], 1)} times real time")
    return title


def _figures(summary: Mapping[str, Any]) -> Table:
    """Return what a flight is judged by: what is known, and what should be."""
    table = _table()
    for row in summary["result"]:
        value, unit, held = row["value"], row["unit"], row["held"]
        if value is None and held is not False:
            continue
        cells: list[str | Text] = [row["what"], _number(value, _DIGITS[unit], unit)]
        if held is not None:
            verdict = Text("held", style="green") if held else Text("NOT HELD", style="bold red")
            cells += [f"{row['bound']} {row['limit']:g} {unit}", verdict]
        table.add_row(*cells)
    return table


def _details(summary: Mapping[str, Any]) -> Table:
    """Return the figures of how the flight was flown, for developers."""
    rmse, tilt, safety = summary["position_rmse_m"], summary["payload_tilt_max_deg"], summary["safety"]
    steps, parts = summary["step_time_ms"], summary.get("step_parts_ms")
    table = _table()

    def row(title: str, values: Sequence[float | None], digits: int, unit: str) -> None:
        table.add_row(title, " / ".join(_number(value, digits) for value in values) + f" {unit}")

    row("position error, north / east / down", [rmse[axis] for axis in "xyz"], 3, "m")
    row("payload angle, roll / pitch / yaw", [tilt[axis] for axis in ("roll", "pitch", "yaw")], 1, "deg")
    row("control step, median / p99 / max", [steps[name] for name in ("p50", "p99", "max")], 1, "ms")
    for name, part in (parts or {}).items():
        row(f"  {name.replace('_', ' ')}, median / p99", [part["p50"], part["p99"]], 1, "ms")
    if safety and safety["payload_tracking_bound_m"] is not None:
        for name in ("payload", "uav"):
            values = [safety[f"{name}_tracking_max_m"], safety[f"{name}_tracking_bound_m"]]
            row(f"{name.replace('uav', 'UAVs')} off the plan, largest / bound", values, 3, "m")
        row("barrier violated by at most", [safety["slack_max_m"]], 3, "m")
        row("steps verified to keep the margin", [100.0 * safety["verified_steps"] / safety["steps"]], 1, "%")
        if safety["way_back_max_s"] is not None:
            row("longest recovery to the reference", [safety["way_back_max_s"]], 1, "s")
    row("steps without a feasible solution", [summary["solver"]["infeasible_steps"]], 0, "")
    return table


def _table() -> Table:
    """Return one without a title line; its columns fit 80 characters."""
    table = Table(box=None, show_header=False, padding=(0, 2, 0, 0))
    table.add_column()
    table.add_column(justify="right")
    table.add_column()
    table.add_column()
    return table


def void_guarantee(summary: Mapping[str, Any]) -> str:
    """Return in words why the safety guarantee did not hold all the time; empty: it did, or is not known.

    Where there was nothing to keep clear of, it is the plan that was left.
    """
    exceeded = (summary["safety"] or {}).get("exceeded") or {}
    named = {"plan_clearance": ("planned clearance", "at least"),
             "payload_deviation": ("payload off the plan", "bound"),
             "uav_deviation": ("UAVs off the plan", "bound")}  # fmt: skip
    parts = [
        f"{named[name][0]} {entry['value']:.2f} m ({named[name][1]} {entry['limit']:.2f} m) at {entry['time_s']:.1f} s"
        for name, entry in exceeded.items()
    ]
    is_void = "plan_clearance" in exceeded or summary["clearance_min_m"] is not None
    void = "the safety guarantee was void: " if is_void else ""
    return f"{void}{', '.join(parts)}" if parts else ""


def _number(value: float | None, digits: int, unit: str = "") -> str:
    return "-" if value is None else f"{value:.{digits}f} {unit}".rstrip()
