"""Set-points and stop plans: from messages to the ground in control, or refused."""

from collections.abc import Callable
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.services.dispatcher import Dispatcher, Request
from vehicle_sim.autopilot.autopilot import Autopilot
from vehicle_sim.autopilot.setpoints import SetpointError, StopPlan, read_setpoint, read_stop_plan
from vehicle_sim.mavlink.control_owner import ControlOwner

STAMP_WRAP = 2**32 * 1e-3  # s after which stamps of 32 bits begin anew


class SetpointServer:
    """SET_ATTITUDE_TARGET and TRAJECTORY_REPRESENTATION_BEZIER.

    ``refused`` counts those that cannot be flown or came from a ground that is not in control.
    """

    def __init__(self, autopilot: Autopilot, owner: ControlOwner, clock: Callable[[float], float]) -> None:
        """``clock`` is what the vehicle's clock shows at a time."""
        self._autopilot = autopilot
        self._owner = owner
        self._clock = clock
        self.refused = 0

    def register(self, dispatcher: Dispatcher) -> None:
        """Take the messages of this service."""
        dispatcher.register_fields(mavlink.MAVLink_set_attitude_target_message, self._on_setpoint)
        dispatcher.register_fields(mavlink.MAVLink_trajectory_representation_bezier_message, self._on_stop_plan)

    def _on_setpoint(self, fields: tuple[Any, ...], request: Request) -> None:
        sender, now = request.sender, request.now
        if self._owner.is_stranger(sender, now):
            self.refused += 1
            return
        try:
            setpoint = read_setpoint(fields, self._autopilot.state.settings.setpoints)
        except SetpointError:
            self.refused += 1
            return
        self._owner.take(setpoint, sender, now)

    def _on_stop_plan(self, fields: tuple[Any, ...], request: Request) -> None:
        now = request.now
        if self._owner.in_control(now) != request.sender:
            return
        try:
            plan = read_stop_plan(fields, self._autopilot.state.settings.setpoints)
        except SetpointError:
            self.refused += 1
            return
        start = plan.start - (self._clock(now) - now)
        # The ground estimates this clock from stamps of 32 bits, which may have begun anew since.
        start += round((now - start) / STAMP_WRAP) * STAMP_WRAP
        self._autopilot.take_stop_plan(StopPlan(start, *plan[1:]))
