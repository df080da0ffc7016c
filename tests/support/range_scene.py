"""Scenes of solid bodies for range sensors: analytic ray casting, a pattern of rays, noise of poses and ranges."""

import math
from dataclasses import dataclass, field, replace

import numpy as np

from idc_controller.perception.placed_scan import PlacedScan
from idc_controller.perception.voxel_kernels import BLOCKS, EDGE, HELD

RANGE_SIGMA, POSITION_SIGMA, ATTITUDE_SIGMA = 0.05, 0.03, math.radians(0.5)
MISSED = 0.02


@dataclass(frozen=True)
class Box:
    """Edges (m) about ``centre``, turned by ``yaw``, then by ``pitch`` (rad)."""

    centre: tuple[float, float, float]
    size: tuple[float, float, float]
    yaw: float = 0.0
    pitch: float = 0.0

    @property
    def rotation(self):
        a, b, c, d = math.cos(self.yaw), math.sin(self.yaw), math.cos(self.pitch), math.sin(self.pitch)
        return np.array([[a * c, -b, a * d], [b * c, a, b * d], [-d, 0.0, c]])

    def ranges(self, origin, ways):
        start, ways = (origin - np.array(self.centre)) @ self.rotation, ways @ self.rotation
        half = np.array(self.size) / 2.0
        with np.errstate(divide="ignore", invalid="ignore"):
            one, other = (-half - start) / ways, (half - start) / ways
        near, far = np.minimum(one, other).max(axis=1), np.maximum(one, other).min(axis=1)
        return np.where((near <= far) & (near > 0.0), near, math.inf)

    def distance(self, points):
        """Signed distance (n,) of points from the surface."""
        q = np.abs((points - np.array(self.centre)) @ self.rotation) - np.array(self.size) / 2.0
        return np.linalg.norm(np.maximum(q, 0.0), axis=1) + np.minimum(q.max(axis=1), 0.0)


@dataclass(frozen=True)
class Sphere:
    centre: tuple[float, float, float]
    radius: float
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def at(self, time):
        return replace(self, centre=tuple(np.array(self.centre) + time * np.array(self.velocity)))

    def ranges(self, origin, ways):
        offset = origin - np.array(self.centre)
        along, rest = ways @ offset, offset @ offset - self.radius**2
        root = along**2 - rest
        near = -along - np.sqrt(np.maximum(root, 0.0))
        return np.where((root > 0.0) & (near > 0.0), near, math.inf)

    def distance(self, points):
        return np.linalg.norm(points - np.array(self.centre), axis=1) - self.radius


@dataclass(frozen=True)
class Pole:
    """An upright cylinder without ends."""

    centre: tuple[float, float, float]
    radius: float
    height: float

    def ranges(self, origin, ways):
        offset = origin - np.array(self.centre)
        a = (ways[:, :2] ** 2).sum(axis=1)
        b, c = ways[:, :2] @ offset[:2], offset[:2] @ offset[:2] - self.radius**2
        root = b**2 - a * c
        with np.errstate(divide="ignore", invalid="ignore"):
            near = (-b - np.sqrt(np.maximum(root, 0.0))) / a
            level = np.abs(offset[2] + near * ways[:, 2]) <= self.height / 2.0
        return np.where((root > 0.0) & (near > 0.0) & level, near, math.inf)

    def distance(self, points):
        offset = points - np.array(self.centre)
        u, w = np.hypot(offset[:, 0], offset[:, 1]) - self.radius, np.abs(offset[:, 2]) - self.height / 2.0
        return np.hypot(np.maximum(u, 0.0), np.maximum(w, 0.0)) + np.minimum(np.maximum(u, w), 0.0)


def pattern(rays, scan, lowest=-0.6, highest=0.6):
    """Unit vectors (n, 3) spread evenly over an elevation band (rad), turned from scan to scan."""
    i = np.arange(rays)
    shift = (scan * 0.5698402909980532) % 1.0
    z = math.sin(lowest) + (math.sin(highest) - math.sin(lowest)) * ((i + shift) / rays)
    angle = 2.0 * math.pi * (i * 0.6180339887498949 + scan * 0.7548776662466927)
    level = np.sqrt(1.0 - z**2)
    return np.stack([level * np.cos(angle), level * np.sin(angle), -z], axis=1)


@dataclass
class Sensor:
    """Scans bodies from true poses and places what it hits by poses with noise."""

    rng: np.random.Generator
    rays: int = 500
    reach: float = 10.0
    noise: float = 1.0
    ground: float | None = None
    """Height of the ground (m, down): rays that meet it end there and return nothing."""
    scans: int = field(default=0)

    def scan(self, bodies, place, time, offset=(0.0, 0.0, 0.0), pattern_of=pattern):
        """Return the placed scan, and the true points that its returns hit (n, 3); ``offset`` of the pose: a bias."""
        origin = np.array(place, dtype=float)
        ways = pattern_of(self.rays, self.scans)
        self.scans += 1
        hit = np.min([body.ranges(origin, ways) for body in bodies], axis=0) if bodies else np.full(len(ways), math.inf)
        end = np.full(len(ways), self.reach)
        if self.ground is not None:
            with np.errstate(divide="ignore"):
                end = np.minimum(end, np.where(ways[:, 2] > 0.0, (self.ground - origin[2]) / ways[:, 2], math.inf))
        returned = (hit <= end) & (self.rng.random(len(ways)) >= MISSED)
        measured = hit[returned] + self.noise * RANGE_SIGMA * self.rng.standard_normal(returned.sum())
        turn = self.noise * ATTITUDE_SIGMA * self.rng.standard_normal(3)
        placed = origin + np.array(offset) + self.noise * POSITION_SIGMA * self.rng.standard_normal(3)
        seen = ways + np.cross(turn, ways)
        seen /= np.linalg.norm(seen, axis=1)[:, None]
        scan = PlacedScan(
            time, placed, placed + measured[:, None] * seen[returned], RANGE_SIGMA, POSITION_SIGMA, ATTITUDE_SIGMA,
            placed + (end[:, None] * seen)[~returned],
        )  # fmt: skip
        return scan, origin + hit[returned, None] * ways[returned]


def return_variance(scan):
    """The covariance of each return of a placed scan (n, 3, 3) (m2), as the kernels compute it where they need it."""
    ways = scan.returns - scan.origin
    square = np.einsum("ni,ni->n", ways, ways)[:, None, None]
    along = ways[:, :, None] * ways[:, None, :] / np.maximum(square, 1e-12)
    own = scan.position_sigma**2 * np.eye(3) + scan.range_sigma**2 * along
    return own + scan.attitude_sigma**2 * square * (np.eye(3) - along)


def occupied(standing):
    """All surface elements of a standing map."""
    return standing.elements(standing._used())


def cells_at(standing, points):
    """What a standing map holds of the voxels with ``points`` (n, 3): rays that passed, with :data:`HELD` if hit."""
    store, voxels = standing._voxels, np.floor(points / standing.settings.voxel).astype(int)
    count = int(store.counts[BLOCKS])
    corners = [tuple(corner) for corner in standing._corners(np.arange(count)).tolist()]
    rows = dict(zip(corners, store.cells, strict=False))
    unseen = np.zeros(EDGE**3, dtype=np.uint8)
    blocks = [rows.get(tuple(corner), unseen) for corner in (voxels // EDGE * EDGE).tolist()]
    return np.array([block[cell] for block, cell in zip(blocks, voxels % EDGE @ (EDGE**2, EDGE, 1), strict=True)])


def is_occupied(standing, points):
    """Whether the voxels with ``points`` (n, 3) hold points that were hit."""
    return cells_at(standing, points) & HELD > 0


def is_seen_free(standing, points):
    """Whether the voxels with ``points`` (n, 3) were seen free and hold no point that was hit."""
    return cells_at(standing, points) == standing.settings.free_passes
