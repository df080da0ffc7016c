"""Animations of the simulations (GIF), as in the paper's video."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.animation import PillowWriter

from gcs.reproduce.figures import TITLES, draw_formation, draw_spheres, enu, label_space, new_figure
from gcs.reproduce.simulation import Flown


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
