"""Kernel of the stop plan; see :mod:`idc_controller.trajectory.stop_plan`. N UAVs, NED, SI."""

import numpy as np

from idc_controller.arrays import Array
from idc_controller.compiled import kernel

_VECTOR, _MATRIX = (f"Array(float64, {axes}, 'C', readonly=True)" for axes in (1, 2))
"""Types of arrays of parameters, which are read only."""


@kernel(
    f"float64[:, :, ::1](float64[:, :], float64[::1], float64[::1], float64[::1], float64[::1], {_MATRIX}, {_VECTOR}, "
    "int64, int64)"
)
def motion(
    payload: Array,
    error: Array,
    q: Array,
    q_dot: Array,
    q_ddot: Array,
    p: Array,
    l: Array,
    s: int,
    s_dot: int,
) -> Array:
    """Return position, velocity and acceleration of the UAVs, then of a payload at rest below them (N + 1, 3, 3).

    All UAVs are beside the reference by what their centre is, the mean of r_0 - l_i s_i.

    Args:
        payload: position, velocity and acceleration of the reference (3, 3).
        error: of the state about the reference (12 + 11 N,).
        q, q_dot, q_ddot: direction of the reference's links and its derivatives (3,).
        p: attachment points (N, 3) (m).
        l: lengths of the links (N,) (m).
        s, s_dot: indices of the first link's tilt, and of its rate, in the state.
    """
    number = len(l)
    result = np.zeros((number + 1, 3, 3))
    for axis in range(3):
        beside, drift = 0.0, 0.0
        if axis < 2:
            for i in range(number):
                beside += l[i] * error[s + 2 * i + axis]
                drift += l[i] * error[s_dot + 2 * i + axis]
        position = payload[0, axis] + (error[axis] - beside / number)
        velocity = payload[1, axis] + (error[3 + axis] - drift / number)
        for i in range(number):
            result[i, 0, axis] = position + p[i, axis] - l[i] * q[axis]
            result[i, 1, axis] = velocity - l[i] * q_dot[axis]
            result[i, 2, axis] = payload[2, axis] - l[i] * q_ddot[axis]
            # The payload hangs below the UAVs' centre.
            up = l[i] if axis == 2 else 0.0
            result[number, 0, axis] += (result[i, 0, axis] - p[i, axis] + up) / number
            result[number, 1, axis] += result[i, 1, axis] / number
            result[number, 2, axis] += result[i, 2, axis] / number
    return result


@kernel("float64[:, :, ::1](float64[:, :, ::1], float64[::1], float64[:, ::1])")
def control_points(states: Array, durations: Array, asides: Array) -> Array:
    """Return the control points (P, 5, 3) (m) of paths to rest: quartics as Bezier curves.

    Args:
        states: position, velocity and acceleration at the start of each path (P, 3, 3); or of all of them (1, 3, 3).
        durations: of the paths (P,) (s); or of all of them (1,).
        asides: place of rest less that to which the motion alone leads (P, 3) (m); (1, 3) with one duration.
    """
    points = np.empty((max(len(states), len(durations)), 5, 3))
    for path in range(len(points)):
        state, other = states[path if len(states) > 1 else 0], path if len(durations) > 1 else 0
        for axis in range(3):
            position, turn = state[0, axis], durations[other] * state[1, axis]
            bend = durations[other] ** 2 * state[2, axis]
            points[path, 0, axis] = position
            points[path, 1, axis] = position + turn / 4.0
            points[path, 2:, axis] = position + turn / 2.0 + (1.0 / 12.0) * bend + asides[other, axis]
    return points
