"""Broad phase of the collision detection: how long the parts of the system surely stay apart from all else."""

import math

import numpy as np

from idc_controller import rotations_float
from idc_controller.arrays import Array, Array1, Array2
from idc_controller.compiled import inlined, kernel
from idc_controller.rotations_float import Vector

#: What no part without contact is accelerated by (m/s2): thrust, drag and the pull of links together are far below.
ACCELERATION_MAX = 200.0

#: Columns of ``sizes`` (m): height of the pad, radii of balls about payload and UAV that hold them, margin, and how far
#: obstacles may travel meanwhile.
TOP, PAYLOAD, UAV, MARGIN, TRAVEL = 0, 1, 2, 3, 4

_into_body = inlined(rotations_float.into_body)


@inlined
def _gap(a: Array, b: Array, c: Array, d: Array) -> float:
    """Return a lower bound of the distance between the segments from a to b and from c to d (m), negative: none.

    It is their distance along an axis across both: from middle to middle, less what lies along their mean direction.
    """
    middles = lengths = 0.0
    for k in range(3):
        middle, length = a[k] + b[k] - c[k] - d[k], b[k] - a[k] + d[k] - c[k]
        middles += middle * length
        lengths += length * length
    share = middles / lengths if lengths > 0.0 else 0.0
    along_a = along_b = along_c = along_d = squared = 0.0
    for k in range(3):
        axis = a[k] + b[k] - c[k] - d[k] - share * (b[k] - a[k] + d[k] - c[k])
        along_a, along_b = along_a + axis * a[k], along_b + axis * b[k]
        along_c, along_d = along_c + axis * c[k], along_d + axis * d[k]
        squared += axis * axis
    return (min(along_a, along_b) - max(along_c, along_d)) / math.sqrt(squared) if squared > 0.0 else -1.0


@inlined
def _distance(point: Array, a: Array, b: Array) -> float:
    """Return the distance of a point from the segment from a to b (m)."""
    x, y, z = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    u, v, w = point[0] - a[0], point[1] - a[1], point[2] - a[2]
    squared = x * x + y * y + z * z
    share = min(max((u * x + v * y + w * z) / squared, 0.0), 1.0) if squared > 0.0 else 0.0
    return math.hypot(math.hypot(u - share * x, v - share * y), w - share * z)


@inlined
def _speed(v: Array) -> float:
    return math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])


@kernel
def time_apart(states: Array2, attachments: Array2, centres: Array2, bounds: Array2, sizes: Array1) -> float:
    """Return for how long (s) no two parts can touch, nor a part the ground, the pad or an obstacle.

    A lower bound, zero where none can be given: a UAV and its link are a segment with the UAV's ball all along it.

    Args:
        states: of payload and UAVs (N + 1, 13), see :mod:`.state_kernels`.
        attachments: of the links in the payload's frame (N, 3) (m).
        centres: of the obstacles (B, 3), NED (m).
        bounds: radii of the balls that hold them in the first column (B, K) (m).
        sizes: see above.
    """
    n = attachments.shape[0]
    payload, radius, w = states[0], sizes[UAV], states[0, 10:13]
    inverse = (payload[3], -payload[4], -payload[5], -payload[6])
    ends = np.empty((n, 3))
    apart, speed = -payload[2] - sizes[PAYLOAD] - sizes[TOP], _speed(payload[7:10])
    for i in range(n):
        p = attachments[i]
        place: Vector = _into_body(inverse, (p[0], p[1], p[2]))
        for k in range(3):
            ends[i, k] = payload[k] + place[k]
        speed = max(speed, _speed(payload[7:10]) + _speed(w) * _speed(p))
    for i in range(n):
        uav = states[i + 1]
        speed = max(speed, _speed(uav[7:10]))
        from_payload = math.hypot(math.hypot(uav[0] - payload[0], uav[1] - payload[1]), uav[2] - payload[2])
        apart = min(apart, -uav[2] - radius - sizes[TOP], from_payload - sizes[PAYLOAD] - radius)
        for j in range(i):
            apart = min(apart, _gap(ends[i], uav, ends[j], states[j + 1]) - 2.0 * radius)
    for b in range(centres.shape[0]):
        size = bounds[b, 0] + sizes[TRAVEL]
        apart = min(apart, _distance(centres[b], payload, payload) - sizes[PAYLOAD] - size)
        for i in range(n):
            apart = min(apart, _distance(centres[b], ends[i], states[i + 1]) - radius - size)
    apart -= sizes[MARGIN]
    if not apart > 0.0:
        return 0.0
    # Two parts that approach each other: 2 (v t + a t^2 / 2) = apart.
    return (math.sqrt(speed * speed + ACCELERATION_MAX * apart) - speed) / ACCELERATION_MAX
