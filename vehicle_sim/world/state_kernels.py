"""The true state of payload and UAVs and the loads that the engine lacks, and the navigation sensors' samples.

A row of a state: position (3) in m, attitude (4) body to world, w first, velocity (3) in m/s, rates (3) in the body
frame in rad/s; north-east-down. Row 0 is the payload's.
"""

import math

from idc_controller import rotations_float
from idc_controller.arrays import Array
from idc_controller.compiled import inlined, kernel
from idc_controller.rotations_float import Quaternion, Vector
from vehicle_sim.world import world_state
from vehicle_sim.world.velocity_product_kernels import (
    Motion,
    brought_forward,
    gyroscopic,
    plus,
    velocity_products,
)

#: Columns of a row of a state.
STATE_COLUMNS = 13
#: Columns of a row of what the engine gives.
READING_COLUMNS = 13
#: Columns of a row of a part's constants.
PART_COLUMNS = 7
#: Columns of a row of loads.
LOAD_COLUMNS = 6

_into_body = inlined(rotations_float.into_body)
_product = inlined(world_state.product)
_quaternion_from_engine = inlined(world_state.quaternion_from_engine)


@inlined
def _vector(row: Array, k: int) -> Vector:
    return row[k], row[k + 1], row[k + 2]


@inlined
def _write_state(state: Array, place: Vector, attitude: Quaternion, motion: Motion) -> None:
    """Write a row of a state; ``attitude`` is in the project's frames, the other two in the engine's."""
    velocity, rates = motion
    rates = _into_body(attitude, (rates[0], -rates[1], -rates[2]))
    for k in range(3):
        sign = 1.0 if k == 0 else -1.0
        state[k], state[7 + k], state[10 + k] = sign * place[k], sign * velocity[k], rates[k]
    for k in range(4):
        state[3 + k] = attitude[k]


@inlined
def _gyroscopic_load(moments: Vector, attitude: Quaternion, old: Motion, new: Motion) -> Vector:
    """Return by how much w x J w of ``old`` exceeds that of ``new`` (N m), in the body's axes."""
    torque = gyroscopic(moments, _into_body(attitude, old[1]))
    return plus(torque, -1.0, gyroscopic(moments, _into_body(attitude, new[1])))


@inlined
def _motion(row: Array) -> Motion:
    return _vector(row, 7), _vector(row, 10)


@kernel(
    "void(float64[:, ::1], float64[:, ::1], float64[:, ::1], float64[::1], float64, float64[:, ::1], float64[:, ::1])"
)
def states_from_engine(
    readings: Array, before: Array, parts: Array, payload_in_axes: Array, step: float, states: Array, loads: Array
) -> None:
    """Write the true ``states`` (M, 13) of payload and UAVs, and the ``loads`` (M, 6) that the engine lacks.

    States and loads are of second order in the physics step, see :mod:`.velocity_product_kernels`.

    Args:
        readings: of the engine (M, 13): position, attitude x first, velocity and angular velocity in its z-up world.
        before: the same one step earlier (M, 13).
        parts: moments of inertia about the axes of the part's frame in the engine (kg m2), mass (kg), and where its
            link is attached in the payload's principal axes (m) (M, 7).
        payload_in_axes: payload frame to principal axes, x first, in which the engine has the payload's attitude (4,).
        step: the physics step (s); zero: no step led here, the velocities are taken as they are.
        states: is written.
        loads: is written: force (N) and torque (N m) in the part's frame in the engine.
    """
    since = 0.5 * step
    r, part = readings[0], parts[0]
    axes = (r[6], r[3], r[4], r[5])
    to_world = (axes[0], -axes[1], -axes[2], -axes[3])
    none = (0.0, 0.0, 0.0)
    place, old = _vector(r, 0), _motion(r)
    new = brought_forward(old, _motion(before[0]), (none, none), since)
    a = payload_in_axes
    attitude = _product((r[3], r[4], r[5], r[6]), (a[0], a[1], a[2], a[3]))
    _write_state(states[0], place, _quaternion_from_engine(attitude), new)
    torque = _gyroscopic_load(_vector(part, 0), axes, old, new)
    for k in range(3):
        loads[0, k], loads[0, 3 + k] = 0.0, torque[k]
    for i in range(1, readings.shape[0]):
        r, part = readings[i], parts[i]
        q, uav_old = (r[6], r[3], r[4], r[5]), _motion(r)
        arm = _into_body(to_world, _vector(part, 4))
        link = plus(plus(_vector(r, 0), -1.0, place), -1.0, arm)
        products = velocity_products(old, uav_old, arm, link, since)
        uav_new = brought_forward(uav_old, _motion(before[i]), products, since)
        _write_state(states[i], _vector(r, 0), _quaternion_from_engine((r[3], r[4], r[5], r[6])), uav_new)
        products_new = velocity_products(new, uav_new, arm, link, 0.0)
        linear = _into_body(q, plus(products[0], -1.0, products_new[0]))
        angular = _into_body(q, plus(products[1], -1.0, products_new[1]))
        torque = _gyroscopic_load(_vector(part, 0), q, uav_old, uav_new)
        for k in range(3):
            loads[i, k] = part[3] * linear[k]
            loads[i, 3 + k] = part[k] * angular[k] + torque[k]


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
