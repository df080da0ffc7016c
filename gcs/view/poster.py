"""``poster.png``: one still of a flight, from above and from the side, at the moment of the least clearance."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from scipy.spatial import ConvexHull

from gcs.record.figures import FLOWN, LIMIT, OBSTACLE, SERIES, save_picture
from gcs.record.landing import in_air
from gcs.record.run_data import RunData
from gcs.record.witness import Nearest, hull_points, least_clearance
from idc_controller.arrays import Array
from idc_controller.geometry.shape import Shape

POSTER = "poster.png"
_ANGLES = np.linspace(0.0, 2.0 * np.pi, 180, endpoint=False)
_NEAR, _SOON = 8.0, 6.0
"""Half the width of the side view (m); time before and after the moment, of which it shows the path (s)."""
_NAMED = 12
"""Obstacles whose names are written; of more, that of the nearest alone."""
_BESIDE = 4.0
"""Obstacles that are farther than this in front of or behind the formation are faint in the side view (m)."""


def write_poster(run: RunData) -> Path:
    """Draw the poster of a run of at least one row into its folder, and return its path.

    Both views show the formation's hull and each obstacle where they are at that moment. Raises
    :class:`UnusableInput` if it cannot be written.
    """
    nearest = least_clearance(run)
    air = range(len(run.time))[in_air(run)] if run.number_of_uavs else range(len(run.time))
    row = air[len(air) // 2] if nearest is None and len(air) else 0 if nearest is None else nearest.row
    figure = Figure(figsize=(13.0, 6.4))
    FigureCanvasAgg(figure)
    top, side = figure.subplots(1, 2)
    figure.subplots_adjust(left=0.055, right=0.985, bottom=0.17, top=0.86, wspace=0.16)
    name, outcome = (
        (run.manifest.get("mission") or {}).get("name", run.folder.name),
        run.summary.get("outcome", "cut off"),
    )
    figure.suptitle(f"{name}, seed {run.manifest.get('seed')}: {outcome}", fontsize=14, fontweight="bold")
    velocity = run.payload_velocity[row, :2]
    speed = float(np.linalg.norm(velocity))
    ahead = np.array([*(velocity / speed), 0.0]) if speed > 0.05 else np.array([1.0, 0.0, 0.0])
    up = np.array([0.0, 0.0, -1.0])
    _draw(top, run, row, np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]), np.inf, nearest)
    _draw(side, run, row, np.array([ahead, up]), _SOON, nearest)
    top.set(xlabel="east (m)", ylabel="north (m)", title=f"From above, at {run.time[row]:.1f} s")
    top.set_aspect("equal", adjustable="datalim")
    side.set_aspect("equal", adjustable="box")
    centre = float(run.payload_position[row] @ ahead)
    side.set(xlabel="along the direction of flight (m)", ylabel="altitude (m)", title="From the side, at the same time")
    side.set_xlim(centre - _NEAR, centre + _NEAR)
    side.set_ylim(min(0.0, *side.get_ylim()), max(float(-run.payload_position[:, 2].min()) + 5.0, 1.4 * _NEAR))
    side.axhline(0.0, color="black", lw=0.8)
    figure.legend(*top.get_legend_handles_labels(), loc="lower center", ncols=6, frameon=False)
    return save_picture(figure, run.folder / POSTER, 100)


def _draw(ax: Axes, run: RunData, row: int, axes: Array, span: float, nearest: Nearest | None) -> None:
    """Draw a view whose two axes are the rows of ``axes`` (2, 3), with the path of ``span`` (s) about the row."""
    if len(run.reference):
        when = np.abs(run.reference["time_s"] - run.time[row]) <= span
        ax.plot(*(axes @ run.reference_position[when].T), color="#BBBBBB", lw=4.0, label="reference")
    flown = "flown" if run.source == "truth" else "flown (estimate)"
    path = run.payload_position[np.abs(run.time - run.time[row]) <= span]
    ax.plot(*(axes @ path.T), color=FLOWN, lw=1.3, label=flown)
    for number, obstacle in enumerate(run.obstacles):
        place = axes @ obstacle.position[row]
        seen = outline(obstacle.shape, axes) + place
        beside = abs(float(np.cross(*axes) @ (obstacle.position[row] - run.payload_position[row])))
        far = bool(np.isfinite(span)) and beside > _BESIDE
        alpha, label = 0.12 if far else 0.8, "" if number else "obstacle"
        ax.fill(*seen.T, fc=OBSTACLE, ec="black", lw=0.7, alpha=alpha, label=label)
        if not far and (len(run.obstacles) <= _NAMED or (nearest and nearest.obstacle == obstacle.name)):
            ax.annotate(obstacle.name, place, ha="center", va="center", fontsize=8, clip_on=True, annotation_clip=True)
    if run.number_of_uavs:
        points = (hull_points(run.formation(slice(row, row + 1))) + run.payload_position[row]) @ axes.T
        ax.fill(
            *points[ConvexHull(points).vertices].T, fc=SERIES[2], ec=SERIES[2], alpha=0.35, label="formation's hull"
        )
    if nearest is not None:
        label = f"least clearance {nearest.distance:.2f} m, {nearest.obstacle}"
        ax.plot(
            *(axes @ np.array([nearest.point_hull, nearest.point_obstacle]).T), "o-", color=LIMIT, ms=4, label=label
        )
    ax.grid(alpha=0.3)


def outline(shape: Shape, axes: Array) -> Array:
    """Return corners (n, 2) of the outline of a shape about its centre, seen along the normal of two axes (2, 3)."""
    normals = np.column_stack([np.cos(_ANGLES), np.sin(_ANGLES)])
    support = shape.support(normals @ axes)
    # Where two neighbouring tangents meet.
    step = _ANGLES[1]
    along = (np.roll(support, -1) - support * np.cos(step)) / np.sin(step)
    return np.asarray(support[:, None] * normals + along[:, None] * np.column_stack([-normals[:, 1], normals[:, 0]]))
