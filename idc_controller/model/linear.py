"""Linear model about hover (eq:disSys), in minimal coordinates, with the onboard attitude loop and the motor lag.

The paper linearises with thrust and torque as inputs and with three-vectors for the links; that form has uncontrollable
modes and leaves out what the vehicles do with a set-point. Here the inputs are what goes over the wire (attitude and
thrust set-points) and every state is controllable. Coordinates, all deviations from hover in the world frame (NED):

========== ========= ======================================================================================
``r_0``    (3,)      payload position (m)
``v_0``    (3,)      payload velocity (m/s)
``Theta``  (3,)      payload roll, pitch, yaw (rad)
``omega``  (3,)      payload rates (rad/s)
``s``      (N, 2)    link tilt: north and east component of the unit vector from UAV to payload
``s_dot``  (N, 2)    its rate (1/s)
``n``      (N, 2)    UAV tilt: north and east component of the unit vector along the thrust
``n_dot``  (N, 2)    its rate (1/s)
``n_acc``  (N, 2)    its acceleration (1/s2), which lags the attitude loop's demand by the motors
``f``      (N,)      thrust (N)
========== ========= ======================================================================================

Inputs: ``n`` set-points (N, 2), then thrust set-points (N,). Disturbances (N): a force on the payload (3,), and a level
one on each of the UAVs (N, 2).
"""

from functools import cached_property, lru_cache

import numpy as np
from scipy.linalg import expm

from idc_controller.arrays import Array
from idc_controller.parameters import SystemParameters
from idc_controller.rotations import hat

E3 = np.array([0.0, 0.0, 1.0])


class StateLayout:
    """Index of each coordinate in the state vector (12 + 11 N) and the input vector (3 N)."""

    r_0, v_0, Theta, omega = slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 12)

    def __init__(self, number_of_uavs: int) -> None:
        self.number_of_uavs = N = number_of_uavs
        self.size, self.inputs = 12 + 11 * N, 3 * N
        self.s, self.s_dot, self.n, self.n_dot, self.n_acc = (
            slice(12 + 2 * k * N, 12 + 2 * (k + 1) * N) for k in range(5)
        )
        self.f = slice(12 + 10 * N, self.size)
        self.n_setpoint, self.f_setpoint = slice(0, 2 * N), slice(2 * N, self.inputs)


class LinearModel:
    """Continuous matrices ``A`` (n, n), ``B`` (n, 3N), ``B_d`` (n, 3 + 2 N), and their exact discretisation.

    Columns of ``B_d``: a force on the payload (3,), then north and east of one on each of the UAVs (N, 2) (N).
    """

    def __init__(self, parameters: SystemParameters) -> None:
        self.parameters = parameters
        self.layout = StateLayout(parameters.number_of_uavs)
        self.A, self.B, self.B_d = _continuous(parameters, self.layout)
        self.discretised = lru_cache(maxsize=256)(self._discretised)

    def _discretised(self, interval_us: int) -> tuple[Array, Array, Array]:
        """``A_k, B_k, B_dk`` for inputs held over ``interval_us`` microseconds (whole, so that they are kept)."""
        A_k, driven = discretised(self.A, np.hstack([self.B, self.B_d]), interval_us * 1e-6)
        m = self.layout.inputs
        return A_k, driven[:, :m].copy(), driven[:, m:].copy()

    @cached_property
    def uav_position_rows(self) -> Array:
        """``C`` with UAV positions = C x, (3N, n): r_i = r_0 + Theta x p_i - l_i s_i to first order."""
        return _kinematic_rows(self.parameters, self.layout, self.layout.r_0, self.layout.Theta, self.layout.s)

    @cached_property
    def uav_velocity_rows(self) -> Array:
        """``C`` with UAV velocities = C x, (3N, n)."""
        return _kinematic_rows(self.parameters, self.layout, self.layout.v_0, self.layout.omega, self.layout.s_dot)


def discretised(A: Array, B: Array, duration: float) -> tuple[Array, Array]:
    """Return ``A`` (n, n) and ``B`` (n, m) for inputs that are held over a ``duration`` (s), exactly."""
    n, m = B.shape
    block = np.zeros((n + m, n + m))
    block[:n, :n], block[:n, n:] = A, B
    step = expm(block * duration)
    return step[:n, :n].copy(), step[:n, n:].copy()


def _kinematic_rows(
    parameters: SystemParameters, layout: StateLayout, translation: slice, rotation: slice, tilt: slice
) -> Array:
    rows = np.zeros((3 * layout.number_of_uavs, layout.size))
    for i, (p, l) in enumerate(zip(parameters.p, parameters.l, strict=True)):
        uav = slice(3 * i, 3 * i + 3)
        rows[uav, translation] = np.eye(3)
        # With the links at rest in the world a payload rotation moves the attachment points alone.
        rows[uav, rotation] = -hat(p)
        rows[3 * i, tilt.start + 2 * i] = rows[3 * i + 1, tilt.start + 2 * i + 1] = -l
    return rows


def _continuous(parameters: SystemParameters, layout: StateLayout) -> tuple[Array, Array, Array]:
    """Newton-Euler with the link tensions eliminated, to first order.

    UAV i:    m_i a_i = F_i + m_i g e3 + T_i s_i + w_i,   a_i = dv_0 + domega x p_i - l_i dds_i
    payload:  m_0 dv_0 = m_0 g e3 - sum T_i s_i + d,   J_0 domega = -sum p_i x R_0^T T_i s_i
    """
    N, n = layout.number_of_uavs, layout.size
    tension = parameters.m_0 * parameters.payload_share * parameters.g
    hover = parameters.hover_thrust
    T_m, kp, kd = parameters.motor_time_constant, parameters.attitude_kp, parameters.attitude_kd

    # Rows of generalised force on (r_0, Theta): functions of the state, of the thrusts' lateral part, of d.
    mass = np.zeros((6, 6))
    mass[:3, :3], mass[3:, 3:] = parameters.m_0 * np.eye(3), parameters.J_0
    force = np.zeros((6, n))
    s, f = layout.s, layout.f
    for i, p in enumerate(parameters.p):
        jacobian = np.hstack([np.eye(3), -hat(p)])  # acceleration of the attachment point
        # The vertical motion of a UAV is that of its attachment point: dT_i = m_i a_z + df_i.
        mass += parameters.m[i] * np.outer(jacobian[2], jacobian[2])
        force[:, f.start + i] -= jacobian[2]
        # Laterally the link pulls the payload with T_i s_i, turned into the payload frame for its moment.
        for axis in range(2):
            force[:, s.start + 2 * i + axis] -= tension[i] * jacobian[axis]
        force[3:, layout.Theta] += hat(p) @ (tension[i] * -hat(E3))
    acceleration = np.linalg.solve(mass, force)

    A = np.zeros((n, n))
    A[layout.r_0, layout.v_0] = np.eye(3)
    A[layout.v_0] = acceleration[:3]
    A[layout.Theta, layout.omega] = np.eye(3)
    A[layout.omega] = acceleration[3:]
    B_d = np.zeros((n, 3 + 2 * N))
    disturbed = np.linalg.solve(mass, np.vstack([np.eye(3), np.zeros((3, 3))]))
    B_d[layout.v_0, :3], B_d[layout.omega, :3] = disturbed[:3], disturbed[3:]

    A[s, layout.s_dot] = np.eye(2 * N)
    A[layout.n, layout.n_dot] = np.eye(2 * N)
    A[layout.n_dot, layout.n_acc] = np.eye(2 * N)
    A[layout.n_acc, layout.n] = -kp / T_m * np.eye(2 * N)
    A[layout.n_acc, layout.n_dot] = -kd / T_m * np.eye(2 * N)
    A[layout.n_acc, layout.n_acc] = -1.0 / T_m * np.eye(2 * N)
    A[f, f] = -1.0 / T_m * np.eye(N)
    for i, (p, l) in enumerate(zip(parameters.p, parameters.l, strict=True)):
        lateral = np.hstack([np.eye(3), -hat(p)])[:2]
        rows = slice(layout.s_dot.start + 2 * i, layout.s_dot.start + 2 * i + 2)
        # l dds = (acceleration of the attachment point) - (lateral force on the UAV) / m_i
        A[rows] = lateral @ acceleration / l
        B_d[rows, :3] = lateral @ disturbed / l
        for axis in range(2):
            B_d[rows.start + axis, 3 + 2 * i + axis] = -1.0 / (parameters.m[i] * l)
            A[rows.start + axis, s.start + 2 * i + axis] -= tension[i] / (parameters.m[i] * l)
            A[rows.start + axis, layout.n.start + 2 * i + axis] -= hover[i] / (parameters.m[i] * l)

    B = np.zeros((n, layout.inputs))
    B[layout.n_acc, layout.n_setpoint] = kp / T_m * np.eye(2 * N)
    B[f, layout.f_setpoint] = 1.0 / T_m * np.eye(N)
    return A, B, B_d
