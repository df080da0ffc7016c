"""The flat chain, discretised: position to snap of one axis over stages, driven by knots of a piecewise linear snap.

A snap that is linear between knots keeps the planned trajectory four times continuously differentiable, as the flat
reference needs it: the UAVs' thrusts follow the snap directly.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from idc_controller.arrays import Array


@dataclass(frozen=True)
class Chain:
    """Stages of ``period`` (s), knots after ``blocks`` stages each."""

    period: float
    blocks: tuple[int, ...]

    @property
    def stages(self) -> int:
        """Number of stages, K."""
        return sum(self.blocks)

    @property
    def knots(self) -> int:
        """Number of free knots of the snap."""
        return len(self.blocks)

    @cached_property
    def times(self) -> Array:
        """Times of the stages 0 .. K (s)."""
        return self.period * np.arange(self.stages + 1, dtype=np.float64)

    @cached_property
    def snap_of_stage(self) -> tuple[Array, Array]:
        """Snap at stages 0 .. K as ``first * s_0 + others @ knots``: (K + 1,), (K + 1, knots)."""
        first, others = np.zeros(self.stages + 1), np.zeros((self.stages + 1, self.knots))
        begin = 0
        for b, length in enumerate(self.blocks):
            for k in range(begin, begin + length + 1):
                share = (k - begin) / length
                others[k, b] = share
                if b:
                    others[k, b - 1] = 1.0 - share
                else:
                    first[k] = 1.0 - share
            begin += length
        return first, others

    @cached_property
    def response(self) -> tuple[Array, Array]:
        """``Phi`` (K + 1, 5, 5) and ``Gamma`` (K + 1, 5, knots): (r, v, a, j, s) at a stage = Phi y_0 + Gamma z."""
        h, K = self.period, self.stages
        first, others = self.snap_of_stage
        # One stage, with the snap linear from s_k to s_k+1.
        A = np.array([[h ** (c - r) / math.factorial(c - r) if c >= r else 0.0 for c in range(4)] for r in range(4)])
        from_snap = np.empty((4, 2))
        for r in range(4):
            d = 4 - r
            ramp = h**d / math.factorial(d + 1)  # h^(d+1) / (d+1)! of a crackle (s' - s) / h
            from_snap[r] = h**d / math.factorial(d) - ramp, ramp
        Phi, Gamma = np.zeros((K + 1, 5, 5)), np.zeros((K + 1, 5, self.knots))
        Phi[0, :4, :4] = np.eye(4)
        Phi[:, 4, 4], Gamma[:, 4] = first, others
        for k in range(K):
            Phi[k + 1, :4] = A @ Phi[k, :4] + from_snap @ Phi[k : k + 2, 4]
            Gamma[k + 1, :4] = A @ Gamma[k, :4] + from_snap @ Gamma[k : k + 2, 4]
        return Phi, Gamma

    def roll_out(self, start: Array, knots: Array) -> Array:
        """States at all stages (K + 1, 5, 3) from ``start`` (5, 3) and snap ``knots`` (knots, 3)."""
        Phi, Gamma = self.response
        return Phi @ start + Gamma @ knots
