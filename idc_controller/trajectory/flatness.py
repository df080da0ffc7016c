"""Differential flatness: from a payload trajectory to the exact state and set-points along it.

With the payload level, its position up to snap fixes everything else: all links are parallel to

    w = g e3 + d / m_0 - a,   q = w / |w|,   (d: the force on the payload)

they share the tension m_0 |w| so that no moment acts on the payload, and the force of UAV i is

    F_i = m_i (a_i - g e3) - T_i q - d_i,   a_i = a - l_i q''.   (d_i: the force on the UAV)

No linearisation is made, so a linear controller about this reference acts on errors only, not on the manoeuvre.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Protocol

import numpy as np

from idc_controller.arrays import Array
from idc_controller.model.drag import Air
from idc_controller.model.linear import StateLayout
from idc_controller.parameters import SystemParameters

E3 = np.array([0.0, 0.0, 1.0])

# Spacing of the samples from which derivatives of the UAVs' forces are taken (s): the trajectory is smooth up to snap
# only, and these derivatives go beyond it.
STENCIL = 0.05


class PayloadTrajectory(Protocol):
    """Anything that has the payload's position and its derivatives up to snap."""

    def derivatives(self, times: Array, order: int = 4) -> Array:
        """Position, velocity, ... at ``times`` (K,) -> (order + 1, K, 3), NED, SI."""
        ...


@dataclass(frozen=True)
class FlatForces:
    """Links and UAV forces along a trajectory; K times, N UAVs, NED."""

    q: Array
    """Link direction from UAV to payload (K, 3)."""
    q_dot: Array
    """(K, 3)"""
    q_ddot: Array
    """(K, 3)"""
    tension: Array
    """(K, N) (N)"""
    force: Array
    """Thrust vectors of the UAVs (K, N, 3) (N)."""
    on_payload: Array
    """Estimated force of the load on the payload (K, 3) (N)."""
    on_uavs: Array
    """Estimated force of the load on each of the UAVs (K, N, 3) (N)."""


@dataclass(frozen=True)
class FlatReference:
    """Exact states and inputs along a trajectory at K times."""

    payload: Array
    """Position, velocity, acceleration, jerk, snap (5, K, 3)."""
    links: FlatForces
    x: Array
    """State in the coordinates of :class:`StateLayout` (K, 12 + 11 N)."""
    u: Array
    """Set-points that keep the state on the reference (K, 3 N)."""

    def part(self, which: slice) -> FlatReference:
        """The reference at some of its times."""
        links = FlatForces(*(getattr(self.links, field.name)[which] for field in fields(FlatForces)))
        return FlatReference(self.payload[:, which], links, self.x[which], self.u[which])


@dataclass(frozen=True, eq=False)
class Load:
    """Estimates of the payload, its mass (kg) and a constant disturbance ``force`` on it (3,), and of the wind.

    ``uav_force``: level force on each of the UAVs (N, 3), or one that is the same for all (3,). Forces in N, NED.
    ``air``: its drag comes on top of the constant forces and changes with the velocity; None: there is none.
    """

    mass: float
    force: Array
    uav_force: Array = field(default_factory=lambda: np.zeros(3))
    air: Air | None = None


def flat_forces(parameters: SystemParameters, derivatives: Array, load: Load) -> FlatForces:
    """Link directions, tensions and UAV forces for payload ``derivatives`` (5, K, 3) under ``load``."""
    acceleration, jerk, snap = derivatives[2], derivatives[3], derivatives[4]
    gravity = parameters.g * E3
    on_payload = np.broadcast_to(load.force, acceleration.shape)
    on_uavs = np.broadcast_to(load.uav_force, (len(acceleration), parameters.number_of_uavs, 3))
    if load.air is not None:
        drag, drag_dot, drag_ddot = load.air.on_payload_along(derivatives)
        on_payload = on_payload + drag
        # The UAVs' own velocity differs little from the payload's.
        on_uavs = on_uavs + load.air.on_uav(derivatives[1])[:, None]
        jerk, snap = jerk - drag_dot / load.mass, snap - drag_ddot / load.mass
    w = gravity - acceleration + on_payload / load.mass
    norm = np.sqrt(_dot(w, w))
    q = w / norm
    norm_dot = -_dot(q, jerk)
    q_dot = (-jerk - norm_dot * q) / norm
    norm_ddot = -_dot(q, snap) + norm * _dot(q_dot, q_dot)
    q_ddot = (-snap - norm_ddot * q - 2.0 * norm_dot * q_dot) / norm

    tension = _tensions(parameters, q, load.mass * norm[:, 0])
    uav_acceleration = acceleration[:, None, :] - parameters.l[:, None] * q_ddot[:, None, :]
    force = parameters.m[:, None] * (uav_acceleration - gravity) - tension[..., None] * q[:, None, :]
    force -= on_uavs
    return FlatForces(q, q_dot, q_ddot, tension, force, on_payload, on_uavs)


def flat_reference(
    parameters: SystemParameters,
    trajectory: PayloadTrajectory,
    times: Array,
    load: Load,
) -> FlatReference:
    """Exact reference at ``times`` (K,) (s): states and the set-points that hold the vehicles on it."""
    K, N = len(times), parameters.number_of_uavs
    stencil = np.arange(-2, 3) * STENCIL
    grid = (np.asarray(times)[:, None] + stencil).ravel()
    # A horizon with the stencil's spacing needs most times five times over.
    _, chosen, back = np.unique(np.round(grid, 9), return_index=True, return_inverse=True)
    derivatives = trajectory.derivatives(grid[chosen])
    forces = flat_forces(parameters, derivatives, load)
    F = forces.force[back].reshape(K, 5, N, 3)
    f = np.sqrt(_dot(F, F))
    n = F[..., :2] / f
    f = f[..., 0]

    centre = back[2::5]
    h = STENCIL
    n_dot = (n[:, 3] - n[:, 1]) / (2 * h)
    n_acc = (n[:, 3] - 2 * n[:, 2] + n[:, 1]) / h**2
    n_jerk = (n[:, 4] - 2 * n[:, 3] + 2 * n[:, 1] - n[:, 0]) / (2 * h**3)
    f_dot = (f[:, 3] - f[:, 1]) / (2 * h)

    layout = StateLayout(N)
    payload = derivatives[:, centre]
    x = np.zeros((K, layout.size))
    x[:, layout.r_0], x[:, layout.v_0] = payload[0], payload[1]
    x[:, layout.s] = np.tile(forces.q[centre, :2], N)
    x[:, layout.s_dot] = np.tile(forces.q_dot[centre, :2], N)
    x[:, layout.n], x[:, layout.n_dot] = n[:, 2].reshape(K, -1), n_dot.reshape(K, -1)
    x[:, layout.n_acc], x[:, layout.f] = n_acc.reshape(K, -1), f[:, 2]

    # The attitude loop and the motor lag inverted: the set-point leads the attitude.
    kp, kd, T_m = parameters.attitude_kp, parameters.attitude_kd, parameters.motor_time_constant
    u = np.zeros((K, layout.inputs))
    u[:, layout.n_setpoint] = (n[:, 2] + (kd * n_dot + n_acc + T_m * n_jerk) / kp).reshape(K, -1)
    u[:, layout.f_setpoint] = f[:, 2] + T_m * f_dot
    links = FlatForces(*(getattr(forces, field.name)[centre] for field in fields(FlatForces)))
    return FlatReference(payload, links, x, u)


def _tensions(parameters: SystemParameters, q: Array, total: Array) -> Array:
    """Least-norm link tensions (K, N) that sum to ``total`` (K,) and leave the payload without moment."""
    p = parameters.p
    balance = np.empty((len(q), 3, parameters.number_of_uavs))
    balance[:, 0] = 1.0
    # The moment p x q T; its component along q is zero, so two of the three suffice.
    balance[:, 1] = np.outer(q[:, 2], p[:, 1]) - np.outer(q[:, 1], p[:, 2])
    balance[:, 2] = np.outer(q[:, 0], p[:, 2]) - np.outer(q[:, 2], p[:, 0])
    wanted = np.zeros((len(q), 3, 1))
    wanted[:, 0, 0] = total
    transposed = balance.transpose(0, 2, 1)
    return np.asarray((transposed @ np.linalg.solve(balance @ transposed, wanted))[..., 0])


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(np.einsum("...i,...i->...", a, b)[..., None])
