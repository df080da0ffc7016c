"""Positions and attitudes of the UAVs in a state of the linear model, compiled."""

import math

import numpy as np

from idc_controller.arrays import Array1, Array2, Const1, Const2
from idc_controller.compiled import kernel


@kernel
def vehicle_states(
    payload: Array1, links: Array1, thrusts: Array1, thrusts_dot: Array1, p: Const2, l: Const1
) -> Array2:
    """Return position, velocity, quaternion and body rates (N, 13) of the UAVs, heading north; NED, SI.

    Args:
        payload: r_0, v_0, Theta, omega (12,).
        links: lateral parts of the links' directions s (2 N,), then of their derivatives (2 N,).
        thrusts: lateral parts of the thrusts' directions n (2 N,).
        thrusts_dot: of their derivatives (2 N,).
        p: attachment points (N, 3) (m).
        l: lengths of the links (N,) (m).
    """
    N = len(l)
    states = np.empty((N, 13))
    cr, sr = math.cos(payload[6] / 2), math.sin(payload[6] / 2)
    cp, sp = math.cos(payload[7] / 2), math.sin(payload[7] / 2)
    cy, sy = math.cos(payload[8] / 2), math.sin(payload[8] / 2)
    w, x = cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy
    y, z = cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy
    omega = payload[9:12]
    for i in range(N):
        a, b, c = p[i, 0], p[i, 1], p[i, 2]
        # R p, and omega x R p
        north = a * (1 - 2 * (y * y + z * z)) + b * (2 * (x * y - w * z)) + c * (2 * (x * z + w * y))
        east = a * (2 * (x * y + w * z)) + b * (1 - 2 * (x * x + z * z)) + c * (2 * (y * z - w * x))
        down = a * (2 * (x * z - w * y)) + b * (2 * (y * z + w * x)) + c * (1 - 2 * (x * x + y * y))
        turning_north = omega[1] * down - omega[2] * east
        turning_east = omega[2] * north - omega[0] * down
        turning_down = omega[0] * east - omega[1] * north
        s_x, s_y = links[2 * i], links[2 * i + 1]
        s_x_dot, s_y_dot = links[2 * (N + i)], links[2 * (N + i) + 1]
        # The third parts of unit vectors with these lateral parts.
        s_z = math.sqrt(max(1.0 - (s_x * s_x + s_y * s_y), 0.01))
        s_z_dot = -(s_x * s_x_dot + s_y * s_y_dot) / s_z
        states[i, 0] = payload[0] + north - l[i] * s_x
        states[i, 1] = payload[1] + east - l[i] * s_y
        states[i, 2] = payload[2] + down - l[i] * s_z
        states[i, 3] = payload[3] + turning_north - l[i] * s_x_dot
        states[i, 4] = payload[4] + turning_east - l[i] * s_y_dot
        states[i, 5] = payload[5] + turning_down - l[i] * s_z_dot
        n_x, n_y = thrusts[2 * i], thrusts[2 * i + 1]
        n_z = math.sqrt(max(1.0 - (n_x * n_x + n_y * n_y), 0.01))
        # Roll and pitch, without a turn from north, that tilt the thrust, along -e3, to (n, -n_z).
        roll, pitch = math.asin(n_y), math.atan2(-n_x, n_z)
        cos_roll, sin_roll = math.cos(roll / 2), math.sin(roll / 2)
        cos_pitch, sin_pitch = math.cos(pitch / 2), math.sin(pitch / 2)
        states[i, 6], states[i, 7] = cos_roll * cos_pitch, sin_roll * cos_pitch
        states[i, 8], states[i, 9] = cos_roll * sin_pitch, -sin_roll * sin_pitch
        # n' = -R (omega x e3), and the heading stays.
        about_x = thrusts_dot[2 * i + 1] / math.cos(roll)
        about_y = (math.sin(pitch) * math.sin(roll) * about_x - thrusts_dot[2 * i]) / math.cos(pitch)
        states[i, 10], states[i, 11], states[i, 12] = about_x, about_y, -math.tan(roll) * about_y
    return states
