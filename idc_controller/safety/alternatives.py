"""Other sets of separating planes: the sides on which a conflicting obstacle may be passed."""

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.obstacles import PredictedObstacle
from idc_controller.safety.constraints.exponential_barrier import ExponentialBarrier
from idc_controller.safety.separation import Separation


def alternatives(
    barrier: ExponentialBarrier, near: list[Separation], position: Array, acceleration: Array, velocity: Array
) -> list[list[Separation]]:
    """Return the separations with the first conflict passed above, left or right, or stopped before.

    Args:
        barrier: which says where the margin is not kept.
        near: the separations of a trajectory with ``position`` and ``acceleration`` (K + 1, 3), NED, SI.
        velocity: of the reference (K + 1, 3) (m/s).
    """
    values = barrier.values(near, position, acceleration).min(axis=1)
    missed = values < 0.0
    first = int(np.argmin(np.where(missed.any(axis=1), missed.argmax(axis=1), values.shape[1])))
    conflict = np.flatnonzero(missed[first])
    if len(conflict) == 0:
        conflict = np.array([int(np.argmin(values[first]))])
    at = conflict[len(conflict) // 2]
    relative = velocity[at] - _velocity_of(near[first].obstacle, at, barrier.settings.chain.period)
    heading = relative[:2] if np.linalg.norm(relative[:2]) > 0.05 else near[first].normals[at, :2]
    heading = heading / max(float(np.linalg.norm(heading)), 1e-9)
    left = np.array([heading[1], -heading[0], 0.0])
    sets = []
    for direction in (np.array([0.0, 0.0, -1.0]), left, -left, None):
        normals = near[first].normals.copy()
        if direction is None:
            normals[conflict[0] :] = [heading[0], heading[1], 0.0]
        else:
            normals[conflict[0] : conflict[-1] + 1] = -direction
        turned = Separation(near[first].obstacle, near[first].distance, normals)
        sets.append([turned if i == first else s for i, s in enumerate(near)])
    return sets


def _velocity_of(obstacle: PredictedObstacle, at: int, period: float) -> Array:
    after = min(at + 1, len(obstacle.positions) - 1)
    before = max(after - 1, 0)
    return np.asarray((obstacle.positions[after] - obstacle.positions[before]) / period)
