"""The interface of a safety filter, what it reports, and the filter of a world without obstacles."""

import math
from typing import NamedTuple, Protocol

from idc_controller.arrays import Array
from idc_controller.estimation.measurements import Estimate
from idc_controller.trajectory.flatness import PayloadTrajectory
from idc_controller.trajectory.trajectory import ScaledReference


class SafetyReport(NamedTuple):
    """Outcome of a safety filter's last plan."""

    deviation: Array | None = None
    """States of the plan's deviation from the reference at the stages (K + 1, 5, 3), SI; None: not deflected."""
    slack: float = 0.0
    """Largest violation of the barrier over the plan (m)."""
    standing_slack: float = 0.0
    """The same of obstacles that stand (m)."""
    infeasible: bool = False
    """No QP had a solution: the safest of the plan in force and of stops is flown."""
    clearance: float = math.inf
    """Least distance of the plan from obstacles, less their growth, by exact distances up to the margin (m)."""
    verified: bool = True
    """By these the plan keeps the margin."""
    qp_count: int = 0
    """QPs solved."""
    nearest: str = ""
    """Name of the obstacle with the least clearance; empty: none near."""
    lag: float = 0.0
    """Lag of the plan behind the reference along its path (m)."""
    payload_bound: float | None = None
    """Deviation of the payload from its plan that the margins allow for (m); None: none is assumed."""
    uav_bound: float | None = None
    """Deviation of the UAVs that the margins allow for (m)."""

    @property
    def active(self) -> bool:
        """Return True if the reference was deflected."""
        return self.deviation is not None


class SafetyFilter(Protocol):
    """Deflects the reference as far as safety demands, and no further."""

    report: SafetyReport
    """Outcome of the last step."""

    def start(self) -> None:
        """Begin anew with the next step, at rest on the ground: nothing is tracked any more."""
        ...

    def filter(self, time: float, reference: ScaledReference, estimate: Estimate) -> PayloadTrajectory:
        """Return the trajectory to track from ``time`` (s) on; before that it is what was tracked."""
        ...

    def correct(self, time: float, u: Array, estimate: Estimate) -> Array:
        """Return the tracker's set-points ``u`` (3 N,) that act at ``time`` (s), changed where safety demands it."""
        ...


class NoObstacles:
    """The safety filter of a world without obstacles."""

    report = SafetyReport()

    def start(self) -> None:
        """Do nothing: it has no memory."""

    def filter(self, time: float, reference: ScaledReference, estimate: Estimate) -> PayloadTrajectory:
        """Return ``reference`` itself."""
        return reference

    def correct(self, time: float, u: Array, estimate: Estimate) -> Array:
        """Return ``u`` itself."""
        return u
