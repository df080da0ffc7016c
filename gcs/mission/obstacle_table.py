"""``[[obstacle]]`` of the project's own missions: the keys that all obstacles have, and those of each shape."""

import math
from dataclasses import Field as ShapeField
from dataclasses import dataclass, field, fields, make_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Union, get_type_hints

import numpy as np
from pydantic import AfterValidator, Field, ValidationInfo

from gcs.config.mesh_file import MOST_CORNERS, UnusableMesh, read_mesh
from gcs.config.tables import Vector
from gcs.config.validate import Positive, strict
from gcs.mission.model import Name, Obstacle
from gcs.mission.motion import Motion
from idc_controller.geometry.shape import Shape
from idc_controller.geometry.shapes import SHAPES, MeshHull

CONVEX = 0.95
"""Share of its hull that a mesh must fill; with less the hull would take too much of the free space."""


def read_hull(path: Path) -> MeshHull:
    """Return the convex hull of the mesh in a file. Raises :class:`UnusableMesh`, too, for one that is concave."""
    mesh = read_mesh(path)
    hull = mesh.convex_hull
    share = mesh.volume / hull.volume
    if share < CONVEX:
        raise UnusableMesh(
            f"'{path.name}' is concave: it fills {100.0 * share:.0f} % of its convex hull "
            f"(limit {100.0 * CONVEX:.0f} %); cut it into convex parts, each a file and an obstacle of its own"
        )
    if len(hull.vertices) > MOST_CORNERS:
        raise UnusableMesh(
            f"the hull of '{path.name}' has {len(hull.vertices)} corners (limit {MOST_CORNERS}); simplify it"
        )
    corners = np.array(hull.vertices) - mesh.bounds.mean(axis=0)
    return MeshHull(path.name, tuple((float(x), float(y), float(z)) for x, y, z in corners))


def _hull_beside(name: str, info: ValidationInfo) -> MeshHull:
    """Return the hull of a mesh file beside the file that names it."""
    try:
        return read_hull(Path((info.context or {}).get("folder", "")) / name)
    except UnusableMesh as error:
        raise ValueError(error) from error


_TYPES: dict[tuple[str, Any], Any] = {
    # of a shape's field, by unit and annotation
    ("m", float): Positive,
    ("m", Vector): tuple[Positive, Positive, Positive],
    ("rad", float): float,
    ("file", MeshHull): Annotated[str, Field(min_length=1), AfterValidator(_hull_beside)],
}


@strict
@dataclass(frozen=True)
class _ObstacleTable:
    """The keys of every obstacle; the tables of the shapes add their own."""

    name: Name
    known: bool = True
    motion: Motion | None = None


def _table(kind: str, shape: type[Shape]) -> Any:
    hints = get_type_hints(shape)
    own: list[tuple[str, Any, Any]] = [
        (key_of(part), _TYPES[part.metadata["unit"], hints[part.name]], field(default=part.default))
        for part in fields(shape)
    ]
    place = tuple[float, float] if shape.is_grounded else Vector
    entries: list[Any] = [("position", place), *own, ("shape", Literal[kind])]
    cls = make_dataclass(f"{shape.__name__}Table", entries, bases=(_ObstacleTable,), frozen=True, kw_only=True)
    return strict(cls)


def key_of(part: ShapeField[Any]) -> str:
    """Return the key of a shape's field in a mission file; angles stand there in degrees."""
    return f"{part.name}_deg" if _is_angle(part) else part.name


def _is_angle(part: ShapeField[Any]) -> bool:
    return bool(part.metadata["unit"] == "rad")


def keys_of(obstacle: Obstacle) -> dict[str, Any]:
    """Return the keys and values of an obstacle as its table has them; the inverse of reading."""
    shape, place = obstacle.shape, obstacle.position
    keys: dict[str, Any] = {"name": obstacle.name, "shape": shape.kind}
    keys["position"] = place[:2] if shape.is_grounded else place
    for part in fields(shape):
        value = getattr(shape, part.name)
        # What was written in degrees comes back as it was written.
        if _is_angle(part):
            value = round(math.degrees(value), 9)
        keys[key_of(part)] = value.name if isinstance(value, MeshHull) else value
    keys["known"] = obstacle.known
    return keys if obstacle.motion is None else {**keys, "motion": obstacle.motion}


def _obstacle(table: Any) -> Obstacle:
    """Return the obstacle of a table; one that stands on the ground has its centre at half its height."""
    cls = SHAPES[table.shape]
    values = {part.name: getattr(table, key_of(part)) for part in fields(cls)}
    shape = cls(**{part.name: math.radians(values[part.name]) if _is_angle(part) else values[part.name]
                   for part in fields(cls)})  # fmt: skip
    position = table.position
    if cls.is_grounded:
        position = (*position, -shape.half_height)
    return Obstacle(table.name, position, shape, table.known, table.motion)


if TYPE_CHECKING:
    ObstacleTable = Obstacle
else:  # read from the table of its shape
    ObstacleTable = Annotated[
        Union[tuple(_table(kind, shape) for kind, shape in SHAPES.items())],  # noqa: UP007
        Field(discriminator="shape"),
        AfterValidator(_obstacle),
    ]
