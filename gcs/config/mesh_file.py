"""Meshes of STL, OBJ and PLY files: read and checked by trimesh."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import trimesh

FORMATS = (".stl", ".obj", ".ply")
LARGEST_FILE = 20e6  # bytes
THINNEST = 1e-3
"""Least edge of the bounding box over its largest."""
MOST_CORNERS = 2000
"""Largest number of corners of the convex hull."""


class UnusableMesh(Exception):
    """A mesh that cannot be read, or that encloses no volume."""


def read_mesh(path: Path) -> trimesh.Trimesh:
    """Return the closed surface that a file holds. Raises :class:`UnusableMesh`."""
    import trimesh  # half a second, spent only where there is a mesh

    name = path.name
    if path.suffix.lower() not in FORMATS:
        raise UnusableMesh(f"'{name}' is none of {', '.join(FORMATS)}")
    try:
        size = path.stat().st_size
        if size > LARGEST_FILE:
            raise UnusableMesh(f"'{name}' has {size / 1e6:.0f} MB (limit {LARGEST_FILE / 1e6:.0f} MB)")
        data, kind = BytesIO(path.read_bytes()), path.suffix.lower().lstrip(".")
        mesh = trimesh.load(data, file_type=kind, force="mesh", process=True)
    except UnusableMesh:
        raise
    except OSError as error:
        raise UnusableMesh(f"cannot read '{name}': {error.strerror or error}") from error
    except Exception as error:  # whatever the parsers raise on damaged files
        raise UnusableMesh(f"'{name}' is no mesh: {str(error).splitlines()[0] if str(error) else error!r}") from error
    if not isinstance(mesh, trimesh.Trimesh) or not len(mesh.faces):
        raise UnusableMesh(f"'{name}' has no faces")
    mesh.merge_vertices()
    if not np.isfinite(mesh.vertices).all():
        raise UnusableMesh(f"'{name}' has vertices that are not finite")
    extents = np.ptp(mesh.vertices, axis=0)
    if extents.min() <= THINNEST * extents.max():
        edges = " x ".join(f"{edge:.3g}" for edge in extents)
        raise UnusableMesh(f"'{name}' is flat: its bounding box is {edges}")
    if not mesh.is_watertight:
        raise UnusableMesh(f"'{name}' is not watertight: its surface has holes; close it")
    if mesh.volume < 0.0:
        mesh.invert()
    return mesh
