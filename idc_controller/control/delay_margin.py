"""Margins of the closed loop at hover against delay and loss of set-points, on the linear model.

The loop is that of the unconstrained MPC: ``u = K x_hat``. ``x_hat`` is the state at which the set-points will act,
predicted from a state that is ``steps`` control periods older, with the set-points that were sent in the meantime: a
loss of one of those is not known yet. A vehicle that gets no set-point flies the one before.
"""

from collections.abc import Callable
from itertools import chain, pairwise

import numpy as np

from idc_controller.arrays import Array
from idc_controller.control.mpc import ModelPredictiveController
from idc_controller.model.linear import LinearModel

_ITERATIONS, _AVERAGED = 150, 30


class HoverLoop:
    """The loop of one system at hover."""

    def __init__(self, model: LinearModel, mpc: ModelPredictiveController) -> None:
        self._model, self._period_us = model, round(mpc.settings.period * 1e6)
        self._n, self._m = model.layout.size, model.layout.inputs
        self._number_of_uavs = model.layout.number_of_uavs
        self.A, self.B, _ = model.discretised(self._period_us)
        self.K = np.column_stack([mpc.qp.unconstrained(e)[: self._m] for e in np.eye(self._n)])
        """Gain (3 N, n) of the first move."""

    def spectral_radius(self, delay: float, payload_mass: float | None = None) -> float:
        """Return the spectral radius of a step whose set-points act ``delay`` (s) late, which nothing compensates.

        ``payload_mass`` (kg) of the plant, of which the gain knows nothing; None: that of the model.
        """
        n, m = self._n, self._m
        plant = self._plant(payload_mass)
        periods, late_us = divmod(round(delay * 1e6), self._period_us)
        A, B_now, _ = plant(self._period_us - late_us)
        B_before = np.zeros((n, m))
        if late_us:
            A_late, B_late, _ = plant(late_us)
            A, B_before = A @ A_late, A @ B_late
        # State: x, then the set-points of the periods before, the newest first.
        F = np.zeros((n + (periods + 1) * m,) * 2)
        sent = [slice(n + k * m, n + (k + 1) * m) for k in range(periods + 1)]
        F[:n, :n], F[sent[0], :n], F[:n, sent[-1]] = A, self.K, B_before
        F[:n, sent[-2] if periods else slice(n)] += B_now if periods else B_now @ self.K
        for newer, older in pairwise(sent):
            F[older, newer] = np.eye(m)
        return float(np.abs(np.linalg.eigvals(F)).max())

    def _plant(self, payload_mass: float | None) -> Callable[[int], tuple[Array, Array, Array]]:
        """Return ``discretised`` of a payload of that mass, in force components over the model's hover thrust."""
        if payload_mass is None:
            return self._model.discretised
        plant = LinearModel(self._model.parameters.with_payload_mass(payload_mass))
        layout = plant.layout
        tilts, tilt_setpoints = np.ones(self._n), np.ones(self._m)
        per_thrust = np.repeat(plant.parameters.hover_thrust / self._model.parameters.hover_thrust, 2)
        for part in (layout.n, layout.n_dot, layout.n_acc):
            tilts[part] = per_thrust
        tilt_setpoints[layout.n_setpoint] = per_thrust

        def discretised(interval_us: int) -> tuple[Array, Array, Array]:
            A, B, B_d = plant.discretised(interval_us)
            return tilts[:, None] * A / tilts, tilts[:, None] * B / tilt_setpoints, tilts[:, None] * B_d

        return discretised

    def delay_margin(self, payload_mass: float | None = None) -> float:
        """Return the delay (s) that is not compensated at which the loop becomes unstable.

        ``payload_mass`` (kg) as of :meth:`spectral_radius`.
        """
        return _crossing(lambda delay: self.spectral_radius(delay, payload_mass), 0.0, 6e-6 * self._period_us)

    def mean_square_growth(self, steps: int, loss: float, late: int = 0) -> float:
        """Return by which factor the mean square of the state grows in a step; below 1 the loop is stable.

        Args:
            steps: age of the newest known state when the set-points should act, in control periods, at least 1.
            loss: probability with which each set-point to each vehicle is lost, independently.
            late: control periods by which set-points act later than they should, of which the loop does not know.
        """
        n, m = self._n, self._m
        size = n + m * (steps + late + 1)
        # State: x; then sent less flown of the set-points 1 .. steps periods ago; then those sent 1 .. late periods
        # ago; then the set-points flown last.
        past, sent = (
            [slice(n + k * m, n + (k + 1) * m) for k in of] for of in (range(steps), range(steps, steps + late))
        )
        flown = slice(size - m, size)
        V = np.zeros((m, size))  # what is sent: K (x + sum of A^(k-1) B (sent - flown))
        V[:, :n] = self.K
        effect = self.B
        for k in range(steps):
            V[:, past[k]] = self.K @ effect
            effect = self.A @ effect
        arriving = V
        if late:
            arriving = np.zeros((m, size))
            arriving[:, sent[-1]] = np.eye(m)
        change = arriving.copy()  # arriving less flown before
        change[:, flown] -= np.eye(m)
        into = np.zeros((size, m))  # what one unit that is not flown changes
        into[:n], into[past[0]], into[flown] = -self.B, np.eye(m), -np.eye(m)
        mean = np.zeros((size, size))
        mean[:n, :n], mean[flown], mean[past[0]] = self.A, arriving, V - arriving
        mean[:n] += self.B @ arriving
        if late:
            mean[sent[0]] = V
        for older, newer in chain(pairwise(past[::-1]), pairwise(sent[::-1])):
            mean[older, newer] = np.eye(m)
        mean += loss * into @ change
        of_vehicle = np.concatenate([np.repeat(np.arange(self._number_of_uavs), 2), np.arange(self._number_of_uavs)])
        same = of_vehicle[:, None] == of_vehicle
        P, growth = np.eye(size) / size, []
        for _ in range(_ITERATIONS):
            scattered = into @ ((change @ P @ change.T) * same) @ into.T
            P = mean @ P @ mean.T + loss * (1.0 - loss) * scattered
            growth.append(trace := float(np.trace(P)))
            P /= trace
        return float(np.exp(np.mean(np.log(growth[-_AVERAGED:]))))

    def loss_margin(self, steps: int) -> float:
        """Return the loss at which the mean square of the state no longer shrinks; ``steps`` as above."""
        return _crossing(lambda loss: self.mean_square_growth(steps, loss), 0.0, 1.0)


def expected_extra_age(loss: float, period: float) -> float:
    """Return by how much older (s) the set-point in force is in the mean, where each is lost with probability ``loss``.

    ``period`` (s) of the set-points. The number lost in a row is geometric: sum of k (1 - p) p^k = p / (1 - p).
    """
    return period * loss / (1.0 - loss)


def _crossing(growth: Callable[[float], float], low: float, high: float) -> float:
    """Return where ``growth`` exceeds 1 between ``low`` and ``high``, to a thousandth of the interval."""
    tolerance = 1e-3 * (high - low)
    while high - low > tolerance:
        middle = (low + high) / 2.0
        low, high = (low, middle) if growth(middle) > 1.0 else (middle, high)
    return low
