"""What the kernels of the barrier compute, in plain numpy."""

import numpy as np


def disc_support(formation, normals, acceleration):
    """Largest ``n . x`` over the discs about the payload's centre without their lever's part (K,).

    The discs lie in the rotor planes, which in flight are about normal to g e3 - a; a little is added for what the
    planes do beyond that.
    """
    thrust = acceleration - np.array([0.0, 0.0, formation.g])
    axis = thrust / np.linalg.norm(thrust, axis=1, keepdims=True)
    along = np.sum(normals * axis, axis=1)
    flat = np.sqrt(np.maximum(1.0 - along**2, 0.0)) + 0.1
    support = np.max(normals @ formation.hover_offsets.T, axis=1) + formation.disc_radius * np.minimum(flat, 1.0)
    return np.asarray(support)
