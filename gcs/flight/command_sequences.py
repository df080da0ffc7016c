"""Sequences of commands to all vehicles: arm, disarm, land autonomously."""

from abc import ABC, abstractmethod

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config.flight_settings import DEFAULTS, FlightSettings
from gcs.flight.team import Team
from gcs.mavlink import px4
from gcs.mavlink.team_failsafe import TeamState


class CommandSequence(ABC):
    """A sequence from ``time`` (s, team) on that is stepped until it is done or has failed."""

    done = False
    problem = ""
    """Reason of a failure; empty: none."""
    descent_pending = False
    """True while a descent is still to be commanded."""

    def __init__(self, team: Team, time: float, settings: FlightSettings = DEFAULTS) -> None:
        self._team, self._since, self._settings = team, time, settings

    @abstractmethod
    def step(self, time: float, now: float) -> None:
        """Go on at team ``time`` (s), ``now`` on the ground's clock."""


class Arming(CommandSequence):
    """OFFBOARD, then arm. Set-points are to be sent meanwhile, or vehicles refuse OFFBOARD."""

    _command: int | None = None

    def step(self, time: float, now: float) -> None:
        """See :class:`CommandSequence`."""
        team, elapsed = self._team, time - self._since
        timeout = self._settings.failsafe.arm_timeout
        if team.refusal is not None or elapsed > timeout:
            self.problem = team.refusal or f"not every vehicle is armed after {timeout:g} s"
        elif self._command is None:
            if elapsed > self._settings.takeoff_landing.offboard_delay:
                self._command = _enter(team, TeamState.ARMED)
        elif team.answered and self._command == mavlink.MAV_CMD_DO_SET_MODE:
            self._command = _arm(team, True)
        elif team.answered and team.armed:
            self.done = True


class Disarming(CommandSequence):
    """Rotors off, by force where a vehicle refuses: payload and vehicles are on the ground, whatever it estimates."""

    _forced = False

    def __init__(self, team: Team, time: float, settings: FlightSettings = DEFAULTS) -> None:
        super().__init__(team, time, settings)
        _arm(team, False)

    def step(self, time: float, now: float) -> None:
        """See :class:`CommandSequence`."""
        team, timeout = self._team, self._settings.failsafe.disarm_timeout
        if team.answered and team.disarmed:
            self.done = True
        elif team.refusal is not None and not self._forced:
            self._forced = True
            _arm(team, False, px4.FORCE_ARM_DISARM)
        elif team.refusal is not None or time - self._since > timeout:
            self.problem = team.refusal or f"not every vehicle is disarmed after {timeout:g} s"


class AutonomousLanding(CommandSequence):
    """The states that follow OFFBOARD, each commanded when a vehicle enters it that receives nothing."""

    descent_pending = True
    _descent_answered = False
    """True once every vehicle has answered the command to descend, or was sent it often enough."""

    def __init__(self, team: Team, time: float, settings: FlightSettings = DEFAULTS) -> None:
        super().__init__(team, time, settings)
        _enter(team, TeamState.OFFBOARD.next)

    def step(self, time: float, now: float) -> None:
        """See :class:`CommandSequence`. The descent is sent to vehicles without telemetry, too: they may receive it."""
        s, team, elapsed = self._settings.failsafe, self._team, time - self._since
        landed = team.reachable_are_disarmed(now, s.data_link_timeout)
        self._descent_answered |= not (self.descent_pending or team.waits)
        if landed and self._descent_answered:
            self.done = True
        elif elapsed > s.landing_timeout:
            self.problem = f"not every vehicle has landed after {s.landing_timeout:g} s"
        elif self.descent_pending:
            if landed or elapsed >= team.land_delay:
                self.descent_pending = False
                _enter(team, TeamState.HOLD.next)
        elif not team.waits and team.unanswered:
            _enter(team, TeamState.HOLD.next)


def _enter(team: Team, state: TeamState) -> int:
    mode = px4.decode_custom_mode(state.mode)
    team.command_all(mavlink.MAV_CMD_DO_SET_MODE, mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED, *mode)
    return mavlink.MAV_CMD_DO_SET_MODE


def _arm(team: Team, arm: bool, *parameters: float) -> int:
    team.command_all(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, float(arm), *parameters)
    return mavlink.MAV_CMD_COMPONENT_ARM_DISARM
