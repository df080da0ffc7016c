"""The controllers compared on one plant: the paper's, corrected step by step, and the project's."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace

import coal
import numpy as np

from gcs.flight import stack
from gcs.reproduce.scene import (
    MARGIN,
    RADIUS,
    ExtrapolatedSpheres,
    KnownSpheres,
    Sphere,
    configuration,
    printed_reference,
)
from idc_controller.arrays import Array
from idc_controller.estimation.measurements import Estimate
from idc_controller.geometry.formation import Formation
from idc_controller.guidance.progress import Guidance
from idc_controller.model.linear import LinearModel, StateLayout
from idc_controller.paper.avoidance import (
    Encounter,
    corrected_input,
    linear_acceleration,
    nonlinear_acceleration,
    obstacle_row,
)
from idc_controller.paper.plant import Plant, PlantState
from idc_controller.paper.state_space import Layout
from idc_controller.paper.tracking import Settings, ThrustTorqueMpc, Weights
from idc_controller.parameters import SystemParameters
from idc_controller.rotations import euler_from_quaternion, rotation_from_quaternion
from idc_controller.safety.filter_protocol import NoObstacles, SafetyFilter
from idc_controller.trajectory.flatness import Load, flat_reference
from idc_controller.trajectory.trajectory import Trajectory

PERIOD = 0.05  # s
VISIBLE = 0.05
"""Deviation (m) from the reference from which on the project's planner counts as avoiding."""


class Control(ABC):
    """A controller of the plant: decides once per period, and acts on the rotors at each step of the plant."""

    avoiding = False
    """The last decision was changed for an obstacle."""
    infeasible_tracking = 0
    """Number of decisions whose QP, as printed, had no solution."""
    infeasible_avoidance = 0

    def __init__(self, parameters: SystemParameters, figure: Trajectory | None) -> None:
        """``figure``: the trajectory to track; None: eq:Lissajous as printed."""
        self.parameters, self.figure = parameters, figure

    def reference(self, times: Array) -> Array:
        """Return the reference positions of the payload (K, 3) at ``times`` (K,)."""
        return printed_reference(times) if self.figure is None else np.asarray(self.figure.derivatives(times, 0)[0])

    @abstractmethod
    def decide(self, time: float, measured: PlantState) -> None:
        """Take the decision of the period that begins at ``time`` (s)."""

    @abstractmethod
    def act(self, state: PlantState, dt: float) -> tuple[Array, Array]:
        """Return thrusts (N,) (N) and torques (N, 3) (N m) for the next ``dt`` (s)."""


@dataclass(frozen=True)
class PaperVariant:
    """A reading of the paper.

    ``tracking``: cost on the components of y' only (outputs); on all states, with zero as the reference of those not
    in y' (states); corrected, on errors about the exact reference over the horizon, entered from rest (flat).
    ``acceleration``: equations that A_obs is derived from, linear or nonlinear.
    """

    tracking: str = "outputs"
    acceleration: str = "linear"
    poles: tuple[float, float] = (2.0, 2.0)


class PaperControl(Control):
    """Thrust and torque, held for a period: the paper's MPC, then its obstacle avoidance controller."""

    def __init__(
        self, parameters: SystemParameters, variant: PaperVariant, figure: Trajectory | None = None,
        spheres: Sequence[Sphere] = (), margin: float = MARGIN,
    ) -> None:  # fmt: skip
        """``figure``: of a flat variant; the others track eq:Lissajous as printed."""
        super().__init__(parameters, figure)
        outputs = variant.tracking == "outputs"
        weights = Weights.of_named_outputs() if outputs else Weights()
        self.variant, self.spheres, self.margin = variant, tuple(spheres), margin
        self._mpc = ThrustTorqueMpc(parameters, Settings(weights=weights, terminal_outputs_alone=outputs))
        self._plant, self._formation = Plant(parameters), Formation(parameters)
        self._linear = linear_acceleration(parameters)
        self._hover = np.column_stack([parameters.hover_thrust, np.zeros((parameters.number_of_uavs, 3))]).ravel()
        self._u = self._hover

    def decide(self, time: float, measured: PlantState) -> None:
        """Take a decision."""
        mpc = self._mpc
        x = minimal_state(measured)
        times = time + PERIOD * np.arange(mpc.settings.horizon + 1, dtype=np.float64)
        if self.figure is None:
            reference = np.zeros((len(times), len(x)))
            reference[:, :3] = printed_reference(times)
            u = np.tile(self._hover, (len(times) - 1, 1))
            state = mpc.F @ x
            free = state - reference
        else:
            reference, u = _flat_in_paper_inputs(self.parameters, self.figure, times)
            free = mpc.F @ (x - reference[0])
            state = reference + free
        move = mpc.solve(free, state, u)
        self.infeasible_tracking += move.infeasible_as_printed
        rows, bounds = self._rows(time, measured, x)
        delta_u = u[0] + move.delta_u - self._hover
        corrected = corrected_input(delta_u, rows, bounds, mpc.lower - self._hover, mpc.upper - self._hover)
        self.avoiding = corrected.active
        self.infeasible_avoidance += corrected.infeasible
        self._u = self._hover + corrected.delta_u

    def act(self, state: PlantState, dt: float) -> tuple[Array, Array]:
        """Return the decision: held over the period."""
        u = self._u.reshape(-1, 4)
        return u[:, 0], u[:, 1:]

    def _rows(self, time: float, state: PlantState, x: Array) -> tuple[Array, Array]:
        if not self.spheres:
            return np.zeros((0, len(self._hover))), np.zeros(0)
        if self.variant.acceleration == "linear":
            # All deviations are small in eq:disSys; the payload's position does not enter.
            A_v, G = self._linear
            a = A_v @ x
        else:
            a, G = nonlinear_acceleration(self._plant, state)
        uavs = self._plant.uav_positions(state)
        points = self._formation.points_in_world(state.r_0, state.quaternion_0, uavs, state.quaternion)
        hull = self._formation.hull(points)
        rows, bounds = [], []
        for sphere in self.spheres:
            position, velocity, acceleration = (part[0] for part in sphere.motion(np.array([time])))
            result = coal.DistanceResult()
            coal.distance(
                hull, coal.Transform3s.Identity(), coal.Sphere(RADIUS), coal.Transform3s(np.eye(3), position),
                coal.DistanceRequest(), result,
            )  # fmt: skip
            encounter = Encounter(
                np.array(result.getNearestPoint1()), state.v_0, position, velocity, acceleration,
                RADIUS + self.margin, np.ones(3),
            )  # fmt: skip
            row, bound = obstacle_row(encounter, a, G, self.variant.poles)
            rows.append(row)
            bounds.append(bound)
        return np.array(rows), np.array(bounds)


class ProjectControl(Control):
    """The project's controller: set-points of attitude and thrust, an attitude loop on board, rotors with a lag."""

    def __init__(
        self, parameters: SystemParameters, figure: Trajectory, spheres: Sequence[Sphere] = (), margin: float = MARGIN,
        extrapolates: bool = False,
    ) -> None:  # fmt: skip
        """``extrapolates``: of the spheres only their motion now is known, not where they will be."""
        super().__init__(parameters, figure)
        self._trajectory, config = figure, configuration()
        model = LinearModel(parameters)
        self._layout = model.layout
        self._safety: SafetyFilter = NoObstacles()
        guidance: Guidance | None = None
        if spheres:
            changed = replace(config, avoidance=replace(config.avoidance, margin=margin))
            known = ExtrapolatedSpheres(spheres) if extrapolates else KnownSpheres(spheres)
            self._safety, guidance = stack.avoidance(changed, model, known), stack.guidance(changed, model, known)
        self._controller = stack.controller(config, model, self._safety, lambda: 0.0, guidance)
        N = parameters.number_of_uavs
        self._directions, self._thrusts = np.tile([0.0, 0.0, -1.0], (N, 1)), parameters.hover_thrust
        self._thrust, self._torque = parameters.hover_thrust, np.zeros((N, 3))

    def decide(self, time: float, measured: PlantState) -> None:
        """Take a decision."""
        N = self._layout.number_of_uavs
        n = self._layout.size + 3 + 2 * N + 1
        estimate = Estimate(
            time, self._state(measured), np.zeros(3), np.zeros((N, 3)), 0.0, np.zeros((3, 3)), lambda: np.zeros((n, n))
        )
        decision = self._controller.decide(estimate, self._trajectory)
        self._directions, self._thrusts = decision.directions, decision.thrusts
        # The plan deviates slightly long before and after an obstacle: only larger deviations count.
        deviation = decision.flat.payload[0, 0] - self._trajectory.position(time)
        self.avoiding = decision.safety.active and float(np.linalg.norm(deviation)) > VISIBLE
        self.infeasible_tracking += decision.infeasible
        self.infeasible_avoidance += decision.safety.infeasible

    def act(self, state: PlantState, dt: float) -> tuple[Array, Array]:
        """Return torques J (kp e - kd omega) and thrusts after the first-order lag of the rotors."""
        p = self.parameters
        R = rotation_from_quaternion(state.quaternion)
        down = np.einsum("ijk,ij->ik", R, np.cross(R[:, :, 2], -self._directions))
        down[:, 2] -= np.arctan2(R[:, 1, 0], R[:, 0, 0])
        demand = np.einsum("ijk,ik->ij", p.J, p.attitude_kp * down - p.attitude_kd * state.omega)
        share = 1.0 - np.exp(-dt / p.motor_time_constant)
        self._torque = self._torque + share * (demand - self._torque)
        self._thrust = self._thrust + share * (np.clip(self._thrusts, 0.0, p.thrust_max) - self._thrust)
        return self._thrust, self._torque

    def _state(self, state: PlantState) -> Array:
        layout, p = self._layout, self.parameters
        x = np.zeros(layout.size)
        x[layout.r_0], x[layout.v_0] = state.r_0, state.v_0
        x[layout.Theta], x[layout.omega] = euler_from_quaternion(state.quaternion_0), state.omega_0
        x[layout.s], x[layout.s_dot] = state.q[:, :2].ravel(), state.q_dot[:, :2].ravel()
        # Thrust directions -R e3 and their derivatives.
        R, e3 = rotation_from_quaternion(state.quaternion), np.array([0.0, 0.0, 1.0])
        rate = np.cross(state.omega, e3)
        second = np.cross(state.omega, rate) + np.cross(np.linalg.solve(p.J, self._torque[:, :, None])[:, :, 0], e3)
        for part, vector in ((layout.n, np.tile(e3, (len(R), 1))), (layout.n_dot, rate), (layout.n_acc, second)):
            x[part] = -np.einsum("ijk,ik->ij", R, vector)[:, :2].ravel()
        x[layout.f] = self._thrust
        return x


def minimal_state(state: PlantState) -> Array:
    """Return the deviation from hover at the origin in the minimal coordinates (12 + 10 N,)."""
    layout = Layout.minimal(len(state.q))
    x = np.zeros(layout.size)
    x[:12] = np.concatenate([state.r_0, state.v_0, euler_from_quaternion(state.quaternion_0), state.omega_0])
    x[layout.of_uavs("s")], x[layout.of_uavs("s_dot")] = state.q[:, :2], state.q_dot[:, :2]
    x[layout.of_uavs("Theta")], x[layout.of_uavs("omega")] = euler_from_quaternion(state.quaternion), state.omega
    return x


def _flat_in_paper_inputs(parameters: SystemParameters, figure: Trajectory, times: Array) -> tuple[Array, Array]:
    """Return the minimal states at ``times`` (K,) and the inputs (K - 1, 4 N) between them that lead through them."""
    load = Load(parameters.m_0, np.zeros(3))
    between = 0.5 * (times[1:] + times[:-1])
    flat = flat_reference(parameters, figure, np.concatenate([times, between]), load)
    K, N = len(times), parameters.number_of_uavs
    source, layout = StateLayout(N), Layout.minimal(N)
    x, u = np.zeros((K, layout.size)), np.zeros((K - 1, N, 4))
    x[:, :6] = flat.x[:K, :6]

    def pairs(part: slice) -> Array:
        return np.asarray(flat.x[:, part].reshape(-1, N, 2))

    x[:, layout.of_uavs("s")], x[:, layout.of_uavs("s_dot")] = pairs(source.s)[:K], pairs(source.s_dot)[:K]
    n = pairs(source.n)
    roll = np.arcsin(n[..., 1])
    pitch = np.arcsin(-n[..., 0] / np.cos(roll))
    x[:, layout.of_uavs("Theta")[:, 0]], x[:, layout.of_uavs("Theta")[:, 1]] = roll[:K], pitch[:K]
    omega, omega_dot = (
        np.stack([part[..., 1] / np.cos(roll), -part[..., 0] / np.cos(pitch)], axis=-1)
        for part in (pairs(source.n_dot), pairs(source.n_acc))
    )
    x[:, layout.of_uavs("omega")[:, :2]] = omega[:K]
    u[..., 1:3] = np.einsum("ijk,tik->tij", parameters.J[:, :2, :2], omega_dot[K:])
    u[..., 0] = flat.x[K:, source.f]
    return x, u.reshape(K - 1, 4 * N)
