"""The paper's obstacle avoidance controller (eq:h_x .. eq:obsAvoid) in its own inputs, thrust and torque.

A_obs and B_obs, which the paper left on a drive, in closed form. With d = x_c - x_obs, h = |d|^2 - R_o^2, the hull
point x_c taken to move with the payload, r_0'' = a + G du, and K = (p_1 p_2, p_1 + p_2) for poles -p_1, -p_2:

    h'   = 2 d . (v_0 - v_obs)
    h''  = 2 d . (a + G du - a_obs) + 2 |v_0 - v_obs|^2  >=  -K (h, h')
    A_obs = -2 d' G
    B_obs =  2 d . (a - a_obs) + 2 |v_0 - v_obs|^2 + K (h, h')

Two readings of "the acceleration equations of the payload": those of eq:disSys (:func:`linear_acceleration`), where G
has but the thrusts' vertical row, -1 / m_T for a symmetric layout, and all torques' columns are zero; or the nonlinear
ones at the state (:func:`nonlinear_acceleration`), where a tilted link lets thrust push sideways a little.
"""

from dataclasses import dataclass

import coal
import numpy as np

from idc_controller.arrays import Array
from idc_controller.errors import SolverError
from idc_controller.estimation.measurements import Estimate
from idc_controller.geometry.formation import Formation
from idc_controller.geometry.obstacles import ObstacleSource, PredictedObstacle
from idc_controller.model.linear import LinearModel
from idc_controller.paper.plant import Plant, PlantState
from idc_controller.paper.state_space import minimal
from idc_controller.parameters import SystemParameters
from idc_controller.qp.daqp_solver import DaqpSolver
from idc_controller.qp.problem import QuadraticProgram
from idc_controller.safety.filter_protocol import NoObstacles


@dataclass(frozen=True, eq=False)
class Encounter:
    """The hull point nearest to an obstacle, and how the obstacle moves; world NED, SI.

    ``mask`` (3,) has zeros for the axes along which the obstacle is endless: (1, 1, 0) of a pole.
    """

    closest: Array
    velocity: Array
    obstacle: Array
    obstacle_velocity: Array
    obstacle_acceleration: Array
    radius: float
    """R_o: of the obstacle with the safety margin (m)."""
    mask: Array


def linear_acceleration(parameters: SystemParameters) -> tuple[Array, Array]:
    """Rows of v_0' in eq:disSys: (3, 12 + 10 N) for the minimal state's deviation, (3, 4 N) for the inputs'."""
    A, B = minimal(parameters)
    return A[3:6], B[3:6]


def nonlinear_acceleration(plant: Plant, state: PlantState) -> tuple[Array, Array]:
    """a (3,) at hover thrust and G (3, 4 N) with r_0'' = a + G du: exact, since r_0'' is affine in the thrusts."""
    parameters = plant.parameters
    N = parameters.number_of_uavs
    none = np.zeros((N, 3))
    hover = parameters.hover_thrust
    a = plant.accelerations(state, hover, none)[0]
    G = np.zeros((3, 4 * N))
    for i in range(N):
        G[:, 4 * i] = plant.accelerations(state, hover + np.eye(N)[i], none)[0] - a
    return a, G


def obstacle_row(encounter: Encounter, a: Array, G: Array, poles: tuple[float, float]) -> tuple[Array, float]:
    """A_obs (4 N,) and B_obs of one obstacle, A_obs du <= B_obs."""
    e = encounter
    d = (e.closest - e.obstacle) * e.mask
    d_dot = (e.velocity - e.obstacle_velocity) * e.mask
    h, h_dot = float(d @ d) - e.radius**2, 2.0 * float(d @ d_dot)
    constant = 2.0 * float(d @ (a - e.obstacle_acceleration)) + 2.0 * float(d_dot @ d_dot)
    return -2.0 * d @ G, constant + poles[0] * poles[1] * h + (poles[0] + poles[1]) * h_dot


@dataclass(frozen=True, eq=False)
class Correction:
    """``delta_u`` (4 N,) of eq:obsAvoid; ``active``: other than the tracker's; ``infeasible``: none keeps all rows."""

    delta_u: Array
    active: bool
    infeasible: bool


def corrected_input(delta_u: Array, rows: Array, bounds: Array, lower: Array, upper: Array) -> Correction:
    """The input nearest to the tracker's ``delta_u`` (4 N,) with ``rows`` (k, 4 N) du <= ``bounds`` and within bounds.

    Q_obs is the identity. Where the paper's QP has no solution its rows are kept as well as can be.
    """
    n, k = len(delta_u), len(rows)
    if k == 0 or np.all(rows @ delta_u <= bounds):
        return Correction(delta_u, False, False)
    for soft in (None, np.ones(k, dtype=bool)):
        try:
            x = DaqpSolver().solve(QuadraticProgram(np.eye(n), -delta_u, rows, bounds, lower, upper, soft)).x
        except SolverError:
            continue
        return Correction(np.clip(x, lower, upper), True, soft is not None)
    return Correction(delta_u, False, True)


THRUST_MIN = 1.0
"""N, of a UAV's set-point."""
DIFFERENCE = 0.05
"""s, for the obstacles' velocity and acceleration from their prediction."""


class PrintedFilter(NoObstacles):
    """Corrects the set-points of the tracker by eq:obsAvoid as printed; the trajectory stays the mission's.

    The payload is taken for a double integrator and the hull for a body that translates with it. Both are false: thrust
    reaches the payload's lateral acceleration only through the links' tilt, so for a pole A_obs is zero and the filter
    cannot act. It is kept to show what that means; the default is
    :class:`~idc_controller.safety.safety_filter.AvoidanceFilter`.
    """

    def __init__(
        self,
        model: LinearModel,
        obstacles: ObstacleSource,
        margin: float,
        poles: tuple[float, float] = (2.0, 2.0),
    ) -> None:
        """``margin`` (m) is added to the obstacles; ``poles`` (1/s) are those of the barrier, real and positive."""
        self.model, self.obstacles, self.margin = model, obstacles, margin
        self.formation = Formation(model.parameters)
        self._poles = poles

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
        lower, upper = np.full(N, THRUST_MIN), np.full(N, 0.95 * parameters.thrust_max)
        soft = np.ones(len(rows), dtype=bool)
        problem = QuadraticProgram(np.eye(N), -f, np.array(rows), np.array(bounds), lower, upper, soft)
        try:
            x = DaqpSolver().solve(problem).x
        except SolverError:
            return u
        corrected = u.copy()
        corrected[layout.f_setpoint] = np.clip(x, lower, upper)
        return corrected

    def row(self, obstacle: PredictedObstacle, estimate: Estimate, drift: Array, B: Array) -> tuple[Array, float]:
        """A_obs (N,) and b_obs of one obstacle: h'' >= -K (h, h') solved for the thrusts."""
        layout, hover = self.model.layout, self.model.parameters.hover_thrust
        position, velocity = estimate.x[layout.r_0], estimate.x[layout.v_0]
        now, soon, later = obstacle.positions
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
        encounter = Encounter(
            closest, velocity, centre, (soon - now) / DIFFERENCE, (later - 2.0 * soon + now) / DIFFERENCE**2,
            (shape.columns.radius if is_round else 0.0) + self.margin, mask,
        )  # fmt: skip
        return obstacle_row(encounter, drift - B @ hover, B, self._poles)
