"""Payload state from the estimate: clear of the ground, touched down, out of control, descent stalled."""

import math

from gcs.config.flight_settings import DEFAULTS, FlightSettings
from idc_controller.estimation.measurements import Estimate
from idc_controller.model.linear import StateLayout
from idc_controller.parameters import SystemParameters
from idc_controller.trajectory.trajectory import Trajectory


class PayloadMonitor:
    """Payload state of one flight. Times are the team's (s); ``progress`` is the time along the mission trajectory."""

    def __init__(self, parameters: SystemParameters, settings: FlightSettings = DEFAULTS) -> None:
        self._settings = settings
        self._layout = StateLayout(parameters.number_of_uavs)
        self._standing = -parameters.payload.below
        self._touch_steps = self._rise_steps = 0
        self._in_control = math.inf

    def height(self, estimate: Estimate) -> float:
        """Return the height of the payload's lower face above the ground (m)."""
        return float(self._standing - estimate.x[self._layout.r_0][2])

    def is_clear(self, estimate: Estimate) -> bool:
        """Return whether the payload is clear of the ground, for what sensors and alarms assume."""
        return self.height(estimate) > self._settings.takeoff_landing.clear_height

    def may_be_weighed(self, estimate: Estimate) -> bool:
        """Return whether the ground surely carries no part of the payload, so that its load can be learnt."""
        return self.height(estimate) > self._settings.takeoff_landing.learn_height

    def is_out_of_control(self, time: float, estimate: Estimate) -> bool:
        """Return whether the payload has been tilted, or its state unknown, for longer than any manoeuvre takes.

        Call once a control step.
        """
        s = self._settings.failsafe
        roll, pitch, _ = estimate.x[self._layout.Theta].tolist()
        if max(abs(roll), abs(pitch)) < s.tilt_limit and math.isfinite(estimate.x @ estimate.x):
            self._in_control = time
        return time - self._in_control > s.tilt_time

    def has_touched_down(self, progress: float, descent: Trajectory, estimate: Estimate) -> bool:
        """Return whether the payload is at rest although ``descent`` sinks on. Call once a control step."""
        s = self._settings.takeoff_landing
        if self.height(estimate) > s.touch_height:
            self._touch_steps = 0
            return False
        depth = descent.position(progress)[2] - estimate.x[self._layout.r_0][2]
        at_rest = abs(estimate.x[self._layout.v_0][2]) < s.touch_speed
        near = self.height(estimate) < s.touch_height_near
        on_ground = depth > s.touch_depth_near if near else depth > s.touch_depth and at_rest
        self._touch_steps = self._touch_steps + 1 if on_ground else 0
        return self._touch_steps >= s.touch_steps

    def has_lifted_again(self, rise: float, limit: float) -> bool:
        """Return whether the payload rises faster than ``limit`` (m/s), in two control steps in a row.

        ``rise``: its upward speed (m/s). Call once a control step.
        """
        self._rise_steps = self._rise_steps + 1 if rise > limit else 0
        return self._rise_steps > 1

    def is_descent_stalled(self, progress: float, descent: Trajectory) -> bool:
        """Return whether the payload is still in the air long after the planned end of ``descent``."""
        return progress - descent.end > self._settings.failsafe.descent_timeout
