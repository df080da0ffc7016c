"""Inertial navigation: the velocity that follows from the specific force."""

from idc_controller.rotations_float import Quaternion, Vector, into_body


def accelerated(velocity: Vector, attitude: Quaternion, force: Vector, g: float, step: float) -> Vector:
    """Return the ``velocity`` (NED, m/s) after a ``step`` (s) of the specific ``force`` (body frame, m/s2).

    ``attitude``: unit quaternion, body to world. ``g`` in m/s2.
    """
    w, x, y, z = attitude
    a_x, a_y, a_z = into_body((w, -x, -y, -z), force)
    v_x, v_y, v_z = velocity
    return v_x + step * a_x, v_y + step * a_y, v_z + step * (a_z + g)
