"""Kernels of the components of force; see :mod:`idc_controller.control.force_components`. N UAVs, SI."""

import math

import numpy as np

from idc_controller.arrays import Array, Indices
from idc_controller.compiled import inlined, kernel

_PARAMETER = "Array(float64, 1, 'C', readonly=True)"
"""Type of an array of parameters, which is read only."""
_LEAST_SQUARE = 1e-3
"""Of a cosine: a tilt is taken for no more than nearly level."""


@inlined
def _cosine(north: float, east: float) -> float:
    """Return the upward part of a unit vector with these level parts."""
    return math.sqrt(max(1.0 - (north * north + east * east), _LEAST_SQUARE))


@inlined
def _convert(x: Array, hover: Array, tilts: int) -> None:
    """Turn states (K, 12 + 11 N) into components of force in place; see ``states``."""
    number = len(hover)
    for k in range(len(x)):
        for i in range(number):
            f = x[k, tilts + 6 * number + i]
            upward = f * _cosine(x[k, tilts + 2 * i], x[k, tilts + 2 * i + 1])
            for part in range(3):
                for axis in range(2):
                    x[k, tilts + 2 * (part * number + i) + axis] *= f / hover[i]
            x[k, tilts + 6 * number + i] = upward


@kernel(f"float64[:, ::1](float64[:, ::1], {_PARAMETER}, int64)")
def states(x: Array, hover: Array, tilts: int) -> Array:
    """Return states (K, 12 + 11 N) with tilts as F_xy / f_hover and thrusts as -F_z.

    Args:
        x: states in the model's coordinates (K, 12 + 11 N).
        hover: thrusts in hover (N,) (N).
        tilts: index of the first UAV's tilt; their rates, their accelerations and the thrusts follow.
    """
    result = x.copy()
    _convert(result, hover, tilts)
    return result


@inlined
def _limit(vector: Array, limit: float) -> None:
    """Shorten ``vector`` (3,) to ``limit`` in place if it is longer."""
    norm = math.sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2])
    if norm > limit:
        for axis in range(3):
            vector[axis] *= limit / norm


@kernel(f"float64[::1](float64[::1], float64[:, ::1], {_PARAMETER}, int64, float64, float64)")
def tracking_error(x: Array, reference: Array, hover: Array, tilts: int, position: float, velocity: float) -> Array:
    """Return the error (12 + 11 N,) of a state about its reference, in components of force.

    Args:
        x: state in the model's coordinates (12 + 11 N,).
        reference: its reference in the first row (K, 12 + 11 N).
        hover, tilts: see ``states``.
        position, velocity: to which the payload's errors of position (m) and velocity (m/s) are shortened.
    """
    both = np.empty((2, len(x)))
    both[0], both[1] = x, reference[0]
    _convert(both, hover, tilts)
    error: Array = both[0] - both[1]
    _limit(error[0:3], position)
    _limit(error[3:6], velocity)
    return error


@kernel(f"void(float64[::1], float64[:, ::1], int64[::1], {_PARAMETER}, {_PARAMETER}, {_PARAMETER})")
def fill_input_bounds(bounds: Array, u: Array, stages: Indices, hover: Array, lower: Array, upper: Array) -> None:
    """Fill the first M 6 N of ``bounds`` with how far set-points are from their limits, upper then lower ones by stage.

    Args:
        bounds: to fill (M 6 N or more,).
        u: tilts and thrusts of the reference at all stages (K, 3 N).
        stages: those whose bounds are returned (M,).
        hover: thrusts in hover (N,) (N).
        lower, upper: limits in components of force (3 N,).
    """
    number, inputs = len(hover), u.shape[1]
    for k in range(len(stages)):
        above, below = bounds[2 * k * inputs :], bounds[(2 * k + 1) * inputs :]
        for i in range(number):
            n_x, n_y, f = u[stages[k], 2 * i], u[stages[k], 2 * i + 1], u[stages[k], 2 * number + i]
            x, y, z = 2 * i, 2 * i + 1, 2 * number + i
            north, east, upward = n_x * (f / hover[i]), n_y * (f / hover[i]), f * _cosine(n_x, n_y)
            above[x], above[y], above[z] = upper[x] - north, upper[y] - east, upper[z] - upward
            below[x], below[y], below[z] = north - lower[x], east - lower[y], upward - lower[z]


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
