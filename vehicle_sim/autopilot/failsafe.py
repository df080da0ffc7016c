"""A vehicle's failsafes, which act without the ground: condition, parameter, action, as one table.

The ground's: ``gcs/flight/failsafe.py``. ``docs/failsafes.md`` is made from both.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Generic, TypeVar

from gcs.mavlink import px4
from vehicle_sim.autopilot.flight_state import FlightState

S = TypeVar("S", bound=FlightState, contravariant=True)


@dataclass(frozen=True)
class Failsafe(Generic[S]):
    """Cause, condition and action; in flight the vehicle is then in failsafe, until a ground commands it."""

    name: str
    meaning: str
    """For people: when it acts."""
    reaction: str
    """For people: what the vehicle does."""
    parameter: str
    """The PX4 parameter that decides when."""
    cause: Callable[[S, float], bool]
    """What must have happened."""
    condition: Callable[[S], bool]
    """And in which state of the vehicle."""
    action: Callable[[S, float], None]
    notice: str
    """STATUSTEXT to the operator; empty: none."""


Table = Sequence[tuple[Callable[[S, float], bool], Sequence[Failsafe[S]]]]
"""Failsafes by their cause: one that several share is looked at once."""


def by_cause(failsafes: Sequence[Failsafe[S]]) -> Table[S]:
    """Return a table of failsafes in the order in which they count, those of one cause side by side."""
    return [(cause, [*rows]) for cause, rows in groupby(failsafes, key=lambda failsafe: failsafe.cause)]


def check_failsafes(table: Table[S], state: S, now: float) -> None:
    """Take the action of the first failsafe whose condition holds."""
    for cause, failsafes in table:
        if not cause(state, now):
            continue
        for failsafe in failsafes:
            if failsafe.condition(state):
                failsafe.action(state, now)
                if failsafe.notice:
                    state.notices.append(failsafe.notice)
                return


def setpoints_lost(state: FlightState, now: float) -> bool:
    """Return True if OFFBOARD is flown and its set-points have stopped."""
    return state.mode == px4.MODE_OFFBOARD and not state.failsafe and not state.has_fresh_setpoints(now)


def _in_flight(state: FlightState) -> bool:
    return state.armed and state.is_up


def armed(state: FlightState) -> bool:
    """Return True if the rotors may turn."""
    return state.armed


def always(state: FlightState) -> bool:
    """Return True."""
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


def disarm(state: FlightState, now: float) -> None:
    """Stop the rotors."""
    state.stop()


def _land(state: FlightState, now: float) -> None:
    if state.armed and state.land.in_air:
        state.begin_descent(now)
    elif state.armed:
        state.stop()
    state.failsafe = True


OFFBOARD_LOSS_ON_GROUND: tuple[Failsafe[FlightState], ...] = (
    Failsafe(
        "offboard_loss_on_ground",
        "OFFBOARD, armed on the ground, no set-point for that time",
        "disarm",
        px4.PARAM_SETPOINT_LOSS,
        setpoints_lost,
        armed,
        disarm,
        "Set-points lost on the ground: disarmed",
    ),
    Failsafe(
        "offboard_loss_disarmed",
        "OFFBOARD, disarmed, no set-point for that time",
        "HOLD (already disarmed)",
        px4.PARAM_SETPOINT_LOSS,
        setpoints_lost,
        always,
        disarm,
        "",
    ),
)
"""Of any vehicle; to follow that of one in the air."""

FAILSAFES: tuple[Failsafe[FlightState], ...] = (
    Failsafe(
        "offboard_loss",
        "OFFBOARD, armed and off the ground, no set-point for that time",
        f"HOLD by the stop plan, LAND at its time, without one after `{px4.PARAM_LAND_DELAY}`; ends when two "
        f"set-points arrive within `{px4.PARAM_SETPOINT_LOSS}`",
        px4.PARAM_SETPOINT_LOSS,
        setpoints_lost,
        _in_flight,
        _hold_then_land,
        "Set-points lost: braking and holding",
    ),
    *OFFBOARD_LOSS_ON_GROUND,
    Failsafe(
        "data_link_loss",
        f"HOLD in flight, no message of the ground in control for that time, and `{px4.PARAM_LINK_LOSS_ACTION}` is "
        f"{px4.LINK_LOSS_LAND}",
        "LAND",
        px4.PARAM_LINK_LOSS,
        _data_link_lost,
        always,
        _land,
        "No ground station: descending",
    ),
)

COUPLED = by_cause(FAILSAFES)
"""Of a vehicle on a payload."""
