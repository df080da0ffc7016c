"""A free vehicle's failsafes, as PX4 has them without a remote control; ``docs/failsafes.md`` is made from it."""

from gcs.mavlink import px4
from vehicle_sim.autopilot.failsafe import OFFBOARD_LOSS_ON_GROUND, Failsafe, by_cause, setpoints_lost
from vehicle_sim.autopilot.free import parameters as names
from vehicle_sim.autopilot.free.modes import return_home
from vehicle_sim.autopilot.free.state import FENCE_HOLD, FENCE_RETURN, FENCE_WARNING, FreeFlightState


def _in_flight(state: FreeFlightState) -> bool:
    return state.armed and state.is_up


def _hold(state: FreeFlightState, now: float) -> None:
    state.begin_failsafe(px4.MODE_HOLD, now)
    state.hold_here()


def _hold_for_setpoints(state: FreeFlightState, now: float) -> None:
    state.begin_failsafe(px4.MODE_HOLD, now, until_setpoints=True)
    state.hold_here()


def _hold_is_over(state: FreeFlightState, now: float) -> bool:
    """Return True if the set-points have not come back while it held."""
    return (
        state.failsafe
        and state.mode == px4.MODE_OFFBOARD
        and state.failsafe_mode == px4.MODE_HOLD
        and now - state.failsafe_since > state.parameters[names.FAILSAFE_DELAY]
    )


def _position_lost(state: FreeFlightState, now: float) -> bool:
    """Return True if the position that is flown by is not measured; attitudes of OFFBOARD are flown without."""
    return state.reckoning.is_lost and state.reference is not None and state.flown_mode != px4.MODE_LAND


def _land(state: FreeFlightState, now: float) -> None:
    state.begin_failsafe(px4.MODE_LAND, now)
    state.flight = None  # what follows begins at the place that the vehicle has by dead reckoning
    state.land_here()


def _return(state: FreeFlightState, now: float) -> None:
    state.begin_failsafe(px4.MODE_RETURN, now)
    return_home(state)


def _return_for_setpoints(state: FreeFlightState, now: float) -> None:
    state.begin_failsafe(px4.MODE_RETURN, now, until_setpoints=True)
    return_home(state)


def _fence_breached(state: FreeFlightState, now: float) -> bool:
    """Return True if the vehicle has just left what the fence allows, and flies nothing that ends that."""
    estimate = state.estimate
    if not _in_flight(state) or estimate is None or state.breach_of(estimate.position) is None:
        state.is_outside = False
        return False
    returns = state.flown_mode == px4.MODE_RETURN and state.parameters[names.FENCE_ACTION] == FENCE_RETURN
    return not (state.is_outside or returns or state.flown_mode == px4.MODE_LAND)


def _react_to_breach(state: FreeFlightState, now: float) -> None:
    action, estimate = state.parameters[names.FENCE_ACTION], state.estimate
    assert estimate is not None
    state.is_outside = True
    breach = f"Fence breach: {state.breach_of(estimate.position)}"
    if action == FENCE_WARNING:
        state.notices.append(breach)
    elif action == FENCE_HOLD:
        state.notices.append(f"{breach}, holding")
        _hold(state, now)
    elif action == FENCE_RETURN:
        state.notices.append(f"{breach}, returning")
        _return(state, now)
    else:
        state.notices.append(f"{breach}, landing")
        _land(state, now)


def is_data_link_lost(state: FreeFlightState, now: float) -> bool:
    """Return True if no ground station sends its HEARTBEAT, and the vehicle is to react to that."""
    return (
        state.parameters[px4.PARAM_LINK_LOSS_ACTION] != px4.LINK_LOSS_NOTHING
        and now - state.link_time > state.parameters[px4.PARAM_LINK_LOSS]
    )


def _data_link_lost(state: FreeFlightState, now: float) -> bool:
    return not state.failsafe and state.mode not in (px4.MODE_LAND, px4.MODE_RETURN) and is_data_link_lost(state, now)


def _react_to_link_loss(state: FreeFlightState, now: float) -> None:
    action = state.parameters[px4.PARAM_LINK_LOSS_ACTION]
    if action == px4.LINK_LOSS_HOLD:
        _hold(state, now)
    elif action == px4.LINK_LOSS_RETURN:
        _return(state, now)
    else:
        _land(state, now)


FAILSAFES: tuple[Failsafe[FreeFlightState], ...] = (
    Failsafe(
        "position_loss",
        "in the air, flown by position, which repeats itself while the vehicle moves",
        "LAND",
        names.POSITION_LOSS,
        _position_lost,
        _in_flight,
        _land,
        "Position lost: descending",
    ),
    Failsafe(
        "fence_breach",
        "in the air, has left what the fence allows; not landing, nor returning where that is the action",
        "by the parameter",
        names.FENCE_ACTION,
        _fence_breached,
        _in_flight,
        _react_to_breach,
        "",
    ),
    Failsafe(
        "offboard_loss",
        "OFFBOARD in the air, no set-point for that time",
        f"brake and hold; ends when two set-points arrive within `{px4.PARAM_SETPOINT_LOSS}`",
        px4.PARAM_SETPOINT_LOSS,
        setpoints_lost,
        _in_flight,
        _hold_for_setpoints,
        "Set-points lost: holding",
    ),
    *OFFBOARD_LOSS_ON_GROUND,
    Failsafe(
        "offboard_still_lost",
        "in that hold for that time",
        "return to home and land",
        names.FAILSAFE_DELAY,
        _hold_is_over,
        _in_flight,
        _return_for_setpoints,
        "Set-points lost: returning",
    ),
    Failsafe(
        "data_link_loss",
        f"in the air, neither returning nor landing, no HEARTBEAT of a ground station for `{px4.PARAM_LINK_LOSS}`",
        "by the parameter",
        px4.PARAM_LINK_LOSS_ACTION,
        _data_link_lost,
        _in_flight,
        _react_to_link_loss,
        "No ground station: NAV_DLL_ACT",
    ),
)

FREE = by_cause(FAILSAFES)
"""Of a vehicle without a payload."""
