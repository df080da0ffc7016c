"""Compiled kernels of the flat map; see :mod:`idc_controller.trajectory.flatness`."""

from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array, Array1, Array2, Array3, Const1, Const2, Indices, Indices2
from idc_controller.compiled import inlined, kernel
from idc_controller.model.drag import SMOOTHING, Air

_SAME = 1e-9
"""Times closer than this (s) are the same."""


class Team(NamedTuple):
    """What the flat map takes of :class:`~idc_controller.parameters.SystemParameters`."""

    g: float
    p: Const2
    l: Const1
    m: Const1
    attitude_kp: float
    attitude_kd: float
    motor_time_constant: float


@kernel
def stencil_grid(times: Array1, spacing: float) -> tuple[Array1, Indices2]:
    """Return the times at which a stencil of five about each of ``times`` (K,) (s) needs the trajectory.

    A horizon whose stages are as far apart as the stencil's points needs most times five times over.

    Args:
        times: in any order (K,) (s).
        spacing: of the stencil's points (s).

    Returns:
        The times without repetitions (G,) (s), and the index in them of each stencil's points (K, 5).
    """
    grid, ticks = np.empty(5 * len(times)), np.empty(5 * len(times))
    index, count = np.empty((len(times), 5), dtype=np.int64), 0
    for k, time in enumerate(times):
        for o in range(5):
            at = time + (o - 2) * spacing
            tick = np.rint(at / _SAME)
            place = count - 1
            while place >= 0 and ticks[place] != tick:
                place -= 1
            if place < 0:
                grid[count], ticks[count] = at, tick
                place = count
                count += 1
            index[k, o] = place
    return grid[:count].copy(), index


@inlined
def _fading(square: float, limit: float) -> tuple[float, float, float]:
    """Return (1 + |F|^4 / limit^4)^(-1/4) and its first two derivatives by |F|^2, at ``square`` = |F|^2 (N2)."""
    a = limit**-4.0
    z = 1.0 + a * square**2
    c = z**-0.25
    return c, -0.5 * a * square * c / z, -0.5 * a * c / z + 1.25 * a * a * square**2 * c / z**2


@inlined
def _drag_along(derivatives: Array, j: int, air: Air) -> Array:
    """Return the drag on the payload and its first two derivatives in time (3, 3) (N, NED) at instant ``j``."""
    u, u_1, u_2 = np.empty(3), np.empty(3), np.empty(3)
    s = s_1 = s_2 = 0.0
    for c in range(3):
        u[c], u_1[c], u_2[c] = air.wind[c] - derivatives[1, j, c], -derivatives[2, j, c], -derivatives[3, j, c]
        size = np.sqrt(u[c] * u[c] + SMOOTHING * SMOOTHING)
        along = u[c] * u_1[c] / size
        s += size * air.payload[c]
        s_1 += along * air.payload[c]
        s_2 += (u_1[c] ** 2 + u[c] * u_2[c] - along**2) / size * air.payload[c]
    square = square_1 = square_2 = 0.0
    for c in range(3):
        F, F_1, F_2 = s * u[c], s_1 * u[c] + s * u_1[c], s_2 * u[c] + 2.0 * s_1 * u_1[c] + s * u_2[c]
        u[c], u_1[c], u_2[c] = F, F_1, F_2
        square += F * F
        square_1 += 2.0 * F * F_1
        square_2 += 2.0 * (F_1 * F_1 + F * F_2)
    f, by, by_2 = _fading(square, air.limit)
    f_1, f_2 = by * square_1, by_2 * square_1**2 + by * square_2
    drag = np.empty((3, 3))
    for c in range(3):
        drag[0, c] = f * u[c]
        drag[1, c] = f_1 * u[c] + f * u_1[c]
        drag[2, c] = f_2 * u[c] + 2.0 * f_1 * u_1[c] + f * u_2[c]
    return drag


@inlined
def _share_tension(q: Array, total: float, p: Array, tension: Array) -> None:
    """Fill ``tension`` (N,) with the least-norm tensions that sum to ``total`` and leave the payload without moment.

    Tensions are B' (B B')^-1 (total, 0, 0) for the rows B of balance: the sum, and two components of the moment
    p x q T; its component along q is zero. B B' is factorised by Cholesky.
    """
    a00 = float(len(p))
    a10 = a11 = a20 = a21 = a22 = 0.0
    for i in range(len(p)):
        b, c = q[2] * p[i, 1] - q[1] * p[i, 2], q[0] * p[i, 2] - q[2] * p[i, 0]
        a10 += b
        a11 += b * b
        a20 += c
        a21 += c * b
        a22 += c * c
    d0 = np.sqrt(a00)
    l10, l20 = a10 / d0, a20 / d0
    d1 = np.sqrt(a11 - l10 * l10)
    l21 = (a21 - l20 * l10) / d1
    d2 = np.sqrt(a22 - l20 * l20 - l21 * l21)
    y0 = total / d0
    y1 = -l10 * y0 / d1
    y2 = (-l20 * y0 - l21 * y1) / d2
    z2 = y2 / d2
    z1 = (y1 - l21 * z2) / d1
    z0 = (y0 - l10 * z1 - l20 * z2) / d0
    for i in range(len(p)):
        b, c = q[2] * p[i, 1] - q[1] * p[i, 2], q[0] * p[i, 2] - q[2] * p[i, 0]
        tension[i] = z0 + b * z1 + c * z2


@inlined
def _forces(
    derivatives: Array, mass: float, force: Array, uav_force: Array, has_air: bool, air: Air, team: Team
) -> tuple[Array, Array, Array, Array, Array]:
    """Return links, tensions, forces on the payload and thrusts at G instants, see :func:`flat_map`.

    Then what the air adds to the force on each UAV (G, 3) (N).
    """
    G, N, g, p, l, m = derivatives.shape[1], len(team.m), team.g, team.p, team.l, team.m
    links, tension = np.empty((3, G, 3)), np.empty((G, N))
    on_payload, thrust, on_uav = np.empty((G, 3)), np.empty((G, N, 3)), np.zeros((G, 3))
    w, jerk, snap = np.empty(3), np.empty(3), np.empty(3)
    for j in range(G):
        for c in range(3):
            on_payload[j, c] = force[c]
            jerk[c], snap[c] = derivatives[3, j, c], derivatives[4, j, c]
        if has_air:
            drag = _drag_along(derivatives, j, air)
            airspeed = 0.0
            for c in range(3):
                on_payload[j, c] += drag[0, c]
                jerk[c] -= drag[1, c] / mass
                snap[c] -= drag[2, c] / mass
                airspeed += (air.wind[c] - derivatives[1, j, c]) ** 2
            airspeed = np.sqrt(airspeed)
            for c in range(3):
                # The UAVs' own velocity differs little from the payload's.
                on_uav[j, c] = air.uav * airspeed * (air.wind[c] - derivatives[1, j, c])
        square = 0.0
        for c in range(3):
            w[c] = -derivatives[2, j, c] + on_payload[j, c] / mass
            if c == 2:
                w[c] += g
            square += w[c] * w[c]
        norm = np.sqrt(square)
        q, q_1, q_2 = links[0, j], links[1, j], links[2, j]
        norm_1 = norm_2 = square = 0.0
        for c in range(3):
            q[c] = w[c] / norm
            norm_1 -= q[c] * jerk[c]
        for c in range(3):
            q_1[c] = (-jerk[c] - norm_1 * q[c]) / norm
            norm_2 -= q[c] * snap[c]
            square += q_1[c] * q_1[c]
        norm_2 += norm * square
        for c in range(3):
            q_2[c] = (-snap[c] - norm_2 * q[c] - 2.0 * norm_1 * q_1[c]) / norm
        _share_tension(q, mass * norm, p, tension[j])
        for i in range(N):
            for c in range(3):
                lifted = derivatives[2, j, c] - l[i] * q_2[c] - (g if c == 2 else 0.0)
                thrust[j, i, c] = m[i] * lifted - tension[j, i] * q[c] - uav_force[i, c] - on_uav[j, c]
    return links, tension, on_payload, thrust, on_uav


@inlined
def _states(
    derivatives: Array, links: Array, thrust: Array, index: Indices, h: float, team: Team
) -> tuple[Array, Array]:
    """Return the states (K, 12 + 11 N) and set-points (K, 3 N) of the reference at K times."""
    K, N, T_m = len(index), thrust.shape[1], team.motor_time_constant
    x, u = np.zeros((K, 12 + 11 * N)), np.empty((K, 3 * N))
    s, s_dot, n_at, n_dot_at, n_acc_at, f_at = 12, 12 + 2 * N, 12 + 4 * N, 12 + 6 * N, 12 + 8 * N, 12 + 10 * N
    f, n = np.empty(5), np.empty(5)
    for k in range(K):
        centre = index[k, 2]
        for c in range(3):
            x[k, c], x[k, 3 + c] = derivatives[0, centre, c], derivatives[1, centre, c]
        for i in range(N):
            for o in range(5):
                F = thrust[index[k, o], i]
                f[o] = np.sqrt(F[0] * F[0] + F[1] * F[1] + F[2] * F[2])
            x[k, f_at + i] = f[2]
            u[k, 2 * N + i] = f[2] + T_m * ((f[3] - f[1]) / (2.0 * h))
            for c in range(2):
                for o in range(5):
                    n[o] = thrust[index[k, o], i, c] / f[o]
                n_dot = (n[3] - n[1]) / (2.0 * h)
                n_acc = (n[3] - 2.0 * n[2] + n[1]) / h**2
                n_jerk = (n[4] - 2.0 * n[3] + 2.0 * n[1] - n[0]) / (2.0 * h**3)
                at = 2 * i + c
                x[k, s + at], x[k, s_dot + at] = links[0, centre, c], links[1, centre, c]
                x[k, n_at + at], x[k, n_dot_at + at], x[k, n_acc_at + at] = n[2], n_dot, n_acc
                u[k, at] = n[2] + (team.attitude_kd * n_dot + n_acc + T_m * n_jerk) / team.attitude_kp
    return x, u


@kernel
def flat_map(
    derivatives: Array3,
    index: Indices2,
    h: float,
    mass: float,
    force: Const1,
    uav_force: Array2,
    has_air: bool,
    air: Air,
    team: Team,
) -> tuple[Array2, Array2, Array3, Array3, Array2, Array3, Array2, Array3]:
    """Return the reference at K times, in the coordinates of the linear model, and the forces there; NED, SI.

    Args:
        derivatives: of the payload's position at G instants, up to snap (5, G, 3).
        index: instants of the five points of the stencil about each time (K, 5).
        h: spacing of these points (s).
        mass: of the payload (kg).
        force, uav_force: constant forces on the payload (3,) and on each UAV (N, 3) (N).
        has_air: whether there is drag, of ``air``.
        team: attitude loops and motors are inverted: the set-point leads the attitude.

    Returns:
        States (K, 12 + 11 N), set-points (K, 3 N), derivatives of the payload's position (5, K, 3), link directions
        from UAV to payload with two derivatives (3, K, 3), tensions (K, N) (N), thrust vectors of the UAVs (K, N, 3)
        (N), and the forces of the load on the payload (K, 3) and on the UAVs (K, N, 3) (N).
    """
    links, tension, on_payload, thrust, on_uav = _forces(derivatives, mass, force, uav_force, has_air, air, team)
    x, u = _states(derivatives, links, thrust, index, h, team)
    K, N = len(index), len(team.m)
    payload, directions, tensions = np.empty((5, K, 3)), np.empty((3, K, 3)), np.empty((K, N))
    thrusts, on_payload_at, on_uavs = np.empty((K, N, 3)), np.empty((K, 3)), np.empty((K, N, 3))
    for k in range(K):
        j = index[k, 2]
        for i in range(N):
            tensions[k, i] = tension[j, i]
        for c in range(3):
            for order in range(5):
                payload[order, k, c] = derivatives[order, j, c]
            for order in range(3):
                directions[order, k, c] = links[order, j, c]
            on_payload_at[k, c] = on_payload[j, c]
            for i in range(N):
                thrusts[k, i, c] = thrust[j, i, c]
                on_uavs[k, i, c] = uav_force[i, c] + on_uav[j, c]
    return x, u, payload, directions, tensions, thrusts, on_payload_at, on_uavs
