"""The condensed prediction of an MPC: E = F e_0 + H V, the errors of all stages from the error now and the moves."""

from collections.abc import Sequence

import numpy as np
from scipy.linalg import block_diag

from idc_controller.arrays import Array
from idc_controller.errors import ParameterError

BLOCKS = (1, 1, 1, 2, 2, 3, 4, 6)
"""Stages over which each move is held, as far as the horizon reaches; beyond them the last goes on."""


def move_blocks(horizon: int) -> tuple[int, ...]:
    """Return blocks that sum to ``horizon`` stages: single stages first, then longer and longer ones."""
    blocks: list[int] = []
    while (rest := horizon - sum(blocks)) > 0:
        blocks.append(min(BLOCKS[min(len(blocks), len(BLOCKS) - 1)], rest))
    return tuple(blocks)


class CondensedPrediction:
    """Time-invariant matrices of e_k+1 = A e_k + B v for moves v that are held over ``blocks`` of stages."""

    def __init__(self, A: Array, B: Array, blocks: Sequence[int]) -> None:
        if not blocks or min(blocks) < 1:
            raise ParameterError(f"move blocks {tuple(blocks)} must be one stage or longer")
        self.A, self.B, self.blocks = A, B, tuple(blocks)
        (n, m), stages, moves = B.shape, sum(blocks), len(blocks)
        move_of_stage = np.repeat(np.arange(moves), blocks)
        self.first_stages = np.array([sum(blocks[:i]) for i in range(moves)])
        """Stage at which each move begins."""
        self.F = np.zeros((stages + 1, n, n))
        """(N_p + 1, n, n)"""
        self.H = np.zeros((stages + 1, n, moves * m))
        """(N_p + 1, n, moves m)"""
        self.F[0] = np.eye(n)
        for k, move in enumerate(move_of_stage):
            self.F[k + 1], self.H[k + 1] = A @ self.F[k], A @ self.H[k]
            self.H[k + 1][:, move * m : (move + 1) * m] += B

    def hessian(self, Q: Array, R: Array, Q_f: Array) -> Array:
        """Return the cost's Hessian (moves m, moves m) for weights of the errors, the moves and the last error."""
        P = block_diag(*(held * R for held in self.blocks))
        for H, weight in self._weighted(Q, Q_f):
            P += H.T @ weight @ H
        return np.asarray((P + P.T) / 2.0)

    def gradients(self, Q: Array, Q_f: Array) -> list[Array]:
        """Return, of stages 1 .. N_p, the gradient (moves m, n) of the cost by the error that no move would leave."""
        return [H.T @ weight for H, weight in self._weighted(Q, Q_f)]

    def _weighted(self, Q: Array, Q_f: Array) -> list[tuple[Array, Array]]:
        return [(H, Q_f if k == len(self.H) - 1 else Q) for k, H in enumerate(self.H) if k]
