"""The world's true state in the coordinates of the controller's linear model."""

import numpy as np

from idc_controller.model.linear import StateLayout
from idc_controller.rotations import euler_from_quaternion, rotation_from_quaternion


def true_state(state, parameters):
    """x (12 + 11 N,) of a WorldState; ``n_acc``, which neither sensors nor world measure, is nan."""
    layout = StateLayout(parameters.number_of_uavs)
    x = np.full(layout.size, np.nan)
    r_0, v_0 = np.array(state.payload_position_in_world), np.array(state.payload_velocity_in_world)
    R_0 = rotation_from_quaternion(np.array(state.payload_quaternion))
    omega_0 = np.array(state.payload_rates_in_payload)
    x[layout.r_0], x[layout.v_0] = r_0, v_0
    x[layout.Theta] = euler_from_quaternion(np.array(state.payload_quaternion))
    x[layout.omega] = omega_0
    r_i = np.array([uav.position_in_world for uav in state.uavs])
    v_i = np.array([uav.velocity_in_world for uav in state.uavs])
    attached = r_0 + parameters.p @ R_0.T
    attached_dot = v_0 + np.cross(omega_0, parameters.p) @ R_0.T
    x[layout.s] = ((attached - r_i) / parameters.l[:, None])[:, :2].ravel()
    x[layout.s_dot] = ((attached_dot - v_i) / parameters.l[:, None])[:, :2].ravel()
    R = rotation_from_quaternion(np.array([uav.quaternion for uav in state.uavs]))
    omega = np.array([uav.rates_in_body for uav in state.uavs])
    x[layout.n] = -R[:, :2, 2].ravel()
    spin = np.cross(omega, [0.0, 0.0, 1.0])
    x[layout.n_dot] = -np.einsum("ijk,ik->ij", R, spin)[:, :2].ravel()
    x[layout.f] = [uav.thrust for uav in state.uavs]
    return x


def known_to_the_world(layout):
    """Indices of the coordinates that :func:`true_state` has."""
    return np.setdiff1d(np.arange(layout.size), np.arange(layout.n_acc.start, layout.n_acc.stop))
