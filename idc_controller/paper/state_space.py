"""The paper's own state space (eq:stateqn .. eq:disSys), corrected: thrust and torque, Euler angles, links as vectors.

Full state, 12 + 12 N (the paper says 12 + 16 N), grouped by UAV as in eq:stateqn:

    r_0, v_0 (payload frame), Theta_0, omega_0; of each UAV q_i, Omega_i, Theta_i, omega_i; each a (3,)

Input 4 N: of each UAV the thrust f_i and the torque tau_i (3). A link's length along q_i and its spin about q_i are no
motions, so 2 N modes of the full state can never be controlled. The minimal state, 12 + 10 N, has north and east
component of q_i in the world and their rates in their place; :func:`embedding` maps its deviations into the full state.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from idc_controller.arrays import Array
from idc_controller.model.linear import LinearModel
from idc_controller.model.nonlinear import Inputs, SystemState, accelerations, thrust_forces
from idc_controller.parameters import SystemParameters
from idc_controller.rotations import quaternion_from_euler, rotation_from_quaternion

_PAYLOAD = ("r_0", "v_0", "Theta_0", "omega_0")
_FULL = (("q", 3), ("Omega", 3), ("Theta", 3), ("omega", 3))
_MINIMAL = (("s", 2), ("s_dot", 2), ("Theta", 3), ("omega", 3))


@dataclass(frozen=True)
class Layout:
    """Index of each coordinate: ``Layout.full(N)`` or ``Layout.minimal(N)``."""

    number_of_uavs: int
    parts: tuple[tuple[str, int], ...]

    @classmethod
    def full(cls, number_of_uavs: int) -> Layout:
        """Return the layout of the paper's state."""
        return cls(number_of_uavs, _FULL)

    @classmethod
    def minimal(cls, number_of_uavs: int) -> Layout:
        """Return the layout of the minimal state."""
        return cls(number_of_uavs, _MINIMAL)

    @property
    def per_uav(self) -> int:
        """Coordinates of one UAV with its link."""
        return sum(size for _, size in self.parts)

    @property
    def size(self) -> int:
        """Length of the state."""
        return 12 + self.per_uav * self.number_of_uavs

    def payload(self, name: str) -> slice:
        """Return the places of ``r_0``, ``v_0``, ``Theta_0`` or ``omega_0``."""
        begin = 3 * _PAYLOAD.index(name)
        return slice(begin, begin + 3)

    def of_uavs(self, name: str) -> NDArray[np.int_]:
        """Return the places of a UAV coordinate (N, size of the coordinate)."""
        begin = 12
        for part, size in self.parts:
            if part == name:
                first = begin + self.per_uav * np.arange(self.number_of_uavs)
                return first[:, None] + np.arange(size)
            begin += size
        raise KeyError(name)

    def names(self) -> list[str]:
        """A name for each coordinate, for the heads of tables."""
        found = [f"{name}_{axis}" for name in _PAYLOAD for axis in "xyz"]
        for i in range(1, self.number_of_uavs + 1):
            found += [f"{name}{i}_{axis}" for name, size in self.parts for axis in "xyz"[:size]]
        return found


def input_names(number_of_uavs: int) -> list[str]:
    """A name for each input."""
    return [f"{name}{i}" for i in range(1, number_of_uavs + 1) for name in ("f", "tau_x", "tau_y", "tau_z")]


def hover(parameters: SystemParameters) -> tuple[Array, Array]:
    """x_e (12 + 12 N,) and u_e (4 N,) of eq:EqPt at the origin."""
    layout = Layout.full(parameters.number_of_uavs)
    x = np.zeros(layout.size)
    x[layout.of_uavs("q")[:, 2]] = 1.0
    u = np.zeros((parameters.number_of_uavs, 4))
    u[:, 0] = parameters.hover_thrust
    return x, u.ravel()


def derivative(parameters: SystemParameters, x: Array, u: Array) -> Array:
    """x' = f(x, u) of the full state (12 + 12 N,) by eq:kinBeg .. eq:EqEnd; defined off |q_i| = 1, too."""
    N = parameters.number_of_uavs
    layout = Layout.full(N)
    Theta_0, omega_0 = x[layout.payload("Theta_0")], x[layout.payload("omega_0")]
    q, Omega = x[layout.of_uavs("q")], x[layout.of_uavs("Omega")]
    Theta, omega = x[layout.of_uavs("Theta")], x[layout.of_uavs("omega")]
    quaternion_0 = quaternion_from_euler(*Theta_0)
    quaternion = np.array([quaternion_from_euler(*angles) for angles in Theta])
    r_0_dot = rotation_from_quaternion(quaternion_0) @ x[layout.payload("v_0")]
    state = SystemState(x[layout.payload("r_0")], r_0_dot, quaternion_0, omega_0, q, Omega, quaternion, omega)
    thrust, torque = u.reshape(N, 4)[:, 0], u.reshape(N, 4)[:, 1:]
    second = accelerations(parameters, state, Inputs(thrust_forces(quaternion, thrust), torque))
    result = np.empty(layout.size)
    result[layout.payload("r_0")] = r_0_dot
    result[layout.payload("v_0")] = state.R_0.T @ second.r_0_ddot - np.cross(omega_0, x[layout.payload("v_0")])
    result[layout.payload("Theta_0")] = _euler_rates(Theta_0, omega_0)
    result[layout.payload("omega_0")] = second.omega_0_dot
    result[layout.of_uavs("q")] = np.cross(Omega - omega_0, q)
    result[layout.of_uavs("Omega")] = second.Omega_dot
    result[layout.of_uavs("Theta")] = [_euler_rates(a, w) for a, w in zip(Theta, omega, strict=True)]
    result[layout.of_uavs("omega")] = second.omega_dot
    return result


def linearised(parameters: SystemParameters) -> tuple[Array, Array]:
    """Continuous A (n, n) and B (n, 4 N) of the full state at hover, by central differences of :func:`derivative`."""
    x_e, u_e = hover(parameters)
    A = _jacobian(lambda x: derivative(parameters, x, u_e), x_e)
    B = _jacobian(lambda u: derivative(parameters, x_e, u), u_e)
    return A, B


def minimal(parameters: SystemParameters) -> tuple[Array, Array]:
    """Continuous A (12 + 10 N squared) and B (., 4 N) of the minimal state, in closed form.

    Payload and links are those of :class:`LinearModel`; its UAV tilts are n = (-pitch, roll), and in place of its
    attitude loop and motor lag stand thrust and torque themselves.
    """
    model = LinearModel(parameters)
    N, from_ = parameters.number_of_uavs, model.layout
    to = Layout.minimal(N)
    kept = np.concatenate([np.arange(12), to.of_uavs("s").ravel(), to.of_uavs("s_dot").ravel()])
    source = np.concatenate([np.arange(12), np.arange(from_.s.start, from_.s_dot.stop)])
    A, B = np.zeros((to.size, to.size)), np.zeros((to.size, 4 * N))
    A[np.ix_(kept, kept)] = model.A[np.ix_(source, source)]
    tilt = model.A[source, from_.n].reshape(len(source), N, 2)
    Theta, omega = to.of_uavs("Theta"), to.of_uavs("omega")
    A[np.ix_(kept, Theta[:, 1])] = -tilt[:, :, 0]
    A[np.ix_(kept, Theta[:, 0])] = tilt[:, :, 1]
    A[Theta.ravel(), omega.ravel()] = 1.0
    B[np.ix_(kept, np.arange(0, 4 * N, 4))] = model.A[source, from_.f]
    for i in range(N):
        B[np.ix_(omega[i], np.arange(4 * i + 1, 4 * i + 4))] = np.linalg.inv(parameters.J[i])
    return A, B


def embedding(parameters: SystemParameters) -> Array:
    """T (12 + 12 N, 12 + 10 N): to first order a deviation of the full state is T times one of the minimal state."""
    N = parameters.number_of_uavs
    full, small = Layout.full(N), Layout.minimal(N)
    T = np.zeros((full.size, small.size))
    T[:12, :12] = np.eye(12)
    q, Omega, s, s_dot = full.of_uavs("q"), full.of_uavs("Omega"), small.of_uavs("s"), small.of_uavs("s_dot")
    pitch, roll = small.payload("Theta_0").start + 1, small.payload("Theta_0").start
    for i in range(N):
        # q_i in the payload frame: the payload's own tilt turns against it. Omega_i = q_i x q_i' in the world.
        T[q[i, 0], s[i, 0]] = T[q[i, 1], s[i, 1]] = 1.0
        T[q[i, 0], pitch], T[q[i, 1], roll] = -1.0, 1.0
        T[Omega[i, 0], s_dot[i, 1]], T[Omega[i, 1], s_dot[i, 0]] = -1.0, 1.0
        for name in ("Theta", "omega"):
            T[full.of_uavs(name)[i], small.of_uavs(name)[i]] = 1.0
    return T


def uncontrollable_modes(A: Array, B: Array, tolerance: float = 1e-6) -> list[complex]:
    """Eigenvalues of ``A`` that no input reaches, each as often as it is unreached (Popov, Belevitch, Hautus)."""
    n, found = len(A), []
    left: list[complex] = []
    for value in np.linalg.eigvals(A):
        if all(abs(value - other) > 1e-3 for other in left):
            left.append(complex(value))
    for value in left:
        # Multiple eigenvalues come out of the solver apart by the root of the rounding error: taken at their mean.
        near = [complex(v) for v in np.linalg.eigvals(A) if abs(v - value) < 1e-3]
        centre = sum(near) / len(near)
        singular = np.linalg.svd(np.hstack([centre * np.eye(n) - A, B]), compute_uv=False)
        found += [centre] * int(np.sum(singular < tolerance * singular[0]))
    return found


def relative_degrees(A: Array, B: Array, C: Array, tolerance: float = 1e-9) -> NDArray[np.int_]:
    """Return the least derivative of each output (p) of y = C x that each input (m) reaches, (p, m); 0: none.

    The first k with C A^(k-1) B other than zero, measured against the largest of that order; within n, by Cayley and
    Hamilton none comes later.
    """
    degrees = np.zeros((len(C), B.shape[1]), dtype=int)
    row = C.copy()
    for k in range(1, len(A) + 1):
        reached = np.abs(row @ B) > tolerance * np.linalg.norm(row, axis=1, keepdims=True) * np.linalg.norm(B, axis=0)
        degrees[(degrees == 0) & reached] = k
        row = row @ A
        # Only the direction counts, and entries that cancel must not grow.
        row /= np.maximum(np.linalg.norm(row, axis=1, keepdims=True), 1e-300)
    return degrees


def _euler_rates(angles: Array, omega: Array) -> Array:
    roll, pitch, _ = angles
    lateral = np.sin(roll) * omega[1] + np.cos(roll) * omega[2]
    return np.array(
        [
            omega[0] + np.tan(pitch) * lateral,
            np.cos(roll) * omega[1] - np.sin(roll) * omega[2],
            lateral / np.cos(pitch),
        ]
    )


def _jacobian(function: Callable[[Array], Array], at: Array, step: float = 1e-5) -> Array:
    columns = []
    for i in range(len(at)):
        offset = np.zeros(len(at))
        offset[i] = step
        columns.append((function(at + offset) - function(at - offset)) / (2.0 * step))
    J = np.array(columns).T
    J[np.abs(J) < 1e-9] = 0.0  # rounding, where the derivative is zero
    return J
