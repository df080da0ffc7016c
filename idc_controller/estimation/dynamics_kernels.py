"""Accelerations of payload and links by the nonlinear equations, compiled: what the linear model leaves out.

The linear model takes the tension of every link for that of the hover. That of a link follows from its UAV's thrust:
from unequal ones, and from those of a payload that has another weight than the model's, links lean otherwise.
"""

import math
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array, Array1, Const1, Const2
from idc_controller.compiled import inlined, kernel

_INERTIA_SHARE_MIN = 1.0 / 3.0
"""Least mass of the payload that its inertia is taken for, over the model's: covariances are those of the model, and by
them the noise of a force would turn a lighter payload about. The model follows a mass that lasts.
"""
_LEAN_MAX = 0.85
"""Largest sine of a link's tilt that is taken: an estimate without a position may have one that is none."""


@inlined
def _cross(a: Array, b: Array) -> Array:
    c = np.empty(3)
    c[0], c[1], c[2] = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
    return c


@inlined
def _solve(A: Array, b: Array) -> Array:
    """Return the solution of A x = b for a symmetric, positive definite A, by elimination; both are overwritten."""
    n = len(b)
    for k in range(n):
        for r in range(k + 1, n):
            factor = A[r, k] / A[k, k]
            for c in range(k, n):
                A[r, c] -= factor * A[k, c]
            b[r] -= factor * b[k]
    for k in range(n - 1, -1, -1):
        for c in range(k + 1, n):
            b[k] -= A[k, c] * b[c]
        b[k] /= A[k, k]
    return b


class Bodies(NamedTuple):
    """Masses and lengths of a team."""

    m_0: float
    """Of the payload (kg)."""
    J_0: Const2
    """Its inertia (3, 3) (kg m2)."""
    p: Const2
    """Attachment points (N, 3) (m)."""
    l: Const1
    """Lengths of the links (N,) (m)."""
    m: Const1
    """Masses of the UAVs (N,) (kg)."""
    g: float
    """m/s2"""


@inlined
def _accelerations(x: Array, bodies: Bodies) -> Array:
    """Return v_0' (3,), omega' (3,) and s'' (2 N,) in a state of the process model (n,).

    Newton's and Euler's laws for payload and UAVs, with each link's tension T by its UAV's motion along the link q,

        T = m (q . a_att + l |q'|^2) - q . (F + m g e3),  l s'' = (a_att - (F + T q) / m) in the level,

    where a_att is the acceleration of the attachment point and F the thrust with the wind's force. A vertical force on
    the payload is taken for weight, from which it cannot be told at rest: of the two only the sum is known well.
    """
    m_0, inertia, p, l, m, g = bodies
    N = len(l)
    force = 12 + 11 * N
    weight = (m_0 + x[-1]) * g + x[force + 2]
    mass = max(weight / g, _INERTIA_SHARE_MIN * m_0)
    J_0 = inertia * (mass / m_0)
    cr, sr, cp, sp = math.cos(x[6]), math.sin(x[6]), math.cos(x[7]), math.sin(x[7])
    cy, sy = math.cos(x[8]), math.sin(x[8])
    R = np.empty((3, 3))
    R[0, 0], R[0, 1], R[0, 2] = cp * cy, sr * sp * cy - cr * sy, cr * sp * cy + sr * sy
    R[1, 0], R[1, 1], R[1, 2] = cp * sy, sr * sp * sy + cr * cy, cr * sp * sy - sr * cy
    R[2, 0], R[2, 1], R[2, 2] = -sp, sr * cp, cr * cp
    omega = x[9:12].copy()
    A, b = np.zeros((6, 6)), np.zeros(6)
    for c in range(3):
        A[c, c] = mass
        for r in range(3):
            A[3 + r, 3 + c] = J_0[r, c]
    b[0], b[1], b[2] = x[force], x[force + 1], weight
    momentum = np.dot(J_0, omega)
    gyroscopic = _cross(omega, momentum)
    for c in range(3):
        b[3 + c] = -gyroscopic[c]
    known, q, rows = np.empty(N), np.empty((N, 3)), np.empty((N, 6))
    forces, turning = np.empty((N, 3)), np.empty((N, 3))
    for i in range(N):
        lean = math.sqrt(x[12 + 2 * i] * x[12 + 2 * i] + x[13 + 2 * i] * x[13 + 2 * i])
        share = _LEAN_MAX / max(lean, _LEAN_MAX)
        s_x, s_y = share * x[12 + 2 * i], share * x[13 + 2 * i]
        d_x, d_y = share * x[12 + 2 * (N + i)], share * x[13 + 2 * (N + i)]
        n_x, n_y, f = x[12 + 2 * (2 * N + i)], x[13 + 2 * (2 * N + i)], x[12 + 10 * N + i]
        w = force + 3 + 2 * i
        s_z = math.sqrt(1.0 - (s_x * s_x + s_y * s_y))
        d_z = -(s_x * d_x + s_y * d_y) / s_z
        q[i, 0], q[i, 1], q[i, 2] = s_x, s_y, s_z
        forces[i, 0], forces[i, 1] = f * n_x + x[w], f * n_y + x[w + 1]
        forces[i, 2] = m[i] * g - f * math.sqrt(max(1.0 - (n_x * n_x + n_y * n_y), 0.01))
        inner = _cross(omega, p[i])
        turning[i] = np.dot(R, _cross(omega, inner))
        pull = 0.0  # what does not depend on v_0' and omega' of the tension
        for c in range(3):
            rows[i, c] = q[i, c]
            pull += q[i, c] * (m[i] * turning[i, c] - forces[i, c])
        in_payload = np.dot(R.T, q[i])
        moment = _cross(p[i], in_payload)
        for c in range(3):
            rows[i, 3 + c] = moment[c]
        known[i] = pull + m[i] * l[i] * (d_x * d_x + d_y * d_y + d_z * d_z)
        for r in range(6):
            b[r] -= known[i] * rows[i, r]
            for c in range(6):
                A[r, c] += m[i] * rows[i, r] * rows[i, c]
    moved = _solve(A, b)
    result = np.empty(6 + 2 * N)
    for c in range(6):
        result[c] = moved[c]
    omega_dot = moved[3:].copy()
    for i in range(N):
        tension = known[i]
        for c in range(6):
            tension += m[i] * rows[i, c] * moved[c]
        attachment = np.dot(R, _cross(omega_dot, p[i]))
        for c in range(2):
            lateral = (forces[i, c] + tension * q[i, c]) / m[i]
            result[6 + 2 * i + c] = (moved[c] + attachment[c] + turning[i, c] - lateral) / l[i]
    return result


@kernel
def nonlinear_part(
    error: Const1, nominal: Const1, rows: Const2, push: Const2, direction: Const1, bodies: Bodies, duration: float
) -> Array1:
    """Return what the linear model of an error leaves out of its change (n,) over a short interval.

    Args:
        error: state less that of the reference (n,).
        nominal: state of the reference (n,).
        rows: of the linear model for v_0', omega' and s'' (6 + 2 N, n), without the excess of mass.
        push, direction: factors of the last column, (6 + 2 N, 3) and (3,), see :func:`.propagated`.
        bodies: masses and lengths.
        duration: of the interval (s).
    """
    N = len(bodies.l)
    exact, about = _accelerations(nominal + error, bodies), _accelerations(nominal, bodies)
    linear = np.dot(rows, error)
    result = np.zeros(len(error))
    for r in range(6 + 2 * N):
        pushed = push[r, 0] * direction[0] + push[r, 1] * direction[1] + push[r, 2] * direction[2]
        left_out = exact[r] - about[r] - linear[r] - pushed * error[-1]
        rate = 3 + r if r < 3 else 6 + r if r < 6 else 12 + 2 * N + r - 6
        result[rate] = duration * left_out
        result[rate - (3 if r < 6 else 2 * N)] = 0.5 * duration * duration * left_out
    return result
