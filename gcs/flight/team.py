"""The vehicles as a team: found, checked, put into OFFBOARD, armed, watched, disarmed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink
from numpy.typing import NDArray

from gcs.mavlink import px4
from gcs.mavlink.vehicle_link import Command, CommandState, VehicleLink
from idc_controller.parameters import SystemParameters

Array = NDArray[np.float64]

SILENCE = 0.46
"""Telemetry older than this means that a vehicle is lost (s): as soon as it may take the ground for lost itself."""
LATE = 0.11
"""Datagrams that usually take longer one way cannot close the loop (s),"""
LATE_FOR = 0.3
"""nor those that all have for so long (s)."""
NEEDED_PARAMETERS = (
    px4.PARAM_THRUST_MAX,
    px4.PARAM_ATTITUDE_KP,
    px4.PARAM_ATTITUDE_KD,
    px4.PARAM_MOTOR_LAG,
    px4.PARAM_ONBOARD_RATE,
    px4.PARAM_SETPOINT_LOSS,
    px4.PARAM_LAND_DELAY,
)
TOLERANCE = 0.01
"""By how much a vehicle's parameter may differ from what the controller's model assumes."""


class DropOut(NamedTuple):
    """A vehicle that no longer takes part: the reason, and for how long (s) it has most likely heard nothing."""

    reason: str
    unheard: float


class Team:
    """All vehicles; questions about them are answered with a reason for people, or None when all is well."""

    def __init__(self, links: Sequence[VehicleLink], parameters: SystemParameters) -> None:
        self.links = tuple(links)
        self._parameters = parameters
        self._commands: list[tuple[VehicleLink, Command]] = []

    def missing(self, now: float) -> str | None:
        """Which vehicles have not told all that a flight needs."""
        for link in self.links:
            link.want_parameters(NEEDED_PARAMETERS)
        return self._first(
            lambda v: (
                _unheard(v)
                if now - v.heard > SILENCE
                else "sends no attitude and position"
                if now - v.whole_telemetry_heard > SILENCE
                else "relays no payload navigation data"
                if now - v.payload_heard > SILENCE
                else "does not tell " + ", ".join(p for p in NEEDED_PARAMETERS if p not in v.parameters)
                if any(p not in v.parameters for p in NEEDED_PARAMETERS)
                else "has not told whether it is ready"
                if v.prearm_ok is None
                else None
            )
        )

    def unfit(self) -> str | None:
        """Which vehicle is not the one that the controller's model describes, or is not ready."""
        p = self._parameters
        expected = {
            px4.PARAM_THRUST_MAX: p.thrust_max,
            px4.PARAM_ATTITUDE_KP: p.attitude_kp,
            px4.PARAM_ATTITUDE_KD: p.attitude_kd,
            px4.PARAM_MOTOR_LAG: p.motor_time_constant,
        }

        def problem(v: VehicleLink) -> str | None:
            for name, value in expected.items():
                told = v.parameters[name]
                # Less thrust than assumed is unsafe, more is not.
                short = told < value * (1.0 - TOLERANCE)
                if short or (name != px4.PARAM_THRUST_MAX and told > value * (1.0 + TOLERANCE)):
                    return f"has {name} = {told:g}, the system file says {value:g}"
            if v.armed:
                return "is armed already: another ground station may be flying it"
            return None if v.prearm_ok else "fails its own checks" + _told(v)

        return self._first(problem)

    def misplaced(self, positions: Array, payload: Array) -> str | None:
        """Which vehicle (positions (N, 3)) does not stand where its link would put it over the payload (3,)."""
        p, lengths = self._parameters.p, self._parameters.l
        expected = payload + p - lengths[:, None] * np.array([0.0, 0.0, 1.0])
        distance = np.linalg.norm(positions - expected, axis=1)
        return self._first(
            lambda v: (
                f"stands {distance[self.links.index(v)]:.1f} m from its place over the payload"
                if distance[self.links.index(v)] > 0.3
                else None
            )
        )

    def command_all(self, number: int, *parameters: float) -> None:
        """Send a command to every vehicle."""
        self._commands = [(link, link.command(number, *parameters)) for link in self.links]

    @property
    def answered(self) -> bool:
        """Whether every vehicle has accepted the last command."""
        return all(command.state is CommandState.ACCEPTED for _, command in self._commands)

    @property
    def refusal(self) -> str | None:
        """Which vehicle refused the last command, or did not answer it."""
        for link, command in self._commands:
            if command.state is CommandState.REFUSED and command.result is not None:
                result = mavlink.enums["MAV_RESULT"].get(command.result)
                name = result.name.removeprefix("MAV_RESULT_").lower() if result else str(command.result)
                return f"vehicle {link.system_id} answers {command.name} with {name}{_told(link)}"
            if command.state is CommandState.UNANSWERED:
                return f"vehicle {link.system_id} does not answer {command.name}"
        return None

    @property
    def armed(self) -> bool:
        """Whether every vehicle is armed."""
        return all(link.armed for link in self.links)

    @property
    def disarmed(self) -> bool:
        """Whether every vehicle is disarmed."""
        return not any(link.armed for link in self.links)

    @property
    def land_delay(self) -> float:
        """Time after which a vehicle without set-points descends (s)."""
        return min(link.parameters[px4.PARAM_LAND_DELAY] for link in self.links)

    def heard_are_disarmed(self, now: float) -> bool:
        """Whether every vehicle that is still heard, and at least one is, is disarmed."""
        heard = [link for link in self.links if now - link.telemetry_heard <= SILENCE]
        return bool(heard) and not any(link.armed for link in heard)

    def silent(self, now: float, longer_than: float) -> bool:
        """Whether nothing at all was heard of any vehicle."""
        return all(now - link.heard > longer_than for link in self.links)

    def dropped_out(self, now: float) -> DropOut | None:
        """Which vehicle no longer takes part in the flight."""
        if all(now - link.telemetry_heard > SILENCE for link in self.links):
            return DropOut(f"no vehicle sends telemetry for {SILENCE:g} s", SILENCE)
        for link in self.links:
            name = f"vehicle {link.system_id}"
            if now - link.telemetry_heard > SILENCE:
                return DropOut(f"{name} sends no telemetry for {SILENCE:g} s", now - link.telemetry_heard)
            if (late := max(link.clock.delay, link.clock.least_delay(LATE_FOR, now))) > LATE:
                return DropOut(f"the way to {name} takes {late * 1e3:.0f} ms, more than {LATE * 1e3:.0f} ms", late)
            if not link.armed:
                return DropOut(f"{name} has disarmed itself{_told(link)}", 0.0)
            if not link.offboard:
                mode = px4.mode_name(link.custom_mode)
                unheard = link.parameters[px4.PARAM_SETPOINT_LOSS] + link.clock.delay
                return DropOut(f"{name} has left OFFBOARD for {mode}{_told(link)}", unheard)
        # Of one vehicle the filter can do without the attitude, or without the position, but not of several.
        partly = [str(link.system_id) for link in self.links if now - link.whole_telemetry_heard > SILENCE]
        if len(partly) > 1:
            return DropOut(f"vehicles {' and '.join(partly)} do not send all telemetry for {SILENCE:g} s", 0.0)
        return None

    def _first(self, problem: Callable[[VehicleLink], str | None]) -> str | None:
        for link in self.links:
            if (text := problem(link)) is not None:
                return f"vehicle {link.system_id} {text}"
        return None


def _unheard(link: VehicleLink) -> str:
    if link.address is None:
        return "has not offered itself"
    other = "" if link.found_instead is None else f": vehicle {link.found_instead} does"
    return f"does not answer at {link.address[0]}:{link.address[1]}{other}"


def _told(link: VehicleLink) -> str:
    return f" ({link.texts[-1]})" if link.texts else ""
