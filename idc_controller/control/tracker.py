"""The interface of a tracking controller: any tracker can take the MPC's place."""

from typing import NamedTuple, Protocol

from idc_controller.arrays import Array
from idc_controller.trajectory.flatness import FlatReference


class TrackingOutput(NamedTuple):
    """Set-points of a tracker, and how they came about."""

    delta_u: Array
    """Set-points less the reference's, in force components (3 N,): :mod:`idc_controller.control.force_components`."""
    iterations: int = 0
    """Solver iterations; 0 when no constraint was active."""
    infeasible: bool = False
    """The constraints could not be met and a fall-back was taken."""


class Tracker(Protocol):
    """Turns the error about a reference into set-points."""

    horizon: int
    """Number N_p of the last stage of the reference that it needs."""

    def track(self, error: Array, reference: FlatReference) -> TrackingOutput:
        """``error`` (12 + 11 N,) now, ``reference`` over the horizon's stages 0 .. N_p."""
        ...
