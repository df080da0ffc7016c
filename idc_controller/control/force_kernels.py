"""Between attitude and thrust and the components of force in which the linear model is most nearly linear.

A UAV pulls with F = f n. In the model's coordinates ``n`` (tilt) and ``f`` (thrust) the lateral force is f n, a
product; in F_xy / f_hover and -F_z it is linear. Errors are taken, and set-points inverted, in these components,
exactly. N UAVs, SI.
"""

import math

import numpy as np

from idc_controller.arrays import Array, Array1, Array2, Indices1
from idc_controller.compiled import inlined, kernel

_LEAST_SQUARE = 1e-3
"""Of a cosine: a tilt is taken for no more than nearly level."""


@inlined
def _cosine(north: float, east: float) -> float:
    """Return the upward part of a unit vector with these level parts."""
    return math.sqrt(max(1.0 - (north * north + east * east), _LEAST_SQUARE))


@inlined
def _convert(x: Array, hover: Array, tilts: int) -> None:
    """Turn a state (12 + 11 N,) into components of force in place; see ``tracking_error``."""
    number = len(hover)
    for i in range(number):
        f = x[tilts + 6 * number + i]
        upward = f * _cosine(x[tilts + 2 * i], x[tilts + 2 * i + 1])
        for part in range(3):
            for axis in range(2):
                x[tilts + 2 * (part * number + i) + axis] *= f / hover[i]
        x[tilts + 6 * number + i] = upward


@inlined
def _limit(vector: Array, limit: float) -> None:
    """Shorten ``vector`` (3,) to ``limit`` in place if it is longer."""
    norm = math.sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2])
    if norm > limit:
        for axis in range(3):
            vector[axis] *= limit / norm


@kernel
def tracking_error(
    x: Array1, reference: Array1, hover: Array1, tilts: int, position_limit: float, velocity_limit: float
) -> Array1:
    """Return the error (12 + 11 N,) of a state about its reference, tilts as F_xy / f_hover and thrusts as -F_z.

    Args:
        x, reference: in the model's coordinates (12 + 11 N,).
        hover: thrusts in hover (N,) (N).
        tilts: index of the first UAV's tilt; their rates, their accelerations and the thrusts follow.
        position_limit, velocity_limit: to which the payload's errors (m, m/s) are shortened.
    """
    error, converted = x.copy(), reference.copy()
    _convert(error, hover, tilts)
    _convert(converted, hover, tilts)
    for i in range(len(error)):
        error[i] -= converted[i]
    _limit(error[0:3], position_limit)
    _limit(error[3:6], velocity_limit)
    return error


@kernel
def followed(force: Array2, estimated: Array2, before: Array1, after: Array1, share: float, limit: float) -> Array2:
    """Return the constant forces (K, 3) (N) that follow the estimated ones, drag and all.

    Args:
        force: constant forces so far (K, 3) (N).
        estimated: estimated forces (K, 3) (N), each shortened to ``limit`` (N).
        before, after: drag that comes on top so far and from now on (3,) (N): it changes what is left over.
        share: of the difference that is followed.
        limit: of the estimated forces (N).
    """
    result = np.empty_like(force)
    for i in range(len(force)):
        estimate = estimated[i].copy()
        _limit(estimate, limit)
        for axis in range(3):
            rest = force[i, axis] + before[axis] - after[axis]
            result[i, axis] = rest + share * (estimate[axis] - after[axis] - rest)
    return result


@kernel
def fill_input_bounds(bounds: Array1, u: Array2, stages: Indices1, hover: Array1, lower: Array1, upper: Array1) -> None:
    """Fill the first M 6 N of ``bounds`` with how far set-points are from their limits, upper then lower ones by stage.

    Args:
        bounds: to fill (M 6 N or more,).
        u: tilts and thrusts of the reference at all stages (K, 3 N).
        stages: those whose bounds are wanted (M,).
        hover: thrusts in hover (N,) (N).
        lower, upper: limits of upward forces (N), and of level ones over the reference's thrust (3 N,).
    """
    number, inputs = len(hover), u.shape[1]
    for k in range(len(stages)):
        above, below = bounds[2 * k * inputs :], bounds[(2 * k + 1) * inputs :]
        for i in range(number):
            n_x, n_y, f = u[stages[k], 2 * i], u[stages[k], 2 * i + 1], u[stages[k], 2 * number + i]
            x, y, z = 2 * i, 2 * i + 1, 2 * number + i
            share, upward = f / hover[i], f * _cosine(n_x, n_y)
            above[x], above[y], above[z] = share * (upper[x] - n_x), share * (upper[y] - n_y), upper[z] - upward
            below[x], below[y], below[z] = share * (n_x - lower[x]), share * (n_y - lower[y]), upward - lower[z]


@kernel
def setpoints(delta: Array1, u_reference: Array1, hover: Array1) -> Array1:
    """Return tilts and thrusts (3 N,) of a reference plus ``delta`` in force components.

    Args:
        delta: F_xy / f_hover and -F_z less the reference's (3 N,).
        u_reference: tilts and thrusts of the reference (3 N,).
        hover: thrusts in hover (N,) (N).
    """
    number, u = len(hover), np.empty(len(delta))
    for i in range(number):
        n_x, n_y, f = u_reference[2 * i], u_reference[2 * i + 1], u_reference[2 * number + i]
        north, east = f * n_x + hover[i] * delta[2 * i], f * n_y + hover[i] * delta[2 * i + 1]
        upward = f * _cosine(n_x, n_y) + delta[2 * number + i]
        thrust = math.sqrt(north * north + east * east + upward * upward)
        u[2 * i], u[2 * i + 1], u[2 * number + i] = north / thrust, east / thrust, thrust
    return u


@kernel
def directions(u: Array1) -> Array2:
    """Return the unit thrust vectors (N, 3), NED, of set-points ``u`` (3 N,), tilts and thrusts."""
    number = len(u) // 3
    result = np.empty((number, 3))
    for i in range(number):
        north, east = u[2 * i], u[2 * i + 1]
        result[i, 0], result[i, 1] = north, east
        result[i, 2] = -math.sqrt(max(1.0 - (north * north + east * east), 0.0))
    return result
