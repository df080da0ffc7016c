"""The seam of the safety filter: where obstacle avoidance enters the controller, and what it tells of itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from idc_controller.estimation.estimate import Estimate
from idc_controller.model.drag import Air
from idc_controller.trajectory.flatness import PayloadTrajectory
from idc_controller.trajectory.trajectory import Trajectory

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SafetyReport:
    """What a safety filter did in its last step."""

    active: bool = False
    """It bent the mission's trajectory."""
    slack: float = 0.0
    """By how much the barrier is missed at worst over the plan (m)."""
    infeasible: bool = False
    """The programme had no solution and the plan before was kept."""
    programmes: int = 0
    """Quadratic programmes solved."""
    nearest: str = ""
    """Name of the obstacle with the least room; empty: none near."""
    lag: float = 0.0
    """How far the payload is behind the mission (m)."""
    clock_rate: float = 1.0
    """Of the mission's clock: 1 runs, 0 stands."""
    detours: int = 0
    """Ways round obstacles taken so far."""
    payload_bound: float | None = None
    """Deviation of the payload from its plan that the margins allow for (m); None: none is assumed."""
    uav_bound: float | None = None
    """The same of the UAVs."""


class SafetyFilter(Protocol):
    """Bends the mission's trajectory as far as safety asks, and no further."""

    report: SafetyReport
    """Of the last step."""

    def filter(self, time: float, mission: Trajectory, estimate: Estimate, air: Air | None = None) -> PayloadTrajectory:
        """The trajectory to track from ``time`` on; it also tells what was tracked before. ``air``: what is known."""
        ...

    def correct(self, time: float, u: Array, estimate: Estimate) -> Array:
        """The tracker's set-points (3 N,) that act at ``time``, changed where safety asks for it."""
        ...

    def mission_time(self, time: float) -> float:
        """The mission's clock at ``time`` (s): a filter that is held up lets it slow down."""
        ...

    def followed(self, time: float, mission: Trajectory) -> tuple[Trajectory, float]:
        """What is followed at ``time``, the mission or a way round something, and its clock (s)."""
        ...

    def blocked(self, time: float) -> str:
        """Why the mission cannot go on; empty: it can."""
        ...

    def replaced(self, time: float, clock: float) -> None:
        """The mission is replaced by another one, whose clock is at ``clock`` at ``time`` (s)."""
        ...


class NoObstacles:
    """The safety filter of a world without obstacles: the mission's own trajectory."""

    report = SafetyReport()

    def filter(self, time: float, mission: Trajectory, estimate: Estimate, air: Air | None = None) -> PayloadTrajectory:
        """``mission`` itself."""
        return mission

    def correct(self, time: float, u: Array, estimate: Estimate) -> Array:
        """``u`` itself."""
        return u

    def mission_time(self, time: float) -> float:
        """``time`` itself."""
        return time

    def followed(self, time: float, mission: Trajectory) -> tuple[Trajectory, float]:
        """The mission at ``time``."""
        return mission, time

    def blocked(self, time: float) -> str:
        """Never."""
        return ""

    def replaced(self, time: float, clock: float) -> None:
        """It has nothing to forget."""
