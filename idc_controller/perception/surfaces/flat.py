"""Walls from surface points: a box that stands upright, with the face of the best visibility in front."""

from functools import cache

import numpy as np

from idc_controller.arrays import Array, Indices, Mask
from idc_controller.geometry.shapes import Wall
from idc_controller.perception.settings import SurfaceSettings
from idc_controller.perception.surfaces.points import EndOfSurface, Fit, SurfacePoints, score, unexplained


class FlatSurface:
    """A wall. Its reference point lies on the front; its own frame has x along the front's outward normal, z down.

    A plane shows motion along that normal only; along itself it is seen to move where both of its ends are in view.
    ``known``: the shape is given and stays as it is; the reference is then its centre.
    """

    kind = "wall"

    def __init__(self, known: Wall | None, settings: SurfaceSettings) -> None:
        self.known, self._settings = known, settings
        self._yaw = known.yaw if known else 0.0
        self._yaw_variance = settings.yaw_sigma**2
        self._thickness = settings.thickness
        self._thickness_is_observed = False
        extensions = {1: settings.side_extension, 2: settings.top_extension}
        self._ends = {(axis, sign): EndOfSurface(extensions[axis], settings) for axis in (1, 2) for sign in (1, -1)}
        if known is not None:
            self.shape, self.offset, self.size_sigma = known, np.zeros(3), 0.0

    def _describe(self) -> None:
        """Keep what follows from a fit; of a surface that is not known there is none before the first."""
        ends = self._ends
        lo = np.array([-self._thickness, -ends[1, -1].outermost, -ends[2, -1].outermost])
        hi = np.maximum(np.array([0.0, ends[1, 1].outermost, ends[2, 1].outermost]), lo + 0.05)
        self._extent = lo, hi
        """Lowest and highest coordinates of the box in its own frame, about the reference point (3,), (3,)."""
        x, y, z = (hi - lo).tolist()
        self.shape = Wall((x, y, z), float(self._yaw))
        """The estimated shape."""
        self.offset = self._rotation() @ (0.5 * (lo + hi))
        """Vector from the reference point to the box's centre (3,)."""
        self.size_sigma = float(min(np.sqrt(self._yaw_variance) * (hi[1] - lo[1]) / 2.0, self._settings.size_sigma_max))
        """Standard deviation of the place of the front's ends (m)."""

    def guess(self, scan: SurfacePoints) -> Array:
        """Orient the box by the points alone, and return a point of its front (3,); of a known one their middle."""
        if self.known is not None:
            return np.asarray(scan.points.mean(axis=0))
        flat = scan.points[:, :2]
        i, j = _pairs(len(flat))
        along = flat[j] - flat[i]
        length = np.hypot(along[:, 0], along[:, 1])
        normal = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.maximum(length, 1e-6)[:, None]
        level = np.einsum("ij,ij->i", flat[i], normal)
        towards = normal @ scan.origins[:, :2].mean(axis=0) - level
        sign = np.where(towards < 0.0, -1.0, 1.0)
        depth = sign[:, None] * (normal @ flat.T - level[:, None])
        # The upright plane through two of the points that holds most of the others and has none before it.
        tolerance = 2.0 * np.sqrt(scan.noise**2 + scan.pose_variance.mean() + scan.scatter)
        votes = np.maximum(1.0 - (depth / tolerance) ** 2, 0.0).sum(axis=1) - (depth > 1.5 * tolerance).sum(axis=1)
        votes = np.where(length > 4.0 * scan.noise, votes + 1e-3 * np.minimum(length, 5.0), votes - len(flat))
        best = int(np.argmax(votes))
        normal_best = sign[best] * normal[best]
        self._yaw = float(np.arctan2(normal_best[1], normal_best[0]))
        middle: Array = scan.points[np.abs(depth[best]) <= tolerance].mean(axis=0)
        middle[:2] += normal_best * (sign[best] * level[best] - middle[:2] @ normal_best)
        return middle

    def fit(self, scan: SurfacePoints, predicted: Array, iterations: int = 3) -> Fit:
        """Return the place of the front in this frame, expected at ``predicted`` (3,), and learn the box from it."""
        if self.known is not None:
            return self._fit_known(scan, predicted)
        s, rotation = self._settings, self._rotation()
        q = (scan.points - predicted) @ rotation
        rays = scan.rays @ rotation
        front = np.abs(q[:, 0]) < 0.5
        shift = 0.0
        own = scan.pose_variance + scan.scatter
        noise = (scan.noise * rays) ** 2 + own[:, None] + s.model_sigma**2
        limit = 3.0 * np.sqrt(scan.noise**2 + scan.pose_variance + scan.scatter)
        across, farthest = noise[:, 0], 9.0 * np.maximum(noise[:, 0], 0.0025)
        self._yaw_variance += s.yaw_walk**2
        for _ in range(iterations):
            depth, along = q[:, 0], q[:, 1]
            residual = depth - shift
            front = np.abs(residual) < limit
            if np.count_nonzero(front) < 3:
                break
            weight = front / (across * (1.0 + residual**2 / farthest))
            turning = weight * along
            # depth = shift - turn along, the turn held by what is known of the yaw.
            both, square = -turning.sum(), (weight * along**2).sum() + 1.0 / self._yaw_variance
            information = np.array([[weight.sum(), both], [both, square]])
            change = np.linalg.solve(information, [(weight * depth).sum(), -(turning * depth).sum()])
            shift, turn = float(change[0]), float(change[1])
            covariance = np.linalg.inv(information)
            self._yaw += turn
            self._yaw_variance = max(float(covariance[1, 1]), 0.001**2)
            rotation = self._rotation()
            q = (scan.points - predicted) @ rotation
            if abs(turn) < 2e-3:
                break
        q[:, 0] -= shift
        front_variance = (scan.noise**2 + scan.scatter) / max(int(np.count_nonzero(front)), 1) + scan.common_variance
        moved, sideways = np.array([shift, 0.0, 0.0]), np.zeros(3)
        for axis in (1, 2):
            moved[axis], sideways[axis] = self._moved_along(axis, q[:, axis], scan.cut)
        q[:, 1:] -= moved[1:]
        for (axis, sign), end in self._ends.items():
            end.update(sign * q[:, axis], scan.cut)
        self._learn_thickness(q, front, scan)
        self._describe()
        variance = rotation[:, :2] ** 2 @ np.array([front_variance, sideways[1]])
        variance[2] = sideways[2]
        return Fit(predicted + rotation @ moved, variance, *self._score(q, noise))

    def _moved_along(self, axis: int, along: Array, cut: Mask) -> tuple[float, float]:
        """Return how far the front has moved along an ``axis`` of itself (m), and the variance (m2).

        Its motion shows where both of its ends are seen; else an end that moves may as well be more of it in sight.
        """
        s = self._settings
        ahead = self._ends[axis, 1].displacement(along, cut)
        behind = self._ends[axis, -1].displacement(-along, cut)
        if ahead is None or behind is None:
            return 0.0, s.unseen_sigma**2
        return 0.5 * (ahead - behind), s.sideways_sigma**2

    def _fit_known(self, scan: SurfacePoints, predicted: Array) -> Fit:
        """Only the place is to be found: every point moves the face that it lies on."""
        assert self.known is not None
        rotation = self.known.rotation
        half = np.array(self.known.size) / 2.0
        q = (scan.points - predicted) @ rotation
        # The face that a point is nearest to, of those that look towards the sensors.
        facing = np.sign((scan.origins - predicted) @ rotation)
        residual = q - facing * half
        beyond = np.abs((scan.origins - predicted) @ rotation) > half
        residual = np.where(beyond, residual, np.inf)
        face = np.argmin(np.abs(residual), axis=1)
        shift, variance = np.zeros(3), np.full(3, self._settings.sideways_sigma**2)
        own = residual[np.arange(len(q)), face]
        for axis in range(3):
            of_face = own[(face == axis) & np.isfinite(own)]
            if len(of_face):
                shift[axis] = float(np.median(of_face))
                variance[axis] = 2.0 * (scan.noise**2 + scan.scatter) / len(of_face) + scan.common_variance
        off = np.where(np.isfinite(own), own - shift[face], 0.5)
        own_variance = scan.noise**2 + scan.pose_variance + scan.scatter
        return Fit(
            predicted + rotation @ shift, rotation**2 @ variance,
            score(off, own_variance), unexplained(off, own_variance, fitted=1),
        )  # fmt: skip

    def _learn_thickness(self, q: Array, front: Mask, scan: SurfacePoints) -> None:
        """Learn the thickness from points behind the front, which lie on the top or on a side."""
        s = self._settings
        behind = (q[:, 0] < -s.depth_observed) & ~front & ~scan.cut
        if np.count_nonzero(behind) == 0:
            return
        depth = float(-q[behind, 0].min())
        if not self._thickness_is_observed or depth > self._thickness + s.end_jump:
            self._thickness, self._thickness_is_observed = depth, True
        elif depth > self._thickness - s.end_jump:
            self._thickness += s.end_smoothing * (depth - self._thickness)

    def _score(self, q: Array, noise: Array) -> tuple[float, float]:
        """Score and what is unexplained of points (n, 3) in the box's frame, of variance ``noise`` (n, 3)."""
        lo, hi = self._extent
        # To the front, the sides and the top; the bottom and the back are out of view of every vehicle that matters.
        distance = np.stack([q[:, 0], q[:, 1] - lo[1], q[:, 1] - hi[1], q[:, 2] - lo[2], q[:, 2] - hi[2]])
        variance = np.stack([noise[:, 0], noise[:, 1], noise[:, 1], noise[:, 2], noise[:, 2]])
        best = np.argmin(distance**2 / variance, axis=0)
        pick = np.arange(len(q))
        off, own = distance[best, pick], variance[best, pick]
        return score(off, own), unexplained(off, own, fitted=2)

    def _rotation(self) -> Array:
        cosine, sine = np.cos(self._yaw), np.sin(self._yaw)
        return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])


@cache
def _pairs(n: int) -> tuple[Indices, Indices]:
    """Return pairs of n points in a fixed order; of many points only some."""
    i, j = np.triu_indices(n, 1)
    few = slice(None, None, max(1, len(i) // 400))
    return i[few], j[few]
