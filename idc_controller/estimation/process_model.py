"""How the filter's state moves on: the linear model, with what disturbs it as part of the state."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from idc_controller.model.linear import LinearModel

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ProcessNoise:
    """Densities of the white noise that drives what the model leaves out, each per square root of a second."""

    payload_acceleration: float = 0.003
    """m/s2"""
    payload_angular_acceleration: float = 0.003
    """rad/s2"""
    link_acceleration: float = 0.0015
    """1/s2"""
    uav_jerk: float = 1.0
    """Of the tilt's acceleration (1/s3)."""
    thrust: float = 0.012
    """N/s"""
    force: float = 0.05
    """Drift of the steady force on the payload (N/s)."""
    uav_force: float = 0.01
    """Drift of the steady force that is common to the UAVs (N/s)."""
    own_force: float = 0.01
    """Change of what each of them has besides, from one sample of its position and velocity to the next (N).

    One that believes in a wrong attitude pulls aside. Of one of which less is known nothing is learnt.
    """
    mass: float = 0.005
    """Drift of the payload's mass (kg/s)."""
    setpoint_loss: float = 0.005
    """Probability with which a set-point is reckoned to be lost on its way, at least; more where more are."""


class ProcessModel:
    """State of the linear model (12 + 11 N), then the forces of :class:`Load`: payload (3), UAVs (2 N), mass excess."""

    def __init__(self, model: LinearModel, densities: ProcessNoise) -> None:
        self.model, self.layout, self._densities = model, model.layout, densities
        n, N = self.layout.size, self.layout.number_of_uavs
        self.size = n + 3 + 2 * N + 1
        self.mass = self.size - 1
        self.force, self.uav_force = slice(n, n + 3), slice(n + 3, self.mass)
        self.forces = slice(n, self.mass)
        self._plain = lru_cache(maxsize=256)(self._discretised)
        self._noise = lru_cache(maxsize=256)(self._integrated)

    def transition(self, interval_us: int, acceleration: Array) -> tuple[Array, Array]:
        """F (n, n) and B (n, 3 N) over an interval (us), where the payload accelerates by ``acceleration`` (3,) (m/s2).

        An excess of mass acts along g e3 - a, which turns with the manoeuvre.
        """
        F, B, B_d = self._plain(interval_us)
        direction = np.array([0.0, 0.0, self.model.parameters.g]) - acceleration
        F = F.copy()
        F[: self.layout.size, self.mass] = B_d[:, :3] @ direction
        return F, B

    def noise(self, interval_us: int, restlessness: float) -> Array:
        """Covariance (n, n) that an interval (us) adds; ``restlessness`` multiplies the noise of the forces."""
        return self._noise(interval_us, restlessness)

    def own_noise(self, seen: NDArray[np.int_]) -> Array:
        """Variances (n,) that samples of the UAVs ``seen`` (K,) leave room for in their own forces."""
        added = np.zeros(self.size)
        added[self.uav_force].reshape(-1, 2)[seen] = self._densities.own_force**2
        return added

    def doubt_noise(self, B: Array, change: Array, doubt: Array) -> Array:
        """Covariance (n, n) that set-points add which may not act yet, or never.

        Each vehicle flies the one before, that differs by ``change`` (3 N,), with probability ``doubt`` (N,).
        """
        N = self.layout.number_of_uavs
        error = B * (change * np.sqrt(np.concatenate([np.repeat(doubt, 2), doubt])))
        tilts = error[:, : 2 * N].reshape(-1, N, 2).sum(axis=2)
        lost = np.hstack([tilts, error[:, 2 * N :]])
        return np.asarray(lost @ lost.T)

    def uav_forces(self, common: float, own: float) -> Array:
        """Covariance (2 N, 2 N) of forces on the UAVs that have a ``common`` and an ``own`` standard deviation (N)."""
        N = self.layout.number_of_uavs
        return np.asarray(np.kron(common**2 * np.ones((N, N)) + own**2 * np.eye(N), np.eye(2)))

    def _discretised(self, interval_us: int) -> tuple[Array, Array, Array]:
        n = self.layout.size
        A_k, B_k, B_dk = self.model.discretised(interval_us)
        F = np.eye(self.size)
        F[:n, :n], F[:n, self.forces] = A_k, B_dk
        return F, np.vstack([B_k, np.zeros((self.size - n, self.layout.inputs))]), B_dk

    def _integrated(self, interval_us: int, restlessness: float) -> Array:
        """Van Loan's integral of the process noise."""
        p, layout, n = self._densities, self.layout, self.layout.size
        density = np.zeros(self.size)
        density[layout.v_0] = p.payload_acceleration
        density[layout.omega] = p.payload_angular_acceleration
        density[layout.s_dot] = p.link_acceleration
        density[layout.n_acc] = p.uav_jerk
        density[layout.f] = p.thrust
        density[self.force], density[self.mass] = restlessness * p.force, p.mass
        covariance = np.diag(density**2)
        covariance[self.uav_force, self.uav_force] = self.uav_forces(restlessness * p.uav_force, 0.0)
        A = np.zeros((self.size, self.size))
        A[:n, :n], A[:n, self.forces] = self.model.A, self.model.B_d
        A[:n, self.mass] = self.model.B_d[:, 2] * self.model.parameters.g
        dt = interval_us * 1e-6
        m = self.size
        block = np.zeros((2 * m, 2 * m))
        block[:m, :m], block[:m, m:], block[m:, m:] = -A, covariance, A.T
        big = expm(block * dt)
        Q = big[m:, m:].T @ big[:m, m:]
        return (Q + Q.T) / 2
