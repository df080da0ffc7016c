"""The distribution over the obstacle scenarios of a campaign: tables and a picture."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from rich.console import RenderableType
from rich.table import Table

from gcs.campaign.result import Result
from gcs.campaign.scenarios.generator import HELD_TO
from gcs.campaign.scenarios.judgement import COLUMNS
from gcs.campaign.tables import extreme, text_table, write_results
from gcs.record.figures import save_picture

_Quantity = tuple[str, str, str, float | None, bool]
"""Column, title, unit, limit, and whether high values are the bad ones."""
_SHARES = (0.0, 1.0, 5.0, 50.0)
_PICTURE = "distribution.png"
_TITLES = ("figure", "worst", "1 %", "5 %", "median", "limit")


def report(results: Sequence[Result], out: Path, separation: float) -> tuple[list[RenderableType], list[Path]]:
    """Write ``results.csv``, ``timing.csv`` and the picture of the distribution; return its tables, and the files.

    ``separation``: least UAV separation with which a flight passes (m).
    """
    quantities: tuple[_Quantity, ...] = (
        ("clearance_min_m", "clearance", "m", HELD_TO.clearance, False),
        ("tilt_max_deg", "payload angle", "deg", HELD_TO.payload_tilt_deg, True),
        ("uav_separation_min_m", "UAV separation", "m", separation, False),
        ("delay_s", "delay", "s", None, True),
        ("goal_error_m", "error at goal", "m", None, True),
        ("step_time_p99_ms", "control step, p99", "ms", None, True),
    )
    files = [*write_results(out, COLUMNS, results), _draw(results, quantities[:4], out)]
    return [_kinds(results), _distribution(results, quantities)], files


def _kinds(results: Sequence[Result]) -> Table:
    rows = []
    for variant, kind in sorted({(result.variant, result.kind) for result in results}):
        chosen = [result for result in results if (result.variant, result.kind) == (variant, kind)]
        rows.append(
            {
                "settings": variant,
                "kind": kind,
                "flown": str(len(chosen)),
                "passed": str(sum(r.passed for r in chosen)),
                "arrived": str(sum(r.arrival_s is not None and r.outcome == "completed" for r in chosen)),
                "broken off": str(sum(r.outcome == "aborted" for r in chosen)),
                "contacts": str(sum(bool(r.contacts) for r in chosen)),
                "least clearance": extreme(chosen, "clearance_min_m", min, 3, "m"),
                "largest angle": extreme(chosen, "tilt_max_deg", max, 1, "deg"),
                "largest RMSE": extreme(chosen, "position_rmse_m", max, 3, "m"),
            }
        )
    return text_table(rows, left=("settings", "kind"))


def _distribution(results: Sequence[Result], quantities: Sequence[_Quantity]) -> Table:
    rows = []
    for field, title, unit, limit, high_is_bad in quantities:
        values = _values(results, field)
        cells = [f"{value:.3f}" for value in from_bad_end(values, high_is_bad)] if len(values) else ["-"] * 4
        bound = "" if limit is None else f"{'<=' if high_is_bad else '>='} {limit:g}"
        rows.append(dict(zip(_TITLES, (f"{title} ({unit})", *cells, bound), strict=True)))
    return text_table(rows, left=("figure",))


def from_bad_end(values: Sequence[float] | np.ndarray, high_is_bad: bool) -> list[float]:
    """Return the worst value, the 1 % and 5 % percentile counted from the bad end, and the median."""
    shares = [100.0 - share for share in _SHARES] if high_is_bad else list(_SHARES)
    return [float(value) for value in np.percentile(values, shares)]


def _draw(results: Sequence[Result], quantities: Sequence[_Quantity], folder: Path) -> Path:
    """Draw histograms of four ``quantities``. Raises :class:`UnusableInput` where it cannot."""
    figure = Figure(figsize=(9.0, 6.5), layout="constrained")
    for ax, (field, title, unit, limit, high_is_bad) in zip(figure.subplots(2, 2).flat, quantities, strict=True):
        values = _values(results, field)
        ax.set_xlabel(f"{title} ({unit})")
        ax.set_ylabel("scenarios")
        if len(values):
            ax.hist(values, bins=min(40, max(8, len(values) // 4)), color="#0072B2")
            worst, _, _, median = from_bad_end(values, high_is_bad)
            ax.set_title(f"worst {worst:.2f}, median {median:.2f} {unit}", fontsize=10)
        if limit is not None:
            ax.axvline(limit, color="#D55E00", lw=1.5, label=f"limit {limit:g} {unit}")
            ax.legend(frameon=False, fontsize=9)
    figure.suptitle(f"{len(results)} scenarios, {sum(result.passed for result in results)} passed")
    return save_picture(figure, folder / _PICTURE, 130)


def _values(results: Sequence[Result], field: str) -> np.ndarray:
    return np.array([value for result in results if (value := result.figure(field)) is not None])
