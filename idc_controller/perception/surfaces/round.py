"""Spheres and poles from surface points: Gauss-Newton on distance to the surface, centre and radius together."""

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.shape import Shape
from idc_controller.geometry.shapes import Pole, Sphere
from idc_controller.perception.settings import SurfaceSettings
from idc_controller.perception.surfaces.points import EndOfSurface, Fit, SurfacePoints
from idc_controller.perception.surfaces.round_kernels import fitted_round

_CLOSE_ENOUGH = 0.004  # m: a smaller last step of the search changes nothing that matters
_ON_GROUND = 0.02  # m: standard deviation of a pole's foot from the ground


class RoundSurface:
    """A sphere, or a pole on the ground. Its reference point is the centre, a pole's on the ground.

    ``known``: the shape is given and stays as it is.
    """

    def __init__(self, kind: str, known: Shape | None, settings: SurfaceSettings) -> None:
        self.kind, self.known, self._settings = kind, known, settings
        self._is_pole = kind == Pole.kind
        self._axes = 2 if self._is_pole else 3
        self._radius = known.columns.radius if known else settings.radius
        self._variance = 1e-6 if known else settings.radius_sigma**2
        self._top = EndOfSurface(settings.pole_extension, settings)
        if known is not None:
            self._describe()

    def _describe(self) -> None:
        """Keep what follows from a fit; of a surface that is not known there is none before the first."""
        self.shape: Shape = self.known or (
            Pole(self._radius, max(self._top.outermost, 0.1)) if self._is_pole else Sphere(self._radius)
        )
        """The estimated shape."""
        self.offset = np.array([0.0, 0.0, -self.shape.half_height if self._is_pole else 0.0])
        """Vector from the reference point to the shape's centre (3,)."""

    @property
    def size_sigma(self) -> float:
        """Standard deviation of the radius (m)."""
        return 0.0 if self.known else float(np.sqrt(self._variance))

    def guess(self, scan: SurfacePoints) -> Array:
        """Return a first reference point: behind the nearest point, along its sensor's ray (3,)."""
        ray = scan.points - scan.origins
        nearest = int(np.argmin(np.einsum("ij,ij->i", ray, ray)))
        direction = scan.rays[nearest].copy()
        if self._is_pole:
            direction[2] = 0.0
            direction /= max(np.hypot(direction[0], direction[1]), 1e-3)
        return np.asarray(scan.points[nearest] + self._radius * direction)

    def fit(self, scan: SurfacePoints, predicted: Array, iterations: int = 3) -> Fit:
        """Return the place in this frame, expected at ``predicted`` (3,), and learn the shape from it."""
        s = self._settings
        position, variance, radius, radius_variance, score, unexplained = fitted_round(
            np.ascontiguousarray(scan.points), np.ascontiguousarray(scan.origins), scan.pose_variance,
            np.ascontiguousarray(predicted), self._axes, self._radius, s.centre_sigma**2,
            self._variance + s.radius_walk**2, scan.noise, scan.scatter, s.model_sigma**2,
            s.pole_radius_min if self._is_pole else s.sphere_radius_min, s.radius_max,
            s.pole_end_depth, s.pole_end_share, iterations, self._axes + (self.known is None), _CLOSE_ENOUGH,
        )  # fmt: skip
        # Where points scatter by as much as the body is wide, their normals are no more than guesses.
        guessed = 1.0 + s.scatter_loss * scan.scatter / radius**2
        spread = guessed * variance + scan.common_variance
        if self._is_pole:
            spread[2] = _ON_GROUND**2
        if self.known is None:
            self._radius = radius
            self._variance = max(radius_variance, s.radius_sigma_min**2)
            if self._is_pole:
                self._top.update(-scan.points[:, 2], scan.cut)
            self._describe()
        return Fit(position, spread, score, unexplained)
