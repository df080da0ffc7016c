"""The trajectory that the safety filter returns: plans one after the other, each a deviation from its reference."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import count

import numpy as np

from idc_controller.arrays import Array
from idc_controller.trajectory.integrator_chain import Chain
from idc_controller.trajectory.scaled import ScaledReference
from idc_controller.trajectory.trajectory import Times, Trajectory
from idc_controller.trajectory.trajectory_kernels import deflect, progress


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
        self._chain = chain
        # Pieces that follow the same trajectory are evaluated together.
        numbers: dict[Trajectory, int] = {}
        references = [piece.reference for piece in pieces]
        self._followed = np.array([numbers.setdefault(r.trajectory, len(numbers)) for r in references])
        self._trajectories = list(numbers)
        self._scalings = np.array([(r.start, r.progress, r.rate) for r in references], dtype=float)
        deviations = [piece.deviation for piece in pieces if piece.deviation is not None]
        rows = count(0, chain.stages + 1)
        self._rows = np.array([-1 if piece.deviation is None else next(rows) for piece in pieces])
        self._states = np.concatenate(deviations) if deviations else np.zeros((0, 5, 3))
        self._is_changed = bool(deviations) or any(r.rate != 1.0 for r in references)

    def derivatives(self, times: Array, order: int = 4) -> Array:
        """Return position to the derivative ``order`` (order + 1, K, 3), NED, SI, at ``times`` (K,) (s)."""
        times = np.ascontiguousarray(times, dtype=float)
        which, along, *span = progress(self._scalings, times)
        if len(self._trajectories) == 1 and len(times):
            result = self._trajectories[0].evaluate(Times(along, *span).checked(), order)
        else:
            result = np.empty((order + 1, len(times), 3))
            followed = self._followed[which]
            for number, trajectory in enumerate(self._trajectories):
                result[:, followed == number] = trajectory.derivatives(along[followed == number], order)
        if self._is_changed:
            deflect(
                result, times, which, self._scalings, self._rows, self._states, self._chain.period, self._chain.stages
            )
        return result
