"""The engine's generalised velocities, and the accelerations by products of them (Coriolis, centripetal).

The engine is a leapfrog: at the time t of the poses it has the generalised velocities of half a step earlier, the
payload's and the joints' in the child's frame, and changes them by the forces and the mass matrix at t. The products it
takes from the old velocities, which makes them, and with them its motion, of first order in the step. What follows
finds the velocities at t, to third order by those of three steps, and thereby the loads that are missing: what is left
of second order is the same forwards and backwards in time, so that energy does not drift. All vectors are in one frame
that does not turn, but where another is named.
"""

from idc_controller.compiled import inlined
from idc_controller.rotations_float import Vector

Motion = tuple[Vector, Vector]
"""A velocity (m/s) and an angular velocity (rad/s); of the products a linear and an angular acceleration."""


@inlined
def dot(a: Vector, b: Vector) -> float:
    """Return the scalar product of ``a`` and ``b``."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def cross(a: Vector, b: Vector) -> Vector:
    """Return the cross product of ``a`` and ``b``."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def plus(a: Vector, factor: float, b: Vector) -> Vector:
    """Return ``a + factor * b``."""
    return a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]


@inlined
def turned(v: Vector, rotation: Vector) -> Vector:
    """Return ``v`` turned by a small rotation vector (rad), to its second order."""
    once = cross(rotation, v)
    return plus(plus(v, 1.0, once), 0.5, cross(rotation, once))


@inlined
def gyroscopic(moments: Vector, rates: Vector) -> Vector:
    """Return w x J w (N m) of ``rates`` w (rad/s) about principal axes with ``moments`` J (kg m2), in these axes."""
    return cross(rates, (moments[0] * rates[0], moments[1] * rates[1], moments[2] * rates[2]))


@inlined
def link_rates(payload: Motion, velocity: Vector, arm: Vector, link: Vector, axis: Vector, about: float) -> Vector:
    """Return a link's angular velocity (rad/s).

    Args:
        payload: its motion.
        velocity: the UAV's (m/s).
        arm: from the payload's centre of mass to the attachment point (m).
        link: from there to the UAV (m).
        axis: the direction of ``link``.
        about: angular velocity about the axis (rad/s), which the ends of the link do not show.
    """
    swing = cross(link, plus(plus(velocity, -1.0, payload[0]), -1.0, cross(payload[1], arm)))
    squared = dot(link, link)
    return plus((swing[0] / squared, swing[1] / squared, swing[2] / squared), about, axis)


@inlined
def velocity_products(payload_rates: Vector, turning: Vector, uav_rates: Vector, arm: Vector, link: Vector) -> Motion:
    """Return a UAV's acceleration (m/s2) and angular acceleration (rad/s2) while no generalised velocity changes.

    Args:
        payload_rates: the payload's angular velocity (rad/s).
        turning: the link's.
        uav_rates: the UAV's.
        arm: from the payload's centre of mass to the attachment point (m).
        link: from there to the UAV (m).
    """
    # A joint's rates turn with the child, against the parent.
    turn = cross(payload_rates, turning)
    centripetal = plus(cross(payload_rates, cross(payload_rates, arm)), 1.0, cross(turning, cross(turning, link)))
    return plus(centripetal, 1.0, cross(turn, link)), plus(turn, 1.0, cross(turning, uav_rates))
