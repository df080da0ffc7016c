"""Wind estimate from the drag forces: what changes fast is the payload's own velocity, not the air's.

In a steady wind the drag of a payload that flies curves swings by many newtons, and a filter that takes it for a force
that drifts comes late every time. The wind itself hardly changes. Over the last seconds it is the level velocity w, and
the drag the factor kappa of a level payload's (:mod:`idc_controller.model.drag`), for which

    kappa drag(w - v)  explains best the estimated force F at the payload's velocity v.

For every w on a grid the best kappa follows from running sums, so there is no initial value and no local minimum.
Where it explains little of F, or where there is hardly any F, there is no wind.
"""

import numpy as np

from idc_controller.arrays import Array
from idc_controller.estimation.settings import WindSettings
from idc_controller.model.drag import Air, drag_coefficients, payload_drag


class WindEstimator:
    """Learns the wind from the estimated forces of one control step after the other."""

    def __init__(self, areas: Array, period: float, limit: float, settings: WindSettings = WindSettings()) -> None:
        """Start without wind.

        Args:
            areas: of the payload's silhouettes along its axes (3,) (m2).
            period: control step (s).
            limit: largest drag that is predicted (N).
            settings: of the estimate.
        """
        self.settings = s = settings
        self._coefficients = drag_coefficients(areas)
        self._limit = limit
        count = round(s.speed_max / s.spacing)
        self._axis = axis = s.spacing * np.arange(-count, count + 1)
        north, east = np.meshgrid(axis, axis, indexing="ij")
        self._winds = np.stack([north, east, np.zeros_like(north)], axis=-1)
        # Of minus twice the logarithm of the probability, in N2 s: what gusts leave counts once in their time.
        self._unit = unit = 2.0 * s.gust_force**2 * s.gust_time
        self._factor_prior = 0.5 * unit / s.factor_sigma**2
        self._wind_prior = 0.5 * unit / s.speed_sigma**2 * (north**2 + east**2)
        self._period, self._keep = period, float(np.exp(-period / s.memory))
        # Integrals over the memory.
        self._product = np.zeros(north.shape)
        """F . drag (N2 s), for each wind on the grid."""
        self._square = np.zeros(north.shape)
        """|drag|^2 (N2 s), for each wind."""
        self._force_square = 0.0
        """|F|^2 (N2 s)."""
        self._mean, self._time = np.zeros(2), 0.0  # F (N s), and how much of the memory is filled (s)
        self._uav_product = self._uav_square = 0.0  # of a UAV, its drag as the square of the airspeed (N m2, m4/s3)
        self.air: Air | None = None
        """Estimated wind and drag; None: no wind."""

    def learn(self, force: Array, uav_force: Array, velocity: Array) -> None:
        """Learn from one control step.

        Args:
            force: estimated disturbance force on the payload (3,) (N, NED).
            uav_force: that on each UAV (3,) (N, NED).
            velocity: of the payload (3,) (m/s, NED).
        """
        s, keep, period, level_force, level_uav_force = (
            self.settings,
            self._keep,
            self._period,
            force[:2],
            uav_force[:2],
        )
        self._product *= keep
        self._square *= keep
        self._force_square = keep * self._force_square + period * float(level_force @ level_force)
        self._mean = keep * self._mean + period * level_force
        self._time = keep * self._time + period
        self._uav_product, self._uav_square = keep * self._uav_product, keep * self._uav_square
        least = s.force_min**2 * s.memory
        if self._force_square < least:
            self.air = None
            return
        drag = payload_drag(self._coefficients, self._winds - velocity)[..., :2]
        self._product += period * (drag @ level_force)
        self._square += period * np.einsum("ijk,ijk->ij", drag, drag)
        prior = self._factor_prior
        factor = np.clip((self._product + prior) / (self._square + prior), 0.0, s.factor_max)
        cost = factor * (factor * self._square - 2.0 * self._product)
        cost += prior * (factor - 1.0) ** 2 + self._wind_prior
        best = np.unravel_index(int(np.argmin(cost)), cost.shape)
        wind = np.array([self._axis[best[0]] + self._vertex(cost[:, best[1]], int(best[0])),
                         self._axis[best[1]] + self._vertex(cost[best[0]], int(best[1])), 0.0])  # fmt: skip
        airspeed = wind - velocity
        uav_drag = float(np.linalg.norm(airspeed)) * airspeed[:2]
        self._uav_product += period * float(level_uav_force @ uav_drag)
        self._uav_square += period * float(uav_drag @ uav_drag)
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

    def _vertex(self, cost: Array, best: int) -> float:
        """Return the distance (m/s) from the least ``cost`` (M,) to the vertex of a parabola through its neighbours."""
        if not 0 < best < len(cost) - 1:
            return 0.0
        before, here, after = cost[best - 1 : best + 2]
        curvature = before - 2.0 * here + after
        return float(0.5 * (before - after) / curvature * self.settings.spacing) if curvature > 0.0 else 0.0
