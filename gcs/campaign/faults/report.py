"""The report of a campaign of faults: tables, rates, and the matrix of faults and severities."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from gcs.campaign.faults.detection_table import Detections
from gcs.campaign.faults.false_alarms import false_alarms
from gcs.campaign.faults.judgement import COLUMNS
from gcs.campaign.faults.rates import CONFIDENCE, rates_of
from gcs.campaign.result import Result
from gcs.campaign.tables import extreme, text_table, write_records, write_results
from gcs.record.figures import save_picture
from gcs.record.outcome import Outcome

MATRIX = "matrix.png"
WITHIN, OUTSIDE = "within limits", "outside limits"
"""How the matrix shows a completed flight."""
COLOURS: dict[str, str] = {
    # Distinct for colour-blind readers, too.
    WITHIN: "#009E73", OUTSIDE: "#F0E442", Outcome.INTERRUPTED: "#BBBBBB", Outcome.ABORTED: "#56B4E9",
    Outcome.FAILED: "#882255", Outcome.LOST: "#0072B2", Outcome.COLLIDED: "#D55E00",
}  # fmt: skip
_WIDTH, _HEIGHT = 1.7, 0.55  # in, of a cell


def report(
    name: str, results: Sequence[Result], out: Path, rows: Sequence[Detections] = ()
) -> tuple[list[RenderableType], list[Path]]:
    """Write the tables and the matrix; return the rates by fault and severity, and the files."""
    rates, clear = rates_of(results), false_alarms(results)
    files = [
        *write_results(out, COLUMNS, results),
        write_records(out / "rates.csv", rates, ".4f"),
        draw_matrix(name, results, out),
    ]
    if rows:
        files.append(write_records(out / "detection.csv", [asdict(row) for row in rows]))
    if any(result.clean_s is not None for result in results):
        files.append(write_records(out / "false_alarms.csv", [asdict(row) for row in clear], ".4f"))
    parts: list[RenderableType] = [_rates_table(rates, results)]
    parts.append(Text(f"Rates with their {100 * CONFIDENCE:.0f} % intervals (Wilson); safe: set down without contact."))
    if false := sum(result.false_alarms or 0 for result in results):
        flights = sum(bool(result.false_alarms) for result in results)
        parts.append(Text(f"{false} alarms before any fault, in {flights} flights", style="bold red"))
    if idle := sum(bool(result.notes) for result in results):
        parts.append(Text(f"{idle} flights with a fault that never started or had no effect: see notes in the table"))
    return parts, files


def _rates_table(rates: Sequence[Mapping[str, Any]], results: Sequence[Result]) -> Table:
    rows = []
    for rate in rates:
        chosen = [result for result in results if (result.fault, result.level) == (rate["fault"], rate["level"])]
        rows.append(
            {
                "fault": rate["fault"],
                "severity": rate["severity"],
                "flights": str(rate["flights"]),
                "within limits": _share(rate, "within_limits"),
                "safe": _share(rate, "safe"),
                "least clearance": extreme(chosen, "clearance_min_m", min, 2, "m"),
                "largest tilt": extreme(chosen, "tilt_max_deg", max, 1, "deg"),
                "least separation": extreme(chosen, "uav_separation_min_m", min, 2, "m"),
                "touchdown": extreme(chosen, "touchdown_mps", max, 2, "m/s"),
                "detected in": _detected(chosen),
                "stopped in": extreme(chosen, "stop_s", max, 2, "s"),
                "all in": extreme(chosen, "team_stop_s", max, 2, "s"),
            }
        )
    return text_table(rows, left=("fault", "severity"))


def _detected(results: Sequence[Result]) -> str:
    """Return the longest time to detection, and the number of flights with one if some have none."""
    count = sum(result.detected_s is not None for result in results)
    share = f" ({count} of {len(results)})" if 0 < count < len(results) else ""
    return extreme(results, "detected_s", max, 2, "s") + share


def _share(rate: Mapping[str, Any], name: str) -> str:
    share, low, high = (100 * rate[f"{name}_{end}"] for end in ("rate", "low", "high"))
    return f"{share:.0f} % ({low:.0f} to {high:.0f})"


def shown_as(result: Result) -> str:
    """Return the key of :data:`COLOURS` by which the matrix shows a flight."""
    if result.outcome != Outcome.COMPLETED:
        return result.outcome
    return WITHIN if result.within_limits else OUTSIDE


def draw_matrix(name: str, results: Sequence[Result], folder: Path) -> Path:
    """Draw a matrix of faults and severities, with the share of each outcome in each cell."""
    faults = list(dict.fromkeys(result.fault for result in results))
    levels = max((result.level for result in results), default=1)
    figure = Figure(figsize=(2.8 + _WIDTH * levels, 1.6 + _HEIGHT * max(len(faults), 1)), layout="constrained")
    ax = figure.subplots()
    cells: dict[tuple[int, int], list[Result]] = {}
    for result in results:
        cells.setdefault((faults.index(result.fault), result.level), []).append(result)
    for (row, level), cell in cells.items():
        left, counts = level - 0.48, Counter(shown_as(result) for result in cell)
        for outcome in COLOURS:
            width = 0.96 * counts[outcome] / len(cell)
            ax.add_patch(Rectangle((left, row - 0.45), width, 0.9, facecolor=COLOURS[outcome], linewidth=0.0))
            left += width
        lines = [cell[0].severity, f"{sum(result.passed for result in cell)} of {len(cell)}"]
        text = "\n".join(line for line in lines if line)
        back = {"facecolor": "white", "alpha": 0.75, "linewidth": 0.0, "boxstyle": "round,pad=0.15"}
        ax.text(level, row, text, ha="center", va="center", fontsize=7, bbox=back)
    ax.set_xlim(0.5, levels + 0.5)
    ax.set_ylim(len(faults) - 0.5, -0.5)
    ax.set_yticks(range(len(faults)), faults, fontsize=8)
    ax.set_xticks(range(1, levels + 1))
    ax.set_xlabel("severity; in each cell: flights that passed")
    ax.spines[:].set_visible(False)
    ax.tick_params(length=0)
    ax.set_title(name, fontsize=10)
    outcomes = [outcome for outcome in COLOURS if any(shown_as(result) == outcome for result in results)]
    figure.legend(
        handles=[Patch(facecolor=COLOURS[outcome], label=outcome) for outcome in outcomes],
        loc="outside lower center", ncols=min(len(outcomes), 3) or 1, frameon=False, fontsize=8,
    )  # fmt: skip
    return save_picture(figure, folder / MATRIX, 130)
