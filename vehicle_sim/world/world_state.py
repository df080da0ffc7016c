"""The state of the world, north-east-down, and the transformation from the engine's z-up frame.

The engine's world is north-west-up and its bodies are forward-left-up. Both differ from the project's frames by half a
turn about the first axis, so a vector and the vector part of a quaternion change the same way: (x, -y, -z).
The engine's quaternions are x-first. Both stay inside the world modules.
"""

from collections.abc import Sequence
from typing import NamedTuple

from idc_controller.rotations_float import Quaternion, Vector, into_body


class UavState(NamedTuple):
    """The true state of one UAV.

    ``position_in_world`` (m) and ``velocity_in_world`` (m/s) of its centre of mass, NED; ``quaternion`` body to
    world, w first; ``rates_in_body`` angular velocity in its own frame (rad/s); ``thrust`` of the last step (N);
    ``cradled``: held by its cradle.
    """

    position_in_world: Vector
    quaternion: Quaternion
    velocity_in_world: Vector
    rates_in_body: Vector
    thrust: float
    cradled: bool


class WorldState(NamedTuple):
    """The true state at ``time`` (s) since the world was made.

    Payload: ``payload_position_in_world`` (m) and ``payload_velocity_in_world`` (m/s) of the centre of mass, NED;
    ``payload_quaternion`` payload frame to world, w first; ``payload_rates_in_payload`` angular velocity in the
    payload frame (rad/s). ``uavs`` in the order of the system's parameters.
    """

    time: float
    payload_position_in_world: Vector
    payload_quaternion: Quaternion
    payload_velocity_in_world: Vector
    payload_rates_in_payload: Vector
    uavs: tuple[UavState, ...]


class FreeState(NamedTuple):
    """The true state of UAVs without a payload at ``time`` (s) since the world was made, in the order of their ids."""

    time: float
    uavs: tuple[UavState, ...]


def flipped(v: Sequence[float]) -> Vector:
    """A vector between the engine's frames and the project's, in either direction."""
    return v[0], -v[1], -v[2]


def quaternion_from_engine(q: Sequence[float]) -> Quaternion:
    """x-first, forward-left-up to north-west-up -> w-first, forward-right-down to north-east-down; w >= 0."""
    if q[3] < 0.0:
        return -q[3], -q[0], q[1], q[2]
    return q[3], q[0], -q[1], -q[2]


def product(a: Sequence[float], b: Sequence[float]) -> Quaternion:
    """Return the product of two x-first quaternions of the engine."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def rotated(q: Sequence[float], v: Sequence[float]) -> Vector:
    """Return ``v`` rotated by an x-first quaternion of the engine."""
    return into_body((q[3], -q[0], -q[1], -q[2]), (v[0], v[1], v[2]))


def upward_axis(q: Sequence[float]) -> Vector:
    """Return the upward axis of a body in the engine's world; ``q``: its attitude there, x-first."""
    x, y, z, w = q
    return 2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)


def quaternion_to_engine(q: Sequence[float]) -> Quaternion:
    """The inverse of :func:`quaternion_from_engine`."""
    return q[1], -q[2], -q[3], q[0]
