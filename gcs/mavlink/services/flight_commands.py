"""Commands that an aircraft flies: arming, take-off, go-to, heading, speed, missions, home, return, landing."""

import math
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from gcs.mavlink.layout import PackedRun
from gcs.mavlink.services.aircraft import Aircraft, MessageSource, Orbit, Place, Reposition, Turn
from gcs.mavlink.services.answer import ACCEPTED, UNSUPPORTED_FRAME, Answer, denied
from gcs.mavlink.services.dispatcher import Command, CommandHandler, Dispatcher, Request
from gcs.mavlink.services.streams import whole

_HOME = px4.AUTOPILOT_COMPONENT, mavlink.MAVLINK_MSG_ID_HOME_POSITION
_ABOVE_SEA = (mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_FRAME_GLOBAL_INT)
_ABOVE_HOME = (mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT)
_NOT_GIVEN = (0x7FFFFFFF, 0x7FF80000)
"""Of a place in whole numbers: MAVLink's, and what some clients make of NaN."""

_AIRSPEED, _GROUND_SPEED = 0, 1
_UNCHANGED = -1.0
_PAUSE, _CONTINUE = 0.0, 1.0
_ITEMS_MAX = 1 << 16
_ORBIT_HEADINGS = mavlink.ORBIT_YAW_BEHAVIOUR_HOLD_FRONT_TANGENT_TO_CIRCLE + 1
"""Those of a remote control are not."""
_WHOLE_TURN = 360.0
_MODE_UNCHANGED = Answer(
    mavlink.MAV_RESULT_UNSUPPORTED, "Reposition denied: param2 is not 1 (MAV_DO_REPOSITION_FLAGS_CHANGE_MODE)", 2
)
"""PX4's answer to a reposition that is not to change the mode."""


class FlightCommands:
    """Checks the parameters of each command, and has the aircraft carry it out."""

    def __init__(self, aircraft: Aircraft, source: MessageSource) -> None:
        """``source`` has the place of home."""
        self._aircraft = aircraft
        self._source = source

    def register(self, dispatcher: Dispatcher) -> None:
        """Take the commands of this service."""
        dispatcher.register_commands(
            {
                mavlink.MAV_CMD_COMPONENT_ARM_DISARM: self._arm_disarm,
                mavlink.MAV_CMD_DO_FLIGHTTERMINATION: self._terminate,
                mavlink.MAV_CMD_NAV_TAKEOFF: self._take_off,
                mavlink.MAV_CMD_NAV_LAND: self._entering(px4.MODE_LAND),
                mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: self._entering(px4.MODE_RETURN),
                mavlink.MAV_CMD_DO_REPOSITION: self._reposition,
                mavlink.MAV_CMD_CONDITION_YAW: self._turn,
                mavlink.MAV_CMD_DO_ORBIT: self._orbit,
                mavlink.MAV_CMD_DO_CHANGE_SPEED: self._change_speed,
                mavlink.MAV_CMD_DO_SET_HOME: self._set_home,
                mavlink.MAV_CMD_MISSION_START: self._start_mission,
                mavlink.MAV_CMD_DO_PAUSE_CONTINUE: self._pause_continue,
            }
        )

    def _arm_disarm(self, message: Command, request: Request) -> Answer:
        """Arm (param1 1) or disarm (0); param2 21196 skips checks."""
        force = message.param2 == px4.FORCE_ARM_DISARM
        if message.param1 == 1.0:
            return self._aircraft.arm(request.now, force)
        if message.param1 == 0.0:
            return self._aircraft.disarm(request.sender, request.now, force)
        return denied(f"Arming denied: param1 {message.param1} is neither 0 nor 1", 1)

    def _terminate(self, message: Command, request: Request) -> Answer:
        """Stop the rotors at once, in the air, too (param1 1); 0 does nothing."""
        if message.param1 == 1.0:
            return self._aircraft.disarm(request.sender, request.now, True)
        return ACCEPTED if message.param1 == 0.0 else denied(f"Termination denied: param1 {message.param1:g}", 1)

    def _take_off(self, message: Command, request: Request) -> Answer:
        """Take off to an altitude (NaN: MIS_TAKEOFF_ALT above the ground)."""
        place = self._valid_place("Takeoff", message, request)
        if isinstance(place, Answer):
            return place
        return self._aircraft.take_off(place.altitude, request.now)

    def _reposition(self, message: Command, request: Request) -> Answer:
        """Fly to a place and hold there; speed (param1), param2 1 (the mode changes), yaw (param4, rad)."""
        place = self._valid_place("Reposition", message, request)
        if isinstance(place, Answer):
            return place
        if message.param2 != mavlink.MAV_DO_REPOSITION_FLAGS_CHANGE_MODE:
            return _MODE_UNCHANGED
        if math.isinf(message.param4):
            return denied("Reposition denied: the yaw is infinite", 4)
        speed = message.param1 if message.param1 > 0.0 else math.nan
        return self._aircraft.reposition(Reposition(*place, message.param4, speed), request.now)

    def _change_speed(self, message: Command, request: Request) -> Answer:
        """Fly with another speed over the ground (param2; -1: as it is)."""
        if message.param1 not in (_AIRSPEED, _GROUND_SPEED):
            return denied("Speed denied: only that over the ground can be changed", 1)
        if message.param2 == _UNCHANGED:
            return ACCEPTED
        if not 0.0 < message.param2 < math.inf:
            return denied(f"Speed denied: {message.param2:g} m/s is none", 2)
        return self._aircraft.change_speed(message.param2, request.now)

    def _turn(self, message: Command, request: Request) -> Answer:
        """Turn in AUTO.LOITER to a heading (param1, deg) or by it (param4 1): param2 deg/s, param3 direction."""
        for number, value in enumerate((message.param1, message.param2, message.param3, message.param4), start=1):
            if not math.isfinite(value):
                return denied(f"Turn denied: param{number} is {value:g}", number)
        if abs(message.param1) > _WHOLE_TURN:
            return denied(f"Turn denied: {message.param1:g} deg is more than a whole turn", 1)
        if message.param2 < 0.0:
            return denied(f"Turn denied: {message.param2:g} deg/s is no rate", 2)
        if message.param3 not in (-1.0, 0.0, 1.0):
            return denied(f"Turn denied: param3 {message.param3:g} is none of -1, 0, 1", 3)
        if message.param4 not in (0.0, 1.0):
            return denied(f"Turn denied: param4 {message.param4:g} is neither 0 nor 1", 4)
        rate = math.radians(message.param2) if message.param2 > 0.0 else math.nan
        turn = Turn(math.radians(message.param1), rate, int(message.param3), message.param4 == 1.0)
        return self._aircraft.turn(turn, request.now)

    def _orbit(self, message: Command, request: Request) -> Answer:
        """Fly on a circle: param1 radius, negative to the left, param2 m/s, param3 heading, param4 rad (0: no end)."""
        place = self._valid_place("Orbit", message, request)
        if isinstance(place, Answer):
            return place
        radius, speed, angle = message.param1, message.param2, message.param4
        if radius == 0.0 or math.isinf(radius):
            return denied(f"Orbit denied: the radius is {radius:g} m", 1)
        if speed <= 0.0 or math.isinf(speed):
            return denied(f"Orbit denied: {speed:g} m/s is no speed", 2)
        heading = 0 if math.isnan(message.param3) else whole(message.param3, _ORBIT_HEADINGS)
        if heading is None:
            return denied(f"Orbit denied: heading {message.param3:g} is none of 0, 1, 2, 3", 3)
        if angle < 0.0:
            return denied(f"Orbit denied: {angle:g} rad is no angle", 4)
        angle = angle if angle > 0.0 else math.inf
        return self._aircraft.orbit(Orbit(radius, speed, heading, angle, place), request.now)

    def _set_home(self, message: Command, request: Request) -> Answer:
        """Return to a place from now on (param1 0), or to where it is (1); angles of home are not kept."""
        if message.param1 == 1.0:
            return self._aircraft.set_home(None, request.now)
        if message.param1 != 0.0:
            return denied(f"Home denied: param1 {message.param1:g} is neither 0 nor 1", 1)
        place = self._valid_place("Home", message, request)
        if isinstance(place, Answer):
            return place
        for value, parameter in zip(place, (5, 6, 7), strict=True):
            if math.isnan(value):
                return denied(f"Home denied: {place._fields[parameter - 5]} is not given", parameter)
        return self._aircraft.set_home(place, request.now)

    def _start_mission(self, message: Command, request: Request) -> Answer:
        """Fly the mission from an item (param1) to its end."""
        first = 0 if math.isnan(message.param1) else whole(message.param1, _ITEMS_MAX)
        if first is None:
            return denied(f"Mission denied: {message.param1:g} is no item", 1)
        return self._aircraft.start_mission(first, request.now)

    def _pause_continue(self, message: Command, request: Request) -> Answer:
        """Hold (param1 0), or go on with the mission (1)."""
        if message.param1 == _PAUSE:
            return self._aircraft.pause(request.now)
        if message.param1 == _CONTINUE:
            return self._aircraft.resume(request.now)
        return denied(f"Pause denied: param1 {message.param1:g} is neither 0 nor 1", 1)

    def _entering(self, mode: int) -> CommandHandler:
        """Return what carries out a command that enters a mode."""

        def enter(message: Command, request: Request) -> Answer:
            return self._aircraft.enter_mode(mode, request.sender, request.now)

        enter.__doc__ = f"Enter {px4.mode_name(mode)}."
        return enter

    def _place(self, message: Command, request: Request) -> Place | None:
        """Return the place in a command, None for a MAV_FRAME that is not global."""
        if isinstance(message, mavlink.MAVLink_command_long_message):
            return Place(message.param5, message.param6, message.param7)
        if message.frame in _ABOVE_SEA:
            base = 0.0
        elif message.frame in _ABOVE_HOME:
            base = self._home_altitude(request.now)
        else:
            return None
        latitude, longitude = (math.nan if x in _NOT_GIVEN else x * 1e-7 for x in (message.x, message.y))
        return Place(latitude, longitude, base + message.z)

    def _valid_place(self, what: str, message: Command, request: Request) -> Place | Answer:
        """Return the place in a command, or the refusal of the command because of it."""
        place = self._place(message, request)
        if place is None:
            return UNSUPPORTED_FRAME
        for value, limit, parameter in ((place.latitude, 90.0, 5), (place.longitude, 180.0, 6)):
            if abs(value) > limit:
                return denied(f"{what} denied: {value:g} deg is no place", parameter)
        return denied(f"{what} denied: the altitude is infinite", 7) if math.isinf(place.altitude) else place

    def _home_altitude(self, now: float) -> float:
        """Return the altitude of home (m above mean sea level), as HOME_POSITION has it; NaN: there is none yet."""
        built = self._source.builders[_HOME](now)
        if isinstance(built, PackedRun) or not built:
            return math.nan
        layout, payload = built[0]
        home: Any = layout.message(payload)
        return float(home.altitude) * 1e-3
