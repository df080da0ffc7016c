"""Motion of an obstacle by an interacting multiple model (IMM) filter: a Kalman filter for each motion model.

All models share the state (position, velocity, acceleration) on each of the three axes, and differ in how it goes on:

- *static*;
- *constant velocity*, and *constant acceleration for a while* (Singer 1970), the latter slow and fast;
- *harmonic* at several frequencies: x''' = -omega^2 x', a swing about a centre that the state implies.

They interact as in Blom and Bar-Shalom (1988). The axes are filtered separately, with a model's weight in common.
``filterpy`` has the same filters one at a time; here all models and axes are steps of one kernel
(:mod:`idc_controller.perception.imm_kernels`), since there are many obstacles and little time. The tests compare a
single model with ``filterpy``, and all of them with the formulas in numpy.
"""

from functools import lru_cache

import numpy as np

from idc_controller.arrays import Array
from idc_controller.perception.imm_kernels import advanced, predicted, updated
from idc_controller.perception.settings import ImmSettings


class MotionModels:
    """Transition and process noise of all M models, for arrays of time steps."""

    def __init__(self, settings: ImmSettings = ImmSettings()) -> None:
        self.settings = settings
        harmonic = 2 + len(settings.singer_times)
        self.count = harmonic + len(settings.frequencies)
        self._singer, self._harmonic = slice(2, harmonic), slice(harmonic, self.count)
        self._sigma = np.array(settings.singer_accelerations)
        self._tau = np.array(settings.singer_times)
        self._omega = np.array(settings.frequencies)
        self._at = lru_cache(maxsize=500)(self._transition_and_noise)

    def transition(self, dt: Array) -> Array:
        """Return F (M, K, 3, 3) over the times ``dt`` (K,) (s), on (position, velocity, acceleration)."""
        dt = np.asarray(dt, dtype=float)
        F = np.zeros((self.count, len(dt), 3, 3))
        F[:, :, 0, 0] = 1.0
        F[1:, :, 1, 1] = 1.0
        F[1, :, 0, 1] = dt
        tau, t = self._tau[:, None], dt[None, :]
        decay = np.exp(-t / tau)
        part = F[self._singer]
        part[..., 0, 1] = t
        part[..., 0, 2] = tau**2 * (decay - 1.0 + t / tau)
        part[..., 1, 2] = tau * (1.0 - decay)
        part[..., 2, 2] = decay
        omega = self._omega[:, None]
        sine, cosine = np.sin(omega * t), np.cos(omega * t)
        part = F[self._harmonic]
        part[..., 0, 1], part[..., 0, 2] = sine / omega, (1.0 - cosine) / omega**2
        part[..., 1, 1], part[..., 1, 2] = cosine, sine / omega
        part[..., 2, 1], part[..., 2, 2] = -omega * sine, cosine
        return F

    def noise(self, dt: Array) -> Array:
        """Return Q (M, K, 3, 3) accumulated over the times ``dt`` (K,) (s)."""
        dt = np.asarray(dt, dtype=float)
        s = self.settings
        Q = np.zeros((self.count, len(dt), 3, 3))
        Q[0, :, 0, 0] = s.static_walk**2 * dt
        q = s.velocity_walk**2
        Q[1, :, 0, 0], Q[1, :, 1, 1] = q * dt**3 / 3.0, q * dt
        Q[1, :, 0, 1] = Q[1, :, 1, 0] = q * dt**2 / 2.0
        # White noise on the jerk, by the midpoint of its effect over ten parts: exact enough for smooth kernels.
        share = (np.arange(10) + 0.5) / 10.0
        kernel = self.transition(np.outer(dt, share).ravel())[2:, :, :, 2]
        kernel = kernel.reshape(self.count - 2, len(dt), 10, 3)
        q_jerk = np.concatenate([2.0 * self._sigma**2 / self._tau, (s.harmonic_walk * self._omega) ** 2])
        weight = q_jerk[:, None] * dt[None, :] / 10.0
        Q[2:] = np.einsum("mkia,mkib,mk->mkab", kernel, kernel, weight)
        return Q

    def step(self, dt: float) -> tuple[Array, Array]:
        """Return F and Q (M, 3, 3) over one step (s); cached, since steps repeat."""
        F, Q = self._at((round(dt, 5),))
        return F[:, 0], Q[:, 0]

    def horizon(self, dt: Array) -> tuple[Array, Array]:
        """Return F and Q (M, K, 3, 3) over a horizon (K,) (s); cached, since controllers use the same few."""
        return self._at(tuple(np.round(dt, 4).tolist()))

    def _transition_and_noise(self, times: tuple[float, ...]) -> tuple[Array, Array]:
        return self.transition(np.array(times)), self.noise(np.array(times))


class MotionImm:
    """The motion of one obstacle: ``x`` (M, axis, 3), ``P`` (M, axis, 3, 3), ``weight`` (M,) at ``time`` (s)."""

    def __init__(self, models: MotionModels, time: float, position: Array, variance: Array) -> None:
        """``position`` (3,) (m) with ``variance`` (3,) (m2) at ``time``."""
        m, s = models.count, models.settings
        self.models, self.time = models, time
        self.x = np.zeros((m, 3, 3))
        self.x[:, :, 0] = position
        self.P = np.zeros((m, 3, 3, 3))
        self.P[:, :, 0, 0] = variance
        self.P[1:, :, 1, 1] = s.initial_velocity**2
        self.P[2:, :, 2, 2] = s.initial_acceleration**2
        # A Singer acceleration starts as large as it usually is.
        sigma = np.array(s.singer_accelerations)
        self.P[2 : 2 + len(sigma), :, 2, 2] = sigma[:, None] ** 2
        self.weight = np.full(m, 1.0 / m)
        self.state = self._mixture()
        """Position (NED, m), velocity and acceleration (3,) of the mixture."""

    def _mixture(self) -> tuple[Array, Array, Array]:
        mean = self.weight @ self.x.reshape(len(self.weight), 9)
        position, velocity, acceleration = mean.reshape(3, 3).T
        return position, velocity, acceleration

    @property
    def position_variance(self) -> Array:
        """Variance of the mixture's position (3,) (m2)."""
        return self._variance(0)

    @property
    def velocity_variance(self) -> Array:
        """Variance of the mixture's velocity (3,) (m2/s2)."""
        return self._variance(1)

    def _variance(self, row: int) -> Array:
        mean = self.weight @ self.x[:, :, row]
        return np.asarray(self.weight @ (self.P[:, :, row, row] + (self.x[:, :, row] - mean) ** 2))

    def advance(self, time: float) -> None:
        """Predict to ``time`` (s); earlier times are passed over.

        The models' states are mixed by the probability that the obstacle has changed its model.
        """
        dt = time - self.time
        if dt <= 0.0:
            return
        F, Q = self.models.step(dt)
        change = min(self.models.settings.transition_rate * dt, 0.5)
        self.weight, self.x, self.P = advanced(self.weight, self.x, self.P, F, Q, change)
        self.time, self.state = time, self._mixture()

    def update(self, position: Array, variance: Array) -> float:
        """Correct by a ``position`` (3,) (m) with ``variance`` (3,) (m2); an axis that is nan is not measured.

        Returns:
            The squared innovation of the mixture over its variance, mean over the measured axes.
        """
        position, variance = np.ascontiguousarray(position), np.ascontiguousarray(variance)
        self.weight, self.x, self.P, squared = updated(self.weight, self.x, self.P, position, variance)
        self.state = self._mixture()
        return squared

    def shift(self, by: Array) -> None:
        """Shift the tracked point ``by`` (3,) (m)."""
        self.x[:, :, 0] += by
        self.state = self._mixture()

    def predict(self, times: Array) -> tuple[Array, Array]:
        """Return mean (K, 3) (m) and covariance (K, 3, 3) (m2) of the position at ``times`` (K,) (s)."""
        F, Q = self.models.horizon(np.maximum(times - self.time, 0.0))
        return predicted(self.weight, self.x, self.P, F, Q)
