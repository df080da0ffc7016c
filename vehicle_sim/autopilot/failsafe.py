"""A vehicle's failsafes: condition, parameter, action, as one table; ``docs/architecture.md`` mirrors it."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import groupby

from gcs.mavlink import px4
from vehicle_sim.autopilot.flight_state import FlightState


@dataclass(frozen=True)
class Failsafe:
    """Cause, condition and action; in flight the vehicle is then in failsafe, until a ground commands it."""

    name: str
    parameter: str
    """The PX4 parameter that decides when."""
    cause: Callable[[FlightState, float], bool]
    """What must have happened."""
    condition: Callable[[FlightState], bool]
    """And in which state of the vehicle."""
    action: Callable[[FlightState, float], None]
    notice: str
    """STATUSTEXT to the operator; empty: none."""


def check_failsafes(state: FlightState, now: float) -> None:
    """Take the action of the first failsafe whose condition holds."""
    for cause, failsafes in _BY_CAUSE:
        if not cause(state, now):
            continue
        for failsafe in failsafes:
            if failsafe.condition(state):
                failsafe.action(state, now)
                if failsafe.notice:
                    state.notices.append(failsafe.notice)
                return


def _setpoints_lost(state: FlightState, now: float) -> bool:
    return state.mode == px4.MODE_OFFBOARD and not state.failsafe and not state.has_fresh_setpoints(now)


def _in_flight(state: FlightState) -> bool:
    return state.armed and state.is_up


def _armed(state: FlightState) -> bool:
    return state.armed


def _always(state: FlightState) -> bool:
    return True


def _data_link_lost(state: FlightState, now: float) -> bool:
    return (
        state.mode == px4.MODE_HOLD
        and state.hold is not None
        and not state.is_descending
        and now - state.link_time > state.parameters[px4.PARAM_LINK_LOSS]
        and state.parameters[px4.PARAM_LINK_LOSS_ACTION] == px4.LINK_LOSS_LAND
    )


def _hold_then_land(state: FlightState, now: float) -> None:
    state.failsafe = True
    state.begin_hold(now, descent_start=now + state.parameters[px4.PARAM_LAND_DELAY])


def _disarm(state: FlightState, now: float) -> None:
    state.stop()


def _land(state: FlightState, now: float) -> None:
    if state.armed and state.land.in_air:
        state.begin_descent(now)
    elif state.armed:
        state.stop()
    state.failsafe = True


FAILSAFES = (
    Failsafe(
        "offboard_loss",
        px4.PARAM_SETPOINT_LOSS,
        _setpoints_lost,
        _in_flight,
        _hold_then_land,
        "Set-points lost: braking and holding",
    ),
    Failsafe(
        "offboard_loss_on_ground",
        px4.PARAM_SETPOINT_LOSS,
        _setpoints_lost,
        _armed,
        _disarm,
        "Set-points lost on the ground: disarmed",
    ),
    Failsafe("offboard_loss_disarmed", px4.PARAM_SETPOINT_LOSS, _setpoints_lost, _always, _disarm, ""),
    Failsafe(
        "data_link_loss",
        px4.PARAM_LINK_LOSS,
        _data_link_lost,
        _always,
        _land,
        "No ground station: descending",
    ),
)

# A cause that several share is looked at once.
_BY_CAUSE = [(cause, [*rows]) for cause, rows in groupby(FAILSAFES, key=lambda failsafe: failsafe.cause)]
