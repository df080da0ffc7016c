"""The place of any known convex shape from surface points: Gauss-Newton on the distance to its surface."""

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.obstacles import Bodies
from idc_controller.geometry.shape import Shape
from idc_controller.perception.settings import SurfaceSettings
from idc_controller.perception.surfaces.points import Fit, SurfacePoints, score, unexplained

_STEP = 1e-4  # m, of the differences that give the surface's normals


class KnownSurface:
    """A shape that is given; only the place of its centre, the reference point, is found."""

    size_sigma = 0.0
    """Standard deviation of the size (m)."""

    def __init__(self, known: Shape, settings: SurfaceSettings) -> None:
        self.shape, self._settings = known, settings
        self.kind = known.kind
        self.offset = np.zeros(3)
        self._body = Bodies([known])

    def guess(self, scan: SurfacePoints) -> Array:
        """Return a first place for the centre: half the body behind the middle of the points (3,)."""
        middle, ray = scan.points.mean(axis=0), scan.rays.mean(axis=0)
        return np.asarray(middle + self.shape.support(ray) * ray)

    def fit(self, scan: SurfacePoints, predicted: Array, iterations: int = 3) -> Fit:
        """Return the place of the centre in this frame, expected at ``predicted`` (3,)."""
        place = predicted.copy()
        prior = np.eye(3) / self._settings.sideways_sigma**2
        variance = scan.noise**2 + scan.pose_variance + scan.scatter
        for _ in range(iterations):
            residual, normal = self._distance(scan.points - place)
            weight = 1.0 / (variance * (1.0 + residual**2 / (9.0 * variance)))
            information = (normal.T * weight) @ normal + prior
            place = place + np.linalg.solve(information, (normal.T * weight) @ residual + prior @ (predicted - place))
        residual, _ = self._distance(scan.points - place)
        spread = np.diag(np.linalg.inv(information)) + scan.common_variance
        return Fit(place, spread, score(residual, variance), unexplained(residual, variance, fitted=3))

    def _distance(self, offsets: Array) -> tuple[Array, Array]:
        """Distance of points (n, 3) about the centre from the surface (n,), and its gradient (n, 3)."""
        steps = np.concatenate([np.zeros((1, 3)), _STEP * np.eye(3)])
        distance = self._body.from_offsets((offsets + steps[:, None]).reshape(1, -1, 3)).reshape(4, -1)
        return distance[0], (distance[1:] - distance[0]).T / _STEP
