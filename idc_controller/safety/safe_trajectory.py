"""The trajectory that the safety filter returns: plans one after the other, each a deviation from its reference."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from idc_controller.arrays import Array
from idc_controller.trajectory.integrator_chain import Chain
from idc_controller.trajectory.scaled import ScaledReference


@dataclass(frozen=True, eq=False)
class Piece:
    """One plan, from the reference's start on."""

    reference: ScaledReference
    deviation: Array | None
    """States of the deviation at the stages (K + 1, 5, 3), SI; None: none."""

    @property
    def start(self) -> float:
        """Time at which the plan begins (s)."""
        return self.reference.start


class SafeTrajectory:
    """The trajectory to track: pieces, each in force until the next."""

    def __init__(self, pieces: Sequence[Piece], chain: Chain) -> None:
        self._pieces, self._chain = pieces, chain
        self._starts = np.array([piece.start for piece in pieces[1:]])

    def derivatives(self, times: Array, order: int = 4) -> Array:
        """Return position to the derivative ``order`` (order + 1, K, 3), NED, SI, at ``times`` (K,) (s)."""
        times = np.asarray(times, dtype=float)
        found, which = np.unique(np.searchsorted(self._starts, times, side="right"), return_inverse=True)
        return _evaluate([self._pieces[i] for i in found], which, self._chain, times)[: order + 1]


def evaluate(piece: Piece, chain: Chain, times: Array) -> Array:
    """Return position to snap (5, K, 3), NED, SI, of one piece at ``times`` (K,) (s)."""
    return _evaluate([piece], np.zeros(len(times), dtype=int), chain, times)


def _evaluate(pieces: Sequence[Piece], which: NDArray[np.int_], chain: Chain, times: Array) -> Array:
    """Position to snap (5, K, 3): each of ``times`` on the piece whose number is in ``which`` (K,)."""
    references = [piece.reference for piece in pieces]
    start, progress, rate = np.array([(r.start, r.progress, r.rate) for r in references])[which].T
    elapsed = times - start
    progress = progress + rate * elapsed
    result = np.empty((5, len(times), 3))
    # Each trajectory is evaluated once: it costs much the same for one time and for many.
    for trajectory in {id(r.trajectory): r.trajectory for r in references}.values():
        follows = np.array([r.trajectory is trajectory for r in references])[which]
        result[:, follows] = trajectory.derivatives(progress[follows], 4)
    if np.any(rate != 1.0):
        result *= (rate ** np.arange(5)[:, None])[..., None]
    deviations = [piece.deviation for piece in pieces if piece.deviation is not None]
    if deviations:
        deflected = np.array([piece.deviation is not None for piece in pieces])
        row = (chain.stages + 1) * (np.cumsum(deflected) - 1)
        at = np.flatnonzero(deflected[which])
        states = np.concatenate(deviations)
        result[:, at] += chain.evaluate(states, np.maximum(elapsed[at], 0.0), row[which[at]])
    return result
