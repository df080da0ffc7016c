"""Paths of a payload that brakes."""

import numpy as np
from scipy.interpolate import BPoly

from idc_controller.trajectory.stop_plan_kernels import control_points


def path_of(braking, state):
    """Path from state (3, 3) on, over the time since then (s)."""
    duration = braking.duration(state[1])
    points = control_points(state[None], np.array([duration]), np.array([braking.aside]))
    return BPoly(points[0][:, None, :], [0.0, duration])
