"""The true state of payload and UAVs and the loads that the engine lacks, and the navigation sensors' samples.

A row of a state: position (3) in m, attitude (4) body to world, w first, velocity (3) in m/s, rates (3) in the body
frame in rad/s; north-east-down. Row 0 is the payload's.
"""

import math

from idc_controller import rotations_float
from idc_controller.arrays import Array, Array1, Array2
from idc_controller.compiled import inlined, kernel
from idc_controller.rotations_float import Quaternion, Vector
from vehicle_sim.world import world_state
from vehicle_sim.world.velocity_product_kernels import (
    Motion,
    cross,
    dot,
    gyroscopic,
    link_rates,
    plus,
    turned,
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
#: Columns of a row of memory, and the first one of what says how a link turns about its axis.
MEMORY_COLUMNS, AXIS = 16, 12

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


@inlined
def _lead(memory: Array, k: int, rates: Vector, before: Vector, change_before: Vector, steps: int) -> Vector:
    """Return by how much ``rates`` will have changed half a step later, and write them with their last change.

    ``before``: the same one step earlier, and ``change_before``: its change then; ``steps`` that they follow.
    """
    change = plus(rates, -1.0, before)
    for j in range(3):
        memory[k + j], memory[6 + k + j] = rates[j], change[j]
    if steps == 0:
        return 0.0, 0.0, 0.0
    if steps == 1:
        return 0.5 * change[0], 0.5 * change[1], 0.5 * change[2]
    return plus((0.875 * change[0], 0.875 * change[1], 0.875 * change[2]), -0.375, change_before)


@kernel
def states_from_engine(
    readings: Array2, parts: Array2, payload_in_axes: Array1, step: float, steps: int,
    memory: Array2, states: Array2, loads: Array2,
) -> None:  # fmt: skip
    """Write the true ``states`` (M, 13) of payload and UAVs, and the ``loads`` (M, 6) that the engine lacks.

    See :mod:`.velocity_product_kernels`.

    Args:
        readings: of the engine (M, 13): position, attitude x first, velocity and angular velocity in its z-up world.
        parts: moments of inertia about the axes of the part's frame in the engine (kg m2), mass (kg), and where its
            link is attached in the payload's principal axes (m) (M, 7).
        payload_in_axes: payload frame to principal axes, x first, in which the engine has the payload's attitude (4,).
        step: the physics step (s).
        steps: number of steps in a row that led here without contact. After none velocities are taken as they are, and
            no load is missing.
        memory: of the step before (M, 16), and is written for the next one: the payload's velocity and rates in the
            world, the link's against the payload and the UAV's against the link in its own frame (6); how they changed
            in the last step (6); the axis of the link (3) and its angular velocity about it (rad/s) as the engine will
            have it after a step in which the axis does not change.
        states: is written.
        loads: is written: force (N) and torque (N m) in the part's frame in the engine.
    """
    r, part, last = readings[0], parts[0], memory[0]
    axes = (r[6], r[3], r[4], r[5])
    to_world = (axes[0], -axes[1], -axes[2], -axes[3])
    place, payload = _vector(r, 0), _motion(r)
    lead_v = _lead(last, 0, payload[0], _vector(last, 0), _vector(last, 6), steps)
    lead_w = _lead(last, 3, payload[1], _vector(last, 3), _vector(last, 9), steps)
    payload_new = plus(payload[0], 1.0, lead_v), plus(payload[1], 1.0, lead_w)
    a = payload_in_axes
    attitude = _product((r[3], r[4], r[5], r[6]), (a[0], a[1], a[2], a[3]))
    _write_state(states[0], place, _quaternion_from_engine(attitude), payload_new)
    torque = _gyroscopic_load(_vector(part, 0), axes, payload, payload_new)
    by_payload = (step * payload[1][0], step * payload[1][1], step * payload[1][2])
    for k in range(3):
        loads[0, k], loads[0, 3 + k] = 0.0, torque[k]
    for i in range(1, readings.shape[0]):
        r, part, last = readings[i], parts[i], memory[i]
        q, uav = (r[6], r[3], r[4], r[5]), _motion(r)
        from_body = (q[0], -q[1], -q[2], -q[3])
        arm = _into_body(to_world, _vector(part, 4))
        link = plus(plus(_vector(r, 0), -1.0, place), -1.0, arm)
        length = math.sqrt(dot(link, link))
        axis = (link[0] / length, link[1] / length, link[2] / length)
        # Nothing turns a link about its own axis, the engine's products of old velocities do.
        about = last[AXIS + 3] + dot(plus(axis, -1.0, _vector(last, AXIS)), payload[1])
        turning = link_rates(payload, uav[0], arm, link, axis, about)
        last[AXIS + 3] = about - step * dot(axis, cross(payload[1], turning))
        relative = plus(turning, -1.0, payload[1])
        by_joint = (step * relative[0], step * relative[1], step * relative[2])
        # A joint's rates are constant in the frame of the link, which the step has turned.
        before = turned(turned(_vector(last, 0), by_payload), by_joint)
        change_before = turned(turned(_vector(last, 6), by_payload), by_joint)
        lead_turning = plus(lead_w, 1.0, _lead(last, 0, relative, before, change_before, steps))
        own = _into_body(q, plus(uav[1], -1.0, turning))
        lead_own = _lead(last, 3, own, _vector(last, 3), _vector(last, 9), steps)
        uav_new = (
            plus(plus(plus(uav[0], 1.0, lead_v), 1.0, cross(lead_w, arm)), 1.0, cross(lead_turning, link)),
            plus(plus(uav[1], 1.0, lead_turning), 1.0, _into_body(from_body, lead_own)),
        )
        _write_state(states[i], _vector(r, 0), _quaternion_from_engine((r[3], r[4], r[5], r[6])), uav_new)
        products = velocity_products(payload[1], turning, uav[1], arm, link)
        turning_new = plus(turning, 1.0, lead_turning)
        products_new = velocity_products(payload_new[1], turning_new, uav_new[1], arm, link)
        linear = _into_body(q, plus(products[0], -1.0, products_new[0]))
        angular = _into_body(q, plus(products[1], -1.0, products_new[1]))
        torque = _gyroscopic_load(_vector(part, 0), q, uav, uav_new)
        for k in range(3):
            last[AXIS + k] = axis[k]
            loads[i, k] = part[3] * linear[k]
            loads[i, 3 + k] = part[k] * angular[k] + torque[k]


@kernel
def measure(states: Array2, sigmas: Array2, normals: Array2, samples: Array2) -> None:
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
