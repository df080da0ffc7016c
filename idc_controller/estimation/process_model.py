"""Process model of the filter: the linear model, with its disturbances as part of the state."""

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from idc_controller.arrays import Array, Indices, Mask
from idc_controller.estimation.dynamics_kernels import Bodies, nonlinear_part
from idc_controller.estimation.health.attitude_steps import AttitudeStep, step_response
from idc_controller.estimation.kalman_filter import SparseRows, Transition
from idc_controller.estimation.propagation_kernels import add_variances
from idc_controller.estimation.settings import CovarianceResetSettings, InitialCovarianceSettings, ProcessNoiseSettings
from idc_controller.model.drag import BOX_DRAG
from idc_controller.model.linear import LinearModel
from idc_controller.trajectory.flatness import Load

_TERMS = 24
"""Of the series; within :attr:`IntegratedNoise.duration_max` the next one is 2^24 / 25! of the first, 1e-18."""


class IntegratedNoise:
    """Integral of exp(A s) C exp(A' s) over s from 0 to t, where C is a weighted sum of power spectral densities.

    It is the sum of t^k / k! M_k with M_1 = C and M_(k+1) = A M_k + M_k A'.
    """

    def __init__(self, A: Array, densities: Sequence[Array]) -> None:
        """Take the matrix ``A`` (n, n) of the model and the ``densities`` (P), (n, n) each."""
        self.duration_max = 1.0 / float(np.abs(np.linalg.eigvals(A)).max())
        """Up to which the series is exact to the digit (s)."""
        terms = [np.stack(densities)]
        for k in range(2, _TERMS + 1):
            product = A @ terms[-1]
            terms.append((product + product.transpose(0, 2, 1)) / k)
        self._terms = np.stack(terms)  # (K, P, n, n)

    def covariance(self, duration: float, weights: Sequence[float]) -> Array:
        """Return the integral (n, n) over a ``duration`` (s), with ``weights`` (P) of the densities."""
        factors = np.outer(duration ** np.arange(1, _TERMS + 1), weights)
        return np.tensordot(factors, self._terms, axes=2)


class ProcessModel:
    """State of the linear model (12 + 11 N), then the forces of :class:`Load`: payload (3), UAVs (2 N), mass excess."""

    def __init__(self, model: LinearModel, densities: ProcessNoiseSettings) -> None:
        self.model, self.layout, self._densities = model, model.layout, densities
        n, N = self.layout.size, self.layout.number_of_uavs
        self.size = n + 3 + 2 * N + 1
        self.mass = self.size - 1
        self.force, self.uav_force = slice(n, n + 3), slice(n + 3, self.mass)
        self.forces = slice(n, self.mass)
        p, layout = model.parameters, self.layout
        moving = np.r_[layout.v_0, layout.omega, layout.s_dot]
        self._moving = np.hstack([model.A[moving], model.B_d[moving], np.zeros((len(moving), 1))])
        self._moved = np.ascontiguousarray(model.B_d[moving, :3])
        J_0, places, l, m = (np.ascontiguousarray(part, dtype=float) for part in (p.J_0, p.p, p.l, p.m))
        self._bodies = Bodies(float(p.m_0), J_0, places, l, m, float(p.g))
        payload_area = BOX_DRAG * 4.0 / math.pi * float(np.mean(p.payload.areas[:2]))  # mean of all directions of wind
        self.drag_share = densities.uav_drag_area / payload_area
        """Drag of a UAV over the payload's."""
        self._uav_columns = self._columns_of_uavs()
        self._noise = self._noise_of(densities)
        self.transition = lru_cache(maxsize=256)(self._discretised)
        self.noise = lru_cache(maxsize=256)(self._integrated_noise)

    def forces_of(self, load: Load | None) -> Array:
        """Return constant forces and mass excess (3 + 2 N + 1,) of ``load``; zero without one."""
        N, forces = self.layout.number_of_uavs, np.zeros(self.size - self.layout.size)
        if load is not None:
            forces[:3], forces[-1] = load.force, load.mass - self.model.parameters.m_0
            forces[3:-1] = np.broadcast_to(load.uav_force, (N, 3))[:, :2].ravel()
        return forces

    def force_of_mass(self, acceleration: Array) -> Array:
        """Return the force (..., 3) of one kilogram of excess of mass at an ``acceleration`` of the payload (..., 3).

        It acts along g e3 - a, which follows the manoeuvre (m/s2).
        """
        return np.array([0.0, 0.0, self.model.parameters.g]) - acceleration

    def nonlinear_part(self, error: Array, nominal: Array, direction: Array, interval_us: int) -> Array:
        """Return what the linear model of an ``error`` (n,) leaves out of its change (n,) over an interval (us).

        ``nominal``: state of the reference (n,). ``direction``: see :meth:`force_of_mass`.
        """
        return nonlinear_part(
            error, nominal, self._moving, self._moved, direction, self._bodies, interval_us * 1e-6
        )  # fmt: skip

    def add_per_vehicle_noise(self, P: Array, measured: Indices) -> None:
        """Add variances to the disturbance forces in ``P`` (n, n) of the UAVs ``measured`` (K,), between samples.

        A UAV with a wrong attitude estimate pulls aside. The force of one that is not measured is not adapted.
        """
        add_variances(P, self.uav_force.start, measured, self._densities.per_vehicle_force**2)

    def initial_covariance(self, settings: InitialCovarianceSettings) -> Array:
        """Return the covariance (n, n) of the whole state of a team on the ground."""
        layout = self.layout
        sigma = np.empty(self.size)
        sigma[layout.r_0], sigma[layout.v_0] = settings.position, settings.velocity
        sigma[layout.Theta], sigma[layout.omega] = settings.attitude, settings.rates
        sigma[layout.s], sigma[layout.s_dot] = settings.link, settings.link_rate
        sigma[layout.n], sigma[layout.n_dot] = settings.thrust_direction, settings.thrust_direction_rate
        sigma[layout.n_acc] = settings.thrust_direction_acceleration
        sigma[layout.f] = settings.thrust
        sigma[self.force], sigma[self.mass] = settings.force, settings.mass
        sigma[self.uav_force] = 0.0
        P = np.diag(sigma**2)
        P[self.uav_force, self.uav_force] = self.uav_forces(settings.uav_force, settings.per_vehicle_force)
        return P

    def covariance_reset(self, P: Array, settings: CovarianceResetSettings) -> Array:
        """Return what is added (n, n) to ``P`` (n, n) where most measurements contradict the prediction.

        A blow or a gust changes velocities and forces, not positions; added at every moment at which they do.
        """
        layout, force = self.layout, self.force
        added = np.zeros(self.size)
        added[layout.v_0], added[layout.omega] = settings.velocity**2, settings.rates**2
        added[layout.s_dot] = settings.link_rate**2
        return np.diag(added) + self._of_wind(np.maximum(settings.force**2 - np.diag(P)[force], 0.0))

    def _of_wind(self, variances: Array) -> Array:
        """Return the covariance (n, n) of a force on the payload with ``variances`` (3,) that the wind makes.

        The same wind pushes the UAVs, each by its own drag area.
        """
        N, carried = self.layout.number_of_uavs, np.zeros((self.size, 3))
        carried[self.force] = np.eye(3)
        carried[self.uav_force, :2] = self.drag_share * np.tile(np.eye(2), (N, 1))
        return np.asarray(carried * variances @ carried.T)

    def attitude_step(self, step: AttitudeStep) -> tuple[Array, Array]:
        """Return what a ``step`` adds to the state (n,) and to its covariance (n, n) at its first sample.

        The UAV's attitude is off by it, its thrust is not: that is a force of its own. Since a moment in the interval
        before the sample it turns against the step.
        """
        p, layout, i, size = self.model.parameters, self.layout, step.uav, float(np.linalg.norm(step.angle))
        _, rate, acceleration = step_response(p, 0.5 * step.interval)
        _, rate_range, acceleration_range = 0.5 * size * step_response(p, step.interval)
        moved, covariance = np.zeros((2, self.size)), np.zeros((self.size, self.size))
        for axis in (0, 1):
            n, n_dot, n_acc = (part.start + 2 * i + axis for part in (layout.n, layout.n_dot, layout.n_acc))
            force = self.uav_force.start + 2 * i + axis
            moved[axis, [n, n_dot, n_acc, force]] = 1.0, rate, acceleration, -p.hover_thrust[i]
            covariance[n_dot, n_dot], covariance[n_acc, n_acc] = rate_range**2, acceleration_range**2
        return step.angle @ moved, covariance + step.deviation**2 * moved.T @ moved

    def uav_forces(self, common: float, own: float) -> Array:
        """Return the covariance (2 N, 2 N) of level forces on the UAVs.

        ``common`` and ``own``: standard deviations (N) of the part common to all, and of each UAV's own.
        """
        N = self.layout.number_of_uavs
        return np.asarray(np.kron(common**2 * np.ones((N, N)) + own**2 * np.eye(N), np.eye(2)))

    def _discretised(self, interval_us: int) -> Transition:
        """Return the transition over an interval (us)."""
        n = self.layout.size
        A_k, B_k, B_dk = self.model.discretised(interval_us)
        F = np.eye(self.size)
        F[:n, :n], F[:n, self.forces] = A_k, B_dk
        B = np.vstack([B_k, np.zeros((self.size - n, self.layout.inputs))])
        columns, filled = self._uav_columns
        moved = self.size - len(columns)
        sparse = SparseRows(columns, filled * F[np.arange(moved, self.size)[:, None], columns])
        return Transition(F[:moved], B_dk[:moved, :3].copy(), sparse, B)

    def _columns_of_uavs(self) -> tuple[Indices, Mask]:
        """Return the columns (R, 3) of the elements in the rows below payload and links, and which of them count.

        Three states of each tilt go by themselves, and so does each thrust, each force and the mass. What a matrix
        exponential leaves elsewhere in these rows is rounding.
        """
        layout, N = self.layout, self.layout.number_of_uavs
        tilts = np.tile(layout.n.start + np.arange(2 * N)[:, None] + 2 * N * np.arange(3), (3, 1))
        alone = np.repeat(np.arange(layout.f.start, self.size)[:, None], 3, axis=1)
        filled = np.ones((len(tilts) + len(alone), 3), dtype=bool)
        filled[len(tilts) :, 1:] = False
        return np.vstack([tilts, alone]), filled

    def _integrated_noise(self, interval_us: int, force_scale: float) -> Array:
        """Return the covariance (n, n) that an interval (us) adds; ``force_scale``: of the forces' noise."""
        duration = interval_us * 1e-6
        if duration <= self._noise.duration_max:
            return self._noise.covariance(duration, (1.0, force_scale**2))
        half = interval_us // 2
        F = self.transition(half).F(self.force_of_mass(np.zeros(3)))
        return np.asarray(F @ self.noise(interval_us - half, force_scale) @ F.T + self.noise(half, force_scale))

    def _noise_of(self, p: ProcessNoiseSettings) -> IntegratedNoise:
        """Return the noise of all but the forces, and that of the forces."""
        layout, n = self.layout, self.layout.size
        density = np.zeros(self.size)
        density[layout.v_0] = p.payload_acceleration
        density[layout.omega] = p.payload_angular_acceleration
        density[layout.s_dot] = p.link_acceleration
        density[layout.n_acc] = p.uav_jerk
        density[layout.f] = p.thrust
        density[self.mass] = p.mass
        of_forces = self._of_wind(np.full(3, p.force**2))
        of_forces[self.uav_force, self.uav_force] += self.uav_forces(p.uav_force, 0.0)
        A = np.zeros((self.size, self.size))
        A[:n, :n], A[:n, self.forces] = self.model.A, self.model.B_d
        A[:n, self.mass] = self.model.B_d[:, 2] * self.model.parameters.g
        return IntegratedNoise(A, (np.diag(density**2), of_forces))
