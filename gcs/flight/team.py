"""The vehicles as a team: commands to all, and their common state."""

from collections.abc import Sequence

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.flight.control_loop import Hold
from gcs.mavlink.requests import Command, CommandState
from gcs.mavlink.stop_plan import LAG_MAX
from gcs.mavlink.team_failsafe import TeamState
from gcs.mavlink.vehicle_link import VehicleLink
from idc_controller.parameters import SystemParameters


class Team:
    """All vehicles of a flight. Times are the ground's (s)."""

    def __init__(self, links: Sequence[VehicleLink], parameters: SystemParameters) -> None:
        self.links = tuple(links)
        self.parameters = parameters
        """Parameters that the controller's model assumes."""
        self._commands: list[tuple[VehicleLink, Command]] = []

    def command_all(self, number: int, *parameters: float) -> None:
        """Send a command to every vehicle."""
        self._commands = [(link, link.requests.command(number, *parameters)) for link in self.links]

    @property
    def answered(self) -> bool:
        """True if every vehicle has accepted the last command."""
        return all(command.state is CommandState.ACCEPTED for _, command in self._commands)

    @property
    def waits(self) -> bool:
        """True while an answer to the last command is awaited."""
        return any(command.state is CommandState.PENDING for _, command in self._commands)

    @property
    def unanswered(self) -> bool:
        """True if a vehicle has not answered the last command, however often it was sent."""
        return any(command.state is CommandState.UNANSWERED for _, command in self._commands)

    @property
    def refusal(self) -> str | None:
        """The vehicle that refused the last command or did not answer it, with its result; None: none."""
        for link, command in self._commands:
            if command.state is CommandState.REFUSED and command.result is not None:
                result = mavlink.enums["MAV_RESULT"].get(command.result)
                name = result.name.removeprefix("MAV_RESULT_").lower() if result else str(command.result)
                return f"vehicle {link.system_id} answers {command.name} with {name}{link.status.last_text}"
            if command.state is CommandState.UNANSWERED:
                return f"vehicle {link.system_id} does not answer {command.name}"
        return None

    @property
    def armed(self) -> bool:
        """True if every vehicle is armed."""
        return all(link.status.armed for link in self.links)

    @property
    def disarmed(self) -> bool:
        """True if every vehicle is disarmed."""
        return not any(link.status.armed for link in self.links)

    @property
    def land_delay(self) -> float:
        """Time after which a vehicle without set-points descends (s)."""
        return min(link.status.parameters[TeamState.HOLD.timer] for link in self.links)

    @property
    def hold(self) -> Hold:
        """The hold without set-points, from the last ones on."""
        loss = max(link.status.parameters[TeamState.OFFBOARD.timer] for link in self.links)
        return Hold(loss + self.land_delay, LAG_MAX * loss)

    def reachable_are_disarmed(self, now: float, timeout: float) -> bool:
        """Return whether every vehicle with telemetry newer than ``timeout`` (s), and at least one, is disarmed."""
        reachable = [link for link in self.links if now - link.telemetry_received_at <= timeout]
        return bool(reachable) and not any(link.status.armed for link in reachable)
