"""Spheres and poles from surface points: Gauss-Newton on distance to the surface, centre and radius together."""

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.pole import Pole
from idc_controller.geometry.shape import Shape
from idc_controller.geometry.sphere import Sphere
from idc_controller.perception.settings import SurfaceSettings
from idc_controller.perception.surfaces.points import EndOfSurface, Fit, SurfacePoints, score, unexplained

_CLOSE_ENOUGH = 0.004  # m: a smaller last step of the search changes nothing that matters


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

    @property
    def shape(self) -> Shape:
        """The estimated shape."""
        if self.known is not None:
            return self.known
        if self._is_pole:
            return Pole(self._radius, max(self._top.outermost, 0.1))
        return Sphere(self._radius)

    @property
    def offset(self) -> Array:
        """Vector from the reference point to the shape's centre (3,)."""
        return np.array([0.0, 0.0, -self.shape.half_height if self._is_pole else 0.0])

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
        n_axes, s = self._axes, self._settings
        prior = np.full(n_axes + 1, 1.0 / s.centre_sigma**2)
        prior[-1] = 1.0 / (self._variance + s.radius_walk**2)
        mean = np.append(predicted[:n_axes], self._radius)
        theta = mean.copy()
        points, rays = scan.points[:, :n_axes], scan.rays[:, :n_axes]
        low, high = s.pole_radius_min if self._is_pole else s.sphere_radius_min, s.radius_max
        H = np.empty((len(points), n_axes + 1))
        for _ in range(iterations):
            residual, normal, variance = self._residuals(points, rays, theta, scan, H[:, -1])
            weight = 1.0 / (variance * (1.0 + residual**2 / (9.0 * np.maximum(variance, 0.0025))))
            if self._is_pole:
                weight[residual < -s.pole_end_depth - s.pole_end_share * theta[-1]] = 0.0
            H[:, :n_axes] = -normal
            HW = H.T * weight
            information = HW @ H
            information[np.arange(n_axes + 1), np.arange(n_axes + 1)] += prior
            step = np.linalg.solve(information, prior * (mean - theta) - HW @ residual)
            theta = theta + step
            theta[-1] = min(max(theta[-1], low), high)
            if abs(step).max() < _CLOSE_ENOUGH:
                break
        covariance = np.linalg.inv(information)
        common = float(np.mean(scan.pose_variance)) / scan.sensors
        position = np.zeros(3)
        position[:n_axes] = theta[:n_axes]
        spread = np.full(3, 0.02**2)
        # Where points scatter by as much as the body is wide, their normals are no more than guesses.
        guessed = 1.0 + s.scatter_loss * scan.scatter / theta[-1] ** 2
        spread[:n_axes] = guessed * np.diag(covariance)[:n_axes] + common
        residual, _, variance = self._residuals(points, rays, theta, scan, H[:, -1])
        if self._is_pole:
            on_side = residual > -s.pole_end_depth - s.pole_end_share * theta[-1]
            # What lies inside the side must be the top: the highest points.
            height = scan.points[:, 2] - scan.points[:, 2].min()
            residual = np.where(on_side, residual, np.minimum(-residual, height))
        if self.known is None:
            self._radius = float(theta[-1])
            self._variance = max(float(covariance[-1, -1]), s.radius_sigma_min**2)
            if self._is_pole:
                self._top.update(-scan.points[:, 2], scan.cut)
        fitted = n_axes + (self.known is None)
        return Fit(position, spread, score(residual, variance), unexplained(residual, variance, fitted))

    def _residuals(
        self, points: Array, rays: Array, theta: Array, scan: SurfacePoints, of_radius: Array
    ) -> tuple[Array, Array, Array]:
        """Distance to the surface (n,), its normals (n, axes), variance of the distance (n,).

        ``of_radius`` (n,) is filled with what the distances change by as the radius grows.
        """
        d = points - theta[:-1]
        distance = np.maximum(np.sqrt(np.einsum("ij,ij->i", d, d)), 1e-3)
        normal = d / distance[:, None]
        incidence = np.einsum("ij,ij->i", normal, rays)
        variance = (scan.noise * incidence) ** 2 + scan.pose_variance + scan.scatter + self._settings.model_sigma**2
        # Scatter across the surface puts points outside of it on average, the more so the smaller it is.
        outside = 0.5 * (self._axes - 1) * scan.scatter / theta[-1]
        residual = distance - theta[-1] - outside
        of_radius[:] = -1.0
        if scan.scatter > 0.0:
            self._behind(d, rays, theta[-1], residual, normal, of_radius)
        return residual, normal, variance

    @staticmethod
    def _behind(d: Array, rays: Array, radius: float, residual: Array, normal: Array, of_radius: Array) -> None:
        """Points that seem to be on the side hidden from all sensors are as far off as from the rim of the visible one.

        Otherwise they would fit a body as well that is nearer by its width. Changes the last three in place.
        """
        rays = rays / np.maximum(np.sqrt(np.einsum("ij,ij->i", rays, rays)), 1e-6)[:, None]
        along = np.einsum("ij,ij->i", d, rays)
        behind = along > 0.0
        if not behind.any():
            return
        ray, along = rays[behind], along[behind]
        across = d[behind] - along[:, None] * ray
        width = np.maximum(np.sqrt(np.einsum("ij,ij->i", across, across)), 1e-3)
        out = width - radius
        distance = np.maximum(np.hypot(along, out), 1e-3)
        residual[behind] = distance
        normal[behind] = (along[:, None] * ray + (out / width)[:, None] * across) / distance[:, None]
        of_radius[behind] = -out / distance
