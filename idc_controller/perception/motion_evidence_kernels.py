"""Rays through the places where points of a body were, compiled."""

import math
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array, Array1, Array2, Indices1, Indices2, Mask1
from idc_controller.compiled import inlined, kernel
from idc_controller.perception.voxel_kernels import Rays

_SECTORS = 128
"""Of the bearing, about a sensor."""


class FrameRays(NamedTuple):
    """The rays of all S scans of a frame, those of each in the order of their bearings. SI units, NED."""

    origins: Array2
    """Places of the sensors (S, 3)."""
    sigmas: Array2
    """Standard deviations of range (m), position (m) and attitude (rad) (S, 3)."""
    ends: Array2
    """Ends of the rays (R, 3)."""
    returned: Mask1
    """Which of them are returns (R,)."""
    first: Indices2
    """First ray of each sector of each scan, then the one after the last of the scan."""


class Places(NamedTuple):
    """Places of points of a body."""

    places: Array2
    """(m, 3), NED (m)."""
    variances: Array1
    """Of each on any axis (m,) (m2)."""
    normals: Array2
    """Unit normals of the surface at each (m, 3); zero where it is not known: then it is taken to be turned by up to
    45 deg from a ray."""


@inlined
def _sector(north: float, east: float) -> int:
    """Return the sector of a bearing: they follow each other round the circle, and are not equally wide."""
    size = abs(north) + abs(east)
    quarter = east / size if 0.0 < size < math.inf else 0.0
    turn = 0.25 * quarter if north >= 0.0 else 0.5 - 0.25 * quarter
    return int((turn % 1.0) * _SECTORS) % _SECTORS


@kernel
def by_sector(rays: Rays) -> tuple[Array2, Mask1, Indices1]:
    """Return the rays of a scan in the order of their bearings, as :func:`count_rays` takes them.

    Returns:
        The ends (n + m, 3), which of them are returns (n + m,), and the first ray of each sector, then n + m.
    """
    origin, returns, free, _ = rays
    count = len(returns) + len(free)
    sectors, first = np.empty(count, np.int64), np.zeros(_SECTORS + 1, np.int64)
    for r in range(count):
        end = returns[r] if r < len(returns) else free[r - len(returns)]
        sectors[r] = _sector(end[0] - origin[0], end[1] - origin[1])
        first[sectors[r] + 1] += 1
    for sector in range(_SECTORS):
        first[sector + 1] += first[sector]
    ends, returned, place = np.empty((count, 3)), np.empty(count, np.bool_), first.copy()
    for r in range(count):
        to = place[sectors[r]]
        place[sectors[r]] += 1
        returned[to] = r < len(returns)
        end = returns[r] if r < len(returns) else free[r - len(returns)]
        for i in range(3):
            ends[to, i] = end[i]
    return ends, returned, first


@inlined
def _meeting(
    origin: Array,
    end: Array,
    variance: float,
    places: Array,
    variances: Array,
    normals: Array,
    beside: float,
    sigmas: float,
) -> tuple[bool, bool]:
    """Return whether a ray ends at one of the places, and whether it passes one and ends beyond."""
    x, y, z = end[0] - origin[0], end[1] - origin[1], end[2] - origin[2]
    length = math.sqrt(x * x + y * y + z * z)
    if not 0.0 < length < math.inf:
        return False, False
    x, y, z = x / length, y / length, z / length
    passes = False
    for m in range(places.shape[0]):
        u, v, w = places[m, 0] - origin[0], places[m, 1] - origin[1], places[m, 2] - origin[2]
        along = u * x + v * y + w * z
        if along <= 0.0 or u * u + v * v + w * w - along * along > beside * beside:
            continue
        beyond, noise = length - along, sigmas * math.sqrt(variance + variances[m])
        if abs(beyond) <= noise:
            return True, False
        if passes or beyond <= noise + beside:
            continue
        # A ray so far beside the place meets the surface there so much farther, by its angle to that.
        across = abs(x * normals[m, 0] + y * normals[m, 1] + z * normals[m, 2])
        is_known = normals[m, 0] != 0.0 or normals[m, 1] != 0.0 or normals[m, 2] != 0.0
        passes = not is_known or (beyond - noise) * across > beside * math.sqrt(max(1.0 - across * across, 0.0))
    return False, passes


@inlined
def _count(
    frame: FrameRays,
    scan: int,
    places: Array,
    variances: Array,
    normals: Array,
    beside: float,
    deviations: float,
    counts: Array,
) -> None:
    """Write into ``counts`` (2,) how many rays of a scan end at the places, and how many pass."""
    origin, sigmas, first, ends, returned = (
        frame.origins[scan], frame.sigmas[scan], frame.first[scan], frame.ends, frame.returned,
    )  # fmt: skip
    if not places.shape[0]:
        return
    middle, radius, level = np.zeros(3), 0.0, 0.0
    for i in range(3):
        middle[i] = places[:, i].mean() - origin[i]
    for m in range(places.shape[0]):
        square = 0.0
        for i in range(3):
            square += (places[m, i] - origin[i] - middle[i]) ** 2
            if i == 1:
                level = max(level, math.sqrt(square) + beside)
        radius = max(radius, math.sqrt(square) + beside)
    distance = math.sqrt(middle[0] ** 2 + middle[1] ** 2 + middle[2] ** 2)
    level_square = level * level * (1.0 + 1e-9)
    level_distance = math.sqrt(middle[0] ** 2 + middle[1] ** 2)
    is_beside = level_distance > level * (1.0 + 1e-9)
    low, sectors = 0, _SECTORS
    if is_beside:
        # The sectors that the places' circle takes in plan view, and those next to them.
        sine = level / level_distance
        cosine = math.sqrt(1.0 - sine * sine)
        north, east = middle[0], middle[1]
        low = _sector(north * cosine + east * sine, east * cosine - north * sine) - 1
        high = _sector(north * cosine - east * sine, east * cosine + north * sine) + 1
        sectors = min((high - low) % _SECTORS + 1, _SECTORS)
    for sector in range(low, low + sectors):
        for r in range(first[sector % _SECTORS], first[sector % _SECTORS + 1]):
            end = ends[r]
            if is_beside:
                # In plan view, where what is upright is small, rays pass it as near or nearer.
                north, east = end[0] - origin[0], end[1] - origin[1]
                across, square = north * middle[1] - east * middle[0], level_square * (north**2 + east**2)
                if north * middle[0] + east * middle[1] <= 0.0 or across * across > square:
                    continue
            square, along = 0.0, 0.0
            for i in range(3):
                way = end[i] - origin[i]
                square += way * way
                along += way * middle[i]
            # Nearer to the middle than the places' radius; along is in square metres.
            if distance > radius and (along <= 0.0 or (distance**2 - radius**2) * square > along * along):
                continue
            variance = sigmas[1] ** 2 + sigmas[2] ** 2 * square + (sigmas[0] ** 2 if returned[r] else 0.0)
            meets, passes = _meeting(origin, end, variance, places, variances, normals, beside, deviations)
            if meets and returned[r]:
                counts[0] += 1.0
            elif passes:
                counts[1] += 1.0


@kernel
def count_rays(
    frame: FrameRays, earlier: Places, points: Places, sensors: Array2, beside: float, deviations: float
) -> Array2:
    """Count the rays of each scan that end where points of a body were, and those that pass through there.

    Args:
        frame: rays of the scans.
        earlier: where points of the body were earlier.
        points: where they are in this frame.
        sensors: places from which those were seen (n, 3).
        beside: distance of a ray from a point up to which it passes through the place of that (m).
        deviations: standard deviations within which it ends there.

    Returns:
        Rays that end at the earlier places, that pass these, and the same for the points that other sensors saw
        (S, 4).
    """
    counts = np.zeros((frame.origins.shape[0], 4))
    of_others = np.empty(len(sensors), np.bool_)
    for scan in range(counts.shape[0]):
        _count(frame, scan, earlier.places, earlier.variances, earlier.normals, beside, deviations, counts[scan, :2])
        for i in range(len(sensors)):
            of_others[i] = (sensors[i] != frame.origins[scan]).any()
        _count(
            frame, scan, points.places[of_others], points.variances[of_others], points.normals[of_others],
            beside, deviations, counts[scan, 2:],
        )  # fmt: skip
    return counts
