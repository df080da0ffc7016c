"""The summary of a flight for the terminal."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich import box
from rich.console import Console, Group, RenderableType
from rich.table import Table
from rich.text import Text

from gcs.record.outcome import Outcome
from gcs.record.summary import within_limits

_COLOUR_OF_OUTCOME = {Outcome.COMPLETED: "green", Outcome.INTERRUPTED: "yellow", Outcome.ABORTED: "yellow"}


def print_summary(
    console: Console, summary: Mapping[str, Any], run_dir: Path | str, pictures: Sequence[Path] = ()
) -> None:
    """Print what ``gcs fly`` prints at the end: the result in one line, each figure with its limit, the folder."""
    console.print(_result(summary), soft_wrap=True)  # whole, however narrow the terminal
    console.print(_figures(summary, run_dir, pictures))


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


def _figures(summary: Mapping[str, Any], run_dir: Path | str, pictures: Sequence[Path]) -> RenderableType:
    limits = summary["limits"]
    rmse, tilt = summary["position_rmse_m"], summary["payload_tilt_max_deg"]
    steps, solver = summary["step_time_ms"], summary["solver"]
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("figure")
    table.add_column("flown", justify="right")
    table.add_column("limit", justify="right")
    table.add_column("")

    def row(title: str, value: str, limit: str = "", sign: str = "", unit: str = "") -> None:
        if limit not in limits:
            table.add_row(title, value)
            return
        verdict = Text("held", style="green") if limits[limit]["held"] else Text("NOT HELD", style="bold red")
        table.add_row(title, value, f"{sign} {limits[limit]['limit']:g} {unit}", verdict)

    row("position error, RMS", _number(rmse["total"], 3, "m"), "position_rmse", "<=", "m")
    if rmse["total"] is not None:
        row("  north / east / down", " / ".join(_number(rmse[axis], 3) for axis in "xyz") + " m")
    # One limit holds for all three angles: it is shown beside the largest.
    largest = max((angle for angle in tilt.values() if angle is not None), default=None)
    row("payload angle, largest", _number(largest, 1, "deg"), "payload_tilt_deg", "<=", "deg")
    angles = " / ".join(_number(tilt[axis], 1) for axis in ("roll", "pitch", "yaw"))
    row("  roll / pitch / yaw", f"{angles} deg")
    if summary["clearance_min_m"] is not None or not limits.get("clearance", {"held": True})["held"]:
        row("clearance to obstacles and fence", _number(summary["clearance_min_m"], 3, "m"), "clearance", ">=", "m")
    row("UAVs apart", _number(summary["uav_separation_min_m"], 3, "m"), "uav_separation", ">=", "m")
    if "arrival" in limits:
        row("from waypoints and landing, largest", _number(limits["arrival"]["value"], 3, "m"), "arrival", "<=", "m")
    row("contacts", "-" if summary["contacts"] is None else str(summary["contacts"]))
    step_times = " / ".join(_number(steps[name], 1) for name in ("p50", "p99", "max"))
    row("control step, median / p99 / max", f"{step_times} ms")
    if (parts := summary.get("step_parts_ms")) is not None:
        for names in (("telemetry", "estimation", "perception"), ("planning", "control", "stop_plan"),
                      ("monitoring", "recording", "setpoints")):  # fmt: skip
            medians = " / ".join(_number(parts[name]["p50"], 1) for name in names)
            row(f"  {' / '.join(names).replace('_', ' ')}, median", f"{medians} ms")
    safety = summary.get("safety")
    if safety and safety["payload_tracking_bound_m"] is not None:
        bounds = f"{safety['payload_tracking_bound_m']:g} / {_number(safety['uav_tracking_bound_m'], 2)}"
        errors = f"{_number(safety['payload_tracking_max_m'], 3)} / {_number(safety['uav_tracking_max_m'], 3)}"
        row("off the plan, payload / UAVs, largest", f"{errors} m (margins allow {bounds} m)")
        row("barrier missed by at most", _number(safety["slack_max_m"], 3, "m"))
        share = f"{100.0 * safety['verified_steps'] / safety['steps']:.1f} %"
        row("steps whose plan keeps the margin, by exact distances", share)
        if safety["way_back_max_s"] is not None:
            row("return to the reference once it was free", _number(safety["way_back_max_s"], 1, "s"))
    if solver["infeasible_steps"]:
        row("steps without a feasible solution", str(solver["infeasible_steps"]))

    shown: list[RenderableType] = [table]
    if summary["source"] == "estimate":
        shown.append(Text("The swarm kept no truth here: figures are the ground's own estimate.", "yellow"))
    shown.append(Text(f"Records   {run_dir}"))
    if pictures:
        shown.append(Text("Pictures  " + "  ".join(path.name for path in pictures)))
    return Group(*shown)


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
