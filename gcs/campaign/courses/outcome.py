"""The distribution over a campaign's courses: a table for the terminal and a picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from rich import box
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from gcs.campaign.courses.flights import SEPARATION, Result
from gcs.campaign.courses.generator import HELD_TO
from gcs.record.pictures import save_picture

_QUANTITIES = (
    # field, title, unit, limit, whether high values are the bad ones
    ("clearance_min_m", "clearance", "m", HELD_TO.clearance, False),
    ("tilt_max_deg", "payload angle", "deg", HELD_TO.payload_tilt_deg, True),
    ("uav_separation_min_m", "UAVs apart", "m", SEPARATION, False),
    ("delay_s", "delay", "s", None, True),
    ("goal_error_m", "error at goal", "m", None, True),
    ("step_time_p99_ms", "control step, p99", "ms", None, True),
)
_SHARES = (0.0, 1.0, 5.0, 50.0)
_PICTURE = "distribution.png"
SHOWN_FAILURES = 20


def outcome_table(results: Sequence[Result], folder: Path) -> RenderableType:
    """Kinds, distribution and the replay command of every failure."""
    passed = sum(result.passed for result in results)
    colour = "bold green" if passed == len(results) else "bold red"
    parts: list[RenderableType] = [Text(f"{passed} of {len(results)} courses passed", style=colour)]
    parts += [_kinds(results), _distribution(results)]
    failures = [result for result in results if not result.passed]
    for result in failures[:SHOWN_FAILURES]:
        why = f"{result.failures}{': ' + result.reason if result.reason else ''}"
        parts.append(Text.assemble((f"{result.name}  {why}", "red"), f"\n  {result.replay}"))
    if len(failures) > SHOWN_FAILURES:
        parts.append(Text(f"... and {len(failures) - SHOWN_FAILURES} more failures: see results.csv"))
    parts.append(Text(f"Results   {folder}: results.csv  results.json  {_PICTURE}"))
    return Group(*parts)


def _kinds(results: Sequence[Result]) -> Table:
    table = Table(
        "kind", "flown", "passed", "arrived", "contacts", "least clearance", box=box.SIMPLE_HEAD, pad_edge=False
    )
    for kind in sorted({result.kind for result in results}):
        chosen = [result for result in results if result.kind == kind]
        clearances = [result.clearance_min_m for result in chosen if result.clearance_min_m is not None]
        table.add_row(
            kind,
            str(len(chosen)),
            str(sum(result.passed for result in chosen)),
            str(sum(result.arrival_s is not None and result.outcome == "completed" for result in chosen)),
            str(sum(bool(result.contacts) for result in chosen)),
            f"{min(clearances):.3f} m" if clearances else "-",
        )
    for column in table.columns[1:]:
        column.justify = "right"
    return table


def _distribution(results: Sequence[Result]) -> Table:
    table = Table("figure", "worst", "1 %", "5 %", "median", "limit", box=box.SIMPLE_HEAD, pad_edge=False)
    for field, title, unit, limit, high_is_bad in _QUANTITIES:
        values = _values(results, field)
        cells = [f"{value:.3f}" for value in from_bad_end(values, high_is_bad)] if len(values) else ["-"] * 4
        sign = "<=" if high_is_bad else ">="
        table.add_row(f"{title} ({unit})", *cells, "" if limit is None else f"{sign} {limit:g}")
    for column in table.columns[1:]:
        column.justify = "right"
    return table


def from_bad_end(values: Sequence[float] | np.ndarray, high_is_bad: bool) -> list[float]:
    """Worst value, 1 % and 5 % percentile counted from the bad end, and median."""
    shares = [100.0 - share for share in _SHARES] if high_is_bad else list(_SHARES)
    return [float(value) for value in np.percentile(values, shares)]


def draw_distribution(results: Sequence[Result], folder: Path) -> Path:
    """Histograms of clearance, tilt, separation and delay. Raises :class:`UnusableInput` where it cannot."""
    figure = Figure(figsize=(9.0, 6.5), layout="constrained")
    FigureCanvasAgg(figure)
    for ax, (field, title, unit, limit, high_is_bad) in zip(figure.subplots(2, 2).flat, _QUANTITIES[:4], strict=True):
        values = _values(results, field)
        ax.set_xlabel(f"{title} ({unit})")
        ax.set_ylabel("courses")
        if len(values):
            ax.hist(values, bins=min(40, max(8, len(values) // 4)), color="#0072B2")
            worst, _, _, median = from_bad_end(values, high_is_bad)
            ax.set_title(f"worst {worst:.2f}, median {median:.2f} {unit}", fontsize=10)
        if limit is not None:
            ax.axvline(limit, color="#D55E00", lw=1.5, label=f"limit {limit:g} {unit}")
            ax.legend(frameon=False, fontsize=9)
    figure.suptitle(f"{len(results)} random courses, {sum(result.passed for result in results)} passed")
    return save_picture(figure, folder / _PICTURE, 130)


def _values(results: Sequence[Result], field: str) -> np.ndarray:
    values = [getattr(result, field) for result in results]
    return np.array([value for value in values if value is not None], dtype=float)
