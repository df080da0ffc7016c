"""How far the filter doubts its own state: at the start, and when sound measurements contradict it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from idc_controller.estimation.process_model import ProcessModel

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FirstDoubt:
    """What is not known of a team that stands on the ground. Standard deviations of what no sensor tells."""

    mass: float = 0.2
    """Of the payload, about its nominal one (kg)."""
    force: float = 0.3
    """Of the steady force on the payload (N)."""
    uav_force: float = 0.05
    """Of the one that is common to the UAVs (N)."""
    own_force: float = 0.05
    """Of what each of them has besides (N)."""

    def covariance(self, process: ProcessModel) -> Array:
        """(n, n), of the whole state."""
        layout = process.layout
        sigma = np.empty(process.size)
        sigma[layout.r_0], sigma[layout.v_0] = 0.05, 0.02
        sigma[layout.Theta], sigma[layout.omega] = 0.02, 0.02
        sigma[layout.s], sigma[layout.s_dot] = 0.02, 0.02
        sigma[layout.n], sigma[layout.n_dot], sigma[layout.n_acc] = 0.03, 0.1, 0.3
        sigma[layout.f] = 0.5
        sigma[process.force], sigma[process.mass] = self.force, self.mass
        sigma[process.uav_force] = 0.0
        P = np.diag(sigma**2)
        P[process.uav_force, process.uav_force] = process.uav_forces(self.uav_force, self.own_force)
        return P


@dataclass(frozen=True)
class Surprise:
    """What is doubted of a prediction that sound measurements contradict: what a blow or a gust changes, no position.

    Standard deviations, added at every moment at which they still contradict it.
    """

    velocity: float = 0.1
    """Of the payload (m/s)."""
    rates: float = 0.1
    """Of the payload (rad/s)."""
    link_rate: float = 0.03
    """1/s"""
    force: float = 3.0
    """Of the steady force (N); also the most that it is doubted."""

    def covariance(self, process: ProcessModel, P: Array) -> Array:
        """(n, n), to be added to ``P`` (n, n)."""
        layout, force = process.layout, process.force
        added = np.zeros(process.size)
        added[layout.v_0], added[layout.omega] = self.velocity**2, self.rates**2
        added[layout.s_dot] = self.link_rate**2
        added[force] = np.maximum(self.force**2 - np.diag(P)[force], 0.0)
        return np.diag(added)
