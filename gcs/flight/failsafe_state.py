"""The failsafes that have been raised in a flight: which counts of several, and the reaction under way."""

import math

from gcs.flight.alarms import AlarmLog
from gcs.flight.condition import Check, Moment, System, Trigger
from gcs.flight.failsafe import Failsafe
from gcs.mavlink.team_failsafe import Reaction, TeamState

_ADMITTED = {
    (check, state): tuple(
        (row, row.condition, state.reaction(row.reaction))
        for row in Failsafe
        if row.check is check and row.condition is not None
    )
    for check in Check
    for state in TeamState
}
"""Failsafes of each check, with their conditions and the reactions that a state of the team allows."""


class FailsafeState:
    """Failsafes that have been raised in a flight: the present reaction, and the first reason."""

    def __init__(self, system: System, alarms: AlarmLog) -> None:
        self.system, self.alarms = system, alarms
        self.reaction = Reaction.NONE
        self.reason = ""
        """First reason for which the flight was ended early; empty: none."""
        self.time = math.nan
        """Time of that reason (s, team time)."""
        self.raised: set[Failsafe] = set()

    @property
    def interrupted(self) -> bool:
        """True if the user has interrupted the flight."""
        return not self.raised.isdisjoint({Failsafe.INTERRUPTED, Failsafe.INTERRUPTED_TWICE})

    def evaluate(self, check: Check, moment: Moment, state: TeamState) -> tuple[Failsafe, Trigger] | None:
        """Return what counts among the conditions of ``check`` that call for more than is under way; None: none."""
        system, present = self.system, self.reaction
        held = [
            (failsafe, trigger)
            for failsafe, condition, reaction in _ADMITTED[check, state]
            if reaction > present and (trigger := condition(system, moment)) is not None
        ]
        if not held:
            return None
        return min(held, key=lambda each: (-each[0].reaction, len(each[1].vehicles), each[1].vehicles))

    def raise_failsafe(self, time: float, state: TeamState, failsafe: Failsafe, trigger: Trigger) -> Reaction:
        """Record it at ``time`` (s); return its reaction, NONE if one at least as severe is under way."""
        source = trigger.source
        if len(trigger.vehicles) == 1:
            source = f"vehicle {self.system.team.links[trigger.vehicles[0]].system_id}"
        self.alarms.raise_alarm(time, source, failsafe, trigger.reason)
        self.raised.add(failsafe)
        if not self.reason:
            self.reason, self.time = trigger.reason, time
        reaction = state.reaction(failsafe.reaction)
        if reaction <= self.reaction:
            return Reaction.NONE
        self.reaction = reaction
        return reaction
