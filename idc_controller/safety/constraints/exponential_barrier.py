"""The discrete exponential barrier between hull and obstacles, linear along separating planes.

Between the hull's nearest feature and an obstacle lies a plane; with h the clearance beyond the margin on the safe side
of it (linear in the decision), every stage has to keep

    (E - p_1) .. (E - p_m) (h_k + slack_k) >= 0,     E h_k = h_k+1,   0 < p_i < 1,

the discrete form of the exponential barrier of degree m with the real poles ln(p_i) / period. Without poles these are
plain distance rows.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.formation import Formation
from idc_controller.safety.constraints.constraint import Constraint, Penalty, PlanningStep
from idc_controller.safety.planner_kernels import barrier_planes, barrier_rows, barrier_values
from idc_controller.safety.separation import Separation
from idc_controller.safety.settings import PlannerSettings
from idc_controller.trajectory.integrator_chain import Chain


class ExponentialBarrier(Constraint):
    """Two sets of rows an obstacle, payload box and rotor discs, and two slacks."""

    is_lazy = True

    def __init__(self, formation: Formation, settings: PlannerSettings) -> None:
        self.formation, self.settings = formation, settings
        self.penalty = Penalty(settings.slack_linear, settings.slack_quadratic)
        chain = settings.chain
        self._response = chain.response[1]
        self._vertices, self._lengths = formation.payload.vertices.copy(), formation.lengths.copy()
        self.operator = barrier_operator(settings.barrier_rates, chain)
        self._degree = len(settings.barrier_rates)
        fading = np.exp(-np.arange(chain.stages + 1) * chain.period / settings.slack_time_constant)
        # The barrier of h + slack in place of h: nested sets that are larger by the slack, now and later.
        shares = self.operator @ np.column_stack([fading, 1.0 - fading])
        self._shares = np.vstack([shares, shares])

    def rows(self, step: PlanningStep) -> tuple[Array, Array]:
        """Return G (2 K O, 3 knots) and h (2 K O,) for O obstacles: payload, then discs of each."""
        if not step.separations:
            return np.zeros((0, 3 * self.settings.chain.knots)), np.zeros(0)
        position, acceleration = step.reference[0] + step.free[:, 0], step.reference[2] + step.free[:, 2]
        planes = self._planes(step.separations, step.acceleration)
        G = barrier_rows(planes.normals, planes.lever, self._response, self.operator, self._degree)
        return G, (barrier_values(*planes, position, acceleration) @ self.operator.T).ravel()

    def slack_shares(self, obstacles: int) -> Array:
        """Return S (O, 2 K, 2): the slack that fades and the one that sets in, of each obstacle."""
        return np.broadcast_to(self._shares, (obstacles, *self._shares.shape))

    def values(self, separations: Sequence[Separation], position: Array, acceleration: Array) -> Array:
        """Return h of payload and discs at all stages (O, 2, K + 1) (m), along the separations' planes.

        Args:
            separations: of O obstacles, one at least.
            position, acceleration: of the payload's centre (K + 1, 3), NED, SI.
        """
        planes = self._planes(separations, acceleration)
        return barrier_values(*planes, np.ascontiguousarray(position), np.ascontiguousarray(acceleration))

    def is_kept(self, separations: Sequence[Separation], position: Array, acceleration: Array) -> bool:
        """Return whether the rows of all ``separations`` hold for ``position`` and ``acceleration`` (K + 1, 3)."""
        return bool((self.values(separations, position, acceleration) @ self.operator.T).min() >= 0.0)

    def _planes(self, separations: Sequence[Separation], acceleration: Array) -> _Planes:
        """Return the planes of ``separations`` for a hull under ``acceleration`` (K + 1, 3)."""
        s, f = self.settings, self.formation
        normals = np.array([separation.normals for separation in separations])
        obstacles = [separation.obstacle for separation in separations]
        growth = np.array([obstacle.growth for obstacle in obstacles])
        supports = np.zeros_like(growth)
        for support, obstacle, outward in zip(supports, obstacles, normals, strict=True):
            if obstacle.shape.rounded_box is None:
                support[:] = obstacle.shape.support(-outward)
        planes = barrier_planes(
            normals, np.array([obstacle.positions for obstacle in obstacles]), growth,
            np.array([obstacle.shape.row for obstacle in obstacles]), supports, self._vertices, f.hover_offsets,
            self._lengths, f.disc_radius, f.g, s.margin + s.tracking, s.uav_tracking,
            np.ascontiguousarray(acceleration),
        )  # fmt: skip
        return _Planes(normals, *planes)


class _Planes(NamedTuple):
    """Separating planes of O obstacles, and the constants of h on the safe side of them."""

    normals: Array
    """Unit vectors from hull to obstacle (O, K + 1, 3)."""
    payload: Array
    """(O, K + 1) (m)"""
    discs: Array
    """(O, K + 1) (m)"""
    lever: Array
    """Of the discs, by the payload's level acceleration (K + 1,) (s2)."""


def barrier_operator(rates: Sequence[float], chain: Chain) -> Array:
    """Return the operator (K, K + 1) that turns h at stages 0 .. K into what must not be negative at 1 .. K.

    Where there is not enough of the past, at the first stages, its degree is lower.
    """
    poles = np.exp(-np.array(rates) * chain.period)
    operator = np.zeros((chain.stages, chain.stages + 1))
    for k in range(1, chain.stages + 1):
        coefficients = np.poly(poles[: min(len(poles), k)]) if len(poles) else np.ones(1)
        operator[k - 1, k + 1 - len(coefficients) : k + 1] = coefficients[::-1]
    return operator
