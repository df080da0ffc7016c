"""Between attitude and thrust and the components of force in which the linear model is most nearly linear.

A UAV pulls with F = f n. In the model's coordinates ``n`` (tilt) and ``f`` (thrust) the lateral force is f n, a
product; in F_xy / f_hover and -F_z it is linear. Errors are taken, and set-points inverted, in these components,
exactly.
"""

import numpy as np

from idc_controller.arrays import Array
from idc_controller.model.linear import StateLayout

_LEAST_SQUARE = 1e-3
"""Of a cosine: a tilt is taken for no more than nearly level."""


def state_in_force_components(x: Array, layout: StateLayout, hover: Array) -> Array:
    """State (..., 12 + 11 N) with tilts as F_xy / f_hover and thrusts as -F_z. ``hover`` (N,) (N)."""
    converted, f = x.copy(), x[..., layout.f]
    # Tilts with their rates and accelerations.
    tilts = converted[..., layout.n.start : layout.f.start].reshape(*x.shape[:-1], 3, -1, 2)
    converted[..., layout.f] = f * _cosine(tilts[..., 0, :, :])
    tilts *= (f / hover)[..., None, :, None]
    return converted


def inputs_in_force_components(u: Array, layout: StateLayout, hover: Array) -> Array:
    """Set-points (..., 3 N), tilts and thrusts, as F_xy / f_hover and -F_z. ``hover`` (N,) (N)."""
    f, n = u[..., layout.f_setpoint], u[..., layout.n_setpoint].reshape(*u.shape[:-1], -1, 2)
    lateral = n * (f / hover)[..., None]
    return np.concatenate([lateral.reshape(*u.shape[:-1], -1), f * _cosine(n)], axis=-1)


def setpoints_from_force_components(
    delta: Array, u_reference: Array, layout: StateLayout, hover: Array, least_lift: float
) -> Array:
    """Set-points (3 N,), tilts and thrusts, of a reference plus ``delta`` (3 N,) in force components.

    The force points up whatever is commanded, with ``least_lift`` of the hover thrust at least.
    """
    f, n = u_reference[layout.f_setpoint], u_reference[layout.n_setpoint].reshape(-1, 2)
    lateral = f[:, None] * n + hover[:, None] * delta[layout.n_setpoint].reshape(-1, 2)
    upward = np.maximum(f * _cosine(n) + delta[layout.f_setpoint], least_lift * hover)
    thrust = np.sqrt(lateral[:, 0] ** 2 + lateral[:, 1] ** 2 + upward**2)
    return np.concatenate([(lateral / thrust[:, None]).ravel(), thrust])


def limited(vectors: Array, limit: float) -> Array:
    """Return ``vectors`` (..., 3), those that are longer than ``limit`` shortened to that."""
    norms = np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True))
    return np.asarray(vectors * (limit / np.maximum(norms, limit)))


def _cosine(n: Array) -> Array:
    """Return the upward parts (..., N) of unit vectors with level parts ``n`` (..., N, 2)."""
    return np.asarray(np.sqrt(np.maximum(1.0 - (n[..., 0] ** 2 + n[..., 1] ** 2), _LEAST_SQUARE)))
