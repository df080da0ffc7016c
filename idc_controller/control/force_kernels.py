"""Kernels of the components of force; see :mod:`idc_controller.control.force_components`. N UAVs, SI."""

import math

import numpy as np

from idc_controller.arrays import Array
from idc_controller.compiled import inlined, kernel

_PARAMETER = "Array(float64, 1, 'C', readonly=True)"
"""Type of an array of parameters, which is read only."""
_LEAST_SQUARE = 1e-3
"""Of a cosine: a tilt is taken for no more than nearly level."""


@inlined
def _cosine(north: float, east: float) -> float:
    """Return the upward part of a unit vector with these level parts."""
    return math.sqrt(max(1.0 - (north * north + east * east), _LEAST_SQUARE))


@kernel(f"float64[:, ::1](float64[:, ::1], {_PARAMETER}, int64)")
def states(x: Array, hover: Array, tilts: int) -> Array:
    """Return states (K, 12 + 11 N) with tilts as F_xy / f_hover and thrusts as -F_z.

    Args:
        x: states in the model's coordinates (K, 12 + 11 N).
        hover: thrusts in hover (N,) (N).
        tilts: index of the first UAV's tilt; their rates, their accelerations and the thrusts follow.
    """
    number, result = len(hover), x.copy()
    for k in range(len(x)):
        for i in range(number):
            f = x[k, tilts + 6 * number + i]
            for part in range(3):
                for axis in range(2):
                    result[k, tilts + 2 * (part * number + i) + axis] *= f / hover[i]
            result[k, tilts + 6 * number + i] = f * _cosine(x[k, tilts + 2 * i], x[k, tilts + 2 * i + 1])
    return result


@kernel(f"float64[:, ::1](float64[:, ::1], {_PARAMETER})")
def inputs(u: Array, hover: Array) -> Array:
    """Return set-points (M, 3 N) as F_xy / f_hover and -F_z, of tilts and thrusts (M, 3 N); ``hover`` (N,) (N)."""
    number, result = len(hover), np.empty(u.shape)
    for k in range(len(u)):
        for i in range(number):
            f = u[k, 2 * number + i]
            for axis in range(2):
                result[k, 2 * i + axis] = u[k, 2 * i + axis] * (f / hover[i])
            result[k, 2 * number + i] = f * _cosine(u[k, 2 * i], u[k, 2 * i + 1])
    return result


@kernel(f"float64[::1](float64[::1], float64[::1], {_PARAMETER}, float64)")
def setpoints(delta: Array, u_reference: Array, hover: Array, least_lift: float) -> Array:
    """Return tilts and thrusts (3 N,) of a reference plus ``delta`` in force components.

    Args:
        delta: F_xy / f_hover and -F_z beside the reference's (3 N,).
        u_reference: tilts and thrusts of the reference (3 N,).
        hover: thrusts in hover (N,) (N).
        least_lift: least upward force, as a share of the thrust in hover.
    """
    number, u = len(hover), np.empty(len(delta))
    for i in range(number):
        f = u_reference[2 * number + i]
        n_x, n_y = u_reference[2 * i], u_reference[2 * i + 1]
        north, east = f * n_x + hover[i] * delta[2 * i], f * n_y + hover[i] * delta[2 * i + 1]
        upward = max(f * _cosine(n_x, n_y) + delta[2 * number + i], least_lift * hover[i])
        thrust = math.sqrt(north * north + east * east + upward * upward)
        u[2 * i], u[2 * i + 1], u[2 * number + i] = north / thrust, east / thrust, thrust
    return u


@kernel("float64[:, ::1](float64[::1])")
def directions(u: Array) -> Array:
    """Return the unit thrust vectors (N, 3), NED, of set-points ``u`` (3 N,), tilts and thrusts."""
    number = len(u) // 3
    result = np.empty((number, 3))
    for i in range(number):
        north, east = u[2 * i], u[2 * i + 1]
        result[i, 0], result[i, 1] = north, east
        result[i, 2] = -math.sqrt(max(1.0 - (north * north + east * east), 0.0))
    return result
