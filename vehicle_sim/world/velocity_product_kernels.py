"""Accelerations from products of velocities (Coriolis, centripetal), and the velocities after half a step more.

The engine takes gravity, forces and the mass matrix at the time of the poses, t, and its generalised velocities
half a step earlier: the payload's, and the joints' in the child's frame. With the same velocities it computes the
products, which makes them, and with them its motion, of first order in the step. What follows finds the velocities
at t, and thereby the loads that are missing. All vectors are in one frame that does not turn.
"""

from idc_controller.compiled import inlined
from idc_controller.rotations_float import Vector

Motion = tuple[Vector, Vector]
"""A velocity (m/s) and an angular velocity (rad/s); of the products a linear and an angular acceleration."""


@inlined
def cross(a: Vector, b: Vector) -> Vector:
    """Return the cross product of ``a`` and ``b``."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def plus(a: Vector, factor: float, b: Vector) -> Vector:
    """Return ``a + factor * b``."""
    return a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]


@inlined
def gyroscopic(moments: Vector, rates: Vector) -> Vector:
    """Return w x J w (N m) of ``rates`` w (rad/s) about principal axes with ``moments`` J (kg m2), in these axes."""
    return cross(rates, (moments[0] * rates[0], moments[1] * rates[1], moments[2] * rates[2]))


@inlined
def velocity_products(payload: Motion, uav: Motion, arm: Vector, link: Vector, since: float) -> Motion:
    """Return a UAV's acceleration (m/s2) and angular acceleration (rad/s2) while no generalised velocity changes.

    Args:
        payload: its motion.
        uav: the UAV's motion.
        arm: from the payload's centre of mass to the attachment point (m).
        link: from there to the UAV (m).
        since: by how much the generalised velocities are older than the poses (s).

    Nothing turns a link about its own axis, hence it has no rate about it; velocities that are older than the link's
    direction have one.
    """
    (velocity, rates), (uav_velocity, uav_rates) = payload, uav
    squared = link[0] * link[0] + link[1] * link[1] + link[2] * link[2]
    attachment = cross(rates, arm)
    swing = cross(link, plus(plus(uav_velocity, -1.0, velocity), -1.0, attachment))
    turning = (swing[0] / squared, swing[1] / squared, swing[2] / squared)
    # A joint's rates turn with the link, against the payload.
    turn = cross(rates, turning)
    about = since * (turn[0] * link[0] + turn[1] * link[1] + turn[2] * link[2]) / squared
    turning = plus(turning, about, link)
    turn = cross(rates, turning)
    linear = plus(plus(cross(rates, attachment), 1.0, cross(turn, link)), 1.0, cross(turning, cross(turning, link)))
    return linear, plus(turn, 1.0, cross(turning, uav_rates))


@inlined
def brought_forward(now: Motion, before: Motion, products: Motion, since: float) -> Motion:
    """Return the motion at the time of the poses.

    Args:
        now: motion by generalised velocities that are ``since`` (s), half a step, older than the poses.
        before: the same one step earlier.
        products: what changes the motion beside the generalised velocities, as :func:`velocity_products`.
        since: half of the step.
    """
    (v, w), (v_before, w_before), (linear, angular) = now, before, products
    v, w = plus(v, 0.5, plus(v, -1.0, v_before)), plus(w, 0.5, plus(w, -1.0, w_before))
    return plus(v, -since, linear), plus(w, -since, angular)
