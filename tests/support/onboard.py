"""The onboard loop of one vehicle, for tests: a team of one."""

import math

import numpy as np

from vehicle_sim.autopilot.onboard_loop import step_together
from vehicle_sim.world.state_kernels import STATE_COLUMNS


def step_alone(autopilot, sample, now):
    """Take one step of the onboard loop; four rotor-speed commands (rad/s). ``sample`` None: none came this time."""
    row = [math.nan] * STATE_COLUMNS if sample is None else sample.as_row()
    times = np.array([now if sample is None else sample.time])
    step_together([autopilot], autopilot.arrays, np.array([row]), times, now, () if sample is not None else (0,))
    return tuple(autopilot.arrays.speeds[0].tolist())
