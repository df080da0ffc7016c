"""Kernels of the stop plan; see :mod:`idc_controller.trajectory.stop_plan`. N UAVs, NED, SI."""

import numpy as np

from idc_controller.arrays import Array, Array1, Array2, Array3, Const1, Const2
from idc_controller.compiled import inlined, kernel


@inlined
def point_on_quartic(control: Array, share: float, axis: int) -> float:
    """Return a coordinate of the Bezier curve of ``control`` points (5, 3) at a ``share`` (0 .. 1) of its time."""
    rest = 1.0 - share
    return float(
        rest**4 * control[0, axis]
        + 4.0 * share * rest**3 * control[1, axis]
        + 6.0 * share**2 * rest**2 * control[2, axis]
        + 4.0 * share**3 * rest * control[3, axis]
        + share**4 * control[4, axis]
    )


@kernel
def on_quartic(control: Array2, shares: Array1) -> Array2:
    """Return the places (K, 3) on the Bezier curve of ``control`` points (5, 3) at ``shares`` (K,) of its time."""
    places = np.empty((len(shares), 3))
    for k, share in enumerate(shares):
        for axis in range(3):
            places[k, axis] = point_on_quartic(control, share, axis)
    return places


@kernel
def motions_at_rest(payload: Array2, error: Array1, links: Array2, p: Const2, l: Const1, s: int, s_dot: int) -> Array3:
    """Return position, velocity and acceleration of the UAVs, then of a payload at rest below them (N + 1, 3, 3).

    All UAVs are beside the reference by what their centre is, the mean of r_0 - l_i s_i.

    Args:
        payload: position, velocity and acceleration of the reference (3, 3).
        error: of the state about the reference (12 + 11 N,).
        links: direction of the reference's links with two derivatives (3, 3).
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
            result[i, 0, axis] = position + p[i, axis] - l[i] * links[0, axis]
            result[i, 1, axis] = velocity - l[i] * links[1, axis]
            result[i, 2, axis] = payload[2, axis] - l[i] * links[2, axis]
            # The payload hangs below the UAVs' centre.
            up = l[i] if axis == 2 else 0.0
            result[number, 0, axis] += (result[i, 0, axis] - p[i, axis] + up) / number
            result[number, 1, axis] += result[i, 1, axis] / number
            result[number, 2, axis] += result[i, 2, axis] / number
    return result


@kernel
def control_points(states: Array3, durations: Array1, asides: Array2) -> Array3:
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
            for k in range(2, 5):
                points[path, k, axis] = position + turn / 2.0 + (1.0 / 12.0) * bend + asides[other, axis]
    return points
