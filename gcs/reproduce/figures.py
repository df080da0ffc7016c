"""The paper's figures as PNG files, each as printed and as corrected."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.animation import PillowWriter
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gcs.record.figures import FLOWN, LIMIT, OBSTACLE, SERIES, save_picture
from gcs.record.run_data import RunData
from gcs.record.summary import payload_angles
from gcs.reproduce.scene import ALTITUDE, RADIUS
from gcs.reproduce.simulation import LOST_TILT, Flown
from idc_controller.arrays import Array
from idc_controller.rotations import rotation_from_quaternion

TITLES = {
    "printed": "as printed", "corrected": "thrust and torque, flat reference", "project": "this project",
    "nonlinear": "as printed, A_obs nonlinear",
}  # fmt: skip
FLOWN_BY = {"idc": "this project", "paper": "the paper's filter"}
"""Controllers of ``gcs fly``."""
DPI = 110
_REFERENCE: dict[str, Any] = {"color": "#BBBBBB", "lw": 4.0, "solid_capstyle": "round", "label": "reference"}


def draw_position(flown: Mapping[str, Flown], title: str, path: Path) -> None:
    """Draw trackxyz or trackObsxyz: position over time, a column per controller, avoidance shaded."""

    def draw(ax: Axes, run: Flown, i: int) -> None:
        ax.plot(run.time, run.reference[:, i], **_REFERENCE)
        ax.plot(run.time, run.position[:, i], color=FLOWN, lw=1.4, label="flown")
        if i == 2:
            ax.invert_yaxis()

    _columns(flown, title, ("x (m)", "y (m)", "z (m)"), draw, path)


def draw_attitude(flown: Mapping[str, Flown], title: str, path: Path) -> None:
    """Draw attrpy or attObsrpy: roll, pitch, yaw of the payload over time, with the 5 degrees of the paper."""

    def draw(ax: Axes, run: Flown, i: int) -> None:
        ax.plot(run.time, run.angles[:, i], color=FLOWN, lw=1.2)
        _limits(ax, -5.0, 5.0)

    _columns(flown, title, ("roll (deg)", "pitch (deg)", "yaw (deg)"), draw, path)


def _columns(
    flown: Mapping[str, Flown], title: str, labels: Sequence[str], draw: Callable[[Axes, Flown, int], None], path: Path
) -> None:
    figure = new_figure(title, (4.6 * len(flown), 7.0))
    grid = figure.subplots(3, len(flown), squeeze=False, sharey="row")
    for column, (name, run) in enumerate(flown.items()):
        for i, ax in enumerate(grid[:, column]):
            draw(ax, run, i)
            for begin, end in run.avoidance_intervals():
                ax.axvspan(begin, end, color="red", alpha=0.12, lw=0)
            ax.grid(alpha=0.3)
        lost = "" if run.lost_at is None else f" (lost at {run.lost_at:.1f} s)"
        grid[0, column].set_title(TITLES.get(name, name) + lost, fontsize=11)
        grid[2, column].set_xlabel("time (s)")
    for row, label in enumerate(labels):
        grid[row, 0].set_ylabel(label)
    if grid[0, 0].get_legend_handles_labels()[1]:
        grid[0, 0].legend(frameon=False, fontsize=8, ncols=2)
    save_picture(figure, path, DPI)


def draw_snapshot(flown: Mapping[str, Flown], title: str, path: Path) -> None:
    """Draw anim3d or animObs3d: the formation at some times in space, east-north-up as in the paper."""
    figure = new_figure(title, (6.4 * len(flown), 6.2))
    for column, (name, run) in enumerate(flown.items()):
        ax = figure.add_subplot(1, len(flown), column + 1, projection="3d")
        ax.plot(*enu(run.reference), ":", color=LIMIT, lw=1.2)
        ax.plot(*enu(run.position), color="black", lw=1.2)
        for k in np.linspace(0, len(run.time) - 1, 5).astype(int):
            draw_formation(ax, run, int(k))
        if run.spheres:
            nearest = int(np.argmin(run.clearance.min(axis=1)))
            draw_spheres(ax, run, nearest)
            draw_formation(ax, run, nearest)
        ax.set_title(TITLES.get(name, name), fontsize=11)
        label_space(ax)
    save_picture(figure, path, DPI)


def draw_formation(ax: Any, run: Flown, k: int) -> list[Any]:
    """Draw the payload's upper face, links and UAVs at record ``k``."""
    R_0, r_0 = rotation_from_quaternion(run.quaternion[k]), run.position[k]
    corners = np.array([[0.5, 0.5, -0.25], [0.5, -0.5, -0.25], [-0.5, -0.5, -0.25], [-0.5, 0.5, -0.25]])
    attached = r_0 + corners @ R_0.T
    drawn = list(ax.plot(*enu(np.vstack([attached, attached[:1]])), color=SERIES[6], lw=1.6))
    angle = np.linspace(0.0, 2.0 * np.pi, 25)
    rim = 0.3 * np.column_stack([np.cos(angle), np.sin(angle), np.zeros(25)])
    for i, uav in enumerate(run.uav_position[k]):
        drawn += ax.plot(*enu(np.vstack([attached[i], uav])), color="#666666", lw=0.9)
        disc = uav + rim @ rotation_from_quaternion(run.uav_quaternion[k, i]).T
        drawn += ax.plot(*enu(disc), color=FLOWN, lw=1.2)
    return drawn


def draw_spheres(ax: Any, run: Flown, k: int) -> list[Any]:
    """Draw the obstacles at record ``k``."""
    u, v = np.meshgrid(np.linspace(0.0, 2.0 * np.pi, 17), np.linspace(0.0, np.pi, 9))
    ball = RADIUS * np.stack([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)], axis=-1)
    return [
        ax.plot_surface(*np.moveaxis((ball + sphere.motion(run.time[k : k + 1])[0][0]) @ _TO_ENU.T, -1, 0),
                        color=OBSTACLE, alpha=0.8, lw=0)
        for sphere in run.spheres
    ]  # fmt: skip


def draw_noise(worst: Mapping[str, Any], path: Path) -> None:
    """Draw sigmavsdev: largest roll and pitch against the noise."""
    figure = new_figure(
        "Largest angle against noise on the payload's velocity and rates, avoiding two spheres", (9, 4.6)
    )
    ax = figure.add_subplot()
    for color, (control, by_sigma) in zip(SERIES, sorted(worst.items()), strict=False):
        sigmas = sorted(by_sigma, key=float)
        for angle, style in (("roll", "o-"), ("pitch", "s--")):
            values = [by_sigma[sigma][f"{angle}_max_deg"] for sigma in sigmas]
            label = f"{TITLES.get(control, control)}: {angle}"
            ax.plot([float(sigma) for sigma in sigmas], values, style, color=color, label=label)
    _limits(ax, 10.0, label="the paper's threshold")
    for sigma, height, text in ((0.008, 8.6, "paper: 10 deg"), (0.012, 7.8, "paper: unstable beyond")):
        ax.axvline(sigma, color="#999999", ls=":", lw=1.0)
        ax.text(sigma, height, f" {text}", fontsize=8, color="#555555")
    ax.set_ylim(bottom=0.0)
    _finish(ax, "sigma (m/s and rad/s)", "largest angle (deg)")
    save_picture(figure, path, DPI)


def draw_mass(mass: Mapping[str, Any], path: Path) -> None:
    """Draw control effort and tilt against the payload's true mass."""
    figure = new_figure("Payload mass: designed for 3.0 kg, avoiding two spheres", (10, 4.2))
    left, right = figure.subplots(1, 2)
    _draw_series(left, mass, lambda n: n.get("effort_change_percent"))
    _draw_series(right, mass, lambda n: max(n["roll_max_deg"], n["pitch_max_deg"]))
    _limits(left, -5.0, 5.0)
    _finish(left, "true mass (kg)", "change of mean |u| (%)")
    right.set_ylim(bottom=0.0)
    _finish(right, "true mass (kg)", "largest roll or pitch (deg)")
    save_picture(figure, path, DPI)


def draw_margin(margin: Mapping[str, Any], path: Path) -> None:
    """Draw clearance and height against the safety margin."""
    figure = new_figure("Safety margin around spheres of 0.5 m", (10, 4.2))
    left, right = figure.subplots(1, 2)
    _draw_series(left, margin, lambda n: n["clearance_min_m"])
    _draw_series(right, margin, lambda n: n["height_max_m"] - ALTITUDE)
    left.plot(left.get_xlim(), left.get_xlim(), ":", color="#999999", label="the margin itself")
    _finish(left, "margin (m)", "least clearance (m)")
    _finish(right, "margin (m)", "highest above the reference (m)")
    save_picture(figure, path, DPI)


def _draw_series(ax: Axes, section: Mapping[str, Any], figure: Callable[[Mapping[str, Any]], Any]) -> None:
    """Draw a figure of the cases of a section, which are named CONTROLLER_VALUE, against the value."""
    by_control: dict[str, dict[float, Any]] = {}
    for name, numbers in section.items():
        control, value = name.split("_")
        by_control.setdefault(control, {})[float(value)] = numbers
    for color, (control, found) in zip(SERIES, by_control.items(), strict=False):
        values = sorted(found)
        label = TITLES.get(control, control)
        ax.plot(values, [figure(found[value]) for value in values], "o-", color=color, label=label)


def draw_course(runs: Mapping[str, RunData], path: Path) -> None:
    """Draw gazObs and payTrajGaz: the obstacles and the payload's path, from above and from the side."""
    figure = new_figure("Obstacle scenario in PyBullet, through MAVLink", (12, 6.4))
    above, side = figure.subplots(2, 1, sharex=True)
    for number, obstacle in enumerate(next(iter(runs.values())).obstacles):
        track = obstacle.position[np.all(np.isfinite(obstacle.position), axis=1)]
        half = obstacle.shape.support(np.eye(3))
        for ax, axis in ((above, 1), (side, 2)):
            sign = 1.0 if axis == 1 else -1.0
            low, high = np.sort(sign * np.array([track[0, axis] - half[axis], track[0, axis] + half[axis]]))
            left = track[0, 0] - half[0]
            label = "obstacle" if number == 0 and axis == 1 else None
            ax.fill([left, left + 2 * half[0], left + 2 * half[0], left], [low, low, high, high],
                    color=OBSTACLE, alpha=0.7 if obstacle.shape.round_axes else 0.2, label=label)  # fmt: skip
            ax.plot(track[:, 0], sign * track[:, axis], color=OBSTACLE, lw=1.0, alpha=0.6)
    for color, (name, run) in zip(SERIES, runs.items(), strict=False):
        flown, label = _until_lost(name, run)
        for ax, height in ((above, flown[:, 1]), (side, -flown[:, 2])):
            ax.plot(flown[:, 0], height, color=color, lw=1.6, label=label)
            if len(flown) < len(run.time):
                ax.plot(flown[-1, 0], height[-1], "x", color=color, ms=10, mew=2.5)
    above.set_aspect("equal", adjustable="datalim")
    _finish(above, "", "east (m)")
    _finish(side, "north (m)", "height (m)")
    save_picture(figure, path, DPI)


def draw_course_position(runs: Mapping[str, RunData], path: Path) -> None:
    """Draw payloadObsGaz: the payload's position and tilt over time among the obstacles."""
    figure = new_figure("Payload in the obstacle scenario", (11, 8.5))
    axes = list(figure.subplots(4, 1, sharex=True))
    for color, (name, run) in zip(SERIES, runs.items(), strict=False):
        flown, label = _until_lost(name, run)
        time = run.time[: len(flown)]
        for i in range(3):
            axes[i].plot(time, flown[:, i], color=color, lw=1.3, label=label)
        axes[3].plot(time, _tilt_over_time(run)[: len(flown)], color=color, lw=1.1, label=label)
    axes[2].invert_yaxis()
    _limits(axes[3], 5.0)
    for ax, label in zip(axes, ("north (m)", "east (m)", "down (m)", "tilt (deg)"), strict=True):
        _finish(ax, "", label)
    axes[3].set_xlabel("time (s)")
    save_picture(figure, path, DPI)


def _until_lost(name: str, run: RunData) -> tuple[Array, str]:
    """Return the payload's path (K, 3) until it tips over, if it does, and the label of the flight."""
    over = np.flatnonzero(_tilt_over_time(run) > LOST_TILT)
    end = over[0] + 1 if len(over) else len(run.time)
    return run.payload_position[:end], FLOWN_BY[name] + (", lost" if len(over) else "")


def _tilt_over_time(run: RunData) -> Array:
    return np.asarray(np.abs(payload_angles(run))[:, :2].max(axis=1))


_TO_ENU = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])


def enu(points: Array) -> Array:
    """Return east, north, up (3, K) of NED points (K, 3)."""
    return np.asarray(_TO_ENU @ points.T)


def label_space(ax: Any) -> None:
    """Label and scale the axes of a picture in space."""
    ax.set(xlabel="east (m)", ylabel="north (m)", zlabel="up (m)", xlim=(-8, 8), ylim=(-8, 8), zlim=(0, 12))
    ax.view_init(elev=28.0, azim=-60.0)


def new_figure(title: str, size: tuple[float, float]) -> Figure:
    """Return an empty figure without pyplot, which would need a display."""
    figure = Figure(figsize=size, layout="constrained")
    figure.suptitle(title, fontsize=12, fontweight="bold")
    return figure


def _limits(ax: Axes, *values: float, label: str | None = None) -> None:
    for value in values:
        ax.axhline(value, color=LIMIT, ls="--", lw=1.0, label=label)


def _finish(ax: Axes, x: str, y: str) -> None:
    ax.set_xlabel(x)
    ax.set_ylabel(y)
    ax.grid(alpha=0.3)
    if ax.get_legend_handles_labels()[1]:
        ax.legend(frameon=False, fontsize=8)


def animate(flown: Mapping[str, Flown], title: str, path: Path, frames: int) -> None:
    """Write ``frames`` pictures of the simulations ``flown``, next to each other, over their time."""
    figure = new_figure(title, (5.2 * len(flown), 4.8))
    axes: list[Any] = []
    moving: list[Any] = []
    for column, (name, run) in enumerate(flown.items()):
        ax: Any = figure.add_subplot(1, len(flown), column + 1, projection="3d")
        ax.plot(*enu(run.reference), ":", color="#D55E00", lw=1.0)
        ax.set_title(TITLES.get(name, name), fontsize=10)
        label_space(ax)
        axes.append(ax)
    # Fixed from here on, which saves the layout of every picture.
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    writer = PillowWriter(fps=12)
    with writer.saving(figure, str(path), 70):
        for share in np.linspace(0.0, 1.0, frames):
            for artist in moving:
                artist.remove()
            moving = []
            for ax, run in zip(axes, flown.values(), strict=True):
                k = round(share * (len(run.time) - 1))
                moving += ax.plot(*enu(run.position[: k + 1]), color="black", lw=1.2)
                moving += draw_formation(ax, run, k)
                moving += draw_spheres(ax, run, k)
            writer.grab_frame()
