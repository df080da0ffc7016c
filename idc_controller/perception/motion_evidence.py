"""Evidence that a body does not stand, from what its points and the rays of all vehicles say (nats).

A fit to few points moves as the view of a body changes: its velocity alone is no evidence of motion. What stands is hit
at the same places again, and rays that pass there end at it as often as they ever did. The evidence is a cumulative sum
(Page 1954) of the log-likelihood ratios of each vehicle's scan:

- most of the points of the body lie in what was seen free, or where something has stood before. Those in space of which
  nothing is known say neither, and beside what is so thin that rays pass it, space is seen free;
- rays through the places of its earlier points end there, or beyond; along a surface, a ray beside them ends beyond
  also while that stands. Rays pass beside what is thin also while it stands: how often, those of the other vehicles at
  the same time say. All rays of a scan together count as one, as the
  error of the pose is common to them.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array
from idc_controller.perception.motion_evidence_kernels import FrameRays, Places, by_sector, count_rays
from idc_controller.perception.placed_scan import PlacedScan
from idc_controller.perception.settings import StandingMapSettings
from idc_controller.perception.surfaces.points import SurfacePoints

_UNEXPLAINED = 0.5
"""Share of the scans of what moves that contradict that it stands, where that can be tested."""
_FRAMES, _APART = 20, 0.45
"""Frames whose points are remembered; time from which on one is earlier (s)."""
_BESIDE = 0.15
"""Distance of a ray from a point within which it passes through the place of that (m)."""
_SIGMAS = 3.0
"""Standard deviations by which it must end beyond."""


Normals = Callable[[Array], Array]
"""Unit normals (n, 3) of what stands at points (n, 3), zero where they are not known."""


def unknown_normals(points: Array) -> Array:
    """Return that no normal is known."""
    return np.zeros((len(points), 3))


class PartOfScan(NamedTuple):
    """Points of a body in one vehicle's scan."""

    uav: int
    unexplained: int
    """Number of those that lie in what was seen free, away from all that stands."""
    explained: int
    """Number of those where something has stood before."""

    def joined(self, other: PartOfScan) -> PartOfScan:
        """Return both parts of one scan."""
        return PartOfScan(self.uav, self.unexplained + other.unexplained, self.explained + other.explained)


class Frame(NamedTuple):
    """Scans of one frame."""

    uavs: Sequence[int]
    rays: FrameRays

    @classmethod
    def of(cls, scans: Sequence[PlacedScan]) -> Frame:
        """Return the frame of some scans, or of none."""
        if not scans:
            return NO_SCANS
        ends, returned, first = zip(*(by_sector(scan.rays) for scan in scans), strict=True)
        begins = np.cumsum([0, *map(len, ends[:-1])])
        return cls(
            [scan.uav for scan in scans],
            FrameRays(
                np.array([scan.origin for scan in scans]), np.array([scan.rays.sigmas for scan in scans]),
                np.concatenate(ends), np.concatenate(returned), np.array(first) + begins[:, None],
            ),
        )  # fmt: skip


_NONE = np.empty((0, 3))
_NOWHERE = Places(_NONE, np.empty(0), _NONE)
NO_SCANS = Frame((), FrameRays(_NONE, _NONE, _NONE, np.empty(0, dtype=bool), np.empty((0, 1), dtype=np.int64)))


class MotionEvidence:
    """Evidence of one body. Times in s, NED, m."""

    def __init__(self, normals: Normals = unknown_normals) -> None:
        """``normals``: of what stands at points."""
        self._normals = normals
        self._frames: deque[tuple[float, Array, Array]] = deque(maxlen=_FRAMES)
        self._ends, self._passes = 0.0, 0.0
        """Scans through points that others saw then: sums of the shares of rays that ended there, and passed."""
        self.nats = 0.0
        """Evidence that it does not stand, not below 0."""

    def reset(self) -> None:
        """Begin anew: without evidence, and without earlier points."""
        self._frames.clear()
        self.nats = 0.0

    def add(
        self,
        points: SurfacePoints,
        parts: Sequence[PartOfScan],
        frame: Frame,
        settings: StandingMapSettings,
    ) -> None:
        """Take one frame.

        Args:
            points: of the body.
            parts: what the map says of them.
            frame: its scans.
            settings: of the map, on false returns and rays that pass what is seen free.
        """
        of_uav: dict[int, PartOfScan] = {}
        for part in parts:
            of_uav[part.uav] = part if part.uav not in of_uav else part.joined(of_uav[part.uav])
        variances = points.noise**2 + points.pose_variance
        here = Places(np.ascontiguousarray(points.points), variances, self._normals(points.points))
        sensors = np.ascontiguousarray(points.origins)
        counts = count_rays(frame.rays, self._earlier(points.time), here, sensors, _BESIDE, _SIGMAS).tolist()
        for uav, (ends, passes, ends_of_others, passes_of_others) in zip(frame.uavs, counts, strict=True):
            ratio = self._ratio_of_points(of_uav[uav], settings) if uav in of_uav else 0.0
            self.nats = max(self.nats + ratio + self._ratio_of_rays(*_shares(ends, passes)), 0.0)
            ends, passes = _shares(ends_of_others, passes_of_others)
            self._ends += ends
            self._passes += passes
        self._frames.append((points.time, points.points, variances))

    @property
    def _passing(self) -> float:
        """Share of the rays through the places of its points that pass while it stands, by Laplace's rule."""
        return (self._passes + 1.0) / (self._ends + self._passes + 2.0)

    def _ratio_of_points(self, part: PartOfScan, settings: StandingMapSettings) -> float:
        if not part.unexplained and not part.explained:
            return 0.0
        # Its place is seen free if all of the rays pass that it takes.
        by_chance = max(settings.false_share, min(self._passing**settings.free_passes, _UNEXPLAINED))
        if part.unexplained > part.explained:
            return math.log(_UNEXPLAINED / by_chance)
        return math.log((1.0 - _UNEXPLAINED) / (1.0 - by_chance))

    def _ratio_of_rays(self, ends: float, passes: float) -> float:
        """Return the ratio by the shares of the rays through its earlier places that end there, and that pass."""
        # Where it has left, half of those that would have met it pass as well.
        return passes * math.log(0.5 * (1.0 + self._passing) / self._passing) + ends * math.log(0.5)

    def _earlier(self, time: float) -> Places:
        """Return the places of its earlier points."""
        chosen = [(places, variances) for at, places, variances in self._frames if time - at > _APART]
        if not chosen:
            return _NOWHERE
        earlier = np.concatenate([places for places, _ in chosen])
        return Places(earlier, np.concatenate([v for _, v in chosen]), self._normals(earlier))


def _shares(ends: float, passes: float) -> tuple[float, float]:
    """Return the shares of the rays that end, and that pass; 0 and 0 if there is none."""
    met = max(ends + passes, 1.0)
    return ends / met, passes / met
