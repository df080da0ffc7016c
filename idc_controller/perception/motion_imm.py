"""How an obstacle moves: a bank of Kalman filters, one a motion model, mixed by likelihood.

All models share the state (position, velocity, acceleration) on each of the three axes, and differ in how it goes on:

- *static*: it stands;
- *constant velocity*, and *constant acceleration for a while* (Singer 1970), the latter slow and fast;
- *harmonic* at several frequencies: x''' = -omega^2 x', a swing about a centre that the state implies.

They interact as in the IMM estimator (Blom and Bar-Shalom 1988). The axes are filtered apart, with a model's weight in
common. ``filterpy`` has the same filters one at a time; here all models and axes are one array, since there are many
obstacles and little time. The tests hold a single model against ``filterpy``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_LOG_2PI = float(np.log(2.0 * np.pi))
_DIAGONAL = np.arange(3)


@dataclass(frozen=True)
class BankSettings:
    """Which models there are, and how much their motion strays. SI units."""

    static_walk: float = 0.01
    """Of the static model: random walk of its position (m / sqrt(s))."""
    velocity_walk: float = 0.15
    """Of constant velocity: random walk of the velocity (m/s / sqrt(s))."""
    singer: tuple[tuple[float, float], ...] = ((1.0, 1.0), (4.0, 0.5))
    """Standard deviation (m/s2) and correlation time (s) of the acceleration."""
    frequencies: tuple[float, ...] = (0.5, 0.7, 1.0, 1.4, 2.0, 2.8)
    """Of the harmonic models (rad/s)."""
    harmonic_walk: float = 0.1
    """Random walk of the harmonic models' acceleration at 1 rad/s; proportional to the frequency (m/s2 / sqrt(s))."""
    first_velocity: float = 1.5
    """Standard deviation of the velocity before anything is known of it (m/s)."""
    first_acceleration: float = 1.5
    """The same of the acceleration (m/s2)."""
    change: float = 0.1
    """Share of the models' weight that moves to the others in a second."""


class MotionModels:
    """Transition and process noise of all models (M of them), for arrays of time steps."""

    def __init__(self, settings: BankSettings) -> None:
        self.settings = settings
        self.names = (
            "static", "velocity", *(f"singer {s:g}/{tau:g}" for s, tau in settings.singer),
            *(f"harmonic {omega:g}" for omega in settings.frequencies),
        )  # fmt: skip
        self.count = len(self.names)
        self._singer = slice(2, 2 + len(settings.singer))
        self._harmonic = slice(2 + len(settings.singer), self.count)
        self._sigma = np.array([s for s, _ in settings.singer])
        self._tau = np.array([tau for _, tau in settings.singer])
        self._omega = np.array(settings.frequencies)
        self._cache: dict[float, tuple[Array, Array]] = {}
        self._horizons: dict[bytes, tuple[Array, Array]] = {}

    def transition(self, dt: Array) -> Array:
        """F (M, K, 3, 3) over the times ``dt`` (K,) (s), on (position, velocity, acceleration)."""
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
        """Q (M, K, 3, 3) gathered over the times ``dt`` (K,) (s), by white noise on each model's last derivative."""
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
        """F and Q (M, 3, 3) over one step; remembered, since steps repeat."""
        key = round(dt, 5)
        if key not in self._cache:
            if len(self._cache) > 500:
                self._cache.clear()
            self._cache[key] = self.transition(np.array([key]))[:, 0], self.noise(np.array([key]))[:, 0]
        return self._cache[key]

    def horizon(self, dt: Array) -> tuple[Array, Array]:
        """F and Q (M, K, 3, 3) over a whole horizon; remembered, since controllers ask for the same few."""
        rounded = np.round(dt, 4)
        key = rounded.tobytes()
        if key not in self._horizons:
            if len(self._horizons) > 300:
                self._horizons.clear()
            self._horizons[key] = self.transition(rounded), self.noise(rounded)
        return self._horizons[key]


class MotionBank:
    """The motion of one obstacle: ``x`` (M, axis, 3), ``P`` (M, axis, 3, 3), ``weight`` (M,) at ``time`` (s)."""

    def __init__(self, models: MotionModels, time: float, position: Array, variance: Array) -> None:
        """``position`` (3,) (m) with ``variance`` (3,) (m2) at ``time``."""
        m, s = models.count, models.settings
        self.models, self.time = models, time
        self.x = np.zeros((m, 3, 3))
        self.x[:, :, 0] = position
        self.P = np.zeros((m, 3, 3, 3))
        self.P[:, :, 0, 0] = variance
        self.P[1:, :, 1, 1] = s.first_velocity**2
        self.P[2:, :, 2, 2] = s.first_acceleration**2
        # A Singer acceleration starts as large as it usually is.
        self.P[2 : 2 + len(s.singer), :, 2, 2] = np.array([sigma for sigma, _ in s.singer])[:, None] ** 2
        self.weight = np.full(m, 1.0 / m)

    @property
    def state(self) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration (3,) of the mixture."""
        mean = self.weight @ self.x.reshape(len(self.weight), 9)
        position, velocity, acceleration = mean.reshape(3, 3).T
        return position, velocity, acceleration

    @property
    def position_variance(self) -> Array:
        """(3,) (m2) of the mixture."""
        mean = self.weight @ self.x[:, :, 0]
        return self.weight @ (self.P[:, :, 0, 0] + (self.x[:, :, 0] - mean) ** 2)

    def advance(self, time: float) -> None:
        """To ``time`` (s); harmless when it is there."""
        dt = time - self.time
        if dt <= 0.0:
            return
        self._mix(dt)
        F, Q = self.models.step(dt)
        F_transposed = F.transpose(0, 2, 1)
        self.x = self.x @ F_transposed
        self.P = F[:, None] @ self.P @ F_transposed[:, None] + Q[:, None]
        self.time = time

    def measured(self, position: Array, variance: Array) -> float:
        """The obstacle was at ``position`` (3,) with ``variance`` (3,) at the bank's time; a nan axis was not seen.

        Returns the square of the mixture's innovation over its variance, mean over the axes seen.
        """
        seen = np.isfinite(position)
        S = self.P[:, :, 0, 0] + variance
        expected = self.weight @ self.x[:, :, 0]
        off = np.where(seen, (position - expected) ** 2 / (self.position_variance + variance), 0.0)
        y = np.where(seen, position - self.x[:, :, 0], 0.0)
        log_likelihood = -0.5 * ((y**2 / S + np.log(S) + _LOG_2PI) * seen).sum(axis=1)
        K = self.P[:, :, :, 0] / S[..., None] * seen[:, None]
        self.x = self.x + K * y[..., None]
        self.P = self.P - K[..., :, None] * self.P[:, :, None, 0, :]
        weight = self.weight * np.exp(np.maximum(log_likelihood - log_likelihood.max(), -50.0))
        weight = np.maximum(weight, 1e-6 * weight.sum())
        self.weight = weight / weight.sum()
        return float(off.sum()) / max(int(seen.sum()), 1)

    def shift(self, by: Array) -> None:
        """Move the point that is tracked by (3,) (m)."""
        self.x[:, :, 0] += by

    def predict(self, times: Array) -> tuple[Array, Array]:
        """Mean (K, 3) and covariance (K, 3, 3) of the position at ``times`` (K,) (s), of the mixture."""
        dt = np.maximum(np.asarray(times, dtype=float) - self.time, 0.0)
        F, Q = self.models.horizon(dt)
        f = F[:, :, 0, :]  # (M, K, 3): how the position comes about
        means = np.matmul(f, np.swapaxes(self.x, 1, 2))  # (M, K, axis)
        ff = (f[..., :, None] * f[..., None, :]).reshape(len(self.weight), len(dt), 9)
        variances = np.matmul(ff, self.P.reshape(len(self.weight), 3, 9).swapaxes(1, 2))
        variances += Q[:, :, 0, 0, None]
        w, k = self.weight, len(dt)
        mean = (w @ means.reshape(len(w), -1)).reshape(k, 3)
        apart = (means - mean).transpose(1, 0, 2)
        covariance = np.matmul((apart * w[:, None]).transpose(0, 2, 1), apart)
        covariance[:, _DIAGONAL, _DIAGONAL] += (w @ variances.reshape(len(w), -1)).reshape(k, 3)
        return mean, covariance

    def _mix(self, dt: float) -> None:
        """Interaction: the obstacle may have changed its model; each filter starts from all, by what is likely."""
        m = len(self.weight)
        change = min(self.models.settings.change * dt, 0.5)
        # From model i to j: stays with 1 - change, else any of the others.
        to = self.weight[:, None] * (np.eye(m) * (1.0 - change - change / (m - 1)) + change / (m - 1))
        weight = to.sum(axis=0)
        share = to / weight  # (from, to)
        # Second moments about a common point, so that little is lost in the difference of large numbers.
        common = (self.weight @ self.x.reshape(m, 9)).reshape(3, 3)
        apart = self.x - common
        mean = (share.T @ apart.reshape(m, 9)).reshape(m, 3, 3)
        second = self.P + apart[..., :, None] * apart[..., None, :]
        mixed = (share.T @ second.reshape(m, 27)).reshape(m, 3, 3, 3)
        self.P = mixed - mean[..., :, None] * mean[..., None, :]
        self.x, self.weight = mean + common, weight
