"""Differential flatness: from a payload trajectory to the exact state and set-points along it, the reference.

With the payload level, its position up to snap fixes everything else: all links are parallel to

    w = g e3 + d / m_0 - a,   q = w / |w|,   (d: the force on the payload)

they share the tension m_0 |w| so that no moment acts on the payload, and the force of UAV i is

    F_i = m_i (a_i - g e3) - T_i q - d_i,   a_i = a - l_i q''.   (d_i: the force on the UAV)

No linearisation is made, so a linear controller about this reference acts on errors only, not on the manoeuvre.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

import numpy as np

from idc_controller.arrays import Array
from idc_controller.model.drag import Air
from idc_controller.parameters import SystemParameters
from idc_controller.trajectory.flatness_kernels import Team, flat_map, stencil_grid

# Spacing of the samples from which derivatives of the UAVs' forces are taken (s): the trajectory is smooth up to snap
# only, and these derivatives go beyond it.
STENCIL = 0.05

_STILL_AIR = Air(np.zeros(3), np.zeros(3), 0.0)


class PayloadTrajectory(Protocol):
    """Anything that has the payload's position and its derivatives up to snap."""

    def derivatives(self, times: Array, order: int = 4) -> Array:
        """Position, velocity, ... at ``times`` (K,) -> (order + 1, K, 3), NED, SI."""
        ...


class FlatForces(NamedTuple):
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


class FlatReference(NamedTuple):
    """Exact states and inputs along a trajectory at K times."""

    payload: Array
    """Position, velocity, acceleration, jerk, snap (5, K, 3)."""
    links: FlatForces
    x: Array
    """State in the coordinates of :class:`~idc_controller.model.linear.StateLayout` (K, 12 + 11 N)."""
    u: Array
    """Set-points that keep the state on the reference (K, 3 N)."""

    def part(self, which: slice) -> FlatReference:
        """The reference at some of its times."""
        links = FlatForces(*[values[which] for values in self.links])
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


def flat_reference(
    parameters: SystemParameters,
    trajectory: PayloadTrajectory,
    times: Array,
    load: Load,
) -> FlatReference:
    """Exact reference at ``times`` (K,) (s): states and the set-points that hold the vehicles on it."""
    p, N = parameters, parameters.number_of_uavs
    grid, places = stencil_grid(times, STENCIL)
    derivatives = np.ascontiguousarray(trajectory.derivatives(grid))
    constant = np.empty((N, 3))
    constant[:] = load.uav_force
    x, u, payload, (q, q_dot, q_ddot), tension, thrust, on_payload, on_uavs = flat_map(
        derivatives, places, STENCIL, load.mass, load.force, constant, load.air is not None, load.air or _STILL_AIR,
        Team(p.g, p.p, p.l, p.m, p.attitude_kp, p.attitude_kd, p.motor_time_constant),
    )  # fmt: skip
    return FlatReference(payload, FlatForces(q, q_dot, q_ddot, tension, thrust, on_payload, on_uavs), x, u)


class Reference(NamedTuple):
    """Exact states and set-points along ``trajectory`` under ``load``, for estimator and controller alike."""

    parameters: SystemParameters
    trajectory: PayloadTrajectory
    load: Load

    def at(self, times: Array) -> FlatReference:
        """Reference at ``times`` (K,) (s)."""
        return flat_reference(self.parameters, self.trajectory, np.asarray(times, dtype=float), self.load)
