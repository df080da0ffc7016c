"""The flat map in plain numpy: the reference of the compiled one."""

import numpy as np

from idc_controller.model.drag import SMOOTHING
from idc_controller.model.linear import StateLayout
from idc_controller.trajectory.flatness import STENCIL, FlatForces, FlatReference

E3 = np.array([0.0, 0.0, 1.0])


def flat_forces(parameters, derivatives, load):
    """Link directions, tensions and UAV forces for payload ``derivatives`` (5, K, 3) under ``load``."""
    acceleration, jerk, snap = derivatives[2], derivatives[3], derivatives[4]
    gravity = parameters.g * E3
    on_payload = np.broadcast_to(load.force, acceleration.shape)
    on_uavs = np.broadcast_to(load.uav_force, (len(acceleration), parameters.number_of_uavs, 3))
    if load.air is not None:
        drag, drag_dot, drag_ddot = payload_drag_along(load.air, derivatives)
        on_payload = on_payload + drag
        # The UAVs' own velocity differs little from the payload's.
        on_uavs = on_uavs + load.air.on_uav(derivatives[1])[:, None]
        jerk, snap = jerk - drag_dot / load.mass, snap - drag_ddot / load.mass
    w = gravity - acceleration + on_payload / load.mass
    norm = np.sqrt(_dot(w, w))
    q = w / norm
    norm_dot = -_dot(q, jerk)
    q_dot = (-jerk - norm_dot * q) / norm
    norm_ddot = -_dot(q, snap) + norm * _dot(q_dot, q_dot)
    q_ddot = (-snap - norm_ddot * q - 2.0 * norm_dot * q_dot) / norm

    tension = _tensions(parameters, q, load.mass * norm[:, 0])
    uav_acceleration = acceleration[:, None, :] - parameters.l[:, None] * q_ddot[:, None, :]
    force = parameters.m[:, None] * (uav_acceleration - gravity) - tension[..., None] * q[:, None, :]
    force -= on_uavs
    return FlatForces(q, q_dot, q_ddot, tension, force, on_payload, on_uavs)


def flat_reference(parameters, trajectory, times, load):
    """Exact reference at ``times`` (K,) (s): states and the set-points that hold the vehicles on it."""
    K, N = len(times), parameters.number_of_uavs
    stencil = np.arange(-2, 3) * STENCIL
    grid = (np.asarray(times)[:, None] + stencil).ravel()
    # A horizon with the stencil's spacing needs most times five times over.
    _, chosen, back = np.unique(np.round(grid, 9), return_index=True, return_inverse=True)
    derivatives = trajectory.derivatives(grid[chosen])
    forces = flat_forces(parameters, derivatives, load)
    F = forces.force[back].reshape(K, 5, N, 3)
    f = np.sqrt(_dot(F, F))
    n = F[..., :2] / f
    f = f[..., 0]

    centre = back[2::5]
    h = STENCIL
    n_dot = (n[:, 3] - n[:, 1]) / (2 * h)
    n_acc = (n[:, 3] - 2 * n[:, 2] + n[:, 1]) / h**2
    n_jerk = (n[:, 4] - 2 * n[:, 3] + 2 * n[:, 1] - n[:, 0]) / (2 * h**3)
    f_dot = (f[:, 3] - f[:, 1]) / (2 * h)

    layout = StateLayout(N)
    payload = derivatives[:, centre]
    x = np.zeros((K, layout.size))
    x[:, layout.r_0], x[:, layout.v_0] = payload[0], payload[1]
    x[:, layout.s] = np.tile(forces.q[centre, :2], N)
    x[:, layout.s_dot] = np.tile(forces.q_dot[centre, :2], N)
    x[:, layout.n], x[:, layout.n_dot] = n[:, 2].reshape(K, -1), n_dot.reshape(K, -1)
    x[:, layout.n_acc], x[:, layout.f] = n_acc.reshape(K, -1), f[:, 2]

    # The attitude loop and the motor lag inverted: the set-point leads the attitude.
    kp, kd, T_m = parameters.attitude_kp, parameters.attitude_kd, parameters.motor_time_constant
    u = np.zeros((K, layout.inputs))
    u[:, layout.n_setpoint] = (n[:, 2] + (kd * n_dot + n_acc + T_m * n_jerk) / kp).reshape(K, -1)
    u[:, layout.f_setpoint] = f[:, 2] + T_m * f_dot
    links = FlatForces(*(values[centre] for values in forces))
    return FlatReference(payload, links, x, u)


def _tensions(parameters, q, total):
    """Least-norm link tensions (K, N) that sum to ``total`` (K,) and leave the payload without moment."""
    p = parameters.p
    balance = np.empty((len(q), 3, parameters.number_of_uavs))
    balance[:, 0] = 1.0
    # The moment p x q T; its component along q is zero, so two of the three suffice.
    balance[:, 1] = np.outer(q[:, 2], p[:, 1]) - np.outer(q[:, 1], p[:, 2])
    balance[:, 2] = np.outer(q[:, 0], p[:, 2]) - np.outer(q[:, 2], p[:, 0])
    wanted = np.zeros((len(q), 3, 1))
    wanted[:, 0, 0] = total
    transposed = balance.transpose(0, 2, 1)
    return np.asarray((transposed @ np.linalg.solve(balance @ transposed, wanted))[..., 0])


def _dot(a, b):
    return np.asarray(np.einsum("...i,...i->...", a, b)[..., None])


def payload_drag_along(air, derivatives):
    """Force and its first two derivatives (3, K, 3) along ``derivatives`` (4 or more, K, 3): position to jerk."""
    u, u_dot, u_ddot = air.wind - derivatives[1], -derivatives[2], -derivatives[3]
    size = _size(u)
    along = u * u_dot / size
    s = (size @ air.payload)[..., None]
    s_dot = (along @ air.payload)[..., None]
    s_ddot = (((u_dot**2 + u * u_ddot - along**2) / size) @ air.payload)[..., None]
    F, F_dot, F_ddot = s * u, s_dot * u + s * u_dot, s_ddot * u + 2.0 * s_dot * u_dot + s * u_ddot
    square = _dot(F, F)
    square_dot, square_ddot = 2.0 * _dot(F, F_dot), 2.0 * (_dot(F_dot, F_dot) + _dot(F, F_ddot))
    c, c_1, c_2 = _fading(square, air.limit)
    c_dot, c_ddot = c_1 * square_dot, c_2 * square_dot**2 + c_1 * square_ddot
    return np.stack([c * F, c_dot * F + c * F_dot, c_ddot * F + 2.0 * c_dot * F_dot + c * F_ddot])


def _size(u):
    return np.sqrt(u * u + SMOOTHING * SMOOTHING)


def _fading(square, limit):
    """(1 + |F|^4 / limit^4)^(-1/4) and its first two derivatives by |F|^2, at ``square`` = |F|^2."""
    a = limit**-4
    z = 1.0 + a * square**2
    c = z**-0.25
    c_1 = -0.5 * a * square * c / z
    return c, c_1, -0.5 * a * c / z + 1.25 * a * a * square**2 * c / z**2


class Wave:
    """A smooth three-dimensional curve with all its derivatives; as wild as a figure eight at 3 m/s2."""

    amplitude = np.array([6.0, -3.0, 0.4])
    frequency = np.array([0.5, 1.0, 0.7])

    def derivatives(self, times, order=4):
        phase = np.asarray(times)[:, None] * self.frequency
        return np.stack([self.amplitude * self.frequency**k * np.sin(phase + k * np.pi / 2) for k in range(order + 1)])
