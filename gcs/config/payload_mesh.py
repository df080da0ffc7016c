"""A payload from a mesh file: hull, centre of mass and inertia of a body of one density, by trimesh."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from pydantic_core.core_schema import ValidationInfo

from gcs.config.mesh_file import MOST_CORNERS, UnusableMesh, read_mesh
from idc_controller.arrays import Array

if TYPE_CHECKING:
    import trimesh


ON_SURFACE = 0.005  # m, by which an attachment point may miss the surface
SMALLEST, LARGEST = 0.05, 20.0  # m, of the longest edge of the bounding box


@dataclass(frozen=True, eq=False)
class PayloadMesh:
    """The body that the surface in a file encloses. The file's axes are forward, right and down, its unit is the metre.

    In a system file it stands as the name of the mesh file beside it.
    """

    path: Path
    name: str  # of the file, as the system file has it
    volume: float  # m3
    centre_of_mass: Array  # (3,) m, in the coordinates of the file
    inertia: Array  # (3, 3) m2, about the centre of mass, of 1 kg
    vertices: Array  # (V, 3) m, of the convex hull, about the centre of mass
    surface: trimesh.Trimesh = field(repr=False)  # in the coordinates of the file

    @classmethod
    def read(cls, path: Path, name: str) -> PayloadMesh:
        """Read and check a mesh file. Raises :class:`UnusableMesh`."""
        mesh = read_mesh(path)
        middle, extents = mesh.bounds.mean(axis=0), mesh.extents
        edges = " x ".join(f"{edge:.3g}" for edge in extents)
        if not SMALLEST <= extents.max() <= LARGEST:
            raise UnusableMesh(
                f"'{name}' is {edges} m (limit of the longest edge {SMALLEST} .. {LARGEST:g} m): its unit is the metre"
            )
        # About the middle first: integrals about a distant origin would lose digits.
        if mesh.body_count != 1:
            raise UnusableMesh(f"'{name}' has {mesh.body_count} closed surfaces (limit 1): join them to one")
        body = mesh.copy()
        body.apply_translation(-middle)
        properties = body.mass_properties
        if not (mesh.is_winding_consistent and properties.volume > 0.0):
            raise UnusableMesh(f"'{name}' has no volume: its faces are not all oriented outwards")
        vertices = np.array(body.convex_hull.vertices) - properties.center_mass
        if len(vertices) > MOST_CORNERS:
            raise UnusableMesh(f"the hull of '{name}' has {len(vertices)} corners (limit {MOST_CORNERS}); simplify it")
        inertia = np.array(properties.inertia) / properties.volume
        return cls(
            path,
            name,
            float(properties.volume),
            properties.center_mass + middle,
            (inertia + inertia.T) / 2.0,
            vertices,
            mesh,
        )

    def __str__(self) -> str:
        return self.name

    def misplaced(self, points: Array) -> list[str]:
        """Return what is wrong with attachment ``points`` (N, 3) about the centre of mass (m), a line for each."""
        import trimesh  # half a second, spent only where there is a mesh

        at = points + self.centre_of_mass
        on, distances, _ = trimesh.proximity.closest_point_naive(self.surface, at)
        return [
            f"point {i + 1} at {_text(at[i])} m is {distances[i]:.3f} m off the surface of '{self.name}' "
            f"(limit {ON_SURFACE} m); the nearest point on it is {_text(on[i])} m"
            for i in np.flatnonzero(distances > ON_SURFACE).tolist()
        ]

    @classmethod
    def from_text(cls, name: str, info: ValidationInfo) -> PayloadMesh:
        """Return the mesh in a file beside the one that names it. Raises ``ValueError`` where there is none."""
        try:
            return cls.read(Path((info.context or {}).get("folder", "")) / name, name)
        except UnusableMesh as error:
            raise ValueError(error) from error


def _text(point: Array) -> str:
    return "[" + ", ".join(f"{value + 0.0:.3f}" for value in point) + "]"
