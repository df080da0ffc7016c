"""The true state of payload and UAVs from what the engine gives, and the navigation sensors' samples of it.

A row of a state: position (3) in m, attitude (4) body to world, w first, velocity (3) in m/s, rates (3) in the body
frame in rad/s; north-east-down. Row 0 is the payload's.
"""

import math

from idc_controller import rotations_float
from idc_controller.arrays import Array
from idc_controller.compiled import inlined, kernel
from vehicle_sim.world import world_state

#: Columns of a row of a state.
STATE_COLUMNS = 13
#: Columns of a row of what the engine gives.
READING_COLUMNS = 19

_into_body = inlined(rotations_float.into_body)
_product = inlined(world_state.product)
_quaternion_from_engine = inlined(world_state.quaternion_from_engine)


@kernel("void(float64[:, ::1], float64[::1], float64[:, ::1])")
def states_from_engine(readings: Array, payload_in_axes: Array, states: Array) -> None:
    """Write the true ``states`` (M, 13), velocities to second order in the physics step.

    ``readings`` (M, 19) of the engine: position, attitude x first, velocity and angular velocity in its z-up world, and
    those velocities one step earlier; ``payload_in_axes`` (4,): payload frame to principal axes,
    x first, in which the engine has the payload's attitude.

    The engine integrates semi-implicitly: its velocities are those of the middles of the steps.
    """
    for i in range(readings.shape[0]):
        r = readings[i]
        q = (r[3], r[4], r[5], r[6])
        if i == 0:
            a = payload_in_axes
            q = _product(q, (a[0], a[1], a[2], a[3]))
        attitude = _quaternion_from_engine(q)
        states[i, 0], states[i, 1], states[i, 2] = r[0], -r[1], -r[2]
        for k in range(4):
            states[i, 3 + k] = attitude[k]
        states[i, 7] = r[7] + 0.5 * (r[7] - r[13])
        states[i, 8] = -(r[8] + 0.5 * (r[8] - r[14]))
        states[i, 9] = -(r[9] + 0.5 * (r[9] - r[15]))
        rates = _into_body(
            attitude,
            (
                r[10] + 0.5 * (r[10] - r[16]),
                -(r[11] + 0.5 * (r[11] - r[17])),
                -(r[12] + 0.5 * (r[12] - r[18])),
            ),
        )
        states[i, 10], states[i, 11], states[i, 12] = rates


@kernel("void(float64[:, ::1], float64[:, ::1], float64[:, ::1], float64[:, ::1])")
def measure(states: Array, sigmas: Array, normals: Array, samples: Array) -> None:
    """Write the ``samples`` (M, 13) of ``states`` (M, 13): the same columns with white noise, unit quaternions.

    ``sigmas`` (M, 4) of position (m), attitude (rad), velocity (m/s) and rates (rad/s); ``normals`` (M, 12): standard
    normal numbers for attitude, rates, position and velocity.
    """
    for i in range(states.shape[0]):
        n, s = normals[i], states[i]
        w, x, y, z = s[3], s[4], s[5], s[6]
        half = 0.5 * sigmas[i, 1]
        # A small rotation in the body frame, on the right of the attitude.
        a, b, c = half * n[0], half * n[1], half * n[2]
        scale = 1.0 / math.sqrt((1.0 + a * a + b * b + c * c) * (w * w + x * x + y * y + z * z))
        samples[i, 3] = scale * (w - x * a - y * b - z * c)
        samples[i, 4] = scale * (x + w * a + y * c - z * b)
        samples[i, 5] = scale * (y + w * b + z * a - x * c)
        samples[i, 6] = scale * (z + w * c + x * b - y * a)
        for k in range(3):
            samples[i, 10 + k] = s[10 + k] + sigmas[i, 3] * n[3 + k]
            samples[i, k] = s[k] + sigmas[i, 0] * n[6 + k]
            samples[i, 7 + k] = s[7 + k] + sigmas[i, 2] * n[9 + k]
