"""The links' forces, by Newton's law on the UAVs: a link has no mass, and its joints take no moment."""

import math

import numpy as np

from idc_controller import rotations_float
from idc_controller.arrays import Array1, Array2
from idc_controller.compiled import inlined, kernel
from vehicle_sim.world import world_state
from vehicle_sim.world.velocity_product_kernels import dot

_into_body = inlined(rotations_float.into_body)
_upward_axis = inlined(world_state.upward_axis)


@kernel
def link_tensions(
    now: Array2, before: Array2, parts: Array2, thrusts: Array1, external: Array2, gravity: float, step: float
) -> Array1:
    """Return the tension of each link over a step (N,) (N); negative: compression.

    Along the link m a is the sum of weight, thrust, external force and the link's own. The accelerations are the
    differences of the engine's velocities, which are half a step older than the poses, as the forces of a step act.

    Args:
        now, before: readings of payload and UAVs (N + 1, 13) after the step and before it, as in :mod:`.state_kernels`.
        parts: their constants (N + 1, 7), as there.
        thrusts: held over the step (N,) (N).
        external: forces on the UAVs over the step (N, 3) (N, NED).
        gravity: m/s2.
        step: s.
    """
    tensions = np.empty(len(thrusts))
    payload = now[0]
    to_world = (payload[6], -payload[3], -payload[4], -payload[5])
    for i in range(len(thrusts)):
        uav, last, part = now[i + 1], before[i + 1], parts[i + 1]
        arm = _into_body(to_world, (part[4], part[5], part[6]))
        link = uav[0] - payload[0] - arm[0], uav[1] - payload[1] - arm[1], uav[2] - payload[2] - arm[2]
        length = math.sqrt(dot(link, link))
        up = _upward_axis((last[3], last[4], last[5], last[6]))
        push = external[i]
        along = 0.0
        for k in range(3):
            acceleration = (uav[7 + k] - last[7 + k]) / step + (gravity if k == 2 else 0.0)
            other = thrusts[i] * up[k] + (push[k] if k == 0 else -push[k])
            along += (part[3] * acceleration - other) * link[k] / length
        tensions[i] = -along
    return tensions
