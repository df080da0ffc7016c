"""The interface of a constraint on the state: rows G e <= h on the error about the reference (eq:stateCon)."""

import numpy as np
from numpy.typing import NDArray

from idc_controller.arrays import Array, Indices
from idc_controller.trajectory.flatness import FlatReference


class StateConstraint:
    """Soft rows, the same at every constrained stage, with bounds that may move with the reference."""

    G: Array
    """Rows on the error (c, 12 + 11 N), in force components."""
    slack: NDArray[np.int_]
    """Index of the constraint's own slack, from 0, by which each row may be exceeded (c,)."""

    limits: Array
    """Bounds of the rows (c,) where the reference uses nothing of them."""

    def used(self, reference: FlatReference, stages: Indices) -> Array | None:
        """Return what the reference uses of the limits at ``stages`` (S, c); None: nothing, wherever it leads."""
        return None
