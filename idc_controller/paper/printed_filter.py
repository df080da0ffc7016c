"""The paper's own obstacle avoidance controller (eq:obsAvoid), as printed, for comparison.

An exponential barrier of degree 2 on the hull point c nearest to each obstacle (eq:h_x, eq:h_ddot), which takes the
payload for a double integrator and the hull for a body that translates with it. Both are false: thrust reaches the
payload's lateral acceleration only through the links' tilt, so for a pole A_obs is zero and the filter cannot act. It
is kept to show what that means; the default is :class:`~idc_controller.safety.safety_filter.AvoidanceFilter`.
"""

import coal
import numpy as np

from idc_controller.arrays import Array
from idc_controller.errors import SolverError
from idc_controller.estimation.estimate import Estimate
from idc_controller.geometry.formation import Formation
from idc_controller.geometry.obstacles import ObstacleSource, PredictedObstacle
from idc_controller.model.linear import LinearModel
from idc_controller.qp.daqp_solver import DaqpSolver
from idc_controller.qp.problem import QuadraticProgram
from idc_controller.safety.filter_protocol import NoObstacles

DIFFERENCE = 0.05
"""s, for the obstacles' velocity and acceleration from their prediction."""


class PrintedFilter(NoObstacles):
    """Corrects the set-points of the tracker; the trajectory stays the mission's."""

    def __init__(
        self,
        model: LinearModel,
        obstacles: ObstacleSource,
        margin: float,
        poles: tuple[float, float] = (2.0, 2.0),
        thrust_min: float = 1.0,
    ) -> None:
        """``margin`` (m) is added to the obstacles; ``poles`` (1/s) are those of the barrier, real and positive."""
        self.model, self.obstacles, self.margin = model, obstacles, margin
        self.formation = Formation(model.parameters)
        self._K = np.array([poles[0] * poles[1], poles[0] + poles[1]])
        self._thrust_min = thrust_min
        self.infeasible = 0
        """Steps in which the rows could not be kept."""

    def correct(self, time: float, u: Array, estimate: Estimate) -> Array:
        """``u`` (3 N,) with the thrusts nearest to the tracker's that keep A_obs u <= b_obs."""
        obstacles = self.obstacles.predict(np.array([time, time + DIFFERENCE, time + 2.0 * DIFFERENCE]))
        if not obstacles:
            return u
        layout, parameters = self.model.layout, self.model.parameters
        A = self.model.A[layout.v_0]
        deviation = estimate.x.copy()
        deviation[layout.f] -= parameters.hover_thrust
        drift = A @ deviation - A[:, layout.f] @ deviation[layout.f]
        rows, bounds = zip(*(self.row(o, estimate, drift, A[:, layout.f]) for o in obstacles), strict=True)
        N = parameters.number_of_uavs
        f = u[layout.f_setpoint]
        lower, upper = np.full(N, self._thrust_min), np.full(N, 0.95 * parameters.thrust_max)
        soft = np.ones(len(rows), dtype=bool)
        problem = QuadraticProgram(np.eye(N), -f, np.array(rows), np.array(bounds), lower, upper, soft)
        try:
            x = DaqpSolver().solve(problem).x
        except SolverError:
            self.infeasible += 1
            return u
        corrected = u.copy()
        corrected[layout.f_setpoint] = np.clip(x, lower, upper)
        return corrected

    def row(self, obstacle: PredictedObstacle, estimate: Estimate, drift: Array, B: Array) -> tuple[Array, float]:
        """A_obs (N,) and b_obs of one obstacle: h'' >= -K (h, h') solved for the thrusts."""
        layout, hover = self.model.layout, self.model.parameters.hover_thrust
        position, velocity = estimate.x[layout.r_0], estimate.x[layout.v_0]
        now, soon, later = obstacle.positions
        obstacle_velocity = (soon - now) / DIFFERENCE
        obstacle_acceleration = (later - 2.0 * soon + now) / DIFFERENCE**2
        shape = obstacle.shape
        result = coal.DistanceResult()
        coal.distance(
            self.formation.hull(self.formation.hull_points(np.zeros((1, 3)))[0]), coal.Transform3s.Identity(),
            shape.geometry(), coal.Transform3s(shape.rotation, now - position), coal.DistanceRequest(), result,
        )  # fmt: skip
        closest = position + np.array(result.getNearestPoint1())
        is_round = shape.round_axes is not None
        centre = now if is_round else position + np.array(result.getNearestPoint2())
        mask = np.array(shape.round_axes) if is_round else np.ones(3)
        d = (closest - centre) * mask
        d_dot = (velocity - obstacle_velocity) * mask
        R = (shape.columns.radius if is_round else 0.0) + self.margin
        h, h_dot = float(d @ d) - R * R, 2.0 * float(d @ d_dot)
        # h'' = 2 d . (drift + B (f - hover) - a_obs) + 2 |d'|^2
        constant = 2.0 * float(d @ (drift - B @ hover - obstacle_acceleration)) + 2.0 * float(d_dot @ d_dot)
        return -2.0 * d @ B, constant + float(self._K @ [h, h_dot])
