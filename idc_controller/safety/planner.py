"""The safety programme: the plan nearest to the mission that keeps an exponential barrier to every obstacle.

Decision variables are the knots of the snap of the payload's deviation from the mission. Between the hull's nearest
feature and an obstacle lies a plane; with h the room on the safe side of it (linear in the decision), every stage asks
for

    (E - p_1) .. (E - p_m) (h_k + slack_k) >= 0,     E h_k = h_k+1,   0 < p_i < 1,

the discrete form of the exponential barrier of degree m with the real poles ln(p_i) / period. Without poles these are
plain distance rows. Slacks, two an obstacle, keep the programme feasible and say by how much safety would be missed.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import daqp
import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, solve_discrete_are

from idc_controller.errors import ParameterError
from idc_controller.geometry.formation import Formation
from idc_controller.safety.separation import Separation
from idc_controller.trajectory.integrator_chain import Chain

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PlannerSettings:
    """Weights of the deviation per axis (x, y, z), limits of the plan, and the barrier."""

    chain: Chain = Chain()
    position: tuple[float, float, float] = (0.7, 0.7, 1.0)
    velocity: tuple[float, float, float] = (0.6, 0.6, 0.05)
    acceleration: float = 0.005
    jerk: float = 0.002
    snap: tuple[float, float, float] = (0.001, 0.001, 0.0002)
    crackle: float = 0.0002
    """On the change of snap from stage to stage, over the period: the UAVs' tilt rates follow it."""
    acceleration_limit: tuple[float, float, float] = (3.0, 3.0, 2.7)
    snap_limit: tuple[float, float, float] = (6.0, 6.0, 10.0)
    lowest: float = -0.30
    """Greatest z of the payload's centre (m, NED)."""
    barrier_rates: tuple[float, ...] = (5.0,)
    """Real, positive rates of the barrier (1/s); one for each degree."""
    margin: float = 0.5
    """Room to keep between hull and obstacles (m)."""
    tracking: float = 0.10
    """Bound on the payload's deviation from the plan (m), added to the margin."""
    uav_tracking: float = 0.02
    """What the discs may deviate beyond that (m)."""
    slack_linear: float = 1000.0
    slack_quadratic: float = 100.0
    slack_time_constant: float = 0.8
    """With which one slack fades over the horizon and the other sets in (s): room that has to be given up now is to be
    won back, and what cannot be kept later excuses nothing now."""
    limit_slack_linear: float = 3000.0
    limit_slack_quadratic: float = 1000.0
    """Beyond its limits the plan cannot be tracked: they weigh more than the margins."""

    def __post_init__(self) -> None:
        if any(not rate > 0.0 for rate in self.barrier_rates):
            raise ParameterError(f"barrier rates {self.barrier_rates} must be real and positive")

    @cached_property
    def barrier(self) -> Array:
        """The operator (K, K + 1) that turns h at stages 0 .. K into what must not be negative at stages 1 .. K.

        Where there is not enough of the past, at the first stages, its degree is lower.
        """
        poles = np.exp(-np.array(self.barrier_rates) * self.chain.period)
        operator = np.zeros((self.chain.stages, self.chain.stages + 1))
        for k in range(1, self.chain.stages + 1):
            coefficients = np.poly(poles[: min(len(poles), k)]) if len(poles) else np.ones(1)
            operator[k - 1, k + 1 - len(coefficients) : k + 1] = coefficients[::-1]
        return operator


@dataclass(frozen=True, eq=False)
class Plan:
    """A solution of the safety programme."""

    knots: Array
    """Snap of the deviation (knots, 3)."""
    deviation: Array
    """States of the deviation at all stages (K + 1, 5, 3)."""
    cost: float
    slack: float
    """Largest slack of an obstacle (m)."""


class Planner:
    """Matrices that do not change, and the programme around them."""

    def __init__(self, formation: Formation, settings: PlannerSettings) -> None:
        self.formation, self.settings = formation, settings
        chain = settings.chain
        Phi, Gamma = chain.response
        self._Phi, self._Gamma = Phi, Gamma
        self.hessians, self.gradients, self._gains = [], [], []
        self._constants = []
        for axis in range(3):
            W = np.diag(
                [
                    settings.position[axis],
                    settings.velocity[axis],
                    settings.acceleration,
                    settings.jerk,
                    settings.snap[axis],
                ]
            )
            W_f = np.zeros((5, 5))
            W_f[:4, :4] = _terminal(chain.period, W)
            steps = (Phi[1:, 4] - Phi[:-1, 4]) / chain.period, (Gamma[1:, 4] - Gamma[:-1, 4]) / chain.period
            H = settings.crackle * steps[1].T @ steps[1]
            G = settings.crackle * steps[1].T @ steps[0]
            C = settings.crackle * steps[0].T @ steps[0]
            for k in range(1, chain.stages + 1):
                weight = W + W_f if k == chain.stages else W
                H = H + Gamma[k].T @ weight @ Gamma[k]
                G = G + Gamma[k].T @ weight @ Phi[k]
                C = C + Phi[k].T @ weight @ Phi[k]
            self.hessians.append(H)
            self.gradients.append(G)
            self._constants.append(C)
            self._gains.append(np.linalg.solve(H, G))
        self._hessian = block_diag(*self.hessians)
        fading = np.exp(-np.arange(chain.stages + 1) * chain.period / settings.slack_time_constant)
        # The barrier of h + slack in place of h: nested sets that are larger by the slack, now and later.
        shares = settings.barrier @ np.column_stack([fading, 1.0 - fading])
        self._slack_shares = np.vstack([shares, shares])
        self._limited = np.arange(3, chain.stages + 1, 3)
        limits = settings.acceleration_limit
        diagonal = np.sqrt(0.5)
        self._limit_directions = np.array(
            [[1, 0, 0], [0, 1, 0], [0, 0, 1], [diagonal, diagonal, 0], [diagonal, -diagonal, 0]]
        )
        self._accelerations = np.array([*limits, min(limits[:2]), min(limits[:2])])
        self._limit_matrix = self._limit_rows()

    def free(self, start: Array) -> Plan:
        """The plan from a deviation ``start`` (5, 3) when nothing is in the way: back to the mission."""
        knots = np.column_stack([-self._gains[axis] @ start[:, axis] for axis in range(3)])
        deviation = self.settings.chain.roll_out(start, knots)
        return Plan(knots, deviation, self._cost(start, knots), 0.0)

    def solve(self, start: Array, mission: Array, separations: list[Separation], acceleration: Array) -> Plan | None:
        """The plan from ``start`` (5, 3) about ``mission`` (5, K + 1, 3) that keeps to the planes of ``separations``.

        ``acceleration`` (K + 1, 3) is that of the plan before, about which the hull's shear is linear. None: no
        solution.
        """
        s, knots = self.settings, self.settings.chain.knots
        obstacles = len(separations)
        n = 3 * knots + 2 * obstacles + 1
        H = np.zeros((n, n))
        H[: 3 * knots, : 3 * knots] = self._hessian
        f = np.zeros(n)
        for axis in range(3):
            f[axis * knots : (axis + 1) * knots] = self.gradients[axis] @ start[:, axis]
        slack = np.arange(3 * knots, n)
        H[slack, slack] = s.slack_quadratic
        f[slack] = s.slack_linear
        H[-1, -1], f[-1] = s.limit_slack_quadratic, s.limit_slack_linear

        # Simple bounds first: the snap at its knots, then the slacks; then the rows, each with its slack.
        each = 2 * s.chain.stages
        m = obstacles * each + len(self._limit_matrix)
        A = np.zeros((m, n))
        upper, lower = np.full(n + m, 1e30), np.full(n + m, -1e30)
        upper[: 3 * knots], lower[: 3 * knots] = self._snap_bounds(mission)
        lower[slack] = 0.0
        b = upper[n:]
        base = self._Phi @ start  # (K + 1, 5, 3)
        for j, separation in enumerate(separations):
            row = slice(j * each, (j + 1) * each)
            A[row, : 3 * knots], b[row] = self._barrier_rows(separation, base, mission, acceleration)
            A[row, 3 * knots + 2 * j : 3 * knots + 2 * j + 2] = -self._slack_shares
        row = slice(obstacles * each, m)
        A[row, : 3 * knots], b[row] = self._limit_matrix, self._limit_bounds(base, mission)
        A[row, -1] = -1.0
        x, _, flag, _ = daqp.solve(H, f, A, upper, lower, np.zeros(n + m, dtype=np.int32))
        if flag < 1 or not np.all(np.isfinite(x)):
            return None
        z = x[: 3 * knots].reshape(3, knots).T
        cost = self._cost(start, z) + float(0.5 * x[slack] @ (np.diag(H)[slack] * x[slack]) + f[slack] @ x[slack])
        return Plan(z, s.chain.roll_out(start, z), cost, float(x[slack[:-1]].max(initial=0.0)))

    def room(self, separation: Separation, position: Array, acceleration: Array) -> Array:
        """h of payload and discs at all stages (2, K + 1) (m): room beyond margins, along the separation's planes."""
        n = separation.normals
        payload, discs, _ = self._sides(separation, acceleration)
        h_payload = payload - np.sum(n * position, axis=1)
        lever = self.formation.levers(acceleration)[:, 0]
        h_discs = discs - np.sum(n * position, axis=1) - lever * np.sum(n[:, :2] * acceleration[:, :2], axis=1)
        return np.stack([h_payload, h_discs])

    def _sides(self, separation: Separation, acceleration: Array) -> tuple[Array, Array, Array]:
        """Constants of h for payload and discs (K + 1,), and the discs' levers."""
        s, n, obstacle = self.settings, separation.normals, separation.obstacle
        surface = np.sum(n * obstacle.positions, axis=1) - obstacle.shape.support(-n)
        surface -= s.margin + s.tracking + obstacle.growth
        payload = surface - self.formation.box_support(n)
        discs = surface - s.uav_tracking - self.formation.disc_support(n, acceleration)
        return payload, discs, self.formation.levers(acceleration)[:, 0]

    def _barrier_rows(
        self, separation: Separation, base: Array, mission: Array, acceleration: Array
    ) -> tuple[Array, Array]:
        """``G z <= h`` of payload and discs for one obstacle, without the slack."""
        n = separation.normals
        payload, discs, lever = self._sides(separation, acceleration)
        position, acc = mission[0] + base[:, 0], mission[2] + base[:, 2]
        along = np.sum(n * position, axis=1)
        shear = lever * np.sum(n[:, :2] * acc[:, :2], axis=1)
        # h_k = constant_k - row_k z
        Gr, Ga = self._Gamma[:, 0], self._Gamma[:, 2]
        row_payload = n[:, :, None] * Gr[:, None, :]
        row_discs = row_payload.copy()
        row_discs[:, :2] += (lever[:, None] * n[:, :2])[:, :, None] * Ga[:, None, :]
        barrier = self.settings.barrier
        G = [barrier @ row.reshape(len(n), -1) for row in (row_payload, row_discs)]
        h = [barrier @ (payload - along), barrier @ (discs - along - shear)]
        return np.vstack(G), np.concatenate(h)

    def within_limits(self, plan: Plan, mission: Array) -> bool:
        """Whether the free plan keeps the limits of snap, acceleration and height."""
        z = plan.knots.T.ravel()
        upper, lower = self._snap_bounds(mission)
        h = self._limit_bounds(self._Phi @ plan.deviation[0], mission)
        return bool(
            np.all(z <= upper + 1e-9) and np.all(z >= lower - 1e-9) and np.all(self._limit_matrix @ z <= h + 1e-9)
        )

    def _snap_bounds(self, mission: Array) -> tuple[Array, Array]:
        """Upper and lower bounds of z: what the mission leaves of the snap; its own is always allowed."""
        snap = mission[4, np.cumsum(self.settings.chain.blocks)]
        limit = np.maximum(self.settings.snap_limit, np.abs(snap).max(axis=0) + 1.0)
        return (limit - snap).T.ravel(), (-limit - snap).T.ravel()

    def _limit_rows(self) -> Array:
        """Rows on z for acceleration, along the axes and between north and east, both ways, and for height."""
        knots, at = self.settings.chain.knots, self._limited
        along = np.einsum("da,kz->dkaz", self._limit_directions, self._Gamma[at, 2])
        both_ways = np.stack([along, -along], axis=1).reshape(-1, 3 * knots)
        height = np.zeros((len(at), 3 * knots))
        height[:, 2 * knots :] = self._Gamma[at, 0]
        return np.vstack([both_ways, height])

    def _limit_bounds(self, base: Array, mission: Array) -> Array:
        """What these rows may come to, without the slack."""
        at = self._limited
        own = self._limit_directions @ mission[2, at].T
        value = own + self._limit_directions @ base[at, 2].T
        # The mission's own acceleration is always allowed.
        limit = np.maximum(self._accelerations[:, None], np.abs(own) + 0.1)
        height = np.maximum(self.settings.lowest, mission[0, at, 2]) - mission[0, at, 2] - base[at, 0, 2]
        return np.concatenate([np.stack([limit - value, limit + value], axis=1).ravel(), height])

    def _cost(self, start: Array, knots: Array) -> float:
        total = 0.0
        for axis in range(3):
            z, y = knots[:, axis], start[:, axis]
            total += float(
                0.5 * z @ self.hessians[axis] @ z + (self.gradients[axis] @ y) @ z + 0.5 * y @ self._constants[axis] @ y
            )
        return total


def _terminal(period: float, W: Array) -> Array:
    """Riccati weight (4, 4) of the chain of position to jerk, driven by a held snap."""
    A = np.array([[period ** (c - r) / _factorial(c - r) if c >= r else 0.0 for c in range(4)] for r in range(4)])
    B = np.array([[period ** (4 - r) / _factorial(4 - r)] for r in range(4)])
    return np.asarray(solve_discrete_are(A, B, W[:4, :4], W[4:, 4:]))


def _factorial(n: int) -> int:
    return 1 if n < 2 else n * _factorial(n - 1)
