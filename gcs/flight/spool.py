"""The payload on the ground, while the thrust grows and it lifts off, and after the flight, while it fades."""

import numpy as np

from gcs.config.flight_settings import TakeoffLandingSettings
from idc_controller.arrays import Array
from idc_controller.estimation.grounded_links import S_DOT, LinkStates, S
from idc_controller.parameters import SystemParameters
from idc_controller.trajectory.trajectory import Trajectory


def lifted_mass(p: SystemParameters, settings: TakeoffLandingSettings, thrusts: Array, risen: float) -> float:
    """Return the mass (kg) of a payload that has ``risen`` (m) while the ``thrusts`` (N,) (N) still grow.

    Since the lift-off, t ago, the thrust has grown by its rate times t, and lifted by rate / mass t^3 / 6.
    """
    lift, rate = float(thrusts.sum()), float(p.hover_thrust.sum()) / settings.spool_up_time
    total = lift / p.g
    for _ in range(5):
        total = (lift - rate * (6.0 * risen * total / rate) ** (1.0 / 3.0)) / p.g
    return total - float(p.m.sum())


class Touchdown:
    """The payload at rest where it touched down, and the spool-down, which waits until leaning links are upright.

    First the ground takes the payload's weight over, all but a share of it that keeps the links taut. A UAV that bears
    less than its own weight falls with its link, if that leans: this begins only when no link does, or after a timeout.
    """

    def __init__(
        self, trajectory: Trajectory, yaw: float, time: float, own_weights: Array, settings: TakeoffLandingSettings
    ) -> None:
        """``trajectory``: rest where it touched down at ``time`` (s); ``yaw`` in rad; ``own_weights`` (N,) (N)."""
        self.trajectory, self.yaw = trajectory, yaw
        self._begin, self._own, self._settings = time, own_weights, settings
        self._upright_at: float | None = None

    def thrusts(self, time: float, hover: Array, links: LinkStates) -> Array:
        """Return the thrusts (N,) at ``time`` (s) of UAVs that need ``hover`` (N,) (N) with the payload in the air."""
        s = self._settings
        carried = max(1.0 - (time - self._begin) / s.unload_time, s.carried_share)
        standing = self._own + carried * np.maximum(hover - self._own, 0.0)
        if carried > s.carried_share:
            return np.asarray(standing)
        if self._upright_at is None:
            lean = max(np.abs(links.x[S]).max(), s.lean_time * np.abs(links.x[S_DOT]).max())
            if lean > s.upright_lean and time - self._begin < s.upright_timeout:
                return np.asarray(standing)
            self._upright_at = time
        return np.maximum(standing - (time - self._upright_at) / s.spool_down_time * hover, 0.0)
