"""A free vehicle's failsafes, as PX4 has them without a remote control; ``docs/architecture.md`` mirrors the table."""

import math

from gcs.mavlink import px4
from vehicle_sim.autopilot.failsafe import Failsafe, always, armed, by_cause, disarm, setpoints_lost
from vehicle_sim.autopilot.free import parameters as names
from vehicle_sim.autopilot.free.modes import return_home
from vehicle_sim.autopilot.free.state import FreeFlightState

_NOTHING, _HOLD, _RETURN = 0, 1, 2  # values of NAV_DLL_ACT; any other: land


def _in_flight(state: FreeFlightState) -> bool:
    return state.armed and state.land.in_air


def _hold(state: FreeFlightState, now: float) -> None:
    state.failsafe, state.failsafe_mode, state.failsafe_since = True, px4.MODE_HOLD, now
    state.hold_here()


def _hold_is_over(state: FreeFlightState, now: float) -> bool:
    """Return True if the set-points have not come back while it held."""
    return (
        state.failsafe
        and state.mode == px4.MODE_OFFBOARD
        and state.failsafe_mode == px4.MODE_HOLD
        and now - state.failsafe_since > state.parameters[names.FAILSAFE_DELAY]
    )


def _return(state: FreeFlightState, now: float) -> None:
    state.failsafe, state.failsafe_mode = True, px4.MODE_RETURN
    return_home(state)


def _data_link_lost(state: FreeFlightState, now: float) -> bool:
    return (
        state.parameters[names.LINK_LOSS_ACTION] != _NOTHING
        and not state.failsafe
        and state.mode not in (px4.MODE_LAND, px4.MODE_RETURN)
        and state.link_time > -math.inf
        and now - state.link_time > state.parameters[px4.PARAM_LINK_LOSS]
    )


def _react_to_link_loss(state: FreeFlightState, now: float) -> None:
    action = state.parameters[names.LINK_LOSS_ACTION]
    if action == _HOLD:
        _hold(state, now)
    elif action == _RETURN:
        _return(state, now)
    else:
        state.failsafe, state.failsafe_mode = True, px4.MODE_LAND
        state.land_here()


FAILSAFES: tuple[Failsafe[FreeFlightState], ...] = (
    Failsafe("offboard_loss", px4.PARAM_SETPOINT_LOSS, setpoints_lost, _in_flight, _hold, "Set-points lost: holding"),
    Failsafe(
        "offboard_loss_on_ground",
        px4.PARAM_SETPOINT_LOSS,
        setpoints_lost,
        armed,
        disarm,
        "Set-points lost on the ground: disarmed",
    ),
    Failsafe("offboard_loss_disarmed", px4.PARAM_SETPOINT_LOSS, setpoints_lost, always, disarm, ""),
    Failsafe(
        "offboard_still_lost", names.FAILSAFE_DELAY, _hold_is_over, _in_flight, _return, "Set-points lost: returning"
    ),
    Failsafe(
        "data_link_loss", names.LINK_LOSS_ACTION, _data_link_lost, _in_flight, _react_to_link_loss, "No ground station"
    ),
)

FREE = by_cause(FAILSAFES)
"""Of a vehicle without a payload."""
