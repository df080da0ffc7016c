"""Wind estimate from the drag forces: what changes fast is the payload's own velocity, not the air's.

In a steady wind the drag of a payload that flies curves swings by many newtons, and a filter that takes it for a force
that drifts comes late every time. The wind itself hardly changes. Over the last seconds it is the level velocity w, and
the drag the factor kappa of a box's (:mod:`idc_controller.model.drag`), for which

    kappa drag(w - v)  explains best the estimated force F at the payload's velocity v.

For every w on a grid the best kappa follows from running sums, so there is no initial value and no local minimum.
Where it explains little of F, or where there is hardly any F, there is no wind.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from idc_controller.estimation.settings import WindSettings
from idc_controller.model.drag import Air, box_coefficients, box_drag

Array = NDArray[np.float64]


class WindEstimator:
    """Learns the wind from the estimated forces of one control step after the other."""

    def __init__(self, payload_size: Array, period: float, limit: float, settings: WindSettings | None = None) -> None:
        """Start without wind.

        Args:
            payload_size: edges of the box (3,) (m).
            period: control step (s).
            limit: largest drag that is predicted (N).
            settings: of the estimate.
        """
        self.settings = s = settings or WindSettings()
        self._coefficients = box_coefficients(payload_size)
        self._limit = limit
        self._period, self._keep = period, float(np.exp(-period / s.memory))
        count = round(s.speed_max / s.spacing)
        axis = s.spacing * np.arange(-count, count + 1)
        self._axis = axis
        north, east = np.meshgrid(axis, axis, indexing="ij")
        self._winds = np.stack([north, east, np.zeros_like(north)], axis=-1)
        # Of minus twice the logarithm of the probability, in N2 s: what gusts leave counts once in their time.
        self._unit = unit = 2.0 * s.gust_force**2 * s.gust_time
        self._factor_prior = 0.5 * unit / s.factor_sigma**2
        self._prior = 0.5 * unit / s.speed_sigma**2 * (north**2 + east**2)
        self._product = np.zeros(north.shape)  # F . drag, integrated over the memory (N2 s)
        self._square = np.zeros(north.shape)  # |drag|^2
        self._force_square = 0.0  # |F|^2 (N2 s)
        self._mean, self._time = np.zeros(2), 0.0  # F, and how much of the memory is filled (s)
        self._uav_product = self._uav_square = 0.0
        self.air: Air | None = None
        """Estimated wind and drag; None: no wind."""

    def learn(self, force: Array, uav_force: Array, velocity: Array) -> None:
        """Learn from one control step.

        Args:
            force: estimated disturbance force on the payload (3,) (N, NED).
            uav_force: that on each UAV (3,) (N, NED).
            velocity: of the payload (3,) (m/s, NED).
        """
        s = self.settings
        self._force_square = self._keep * self._force_square + self._period * float(force[:2] @ force[:2])
        self._mean = self._keep * self._mean + self._period * force[:2]
        self._time = self._keep * self._time + self._period
        least = s.force_min**2 * s.memory
        if self._force_square < least:
            self.air = None
            self._product *= self._keep
            self._square *= self._keep
            self._uav_product, self._uav_square = self._keep * self._uav_product, self._keep * self._uav_square
            return
        drag = box_drag(self._coefficients, self._winds - velocity)
        self._product = self._keep * self._product + self._period * (drag[..., :2] @ force[:2])
        self._square = self._keep * self._square + self._period * np.einsum("ijk,ijk->ij", drag[..., :2], drag[..., :2])
        factor = np.clip((self._product + self._factor_prior) / (self._square + self._factor_prior), 0.0, s.factor_max)
        cost = factor * (factor * self._square - 2.0 * self._product)
        cost += self._factor_prior * (factor - 1.0) ** 2 + self._prior
        best = np.unravel_index(int(np.argmin(cost)), cost.shape)
        wind = np.array([self._axis[best[0]] + self._vertex(cost[:, best[1]], int(best[0])),
                         self._axis[best[1]] + self._vertex(cost[best[0]], int(best[1])), 0.0])  # fmt: skip
        self._learn_uav(uav_force, wind - velocity)
        low, high = s.explained_min, s.explained_full
        explained = -(float(cost[best]) + least) / self._force_square
        weight = float(np.clip((explained - low) / (high - low), 0.0, 1.0))
        # A force that is the same at all velocities is no wind.
        steady = self._force_square - float(self._mean @ self._mean) / self._time
        weight *= float(np.clip(2.0 - (self._force_square + float(cost[best]) - steady) / self._unit, 0.0, 1.0))
        if weight == 0.0:
            self.air = None
            return
        uav = max(self._uav_product / self._uav_square, 0.0) if self._uav_square > 0.0 else 0.0
        self.air = Air(wind, weight * float(factor[best]) * self._coefficients, weight * uav, self._limit)

    def _learn_uav(self, force: Array, u: Array) -> None:
        drag = float(np.linalg.norm(u)) * u[:2]
        self._uav_product = self._keep * self._uav_product + self._period * float(force[:2] @ drag)
        self._uav_square = self._keep * self._uav_square + self._period * float(drag @ drag)

    def _vertex(self, cost: Array, best: int) -> float:
        """Return the distance (m/s) from the least ``cost`` (M,) to the vertex of a parabola through its neighbours."""
        if not 0 < best < len(cost) - 1:
            return 0.0
        before, here, after = cost[best - 1 : best + 2]
        curvature = before - 2.0 * here + after
        return float(0.5 * (before - after) / curvature * self.settings.spacing) if curvature > 0.0 else 0.0
