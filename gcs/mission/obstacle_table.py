"""``[[obstacle]]`` of the project's own missions: the keys that all obstacles have, and those of each shape."""

from __future__ import annotations

import math
from dataclasses import Field as ShapeField
from dataclasses import dataclass, field, fields, make_dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal, Union

from pydantic import AfterValidator, Field

from gcs.config.tables import Vector
from gcs.config.toml_file import Positive, strict
from gcs.mission.model import Motion, Name, Obstacle
from idc_controller.geometry.shape import Shape
from idc_controller.geometry.shapes import SHAPES

_TYPES: dict[tuple[str, str], Any] = {
    # of a shape's field, by unit and annotation
    ("m", "float"): Positive,
    ("m", "Vector"): tuple[Positive, Positive, Positive],
    ("rad", "float"): float,
}


@strict
@dataclass(frozen=True)
class _ObstacleTable:
    """The keys of every obstacle; the tables of the shapes add their own."""

    name: Name
    known: bool = True
    motion: Motion | None = None


def _table(kind: str, shape: type[Shape]) -> Any:
    """Return the dataclass that a table of this shape is read into."""
    own = [
        (key_of(part), _TYPES[part.metadata["unit"], str(part.type)], *([field(default=0.0)] * _is_angle(part)))
        for part in fields(shape)
    ]
    place = tuple[float, float] if shape.is_grounded else Vector
    entries = [("position", place), *own, ("shape", Literal[kind])]
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
        keys[key_of(part)] = round(math.degrees(value), 9) if _is_angle(part) else value
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
