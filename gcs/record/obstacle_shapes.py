"""``obstacle_shapes.json`` of a run: obstacles' shapes that the columns of ``obstacles.csv`` do not hold in full."""

import dataclasses
import json
from collections.abc import Mapping
from pathlib import Path

from idc_controller.errors import ShapeError
from idc_controller.geometry.shape import Columns, Shape
from idc_controller.geometry.shapes import shape_class

OBSTACLE_SHAPES = "obstacle_shapes.json"


def write_shapes(folder: Path, shapes: Mapping[str, Shape]) -> None:
    """Write the shapes, by the obstacles' names; no file if the columns hold all of them."""
    found = {
        name: {"shape": shape.kind, **dataclasses.asdict(shape)}
        for name, shape in shapes.items()
        if not shape.in_columns
    }
    if found:
        (folder / OBSTACLE_SHAPES).write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


def read_shape(kind: str, columns: Columns, fields: Mapping[str, object] | None) -> Shape:
    """Return a shape from its ``fields`` in the file or, where that has none (None), from the columns.

    Raises :class:`ShapeError` for a shape that does not exist or that neither holds.
    """
    cls = shape_class(kind)
    if fields is None:
        return cls.from_columns(columns)
    try:
        return cls.from_fields({key: value for key, value in fields.items() if key != "shape"})
    except (ValueError, LookupError, TypeError) as error:
        raise ShapeError(f"{OBSTACLE_SHAPES} does not hold the {kind}: {error}") from error
