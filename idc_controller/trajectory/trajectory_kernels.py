"""Kernels that evaluate trajectories: splines, the figure eight, states of a plan's deviation. SI, NED."""

import math

import numpy as np

from idc_controller.arrays import Array, Array1, Array2, Array3, Indices1
from idc_controller.compiled import inlined, kernel

_SUPPORT = 6
"""Control points that act at one time: :data:`idc_controller.trajectory.spline.SUPPORT`."""


@kernel
def span(times: Array1) -> tuple[float, float]:
    """Return the earliest and the latest of ``times`` (K,); NaN twice if one of them is not finite."""
    earliest, latest = math.inf, -math.inf
    for time in times:
        if not math.isfinite(time):
            return math.nan, math.nan
        earliest, latest = min(earliest, time), max(latest, time)
    return earliest, latest


@kernel
def spline(control_points: Array2, basis: Array3, arguments: Array1, order: int) -> Array3:
    """Return position and derivatives (order + 1, K, 3) of a uniform B-spline of degree 5.

    Args:
        control_points: (M, 3) (m); at rest at the first and the last outside.
        basis: polynomials of the basis function and its derivatives (order + 1 or more, 6 control points, oldest
            first, 6 powers of the fraction of an interval).
        arguments: (K,), time in intervals.
        order: highest derivative.
    """
    number = len(control_points)
    result = np.zeros((order + 1, len(arguments), 3))
    powers = np.ones(_SUPPORT)
    for i, argument in enumerate(arguments):
        clipped = min(max(argument, 0.0), float(number + _SUPPORT))
        cell = math.floor(clipped)
        for p in range(1, _SUPPORT):
            powers[p] = powers[p - 1] * (clipped - cell)
        # Relative to the newest of the points: rest is then exactly rest.
        base = control_points[min(max(cell, 0), number - 1)]
        for k in range(_SUPPORT - 1):
            point = control_points[min(max(cell + k - _SUPPORT + 1, 0), number - 1)]
            x, y, z = point[0] - base[0], point[1] - base[1], point[2] - base[2]
            for d in range(order + 1):
                weight = 0.0
                for p in range(_SUPPORT - d):
                    weight += powers[p] * basis[d, k, p]
                result[d, i, 0] += weight * x
                result[d, i, 1] += weight * y
                result[d, i, 2] += weight * z
        for axis in range(3):
            result[0, i, axis] += base[axis]
    return result


@inlined
def _polynomial(coefficients: Array, knots: Array, time: float, values: Array) -> None:
    """Write a piecewise polynomial and its derivatives at ``time`` into ``values`` (order + 1,); see ``_phase``."""
    degree = len(coefficients) - 1
    piece = 0
    while piece < len(knots) - 2 and time >= knots[piece + 1]:
        piece += 1
    since = time - knots[piece]
    for d in range(len(values)):
        value, power = 0.0, 1.0
        for p in range(d, degree + 1):
            factor = 1.0
            for j in range(d):
                factor *= p - j
            value += factor * coefficients[degree - p, piece] * power
            power *= since
        values[d] = value


@inlined
def _phase(coefficients: Array, knots: Array, times: Array, order: int) -> Array:
    """Return a piecewise polynomial and its derivatives (order + 1, K), exactly at rest from both ends on."""
    result = np.zeros((order + 1, len(times)))
    values = np.empty(order + 1)
    for i, time in enumerate(times):
        _polynomial(coefficients, knots, min(max(time, knots[0]), knots[-1]), values)
        for d in range(order + 1):
            result[d, i] = values[d]
        if time <= knots[0] or time >= knots[-1]:
            result[1:, i] = 0.0
    return result


@kernel
def figure_eight(curve: Array1, phases: Array2) -> Array3:
    """Return position and derivatives by time (order + 1, K, 3) on the figure eight, by the chain rule (Faa di Bruno).

    Args:
        curve: amplitudes of x and y, centre's x and y, down (5,) (m).
        phases: the phase and its derivatives by time (order + 1, K) (rad / s^d).
    """
    order, number = len(phases) - 1, phases.shape[1]
    result = np.empty((order + 1, number, 3))
    by_phase, by_time = np.empty(5), np.zeros(5)
    for i in range(number):
        for d in range(order + 1):
            by_time[d] = phases[d, i]
            result[d, i, 2] = 0.0
        result[0, i, 2] = curve[4]
        for axis in range(2):
            # x = a sin(phase), y = -a sin(2 phase).
            multiple = 1.0 + axis
            size = curve[axis] if axis == 0 else -curve[axis]
            sine, cosine = math.sin(multiple * by_time[0]), math.cos(multiple * by_time[0])
            for d, value in enumerate((sine, cosine, -sine, -cosine, sine)):
                by_phase[d] = size * multiple**d * value
            s_1, s_2, s_3, s_4 = by_time[1], by_time[2], by_time[3], by_time[4]
            r_1, r_2, r_3, r_4 = by_phase[1], by_phase[2], by_phase[3], by_phase[4]
            result[0, i, axis] = by_phase[0] + curve[2 + axis]
            if order >= 1:
                result[1, i, axis] = r_1 * s_1
            if order >= 2:
                result[2, i, axis] = r_2 * s_1**2 + r_1 * s_2
            if order >= 3:
                result[3, i, axis] = r_3 * s_1**3 + 3.0 * r_2 * s_1 * s_2 + r_1 * s_3
            if order >= 4:
                curved = r_2 * (3.0 * s_2**2 + 4.0 * s_1 * s_3)
                result[4, i, axis] = r_4 * s_1**4 + 6.0 * r_3 * s_1**2 * s_2 + curved + r_1 * s_4
    return result


@kernel
def figure_eight_at(curve: Array1, coefficients: Array2, knots: Array1, times: Array1, order: int) -> Array3:
    """Return position and derivatives (order + 1, K, 3) on the figure eight at ``times`` (K,) (s).

    Args:
        curve: see :func:`figure_eight`.
        coefficients: of the polynomials of the phase (degree + 1, pieces), highest power first.
        knots: between the pieces (pieces + 1,) (s); before and after them it rests.
        times: (K,) (s).
        order: highest derivative.
    """
    return figure_eight(curve, _phase(coefficients, knots, times, order))


@inlined
def _add_chain(states: Array, row: int, period: float, stages: int, elapsed: float, result: Array) -> None:
    """Add to ``result`` (order + 1, 3); see ``chain``."""
    order = len(result) - 1
    stage = min(max(int(elapsed / period), 0), stages - 1)
    dt = min(max(elapsed - stage * period, 0.0), period)
    k = row + stage
    over = elapsed - stages * period
    for axis in range(3):
        crackle = (states[k + 1, 4, axis] - states[k, 4, axis]) / period
        for d in range(order + 1):
            value = crackle
            for c in range(4, d - 1, -1):
                value = states[k, c, axis] + value * dt / (c + 1 - d)
            if over > 0.0:
                if d == 0:
                    value += states[row + stages, 1, axis] * over
                elif d >= 2:
                    value = 0.0
            result[d, axis] += value


@kernel
def chain(states: Array3, period: float, elapsed: Array1) -> Array3:
    """Return position to snap (5, M, 3) between the stages of a plan, whose snap is linear from one to the next.

    Beyond the last stage it goes on with the last acceleration fading at once: callers look that far for shape only.

    Args:
        states: position to snap at the stages 0 .. K (K + 1, 5, 3).
        period: from stage to stage (s).
        elapsed: times since stage 0 (M,) (s).
    """
    result = np.zeros((5, len(elapsed), 3))
    for i, since in enumerate(elapsed):
        _add_chain(states, 0, period, len(states) - 1, since, result[:, i])
    return result


@kernel
def progress(scalings: Array2, times: Array1) -> tuple[Indices1, Array1, float, float]:
    """Return the piece in force (M,), the progress of its reference (M,) (s), and the span of that.

    The span is NaN twice if a progress is not finite.

    Args:
        scalings: start (s), progress at the start (s) and rate of the pieces, each in force until the next (P, 3).
        times: (M,) (s); before the first start the first piece is in force.
    """
    which, result = np.empty(len(times), dtype=np.int64), np.empty(len(times))
    for i, time in enumerate(times):
        piece = 0
        for j in range(len(scalings) - 1, 0, -1):
            if scalings[j, 0] <= time:
                piece = j
                break
        which[i] = piece
        result[i] = scalings[piece, 1] + scalings[piece, 2] * (time - scalings[piece, 0])
    earliest, latest = span(result)
    return which, result, earliest, latest


@kernel
def deflect(
    derivatives: Array3,
    times: Array1,
    which: Indices1,
    scalings: Array2,
    rows: Indices1,
    states: Array3,
    period: float,
    stages: int,
) -> None:
    """Turn derivatives by progress into those of the plans in force, by time, in place.

    Args:
        derivatives: of the reference by its progress (order + 1, M, 3).
        times: (M,) (s).
        which, scalings: see ``progress``.
        rows: where stage 0 of each piece's deviation is in ``states`` (P,); -1: it has none.
        states: deviations of all pieces, position to snap at their stages (R, 5, 3).
        period: from stage to stage of a plan (s).
        stages: of a plan.
    """
    for i, time in enumerate(times):
        piece = which[i]
        rate, factor = scalings[piece, 2], 1.0
        if rate != 1.0:
            for d in range(1, len(derivatives)):
                factor *= rate
                for axis in range(3):
                    derivatives[d, i, axis] *= factor
        if rows[piece] >= 0:
            elapsed = max(time - scalings[piece, 0], 0.0)
            _add_chain(states, rows[piece], period, stages, elapsed, derivatives[:, i])
