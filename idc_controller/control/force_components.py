"""Between attitude and thrust and the components of force in which the linear model is most nearly linear.

A UAV pulls with F = f n. In the model's coordinates ``n`` (tilt) and ``f`` (thrust) the lateral force is f n, a
product; in F_xy / f_hover and -F_z it is linear. Errors are taken, and set-points inverted, in these components,
exactly.
"""

import numpy as np

from idc_controller.arrays import Array
from idc_controller.model.linear import StateLayout


def state_in_force_components(x: Array, layout: StateLayout, hover: Array) -> Array:
    """State (..., 12 + 11 N) with tilts as F_xy / f_hover and thrusts as -F_z. ``hover`` (N,) (N)."""
    converted = x.copy()
    N = layout.number_of_uavs
    f = x[..., layout.f]
    n = x[..., layout.n].reshape(*x.shape[:-1], N, 2)
    scale = np.repeat(f / hover, 2, axis=-1)
    for part in (layout.n, layout.n_dot, layout.n_acc):
        converted[..., part] *= scale
    converted[..., layout.f] = f * _cosine(n)
    return converted


def setpoints_from_force_components(
    delta: Array, u_reference: Array, layout: StateLayout, hover: Array, least_lift: float
) -> Array:
    """Set-points (3 N,), tilts and thrusts, of a reference plus ``delta`` (3 N,) in force components.

    The force points up whatever is commanded, with ``least_lift`` of the hover thrust at least.
    """
    N = layout.number_of_uavs
    n = u_reference[layout.n_setpoint].reshape(N, 2)
    f = u_reference[layout.f_setpoint]
    lateral = f[:, None] * n + hover[:, None] * delta[layout.n_setpoint].reshape(N, 2)
    upward = f * _cosine(n) + delta[layout.f_setpoint]
    upward = np.maximum(upward, least_lift * hover)
    thrust = np.sqrt(np.sum(lateral**2, axis=-1) + upward**2)
    return np.concatenate([(lateral / thrust[:, None]).ravel(), thrust])


def inputs_in_force_components(u: Array, layout: StateLayout, hover: Array) -> Array:
    """Set-points (..., 3 N) as F_xy / f_hover and -F_z."""
    N = layout.number_of_uavs
    n = u[..., layout.n_setpoint].reshape(*u.shape[:-1], N, 2)
    f = u[..., layout.f_setpoint]
    lateral = n * (f / hover)[..., None]
    return np.concatenate([lateral.reshape(*u.shape[:-1], 2 * N), f * _cosine(n)], axis=-1)


def _cosine(n: Array) -> Array:
    return np.asarray(np.sqrt(np.maximum(1.0 - np.sum(n**2, axis=-1), 1e-3)))
