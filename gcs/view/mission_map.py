"""The map of a mission before it is flown: ``gcs check MISSION --plot FILE``."""

from pathlib import Path

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from shapely.plotting import plot_polygon

from gcs.errors import UnusableInput
from gcs.mission.flown_legs import flown_legs
from gcs.mission.model import Mission, Obstacle
from gcs.mission.route import Route
from gcs.mission.route_clearance import free_space, route_places, standing_obstacles
from gcs.record.figures import FLOWN, LIMIT, OBSTACLE, SERIES, save_picture
from idc_controller.arrays import Array
from idc_controller.geometry.free_space import BoundingCylinder

_ROUTE, _KNOWN, _UNKNOWN, _LEAST, _FENCE = FLOWN, OBSTACLE, SERIES[1], LIMIT, SERIES[2]
_SPACING = 0.1
"""m along the route, between places at which the clearance is looked at."""
_SHOWN = 40
"""Legs whose ends are numbered."""
_NAMED = 30
"""Obstacles whose names are written; of more, none but that of the least clearance."""
_BESIDE = 4.0
"""m about the route and what stands."""


def write_map(mission: Mission, path: Path) -> None:
    """Draw the map of a mission as an image file of the kind that the suffix of ``path`` names.

    North up: fence, obstacles, the numbered legs, the area that the formation sweeps along them (its upright bounds at
    rest, as in the preflight check), and where it comes nearest to what stands on the map. Raises
    :class:`UnusableInput` if it cannot be written.
    """
    figure = draw_map(mission)
    kinds = figure.canvas.get_supported_filetypes()
    if (kind := path.suffix.lower().lstrip(".")) not in kinds:
        raise UnusableInput(f"--plot {path}: images of kind {kind!r} are not written, only of {', '.join(kinds)}")
    save_picture(figure, path, 130)


def draw_map(mission: Mission) -> Figure:
    """Return the map of a mission (see :func:`write_map`)."""
    figure = Figure(figsize=(8.0, 8.0), layout="constrained")
    FigureCanvasAgg(figure)
    ax = figure.add_subplot(aspect="equal", xlabel="east (m)", ylabel="north (m)")
    ax.set_title(f"{mission.name}, {mission.system.team.vehicles} vehicles, seed {mission.seed}")
    places = _places(mission)
    area = swept_area(places, BoundingCylinder.of(mission.system.parameters()))
    plot_polygon(
        _north_up(area), ax, add_points=False, color=_ROUTE, alpha=0.15, lw=0.0, label="swept by the formation"
    )
    _draw_fence(ax, mission)
    for obstacle in mission.obstacles:
        _draw_obstacle(ax, obstacle, named=len(mission.obstacles) <= _NAMED)
    ax.plot(places[:, 1], places[:, 0], color=_ROUTE, lw=1.2, label="route of the payload")
    _number_legs(ax, mission)
    if (gap := least_clearance(mission, places)) is not None:
        _mark(ax, *gap)
    drawn = np.vstack([places[:, :2], *(np.array([o.position[:2]]) for o in mission.obstacles), *mission.boundary])
    low, high = drawn.min(axis=0) - _BESIDE, drawn.max(axis=0) + _BESIDE
    middle, half = (low + high) / 2.0, float((high - low).max()) / 2.0
    ax.set(xlim=(middle[1] - half, middle[1] + half), ylim=(middle[0] - half, middle[0] + half))
    ax.grid(alpha=0.3)
    handles, labels = ax.get_legend_handles_labels()
    unique = dict(zip(labels, handles, strict=True))
    figure.legend(unique.values(), unique.keys(), loc="outside lower center", ncols=3, frameon=False)
    return figure


def swept_area(places: Array, formation: BoundingCylinder) -> shapely.Geometry:
    """Return what a formation at rest covers in plan view (north, east, m) on the lines between ``places`` (P, 3)."""
    half_north, half_east = formation.core
    corners = np.array([[1, 1], [1, -1], [-1, -1], [-1, 1]]) * (half_north, half_east)
    starts, ends = places[:-1, None, :2] + corners, places[1:, None, :2] + corners
    cores = shapely.convex_hull(shapely.multipoints(np.concatenate([starts, ends], axis=1)))
    return shapely.union_all(cores).buffer(min(formation.rounding, formation.radius))


def least_clearance(mission: Mission, places: Array) -> tuple[Array, Obstacle, float] | None:
    """Return where on the lines between ``places`` (P, 3) the formation at rest is nearest to what stands on the map.

    The place (3,) (NED, m), the obstacle and the clearance (m), as the preflight check measures it, negative where they
    overlap; None: nothing stands.
    """
    standing = standing_obstacles(mission)
    if not standing:
        return None
    lengths = np.linalg.norm(np.diff(places, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(lengths)])
    at = np.linspace(0.0, along[-1], 2 + int(along[-1] / _SPACING))
    fine = np.stack([np.interp(at, along, places[:, axis]) for axis in range(3)], axis=1)
    clearance = free_space(mission, standing).clearance(fine)
    row, column = np.unravel_index(np.argmin(clearance), clearance.shape)
    return fine[row], standing[column], float(clearance[row, column])


def _places(mission: Mission) -> Array:
    return np.vstack([[0.0, 0.0, -mission.system.resting_altitude], route_places(mission)])


def _north_up(area: shapely.Geometry) -> shapely.Geometry:
    return shapely.transform(area, lambda corners: corners[:, ::-1])


def _draw_fence(ax: Axes, mission: Mission) -> None:
    for rings, style, label in (
        (mission.boundary, "-", "fence: stay inside"),
        (mission.excluded, "--", "fence: keep out"),
    ):
        for ring in rings:
            ax.add_patch(Polygon(np.array(ring)[:, ::-1], fill=False, edgecolor=_FENCE, ls=style, lw=1.6, label=label))


def _draw_obstacle(ax: Axes, obstacle: Obstacle, *, named: bool) -> None:
    outline = obstacle.shape.plan_view.outline() + np.array(obstacle.position[:2])
    colour, label = (_KNOWN, "on the map") if obstacle.known else (_UNKNOWN, "not on the map")
    label = f"obstacle {label}" if obstacle.motion is None else f"moving obstacle {label}, at the start"
    style = "-" if obstacle.motion is None else ":"
    ax.add_patch(Polygon(outline[:, ::-1], facecolor=colour, edgecolor="black", ls=style, alpha=0.7, label=label))
    north, east = obstacle.position[:2]
    if named:
        ax.annotate(obstacle.name, (east, north), ha="center", va="center", fontsize=7)


def _number_legs(ax: Axes, mission: Mission) -> None:
    """Write the number of each leg at its end, those of one place beside each other."""
    if not isinstance(mission.reference, Route):
        return
    numbers: dict[tuple[float, float], list[str]] = {}
    for leg in flown_legs(mission.reference, mission.system).legs[:_SHOWN]:
        numbers.setdefault((round(leg.east, 1), round(leg.north, 1)), []).append(str(leg.number))
    for (east, north), found in numbers.items():
        ax.plot(east, north, "o", color=_ROUTE, ms=4)
        ax.annotate(
            ", ".join(found), (east, north), xytext=(5, 5), textcoords="offset points", color=_ROUTE, weight="bold"
        )


def _mark(ax: Axes, place: Array, obstacle: Obstacle, clearance: float) -> None:
    outline = shapely.Polygon(obstacle.shape.plan_view.outline() + np.array(obstacle.position[:2]))
    line = shapely.get_coordinates(shapely.shortest_line(shapely.Point(place[:2]), outline))
    ax.plot(line[:, 1], line[:, 0], color=_LEAST, lw=2.0, label="least clearance")
    there = f"to {obstacle.name}, {-place[2]:.1f} m high"
    ax.annotate(
        f"{clearance:.2f} m {there}" if clearance > 0.0 else f"leads in{there}",
        line[-1, ::-1], xytext=(12, -16),
        textcoords="offset points", color=_LEAST, weight="bold", fontsize=9,
        bbox={"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 1.5},
    )  # fmt: skip
