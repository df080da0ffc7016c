"""The report of a study: its table and its picture."""

import math
from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from gcs.campaign.result import Result
from gcs.campaign.studies.study import STUDY_COLUMNS, Study
from gcs.campaign.tables import extreme, text_table, write_results
from gcs.record.figures import LIMIT, SERIES, save_picture

_MARKERS = "os^Dv"
_HIGHEST_ANGLE = 30.0
"""Upper end of the axis (deg): one payload that tips over must not compress the rest."""


def report(study: Study, results: Sequence[Result], out: Path) -> tuple[list[RenderableType], list[Path]]:
    """Write ``NAME.csv`` and ``NAME.png``; return the table for the terminal, and the files."""
    files = write_results(out, STUDY_COLUMNS, results, study.name)
    files.append(draw_study(study, results, out / f"{study.name}.png"))
    return [Text(f"{study.name}: {study.about}; the worst of each"), _table(study, results)], files


def _table(study: Study, results: Sequence[Result]) -> Table:
    """Return a row for each mission and variant, with the worst values."""
    rows = []
    for mission, variant in product(study.missions, study.variants):
        chosen = [result for result in results if (result.mission, result.variant) == (mission, variant.label)]
        if not chosen:
            continue
        clearance, tilt = chosen[0].clearance_asked_m, chosen[0].tilt_limit_deg
        rows.append(
            {
                "mission": mission,
                "variant": variant.label,
                "done": f"{sum(result.outcome == 'completed' for result in chosen)}/{len(chosen)}",
                "contacts": str(sum(result.contacts or 0 for result in chosen)),
                "clearance (m)": _with_limit(extreme(chosen, "clearance_min_m", min, 2), ">=", clearance),
                "angle (deg)": _with_limit(extreme(chosen, "tilt_max_deg", max, 1), "<=", tilt),
                "UAVs (m)": extreme(chosen, "uav_separation_min_m", min, 2),
                "RMSE (m)": extreme(chosen, "position_rmse_m", max, 3),
                "slack (m)": extreme(chosen, "slack_max_m", max, 3),
                "delay (s)": extreme(chosen, "delay_s", max, 1),
            }
        )
    return text_table(rows, left=("mission", "variant"))


def _with_limit(figure: str, sign: str, limit: float | None) -> str:
    return figure if limit is None else f"{figure} {sign} {limit:g}"


def draw_study(study: Study, results: Sequence[Result], path: Path) -> Path:
    """Draw clearance and payload angle of every flight against the variants. Raises :class:`UnusableInput`."""
    figure = Figure(figsize=(9.0, 4.2), layout="constrained")
    clearance, angle = figure.subplots(1, 2)
    _draw(clearance, study, results, "clearance_min_m", "clearance_asked_m")
    _draw(angle, study, results, "tilt_max_deg", "tilt_limit_deg")
    clearance.set_ylabel("least clearance, hull to surface (m)")
    angle.set_ylabel("largest payload angle (deg)")
    clearance.set_ylim(0.0, 1.1 * clearance.get_ylim()[1])
    overturned = any((result.tilt_max_deg or 0.0) > _HIGHEST_ANGLE for result in results)
    if overturned:
        angle.set_ylabel(f"largest payload angle (deg; at the edge: > {_HIGHEST_ANGLE:g})")
        angle.set_ylim(0.0, _HIGHEST_ANGLE)
    else:
        angle.set_ylim(0.0, max(10.0, angle.get_ylim()[1]))
    handles = {
        label: handle
        for ax in (clearance, angle)
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True)
    }
    figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=5, frameon=False, fontsize=9)
    figure.suptitle(f"{study.name}: {study.about} ({len(results)} flights)", fontsize=11)
    return save_picture(figure, path, 110)


def _draw(ax: Axes, study: Study, results: Sequence[Result], figure: str, limit: str) -> None:
    by_label = study.variants[0].value is None
    variants = {variant.label: variant for variant in study.variants}
    for number, mission in enumerate(study.missions):
        colour, marker = SERIES[number % len(SERIES)], _MARKERS[number % len(_MARKERS)]
        aside = 0.12 * (number - (len(study.missions) - 1) / 2.0) if by_label else 0.0
        points: dict[bool, list[tuple[float, float]]] = {False: [], True: []}  # by contact
        limits: dict[float, float] = {}
        for result in results:
            if result.mission != mission:
                continue
            variant = variants[result.variant]
            x = study.variants.index(variant) + aside if variant.value is None else variant.value
            if (value := result.figure(limit)) is not None:
                limits[x] = value
            if (value := result.figure(figure)) is not None and math.isfinite(value):
                y = min(value, _HIGHEST_ANGLE) if figure == "tilt_max_deg" else value
                points[bool(result.contacts)].append((x, y))
        style: dict[str, Any] = {"color": colour, "clip_on": False}
        if points[False]:
            ax.plot(*zip(*points[False], strict=True), marker, ms=6, alpha=0.8, label=mission, **style)
        if points[True]:
            ax.plot(*zip(*points[True], strict=True), "x", ms=9, mew=2, label=f"{mission}, contact", **style)
        if limits:
            xs = sorted(limits)
            ax.plot(xs, [limits[x] for x in xs], "--", color=LIMIT, lw=1.2, label="limit")
    if by_label:
        ax.set_xticks(range(len(study.variants)), [variant.label for variant in study.variants])
    else:
        values = [variant.value for variant in study.variants if variant.value is not None]
        if study.logarithmic:
            ax.set_xscale("log")
        ax.set_xticks(values, [f"{value:g}" for value in values], minor=False)
        ax.minorticks_off()
        if values[0] > values[-1]:
            ax.invert_xaxis()
        ax.set_xlabel(study.axis, fontsize=9)
    ax.grid(alpha=0.3)
