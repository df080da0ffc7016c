"""PX4's modes: how each is entered, or why it is not. What OFFBOARD flies is in :mod:`.autopilot`, HOLD and LAND in
:mod:`.hold_control`.
"""

import math
from collections.abc import Callable
from dataclasses import replace

from gcs.mavlink import px4
from gcs.mavlink.services.answer import ACCEPTED, Answer, denied, rejected_for_now
from vehicle_sim.autopilot.flight_state import FlightState
from vehicle_sim.autopilot.setpoint_stream import Setpoint


def enter_mode(state: FlightState, custom_mode: int, now: float) -> Answer:
    """Enter any mode but OFFBOARD, which needs set-points; see :func:`enter_offboard`."""
    enter = ENTRY.get(custom_mode)
    if enter is None:
        return denied(f"{px4.mode_name(custom_mode)} denied: no such mode")
    return enter(state, custom_mode, now)


def enter_offboard(state: FlightState, setpoint: Setpoint, received: float, now: float) -> Answer:
    """Fly the set-points of a ground, the last of which was ``received`` (s) a moment ago."""
    if state.land.in_air and not state.navigation.is_valid(now):
        return rejected_for_now("OFFBOARD denied: no navigation data")
    state.mode = px4.MODE_OFFBOARD
    state.failsafe = False
    state.hold = None
    state.stop_plan = None
    state.setpoints.clear()
    state.setpoints.add(setpoint, received)
    return ACCEPTED


def _hold(state: FlightState, custom_mode: int, now: float) -> Answer:
    """Commanded again, or while it brakes in a failsafe, it goes on with its plan: its neighbours do.

    A descent of all vehicles is not put off: the ground may be lost before it commands another.
    """
    keeps = state.hold is not None and (state.hold.plan.is_common or not state.is_descending)
    state.mode = px4.MODE_HOLD
    state.failsafe = False
    if keeps and state.hold is not None:
        if not state.hold.plan.is_common:
            state.hold.plan = replace(state.hold.plan, descent_start=math.inf)
    else:
        state.hold = None
        if state.armed and state.is_up:
            state.begin_hold(now, descent_start=math.inf)
    return ACCEPTED


def _land(state: FlightState, custom_mode: int, now: float) -> Answer:
    if not state.armed:
        return rejected_for_now("AUTO.LAND denied: not flying")
    state.begin_descent(now)
    return ACCEPTED


def _manual(state: FlightState, custom_mode: int, now: float) -> Answer:
    if state.armed:
        return denied(f"{px4.mode_name(custom_mode)} denied: no manual control")
    state.mode = custom_mode
    return ACCEPTED


def team_only(what: str) -> Answer:
    """Return the refusal of what one vehicle cannot do while it carries a payload with others."""
    return denied(f"{what} denied: one vehicle alone would tip the payload; fly together in OFFBOARD")


def _of_team_only(state: FlightState, custom_mode: int, now: float) -> Answer:
    return team_only(px4.mode_name(custom_mode))


ENTRY: dict[int, Callable[[FlightState, int, float], Answer]] = {
    px4.MODE_HOLD: _hold,
    px4.MODE_LAND: _land,
    px4.MODE_MANUAL: _manual,
    px4.MODE_ALTCTL: _manual,
    px4.MODE_POSCTL: _manual,
    px4.MODE_TAKEOFF: _of_team_only,
    px4.MODE_MISSION: _of_team_only,
    px4.MODE_RETURN: _of_team_only,
}
