"""Pictures of a run folder: what ``gcs report`` draws, and every flight at its end."""

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from gcs.errors import UnusableInput
from gcs.record.clearance import ObstacleTrack
from gcs.record.run_data import RunData, position_error
from gcs.record.summary import payload_angles

# The palette of Okabe and Ito: distinct for colour-blind readers, too.
FLOWN, LIMIT, OBSTACLE = "#0072B2", "#D55E00", "#CC79A7"
SERIES = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#8C6D1F", "#000000")
# Broad and pale, below what was flown: both stay visible where they agree.
_REFERENCE_STYLE: dict[str, Any] = {"color": "#BBBBBB", "lw": 4.5, "solid_capstyle": "round", "label": "reference"}
_DPI = 130
_TOP_VIEW = (8.0, 8.2)
"""Inches."""


def report(run: RunData) -> list[Path]:
    """Draw the pictures of a run, finished or cut off, as PNG files in its folder; return their paths.

    ``position``, ``payload_angles``, ``top_view``; ``thrust`` and ``separation`` where UAVs are on record
    (the latter with the clearance where there are obstacles). Raises :class:`UnusableInput` where nothing was
    flown, or where the folder cannot be written.
    """
    if len(run.time) == 0:
        raise UnusableInput(f"{run.folder}: nothing was flown: there is no row in truth.csv or estimate.csv")
    drawings: dict[str, Callable[[RunData], Figure]] = {
        "position": draw_position,
        "payload_angles": draw_payload_angles,
        "top_view": draw_top_view,
    }
    if run.number_of_uavs:
        drawings |= {"thrust": draw_thrust, "separation": draw_separation}
    return [save_picture(draw(run), run.folder / f"{name}.png", _DPI) for name, draw in drawings.items()]


def save_picture(figure: Figure, path: Path, dpi: int) -> Path:
    """Write a figure to ``path`` and return it. Raises :class:`UnusableInput` if it cannot be written."""
    try:
        figure.savefig(path, dpi=dpi, pil_kwargs={"compress_level": 1})  # half the time of 6, a fifth more bytes
    except OSError as error:
        with suppress(OSError):
            path.unlink(missing_ok=True)
        raise UnusableInput(f"{path}: cannot be written: {error.strerror}") from None
    return path


def draw_position(run: RunData) -> Figure:
    """Return the payload's position and its reference over time, axis by axis, and the error."""
    figure, axes = _rows(run, "Payload position", 4, height=8.5)
    reference = run.reference_position
    for i, (ax, name) in enumerate(zip(axes, ("north", "east", "down"), strict=False)):
        if len(reference):
            ax.plot(run.reference["time_s"], reference[:, i], **_REFERENCE_STYLE)
        ax.plot(run.time, run.payload_position[:, i], color=FLOWN, lw=1.4, label=_flown(run))
        ax.set_ylabel(f"{name} (m)")
    axes[2].invert_yaxis()  # up is up
    _legend(axes[0])
    time, error = position_error(run)
    for i, name in enumerate(("north", "east", "down")):
        axes[3].plot(time, error[:, i], color=SERIES[i], lw=1.2, label=name)
    if len(time):
        _legend(axes[3])
    else:
        axes[3].text(0.5, 0.5, "no reference on record", ha="center", transform=axes[3].transAxes)
    axes[3].set_ylabel("error (m)")
    return figure


def draw_payload_angles(run: RunData) -> Figure:
    """Return the payload's roll, pitch and yaw over time, with their limit."""
    figure, axes = _rows(run, "Payload attitude", 3, height=7.0)
    limit = _limit(run, "payload_tilt_deg")
    for ax, name, angle in zip(axes, ("roll", "pitch", "yaw"), payload_angles(run).T, strict=True):
        ax.plot(run.time, angle, color=FLOWN, lw=1.3)
        ax.set_ylabel(f"{name} (deg)")
        if limit is not None:
            for sign in (1.0, -1.0):
                ax.axhline(sign * limit, color=LIMIT, ls="--", lw=1.2, label="limit" if sign > 0 else None)
    if limit is not None:
        _legend(axes[0])
    return figure


def draw_top_view(run: RunData) -> Figure:
    """Return the flight from above: path, reference and obstacles, north up."""
    figure = _figure(run, "Top view", _TOP_VIEW)
    ax = figure.add_subplot()
    for number, obstacle in enumerate(run.obstacles):
        _draw_obstacle(ax, obstacle, label="obstacle" if number == 0 else None)
    reference = run.reference_position
    if len(reference):
        ax.plot(reference[:, 1], reference[:, 0], **_REFERENCE_STYLE)
    north, east = run.payload_position[:, 0], run.payload_position[:, 1]
    ax.plot(east, north, color=FLOWN, lw=1.4, label=_flown(run))
    ax.plot(east[0], north[0], "o", color=SERIES[2], ms=8, label="start", zorder=4)
    ax.plot(east[-1], north[-1], "s", color=LIMIT, ms=8, label="end", zorder=4)
    # One square with equal scales; not less than a few metres around a payload that only hovers.
    low, high = np.array([ax.get_xlim(), ax.get_ylim()]).T
    half = max(float(np.max(high - low)) / 2.0, 1.5)
    (middle_east, middle_north) = (low + high) / 2.0
    ax.set_xlim(middle_east - half, middle_east + half)
    ax.set_ylim(middle_north - half, middle_north + half)
    ax.set_aspect("equal")
    ax.grid(alpha=0.3)
    ax.set_xlabel("east (m)")
    ax.set_ylabel("north (m)")
    figure.subplots_adjust(bottom=0.9 / _TOP_VIEW[1], top=1.0 - 0.6 / _TOP_VIEW[1])
    figure.legend(*ax.get_legend_handles_labels(), loc="lower center", ncols=5, frameon=False)
    return figure


def draw_thrust(run: RunData) -> Figure:
    """Return the thrust of each UAV over time."""
    figure, (ax,) = _rows(run, "Thrust", 1, height=4.2)
    for i, thrust in enumerate(run.thrust.T):
        ax.plot(run.time, thrust, color=SERIES[i % len(SERIES)], lw=1.1, label=f"UAV {i + 1}")
    ax.set_ylabel("thrust (N)")
    ax.set_ylim(bottom=min(0.0, float(np.nanmin(run.thrust))))
    _legend(ax)
    return figure


def draw_separation(run: RunData) -> Figure:
    """Return the separation of the UAVs, and the clearance to the nearest obstacle, over time."""
    has_barriers = bool(run.barriers)
    title = "UAV separation and clearance" if has_barriers else "UAV separation"
    figure, axes = _rows(run, title, 2 if has_barriers else 1, height=6.4 if has_barriers else 4.2)
    if run.number_of_uavs > 1:
        axes[0].plot(run.time, run.uav_separation(), color=FLOWN, lw=1.4, label="nearest two UAVs")
    axes[0].set_ylabel("between centres (m)")
    _draw_floor(axes[0], _limit(run, "uav_separation"))
    if has_barriers:
        axes[1].plot(run.time, run.clearance, color=FLOWN, lw=1.4, label="nearest obstacle or fence")
        axes[1].set_ylabel("from the hull (m)")
        _draw_floor(axes[1], _limit(run, "clearance"))
    return figure


def _draw_floor(ax: Axes, limit: float | None) -> None:
    if limit is not None:
        ax.axhline(limit, color=LIMIT, ls="--", lw=1.2, label="limit")
    ax.set_ylim(bottom=0.0)
    _legend(ax)


def _draw_obstacle(ax: Axes, obstacle: ObstacleTrack, label: str | None) -> None:
    """Draw an obstacle at its first place, solid; of a moving one its track, and its last place, faint."""
    track = obstacle.position[np.all(np.isfinite(obstacle.position), axis=1)]
    if len(track) == 0:
        return
    moved = float(np.max(np.linalg.norm(track[:, :2] - track[0, :2], axis=1))) > 1e-6
    for north, east in (track[[0, -1], :2] if moved else track[:1, :2]).tolist():
        faint = moved and (north, east) == tuple(track[-1, :2])
        patch = Polygon((obstacle.shape.plan_view.outline() + np.array([north, east]))[:, ::-1], closed=True)
        patch.set(facecolor=OBSTACLE, edgecolor="black", alpha=0.25 if faint else 0.8, lw=0.8)
        if label is not None and not faint:
            patch.set_label(label)
        ax.add_patch(patch)
    if moved:
        ax.plot(track[:, 1], track[:, 0], ":", color=OBSTACLE, lw=1.2)
    ax.annotate(obstacle.name, (track[0, 1], track[0, 0]), ha="center", va="center", fontsize=8)


def _figure(run: RunData, title: str, size: tuple[float, float]) -> Figure:
    # Figure and canvas by hand: pyplot would keep every figure and pick a screen.
    figure = Figure(figsize=size)
    FigureCanvasAgg(figure)
    # Fixed margins: a layout engine would draw every picture twice.
    width, height = size
    figure.subplots_adjust(left=0.9 / width, right=1.0 - 0.25 / width, bottom=0.6 / height, top=1.0 - 0.8 / height)
    outcome = run.summary.get("outcome", "cut off")
    figure.suptitle(f"{title}: {run.folder.resolve().name} ({outcome})", fontsize=13, fontweight="bold")
    return figure


def _rows(run: RunData, title: str, rows: int, height: float) -> tuple[Figure, list[Axes]]:
    figure = _figure(run, title, (10.0, height))
    axes = list(figure.subplots(rows, 1, sharex=True, squeeze=False)[:, 0])
    for ax in axes:
        ax.grid(alpha=0.3)
        ax.margins(x=0.01)
    axes[-1].set_xlabel("time (s)")
    return figure, axes


def _legend(ax: Axes) -> None:
    """Draw the legend as one line above the axes, where no curve runs."""
    handles, labels = ax.get_legend_handles_labels()
    if handles:
        ax.legend(
            handles, labels, loc="lower right", bbox_to_anchor=(1.0, 0.98), ncols=min(len(labels), 9),
            frameon=False, fontsize=9, borderpad=0.2, handlelength=1.6,
        )  # fmt: skip


def _flown(run: RunData) -> str:
    return "flown" if run.source == "truth" else "flown (estimate)"


def _limit(run: RunData, name: str) -> float | None:
    entry = (run.summary.get("limits") or {}).get(name)
    return float(entry["limit"]) if entry else None
