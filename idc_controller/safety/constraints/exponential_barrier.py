"""The discrete exponential barrier between hull and obstacles, linear along separating planes.

Between the hull's nearest feature and an obstacle lies a plane; with h the clearance beyond the margin on the safe side
of it (linear in the decision), every stage has to keep

    (E - p_1) .. (E - p_m) (h_k + slack_k) >= 0,     E h_k = h_k+1,   0 < p_i < 1,

the discrete form of the exponential barrier of degree m with the real poles ln(p_i) / period. Without poles these are
plain distance rows.
"""

from collections.abc import Sequence

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.formation import Formation
from idc_controller.safety.constraints.constraint import Penalty, PlanningStep
from idc_controller.safety.separation import Separation
from idc_controller.safety.settings import PlannerSettings
from idc_controller.trajectory.integrator_chain import Chain


class ExponentialBarrier:
    """Two sets of rows an obstacle, payload box and rotor discs, and two slacks."""

    def __init__(self, formation: Formation, settings: PlannerSettings) -> None:
        self.formation, self.settings = formation, settings
        self.penalty = Penalty(settings.slack_linear, settings.slack_quadratic)
        chain = settings.chain
        self._Gamma = chain.response[1]
        self.operator = barrier_operator(settings.barrier_rates, chain)
        fading = np.exp(-np.arange(chain.stages + 1) * chain.period / settings.slack_time_constant)
        # The barrier of h + slack in place of h: nested sets that are larger by the slack, now and later.
        shares = self.operator @ np.column_stack([fading, 1.0 - fading])
        self._shares = np.vstack([shares, shares])

    def rows(self, step: PlanningStep) -> tuple[Array, Array]:
        """Return G (2 K O, 3 knots) and h (2 K O,) for O obstacles: payload, then discs of each."""
        if not step.separations:
            return np.zeros((0, 3 * self.settings.chain.knots)), np.zeros(0)
        G, h = zip(*(self._rows_of(separation, step) for separation in step.separations), strict=True)
        return np.vstack(G), np.concatenate(h)

    def slack_shares(self, step: PlanningStep) -> Array:
        """Return S (2 K O, 2 O): the slack that fades and the one that sets in, of each obstacle."""
        rows, number = len(self._shares), len(step.separations)
        shares = np.zeros((number * rows, 2 * number))
        for j in range(number):
            shares[j * rows : (j + 1) * rows, 2 * j : 2 * j + 2] = self._shares
        return shares

    def values(self, separation: Separation, position: Array, acceleration: Array) -> Array:
        """Return h of payload and discs at all stages (2, K + 1) (m), along the separation's planes.

        Args:
            separation: of one obstacle.
            position, acceleration: of the payload's centre (K + 1, 3), NED, SI.
        """
        n = separation.normals
        payload, discs, lever = self._constants(separation, acceleration)
        h_payload = payload - np.sum(n * position, axis=1)
        h_discs = discs - np.sum(n * position, axis=1) - lever * np.sum(n[:, :2] * acceleration[:, :2], axis=1)
        return np.stack([h_payload, h_discs])

    def is_kept(self, separations: Sequence[Separation], position: Array, acceleration: Array) -> bool:
        """Return whether the rows of all ``separations`` hold for ``position`` and ``acceleration`` (K + 1, 3)."""
        return all(
            float((self.operator @ h).min()) >= 0.0
            for separation in separations
            for h in self.values(separation, position, acceleration)
        )

    def _constants(self, separation: Separation, acceleration: Array) -> tuple[Array, Array, Array]:
        """Constants of h for payload and discs (K + 1,), and the discs' levers."""
        s, n, obstacle = self.settings, separation.normals, separation.obstacle
        surface = np.sum(n * obstacle.positions, axis=1) - obstacle.shape.support(-n)
        surface -= s.margin + s.tracking + obstacle.growth
        payload = surface - self.formation.payload.support(n)
        discs = surface - s.uav_tracking - self.formation.disc_support(n, acceleration)
        return payload, discs, self.formation.levers(acceleration)[:, 0]

    def _rows_of(self, separation: Separation, step: PlanningStep) -> tuple[Array, Array]:
        n = separation.normals
        payload, discs, lever = self._constants(separation, step.acceleration)
        position, acceleration = step.reference[0] + step.free[:, 0], step.reference[2] + step.free[:, 2]
        along = np.sum(n * position, axis=1)
        shear = lever * np.sum(n[:, :2] * acceleration[:, :2], axis=1)
        # h_k = constant_k - row_k z
        row_payload = n[:, :, None] * self._Gamma[:, 0][:, None, :]
        row_discs = row_payload.copy()
        row_discs[:, :2] += (lever[:, None] * n[:, :2])[:, :, None] * self._Gamma[:, 2][:, None, :]
        G = [self.operator @ row.reshape(len(n), -1) for row in (row_payload, row_discs)]
        h = [self.operator @ (payload - along), self.operator @ (discs - along - shear)]
        return np.vstack(G), np.concatenate(h)


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
