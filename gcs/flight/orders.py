"""What all vehicles are told to do together, and how far they have come with it: arm, disarm, land on their own."""

from __future__ import annotations

from typing import NamedTuple

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.flight.team import Team
from gcs.mavlink import px4

ARM_TIMEOUT = 12.0  # s
DISARM_TIMEOUT = 10.0  # s: the heartbeat that tells it comes once a second, and may be lost
STREAM_BEFORE_OFFBOARD = 0.5  # s
ALONE_TIMEOUT = 120.0  # s for the vehicles to land on their own


class Outcome(NamedTuple):
    """Of an order: whether it is carried out, or why it will not be."""

    done: bool = False
    problem: str = ""


PENDING, DONE = Outcome(), Outcome(done=True)


class Arming:
    """Into OFFBOARD, then armed; set-points are to be sent meanwhile, or vehicles will not enter OFFBOARD."""

    def __init__(self, team: Team, time: float) -> None:
        self._team, self._since = team, time
        self._asked: int | None = None

    def step(self, time: float) -> Outcome:
        """At ``time`` (s)."""
        team = self._team
        if (refusal := team.refusal) is not None:
            return Outcome(problem=refusal)
        if time - self._since > ARM_TIMEOUT:
            return Outcome(problem="not every vehicle is armed")
        if self._asked is None:
            if time - self._since > STREAM_BEFORE_OFFBOARD:
                self._asked = _set_mode(team, px4.MainMode.OFFBOARD)
        elif team.answered and self._asked == mavlink.MAV_CMD_DO_SET_MODE:
            self._asked = _arm(team, True)
        elif team.answered and team.armed:
            return DONE
        return PENDING


class Disarming:
    """Rotors off. The payload stands and the rotors idle; what a vehicle without a position believes does not count."""

    def __init__(self, team: Team, time: float) -> None:
        self._team, self._since = team, time
        self._forced = False
        _arm(team, False)

    def step(self, time: float) -> Outcome:
        """At ``time`` (s)."""
        team = self._team
        if team.answered and team.disarmed:
            return DONE
        if team.refusal is not None and not self._forced:
            self._forced = True
            _arm(team, False, px4.FORCE_ARM_DISARM)
        elif team.refusal is not None or time - self._since > DISARM_TIMEOUT:
            return Outcome(problem=team.refusal or "not every vehicle has disarmed")
        return PENDING


class LandingAlone:
    """All follow the stop plan that they have, hold, and descend as late as one does that hears nothing."""

    def __init__(self, team: Team, time: float) -> None:
        self._team, self._since = team, time
        self.descends = False
        """Whether they have been told to."""
        _set_mode(team, px4.MainMode.AUTO, px4.AutoMode.LOITER)

    def step(self, time: float, now: float) -> Outcome:
        """At ``time`` (s), ``now`` on the ground's clock."""
        if not self.descends and time - self._since >= self._team.land_delay:
            self.descends = True
            _set_mode(self._team, px4.MainMode.AUTO, px4.AutoMode.LAND)
        if self._team.heard_are_disarmed(now):
            return DONE
        return Outcome(problem="the vehicles have not landed") if time - self._since > ALONE_TIMEOUT else PENDING


def _set_mode(team: Team, *mode: float) -> int:
    team.command_all(mavlink.MAV_CMD_DO_SET_MODE, mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED, *mode)
    return mavlink.MAV_CMD_DO_SET_MODE


def _arm(team: Team, arm: bool, *parameters: float) -> int:
    team.command_all(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, float(arm), *parameters)
    return mavlink.MAV_CMD_COMPONENT_ARM_DISARM
