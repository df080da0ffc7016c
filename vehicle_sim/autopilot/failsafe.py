"""A vehicle's failsafes, which act without the ground: condition, parameter, action.

The ground's: ``gcs/flight/failsafe.py``; the states that both lead to: ``gcs/mavlink/team_failsafe.py``.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Generic, TypeVar

from gcs.mavlink import px4
from gcs.mavlink.team_failsafe import TeamState
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
    state: TeamState | None = None
    """State of the team that it ends, for the next one; None: it is of free vehicles alone."""


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


def _data_link_lost(state: FlightState, now: float) -> bool:
    return (
        state.mode == px4.MODE_HOLD
        and now - state.link_time > state.parameters[px4.PARAM_LINK_LOSS]
        and state.parameters[px4.PARAM_LINK_LOSS_ACTION] == px4.LINK_LOSS_LAND
    )


def _hold(state: FlightState, now: float) -> None:
    state.failsafe = True
    state.begin_hold(now, descent_start=now + state.parameters[TeamState.HOLD.timer])


def _land(state: FlightState, now: float) -> None:
    state.begin_descent(now)
    state.failsafe = True


def _disarm(state: FlightState, now: float) -> None:
    state.stop()


_ENTRY = {TeamState.HOLD: _hold, TeamState.LAND: _land, TeamState.DISARMED: _disarm}


def _end_of(
    state: TeamState, name: str, meaning: str, parameter: str, cause: Callable[[FlightState, float], bool], notice: str
) -> Failsafe[FlightState]:
    """Return the failsafe that ends ``state`` of the team for the next one."""
    return Failsafe(
        name, meaning, f"`{state.next.name}`", parameter, cause, lambda own: own.team_state is state,
        _ENTRY[state.next], notice, state,
    )  # fmt: skip


# fmt: off
OFFBOARD_LOSS_ON_GROUND = (
    _end_of(TeamState.ARMED, "offboard_loss_on_ground", "OFFBOARD, armed on the ground, no set-point for that time",
        TeamState.ARMED.timer, setpoints_lost, "Set-points lost on the ground: disarmed"),
    _end_of(TeamState.DISARMED, "offboard_loss_disarmed", "OFFBOARD, disarmed, no set-point for that time",
        TeamState.ARMED.timer, setpoints_lost, ""),
)
"""Of any vehicle."""

FAILSAFES = (
    _end_of(TeamState.OFFBOARD, "offboard_loss", "OFFBOARD, armed and off the ground, no set-point for that time",
        TeamState.OFFBOARD.timer, setpoints_lost, "Set-points lost: braking and holding"),
    *OFFBOARD_LOSS_ON_GROUND,
    _end_of(TeamState.HOLD, "data_link_loss",
        f"HOLD in flight, no message of the ground in control for that time, and `{px4.PARAM_LINK_LOSS_ACTION}` is "
        f"{px4.LINK_LOSS_LAND}", px4.PARAM_LINK_LOSS, _data_link_lost, "No ground station: descending"),
    _end_of(TeamState.ARMED, "data_link_loss_on_ground",
        "HOLD, armed on the ground, no message of the ground in control for that time, as in flight",
        px4.PARAM_LINK_LOSS, _data_link_lost, "No ground station on the ground: disarmed"),
)
# fmt: on

COUPLED = by_cause(FAILSAFES)
"""Of a vehicle on a payload."""
