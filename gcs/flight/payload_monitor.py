"""What the estimate tells of the payload: whether it is clear of the ground, has touched it, or is out of control."""

from __future__ import annotations

import math

import numpy as np

from idc_controller.estimation.estimate import Estimate
from idc_controller.model.linear import StateLayout
from idc_controller.parameters import SystemParameters
from idc_controller.trajectory.trajectory import Trajectory

TOUCH_DEPTH = 0.06  # m above the reference at which the payload must be standing
TOUCH_SPEED = 0.05  # m/s
TOUCH_NEAR = 0.08  # m above the ground, a pad's height, where it stands even if it bounces,
TOUCH_DEPTH_NEAR = 0.03  # m above the reference
TOUCH_STEPS = 4
TOUCH_GRACE = 3.0  # s after the descent's end at which it counts as touched without these signs
TOUCH_HEIGHT = 1.0  # m above the ground: higher up nothing can have been touched, wherever the reference is
NOT_DOWN = 15.0  # s after the descent's end at which a payload that is still higher will not come down by itself
LOST_TILT = math.radians(45.0)  # of the payload, at which nothing can be planned any more
LOST_AFTER = 0.5  # s
LEARN_ABOVE = 0.3  # m above the ground: below it the ground may carry part of the load


class PayloadWatch:
    """Of one flight. Times are the team's (s), ``clock`` that of the course."""

    def __init__(self, parameters: SystemParameters) -> None:
        self._layout = StateLayout(parameters.number_of_uavs)
        self._standing = -float(parameters.payload_size[2]) / 2.0
        self._touch_steps = 0
        self._in_control = math.inf

    def height(self, estimate: Estimate) -> float:
        """Of the payload's lower face above the ground (m)."""
        return float(self._standing - estimate.x[self._layout.r_0][2])

    def is_clear(self, estimate: Estimate) -> bool:
        """Whether the ground carries nothing of it."""
        return self.height(estimate) > LEARN_ABOVE

    def is_out_of_control(self, time: float, estimate: Estimate) -> bool:
        """Whether it has been tipped, or its state unknown, for longer than any manoeuvre takes."""
        tilt = np.abs(estimate.x[self._layout.Theta][:2]).max()
        if np.all(np.isfinite(estimate.x)) and tilt < LOST_TILT:
            self._in_control = time
        return time - self._in_control > LOST_AFTER

    def has_touched(self, clock: float, descent: Trajectory, estimate: Estimate) -> bool:
        """Whether it stands where ``descent`` would have it sink on; to be asked once a control step."""
        if self.height(estimate) > TOUCH_HEIGHT:
            self._touch_steps = 0
            return False
        depth = descent.position(clock)[2] - estimate.x[self._layout.r_0][2]
        still = abs(estimate.x[self._layout.v_0][2]) < TOUCH_SPEED
        near = self.height(estimate) < TOUCH_NEAR
        stands = depth > TOUCH_DEPTH_NEAR if near else depth > TOUCH_DEPTH and still
        self._touch_steps = self._touch_steps + 1 if stands else 0
        return self._touch_steps >= TOUCH_STEPS or clock > descent.end + TOUCH_GRACE

    def stays_up(self, clock: float, descent: Trajectory, estimate: Estimate) -> bool:
        """Whether it is still high long after ``descent`` should have brought it down."""
        return clock - descent.end > NOT_DOWN and self.height(estimate) > TOUCH_HEIGHT
