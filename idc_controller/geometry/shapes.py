"""The registry of shapes: a new kind is its own module and one entry here."""

from idc_controller.errors import ShapeError
from idc_controller.geometry.box import Box, Wall
from idc_controller.geometry.capsule import Capsule
from idc_controller.geometry.mesh import Mesh
from idc_controller.geometry.pole import Pole
from idc_controller.geometry.shape import Shape
from idc_controller.geometry.sphere import Sphere

SHAPES: dict[str, type[Shape]] = {shape.kind: shape for shape in (Sphere, Pole, Wall, Capsule, Box, Mesh)}


def shape_class(kind: str) -> type[Shape]:
    """Return the class of the shapes of that ``kind``. Raises :class:`ShapeError` for one that does not exist."""
    if kind not in SHAPES:
        raise ShapeError(f"shape is {kind!r}, expected one of {', '.join(SHAPES)}")
    return SHAPES[kind]
