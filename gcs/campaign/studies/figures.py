"""A study's table for the terminal and its picture."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from rich import box
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from gcs.campaign.courses.flights import Result
from gcs.campaign.studies.study import Study, StudyRow
from gcs.record.figures import LIMIT, SERIES
from gcs.record.pictures import save_picture

_MARKERS = "os^Dv"
_HIGHEST_ANGLE = 30.0
"""deg: a payload that tips over would make the rest invisible."""


def study_table(study: Study, rows: Sequence[StudyRow]) -> RenderableType:
    """A row for each mission and variant, worst values; below it every flight outside its limits, to be repeated."""
    table = Table(
        "mission", "variant", "done", "contacts", "clearance (m)", "angle (deg)", "UAVs (m)", "RMSE (m)", "slack (m)",
        "delay (s)", box=box.SIMPLE_HEAD, pad_edge=False,
    )  # fmt: skip
    table.columns[0].min_width = max(len(mission) for mission in study.missions)
    for column in table.columns[2:]:
        column.justify = "right"
    for mission in study.missions:
        for variant in study.variants:
            chosen = [row for row in rows if row.flight.mission == mission and row.flight.variant == variant]
            if not chosen:
                continue
            results, held_to = [row.result for row in chosen], chosen[0].flight.plan.held_to
            table.add_row(
                mission,
                variant.label,
                f"{sum(result.outcome == 'completed' for result in results)}/{len(results)}",
                str(sum(result.contacts or 0 for result in results)),
                _beside(worst(results, "clearance_min_m", 2, min), ">=", held_to.clearance),
                _beside(worst(results, "tilt_max_deg", 1), "<=", held_to.payload_tilt_deg),
                worst(results, "uav_separation_min_m", 2, min),
                worst(results, "position_rmse_m", 3),
                worst(results, "slack_max_m", 3),
                worst(results, "delay_s", 1),
            )
    parts: list[RenderableType] = [Text(f"{study.name}: {study.about}; the worst of each"), table]
    for result in (row.result for row in rows):
        if not result.passed:
            why = f"{result.failures}{': ' + result.reason if result.reason else ''}"
            parts.append(Text.assemble((f"{result.name}  {why}", "red"), f"\n  {result.replay}"))
    return Group(*parts)


def _beside(figure: str, sign: str, limit: float | None) -> str:
    """A figure with its limit."""
    return figure if limit is None else f"{figure} {sign} {limit:g}"


def worst(results: Sequence[Result], field: str, digits: int, of: Callable[[list[float]], float] = max) -> str:
    """The largest (or least) of what is known, as text."""
    values = [value for result in results if (value := getattr(result, field)) is not None]
    return f"{of(values):.{digits}f}" if values else "-"


def draw_study(study: Study, rows: Sequence[StudyRow], path: Path) -> Path:
    """Clearance and payload angle of every flight against what is changed. Raises :class:`UnusableInput`."""
    figure = Figure(figsize=(9.0, 4.2), layout="constrained")
    FigureCanvasAgg(figure)
    clearance, angle = figure.subplots(1, 2)
    _draw(clearance, study, rows, "clearance_min_m", "clearance")
    _draw(angle, study, rows, "tilt_max_deg", "payload_tilt_deg")
    clearance.set_ylabel("least clearance, hull to surface (m)")
    angle.set_ylabel("largest payload angle (deg)")
    clearance.set_ylim(0.0, 1.1 * clearance.get_ylim()[1])
    overturned = any((row.result.tilt_max_deg or 0.0) > _HIGHEST_ANGLE for row in rows)
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
    figure.suptitle(f"{study.name}: {study.about} ({len(rows)} flights)", fontsize=11)
    return save_picture(figure, path, 110)


def _draw(ax: Axes, study: Study, rows: Sequence[StudyRow], figure: str, limit: str) -> None:
    by_label = study.variants[0].value is None
    for number, mission in enumerate(study.missions):
        chosen = [row for row in rows if row.flight.mission == mission]
        colour = SERIES[number % len(SERIES)]
        aside = 0.12 * (number - (len(study.missions) - 1) / 2.0) if by_label else 0.0
        points: list[tuple[float, float]] = []
        touching: list[tuple[float, float]] = []
        limits: dict[float, float] = {}
        for row in chosen:
            variant = row.flight.variant
            x = study.variants.index(variant) + aside if variant.value is None else variant.value
            if (value := getattr(row.flight.plan.held_to, limit)) is not None:
                limits[x] = value
            if (value := getattr(row.result, figure)) is not None and math.isfinite(value):
                (touching if row.result.contacts else points).append((x, value))
        if figure == "tilt_max_deg":
            points, touching = [[(x, min(y, _HIGHEST_ANGLE)) for x, y in places] for places in (points, touching)]
        marker = _MARKERS[number % len(_MARKERS)]
        if points:
            ax.plot(*zip(*points, strict=True), marker, color=colour, ms=6, alpha=0.8, clip_on=False, label=mission)
        if touching:
            ax.plot(
                *zip(*touching, strict=True), "x", color=colour, ms=9, mew=2, clip_on=False, label=f"{mission}, contact"
            )
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
