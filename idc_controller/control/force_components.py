"""Between attitude and thrust and the components of force in which the linear model is most nearly linear.

A UAV pulls with F = f n. In the model's coordinates ``n`` (tilt) and ``f`` (thrust) the lateral force is f n, a
product; in F_xy / f_hover and -F_z it is linear. Errors are taken, and set-points inverted, in these components,
exactly.
"""

from idc_controller.arrays import Array
from idc_controller.control import force_kernels
from idc_controller.model.linear import StateLayout


def state_in_force_components(x: Array, layout: StateLayout, hover: Array) -> Array:
    """State (..., 12 + 11 N) with tilts as F_xy / f_hover and thrusts as -F_z. ``hover`` (N,) (N)."""
    return force_kernels.states(x.reshape(-1, layout.size), hover, layout.n.start).reshape(x.shape)


def setpoints_from_force_components(delta: Array, u_reference: Array, hover: Array, least_lift: float) -> Array:
    """Set-points (3 N,), tilts and thrusts, of a reference plus ``delta`` (3 N,) in force components.

    The force points up whatever is commanded, with ``least_lift`` of the hover thrust at least.
    """
    return force_kernels.setpoints(delta, u_reference, hover, least_lift)
