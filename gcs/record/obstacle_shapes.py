"""``obstacle_shapes.json`` of a run: obstacles' shapes that the columns of ``obstacles.csv`` do not hold in full."""

import dataclasses
import json
from collections.abc import Mapping
from pathlib import Path

from gcs.errors import UnusableInput
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


def read_shape(folder: Path, name: str, kind: str, columns: Columns) -> Shape:
    """Return the shape of an obstacle from the columns or, where those do not suffice, from the file.

    Raises :class:`UnusableInput` for a shape that does not exist or that neither holds.
    """
    try:
        cls = shape_class(kind)
        if cls.in_columns:
            return cls.from_columns(columns)
        found = json.loads((folder / OBSTACLE_SHAPES).read_text(encoding="utf-8"))[name]
        return cls.from_fields({key: value for key, value in found.items() if key != "shape"})
    except ShapeError as error:
        raise UnusableInput(f"obstacle {name}: {error}") from error
    except (OSError, ValueError, LookupError, TypeError) as error:
        raise UnusableInput(f"{folder / OBSTACLE_SHAPES}: does not hold the {kind} {name!r}: {error}") from error
