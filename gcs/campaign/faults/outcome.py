"""What a campaign tells at its end: a table for the terminal, and the matrix of faults and severities."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle
from rich import box
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from gcs.campaign.faults.result import (
    ABORTED,
    COLLIDED,
    FAILED,
    NOT_FLOWN,
    OUTSIDE,
    VERDICTS,
    WITHIN,
    WITHIN_LIMITS,
    FaultResult,
)
from gcs.campaign.faults.tables import CONFIDENCE, Rates, rates_of
from gcs.record.pictures import save_picture

MATRIX = "matrix.png"
COLOURS = {
    # Told apart without red and green, too.
    WITHIN: "#009E73", OUTSIDE: "#F0E442", ABORTED: "#56B4E9", COLLIDED: "#D55E00", FAILED: "#882255",
    NOT_FLOWN: "#BBBBBB",
}  # fmt: skip
_WRAPPED = ("fault", "severity")
_WIDTH, _HEIGHT = 1.7, 0.55  # in, of a cell


def outcome_table(
    results: Sequence[FaultResult], files: Sequence[Path], requirement: str = WITHIN_LIMITS
) -> RenderableType:
    """Rates by fault and severity, and the replay command of every failure."""
    passed = sum(result.passed for result in results)
    colour = "bold green" if passed == len(results) else "bold red"
    how = "within their limits" if requirement == WITHIN_LIMITS else "set down safely, with their limits held"
    parts: list[RenderableType] = [Text(f"{passed} of {len(results)} flights {how}", style=colour)]
    parts.append(_rates(rates_of(results), results))
    parts.append(Text(f"Rates with their {100 * CONFIDENCE:.0f} % intervals (Wilson); safe: set down without contact."))
    if false := sum(result.false_alarms or 0 for result in results):
        flights = sum(bool(result.false_alarms) for result in results)
        parts.append(Text(f"{false} alarms before any fault, in {flights} flights", style="bold red"))
    idle = [result for result in results if result.notes]
    if idle:
        parts.append(
            Text(f"{len(idle)} flights with a fault that never came or disturbed nothing: see notes in the table")
        )
    for result in results:
        if not result.passed:
            parts.append(Text.assemble((told(result), "red"), f"\n  {result.replay}"))
    parts.append(Text("Results   " + "  ".join(map(str, files))))
    return Group(*parts)


def told(result: FaultResult) -> str:
    """A flight and how it ended, on one line."""
    who = ", ".join(part for part in (result.fault, result.severity) if part)
    why = "; ".join(part for part in (result.failures, result.reason) if part)
    return f"{who}, {result.mission}, seed {result.seed}: {result.outcome}{f' ({why})' if why else ''}"


def _rates(rates: Sequence[Rates], results: Sequence[FaultResult]) -> Table:
    """A row a fault and severity; without columns of which nothing is known."""
    columns: dict[str, list[str]] = {}
    for rate in rates:
        chosen = [result for result in results if (result.fault, result.level) == (rate.fault, rate.level)]
        noticed = [r.detected_s for r in chosen if r.detected_s is not None]
        for title, cell in (
            ("fault", rate.fault),
            ("severity", rate.severity),
            ("flights", str(rate.flights)),
            ("within limits", _share(rate.within_limits_rate, rate.within_limits_low, rate.within_limits_high)),
            ("safe", _share(rate.safe_rate, rate.safe_low, rate.safe_high)),
            ("worst clearance", _told(min, (r.clearance_min_m for r in chosen), ".2f", "m")),
            ("worst tilt", _told(max, (r.tilt_max_deg for r in chosen), ".1f", "deg")),
            ("least apart", _told(min, (r.uav_separation_min_m for r in chosen), ".2f", "m")),
            ("touched with", _told(max, (r.touchdown_mps for r in chosen), ".2f", "m/s")),
            ("noticed in", _noticed(noticed, len(chosen))),
            ("stopped in", _told(max, (r.stop_s for r in chosen), ".2f", "s")),
            ("all in", _told(max, (r.team_stop_s for r in chosen), ".2f", "s")),
        ):
            columns.setdefault(title, []).append(cell)
    known = {title: cells for title, cells in columns.items() if set(cells) - {"", "-"}}
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for title, cells in known.items():
        # Titles may wrap between their words, figures not.
        least = max(len(part) for part in (*title.split(), *([] if title in _WRAPPED else cells)))
        table.add_column(title, justify="left" if title in _WRAPPED else "right", min_width=least)
    for row in zip(*known.values(), strict=True):
        table.add_row(*map(Text, row))
    return table


def _told(pick: Callable[[Iterable[float]], float], values: Iterable[float | None], digits: str, unit: str) -> str:
    """The least or the largest of what is known."""
    known = [value for value in values if value is not None]
    return f"{pick(known):{digits}} {unit}" if known else "-"


def _noticed(times: Sequence[float], flights: int) -> str:
    """The longest time, and in how many flights where it was not in all."""
    if not times:
        return "-"
    return f"{max(times):.2f} s" + (f" ({len(times)} of {flights})" if len(times) < flights else "")


def _share(rate: float, low: float, high: float) -> str:
    return f"{100 * rate:.0f} % ({100 * low:.0f} to {100 * high:.0f})"


def draw_matrix(name: str, results: Sequence[FaultResult], folder: Path) -> Path:
    """A row a fault, a cell a severity, in it the share of each outcome. Raises :class:`UnusableInput`."""
    faults = list(dict.fromkeys(result.fault for result in results))
    levels = max((result.level for result in results), default=1)
    figure = Figure(figsize=(2.8 + _WIDTH * levels, 1.6 + _HEIGHT * max(len(faults), 1)), layout="constrained")
    FigureCanvasAgg(figure)
    ax = figure.subplots()
    cells: dict[tuple[int, int], list[FaultResult]] = {}
    for result in results:
        cells.setdefault((faults.index(result.fault), result.level), []).append(result)
    for (row, level), cell in cells.items():
        left, counts = level - 0.48, Counter(result.outcome for result in cell)
        for outcome in VERDICTS:
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
    seen = [outcome for outcome in VERDICTS if any(result.outcome == outcome for result in results)]
    figure.legend(
        handles=[Patch(facecolor=COLOURS[outcome], label=outcome) for outcome in seen],
        loc="outside lower center", ncols=min(len(seen), 3) or 1, frameon=False, fontsize=8,
    )  # fmt: skip
    return save_picture(figure, folder / MATRIX, 130)
