"""Set-points and stop plans: from messages to the ground in control, or refused."""

from collections.abc import Callable
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.services.dispatcher import Dispatcher, Request
from gcs.mavlink.services.local_frame import LocalFrame
from gcs.mavlink.services.unserved_inputs import Reminders
from gcs.mavlink.stop_plan import read_stop_plan
from idc_controller.rotations_float import euler_of
from vehicle_sim.autopilot.autopilot import Autopilot
from vehicle_sim.autopilot.position_setpoints import read_global, read_local
from vehicle_sim.autopilot.setpoint_stream import Setpoint
from vehicle_sim.autopilot.setpoints import SetpointError, checked_stop_plan, read_setpoint
from vehicle_sim.mavlink.control_owner import ControlOwner

STAMP_WRAP = 2**32 * 1e-3  # s after which stamps of 32 bits begin anew

_LOCAL = mavlink.MAVLink_set_position_target_local_ned_message
_GLOBAL = mavlink.MAVLink_set_position_target_global_int_message


class SetpointServer:
    """SET_ATTITUDE_TARGET of any vehicle.

    ``refused`` counts those that cannot be flown or came from a ground that is not in control.
    """

    def __init__(self, autopilot: Autopilot, owner: ControlOwner, clock: Callable[[float], float]) -> None:
        """``clock`` is what the vehicle's clock shows at a time."""
        self._autopilot = autopilot
        self._owner = owner
        self._clock = clock
        self._reminders = Reminders()
        self.refused = 0

    def register(self, dispatcher: Dispatcher) -> None:
        """Take the messages of this service."""
        dispatcher.register_fields(mavlink.MAVLink_set_attitude_target_message, self._on_setpoint)

    def _on_setpoint(self, fields: tuple[Any, ...], request: Request) -> None:
        limits = self._autopilot.state.settings.setpoints
        self._take(lambda: read_setpoint(fields, limits), "SET_ATTITUDE_TARGET", request)

    def _take(self, read: Callable[[], Setpoint], kind: str, request: Request) -> None:
        """Pass a set-point on to who is in control, if it can be flown; ``kind``: the message's name."""
        sender, now = request.sender, request.now
        if self._owner.is_stranger(sender, now):
            self.refused += 1
            return
        try:
            setpoint = read()
        except SetpointError as error:
            self._refuse(kind, str(error), request)
            return
        self._owner.take(setpoint, sender, now)

    def _refuse(self, kind: str, why: str, request: Request) -> None:
        text = f"{kind} refused: {why}"
        self.refused += 1
        self._owner.refuse(text, request.sender, request.now)
        self._reminders.send(text, kind, request)

    def _on_stop_plan(self, fields: tuple[Any, ...], request: Request) -> None:
        now = request.now
        content = read_stop_plan(fields)
        if content is None or self._owner.in_control(now) != request.sender:
            return
        try:
            plan = checked_stop_plan(content, self._autopilot.state.settings.setpoints)
        except SetpointError:
            self.refused += 1
            return
        ahead = self._clock(now) - now
        # The ground estimates this clock from stamps of 32 bits, which may have begun anew since.
        ahead += round((plan.start - ahead - now) / STAMP_WRAP) * STAMP_WRAP
        plan = plan._replace(start=plan.start - ahead, descent=plan.descent - ahead)
        if not self._autopilot.state.begins_on_path(plan, now):
            self.refused += 1
        elif self._owner.is_new_plan(content.session, content.number):
            self._autopilot.take_stop_plan(plan)


class AttitudeSetpointServer(SetpointServer):
    """Set-points, and stop plans in TUNNEL, of a vehicle on a payload: it flies no others, and says what it refuses."""

    def register(self, dispatcher: Dispatcher) -> None:
        """Take the messages of this service."""
        super().register(dispatcher)
        dispatcher.register_fields(mavlink.MAVLink_tunnel_message, self._on_stop_plan)
        for kind in (_LOCAL, _GLOBAL):
            dispatcher.register(kind, self._on_position)

    def _on_position(self, message: Any, request: Request) -> None:
        why = "position set-points are not flown on a payload, only SET_ATTITUDE_TARGET is"
        self._refuse(message.get_type(), why, request)


class PositionSetpointServer(SetpointServer):
    """Takes set-points of position, velocity and acceleration, too: SET_POSITION_TARGET_LOCAL_NED and _GLOBAL_INT."""

    def __init__(
        self, autopilot: Autopilot, owner: ControlOwner, clock: Callable[[float], float], frame: LocalFrame
    ) -> None:
        super().__init__(autopilot, owner, clock)
        self._frame = frame

    def register(self, dispatcher: Dispatcher) -> None:
        """Take the messages of this service."""
        super().register(dispatcher)
        dispatcher.register_fields(_LOCAL, self._on_local)
        dispatcher.register_fields(_GLOBAL, self._on_global)

    def _on_local(self, fields: tuple[Any, ...], request: Request) -> None:
        estimate = self._autopilot.state.navigation.estimate
        heading = 0.0 if estimate is None else euler_of(estimate.attitude)[2]
        self._take(lambda: read_local(fields, heading), _LOCAL.msgname, request)

    def _on_global(self, fields: tuple[Any, ...], request: Request) -> None:
        home_altitude = self._frame.altitude - self._autopilot.home[2]
        self._take(lambda: read_global(fields, self._frame.local, home_altitude), _GLOBAL.msgname, request)
