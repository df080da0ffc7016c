"""What is done between a landing and the next take-off: waits, and commands to the grippers of the payload unit."""

import math
from collections.abc import Callable, Iterator

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config.flight_settings import DEFAULTS, FlightSettings
from gcs.flight.command_sequences import CommandSequence
from gcs.flight.team import Team
from gcs.mavlink.requests import CommandState
from gcs.mission.cargo import CargoState
from gcs.mission.route import Gripper, GroundLeg, Stand


class GroundLegs(CommandSequence):
    """Legs on the ground, one after the other. A gripper that does not do what is commanded ends nothing."""

    def __init__(
        self,
        team: Team,
        time: float,
        legs: Iterator[GroundLeg],
        cargo: CargoState,
        settings: FlightSettings = DEFAULTS,
        on_done: Callable[[str], None] = lambda source: None,
    ) -> None:
        """``cargo``: takes what the grippers have acknowledged. ``on_done``: is called with each leg's source."""
        super().__init__(team, time, settings)
        self._legs, self._cargo, self._on_done = legs, cargo, on_done
        self._leg: GroundLeg | None = next(legs, None)
        self._command: PayloadUnitCommand | None = None
        self.moved: frozenset[int] = frozenset()
        """Grippers that have acknowledged a change of what they hold."""
        self.refusals: list[str] = []
        """Commands that the payload unit has not accepted, with its reasons."""

    @property
    def source(self) -> str | None:
        """Source of the leg that is carried out; None: all are done."""
        return None if self._leg is None else self._leg.source

    def step(self, time: float, now: float) -> None:
        """See :class:`CommandSequence`."""
        while (leg := self._leg) is not None and self._is_done(leg, time, now):
            self._on_done(leg.source)
            self._leg, self._command, self._since = next(self._legs, None), None, time
        self.done = leg is None

    def _is_done(self, leg: GroundLeg, time: float, now: float) -> bool:
        if isinstance(leg, Stand):
            return time - self._since >= leg.seconds
        if self._command is None:
            number, action = float(leg.gripper), float(leg.action)
            self._command = PayloadUnitCommand(self._team, mavlink.MAV_CMD_DO_GRIPPER, number, action)
        self._command.step(now)
        if self._command.state is CommandState.PENDING:
            return False
        if self._command.state is not CommandState.REFUSED:
            # One that is not acknowledged may have been carried out: the mass will show it.
            self.moved ^= self._cargo.moved(leg)
            self._cargo.carry_out(leg)
        if self._command.problem:
            self.refusals.append(f"{_name(leg)}: {self._command.problem}")
        return True


class PayloadUnitCommand:
    """A command to the payload unit, through one vehicle after the other until any of them brings an answer."""

    def __init__(self, team: Team, number: int, *parameters: float) -> None:
        self._links, self._number, self._parameters = team.links, number, parameters
        self._sent, self._next_try = 0, -math.inf
        self.state = CommandState.PENDING
        self.problem = ""
        """Reason of the payload unit, or that it does not answer; empty: none."""
        for link in self._links:
            link.requests.payload_unit_answers.pop(number, None)

    def step(self, now: float) -> None:
        """Take the answer that has come, or send it again, at ``now`` (s) on the ground's clock."""
        name = mavlink.enums["MAV_CMD"][self._number].name
        for link in self._links:
            if (result := link.requests.payload_unit_answers.get(self._number)) is not None:
                accepted = result == mavlink.MAV_RESULT_ACCEPTED
                self.state = CommandState.ACCEPTED if accepted else CommandState.REFUSED
                if not accepted:
                    entry = mavlink.enums["MAV_RESULT"].get(result)
                    answer = entry.name.removeprefix("MAV_RESULT_").lower() if entry else str(result)
                    text = f" ({link.status.payload_text})" if link.status.payload_text else ""
                    self.problem = f"the payload unit answers {name} with {answer}{text}"
                return
        if now < self._next_try:
            return
        link = self._links[self._sent % len(self._links)]
        if self._sent >= link.requests.settings.tries:
            self.state, self.problem = CommandState.UNANSWERED, f"the payload unit does not answer {name}"
            return
        link.requests.command_payload_unit(self._number, self._parameters, self._sent)
        self._sent, self._next_try = self._sent + 1, now + link.requests.settings.retry_interval


def _name(leg: Gripper) -> str:
    what = "unloading" if leg.action == mavlink.GRIPPER_ACTION_RELEASE else "loading"
    return f"{what} of {f'gripper {leg.gripper}' if leg.gripper else 'all grippers'}"
