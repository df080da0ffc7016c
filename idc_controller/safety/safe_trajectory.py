"""The trajectory that the safety filter returns: plans one after the other, each a deviation from its reference."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array
from idc_controller.trajectory.integrator_chain import Chain
from idc_controller.trajectory.trajectory import ScaledReference, Times, Trajectory
from idc_controller.trajectory.trajectory_kernels import deflect, progress

_NO_STATES = np.zeros((0, 5, 3))


class Piece(NamedTuple):
    """One plan, from the reference's start on."""

    reference: ScaledReference
    deviation: Array | None
    """States of the deviation at the stages (K + 1, 5, 3), SI; None: none."""


class SafeTrajectory:
    """The trajectory to track: pieces, each in force until the next."""

    def __init__(self, pieces: Sequence[Piece], chain: Chain) -> None:
        self._chain = chain
        numbers: dict[Trajectory, int] = {}
        followed: list[int] = []
        scalings: list[float] = []
        rows: list[int] = []
        deviations: list[Array] = []
        for reference, deviation in pieces:
            followed.append(numbers.setdefault(reference.trajectory, len(numbers)))
            scalings += reference.start, reference.progress, reference.rate
            rows.append(-1 if deviation is None else len(deviations) * (chain.stages + 1))
            if deviation is not None:
                deviations.append(deviation)
        # Pieces that follow the same trajectory are evaluated together.
        self._followed, self._trajectories = np.array(followed), list(numbers)
        self._scalings, self._rows = np.array(scalings, dtype=float).reshape(-1, 3), np.array(rows)
        self._states = np.concatenate(deviations) if deviations else _NO_STATES
        self._is_changed = bool(deviations) or scalings[2::3] != [1.0] * len(rows)

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
