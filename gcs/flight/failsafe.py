"""What ends or changes a flight: one table of conditions, thresholds, reactions, severities and alarm codes.

Whoever ends or changes a flight raises a member of :class:`Failsafe`; the more severe reaction wins. To add one, add a
member here, with its condition. ``docs/failsafes.md`` is made from this table.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import Enum, IntEnum

import numpy as np

from gcs.config.flight_settings import DEFAULTS, FailsafeSettings
from gcs.flight.alarms import AlarmCode, AlarmLog, Severity
from gcs.flight.command_sequences import CommandSequence
from gcs.flight.payload_monitor import PayloadMonitor
from gcs.flight.phase import IN_AIR, Phase
from gcs.flight.preflight import Preflight
from gcs.flight.team import Team, last_text
from gcs.mavlink import px4
from gcs.mavlink.vehicle_link import VehicleLink
from idc_controller.estimation.estimate import Estimate
from idc_controller.estimation.estimator import Estimator
from idc_controller.guidance.progress import Guidance
from idc_controller.perception.obstacle_map import ObstacleMap
from idc_controller.trajectory.trajectory import Trajectory


class Reaction(IntEnum):
    """What the ground does, in ascending severity."""

    NONE = 0
    REFUSE = 1
    """The flight does not begin; nothing is armed."""
    DISARM = 2
    """The vehicles are on the ground: rotors off."""
    BRAKE_AND_LAND = 3
    """Come to rest along the path that is followed, then land there under the ground's control."""
    AUTONOMOUS_LANDING = 4
    """All vehicles follow the same stop plan, hold, and descend on board."""
    END_CONTROL = 5
    """The ground stops; each vehicle is left to its own failsafes."""

    def in_phase(self, phase: Phase) -> Reaction:
        """Return the reaction where ``phase`` allows it: on the ground there is nothing to land."""
        if self is Reaction.END_CONTROL:
            return self
        if phase in (Phase.CONNECT, Phase.CHECK):
            return Reaction.REFUSE
        return Reaction.DISARM if phase in (Phase.ARM, Phase.SPOOL_UP) else self


class Check(Enum):
    """When a condition is evaluated."""

    EVENT = "when it happens"
    CONNECT = "while connecting"
    PREFLIGHT = "before arming"
    COMMAND = "while a command sequence is carried out"
    LINK = "at every datagram, from spool-up to touchdown"
    STEP = "at every control step"
    ESTIMATE = "at every control step, on the new estimate"


@dataclass(frozen=True, eq=False)
class System:
    """The objects that conditions are evaluated on."""

    team: Team
    estimator: Estimator
    guidance: Guidance
    payload: PayloadMonitor
    preflight: Preflight
    obstacle_map: ObstacleMap | None = None
    settings: FailsafeSettings = DEFAULTS.failsafe


@dataclass(frozen=True, eq=False)
class Moment:
    """The moment of the evaluation; times in s, ``time`` the team's, ``now`` the ground's."""

    phase: Phase
    time: float
    now: float
    sequence: CommandSequence | None = None
    estimate: Estimate | None = None
    descent: tuple[float, Trajectory] | None = None
    """Progress along the mission trajectory, and that trajectory."""


@dataclass(frozen=True)
class Trigger:
    """A condition that holds."""

    reason: str
    """For people: what is wrong, the value, the limit."""
    vehicle: int = -1
    """Index of the vehicle (0 .. N-1); -1: none in particular."""
    cut_off: float = 0.0
    """For how long the vehicle has most likely received nothing (s)."""
    source: str = "team"


Condition = Callable[[System, Moment], Trigger | None]


def _first_vehicle(team: Team, problem: Callable[[VehicleLink], str]) -> Trigger | None:
    """Return the first vehicle with a problem."""
    for i, link in enumerate(team.links):
        if text := problem(link):
            return Trigger(f"vehicle {link.system_id} {text}", i)
    return None


def _connect_timeout(system: System, moment: Moment) -> Trigger | None:
    late = moment.now - system.preflight.connect_start > system.settings.connect_timeout
    return Trigger(system.preflight.missing) if late else None


def _parameter_mismatch(system: System, moment: Moment) -> Trigger | None:
    p, tolerance = system.team.parameters, system.settings.parameter_tolerance
    expected = {
        px4.PARAM_THRUST_MAX: p.thrust_max,
        px4.PARAM_ATTITUDE_KP: p.attitude_kp,
        px4.PARAM_ATTITUDE_KD: p.attitude_kd,
        px4.PARAM_MOTOR_LAG: p.motor_time_constant,
    }

    def problem(link: VehicleLink) -> str:
        for name, value in expected.items():
            reported = link.parameters[name]
            # Less thrust than assumed is unsafe, more is not.
            too_low = reported < value * (1.0 - tolerance)
            if too_low or (name != px4.PARAM_THRUST_MAX and reported > value * (1.0 + tolerance)):
                return f"has {name} = {reported:g}, the system file says {value:g}"
        return ""

    return _first_vehicle(system.team, problem)


def _already_armed(system: System, moment: Moment) -> Trigger | None:
    text = "is armed already: another ground station may be flying it"
    return _first_vehicle(system.team, lambda link: text if link.armed else "")


def _prearm_check_failed(system: System, moment: Moment) -> Trigger | None:
    return _first_vehicle(
        system.team, lambda link: "" if link.prearm_ok else f"fails its pre-arm checks{last_text(link)}"
    )


def _position_unknown(system: System, moment: Moment) -> Trigger | None:
    preflight = system.preflight
    if preflight.has_positions or moment.time - preflight.check_start <= system.settings.connect_timeout:
        return None
    return Trigger("no position of every vehicle and of the payload")


def _misplaced(system: System, moment: Moment) -> Trigger | None:
    preflight, p, limit = system.preflight, system.team.parameters, system.settings.placement_tolerance
    if not (preflight.has_positions and preflight.is_settled(moment.time)):
        return None
    expected = preflight.payload + p.p - p.l[:, None] * np.array([0.0, 0.0, 1.0])
    for i, distance in enumerate(np.linalg.norm(preflight.vehicles - expected, axis=1)):
        if distance > limit:
            name = f"vehicle {system.team.links[i].system_id}"
            return Trigger(f"{name} stands {distance:.1f} m from its place over the payload (limit {limit:g} m)", i)
    return None


def _sequence_failed(phase: Phase) -> Condition:
    def condition(system: System, moment: Moment) -> Trigger | None:
        failed = moment.phase is phase and moment.sequence is not None and moment.sequence.problem
        return Trigger(failed) if failed else None

    return condition


def _states_unknown(system: System, moment: Moment) -> Trigger | None:
    lost = system.estimator.health.isolation.uavs_without_position
    if len(lost) < 2:
        return None
    return Trigger(f"the states of vehicles {_names(system.team.links[i] for i in lost)} cannot be estimated")


def _all_telemetry_lost(system: System, moment: Moment) -> Trigger | None:
    timeout = system.settings.telemetry_timeout
    if any(moment.now - link.telemetry_received_at <= timeout for link in system.team.links):
        return None
    return Trigger(f"no vehicle sends telemetry for {timeout:g} s", cut_off=timeout)


def _telemetry_lost(system: System, moment: Moment) -> Trigger | None:
    timeout = system.settings.telemetry_timeout
    for i, link in enumerate(system.team.links):
        if (age := moment.now - link.telemetry_received_at) > timeout:
            return Trigger(f"vehicle {link.system_id} sends no telemetry for {timeout:g} s", i, age)
    return None


def _link_latency_exceeded(system: System, moment: Moment) -> Trigger | None:
    limit, window = system.settings.latency_limit, system.settings.latency_window
    for i, link in enumerate(system.team.links):
        if (latency := max(link.clock.delay, link.clock.least_delay(window, moment.now))) > limit:
            text = f"link latency to vehicle {link.system_id} is {latency * 1e3:.0f} ms (limit {limit * 1e3:.0f} ms)"
            return Trigger(text, i, latency)
    return None


def _disarmed_in_flight(system: System, moment: Moment) -> Trigger | None:
    return _first_vehicle(system.team, lambda link: "" if link.armed else f"has disarmed itself{last_text(link)}")


def _offboard_left(system: System, moment: Moment) -> Trigger | None:
    for i, link in enumerate(system.team.links):
        if not link.offboard:
            mode = px4.mode_name(link.custom_mode)
            text = f"vehicle {link.system_id} has left OFFBOARD for {mode}{last_text(link)}"
            return Trigger(text, i, link.parameters[px4.PARAM_SETPOINT_LOSS] + link.clock.delay)
    return None


def _telemetry_incomplete(system: System, moment: Moment) -> Trigger | None:
    # The estimator can do without the attitude or the position of one vehicle, but not of several.
    links, timeout = system.team.links, system.settings.telemetry_timeout
    partial = [link for link in links if moment.now - link.complete_telemetry_received_at > timeout]
    if len(partial) < 2:
        return None
    return Trigger(f"vehicles {_names(partial)} do not send all telemetry for {timeout:g} s", len(links))


def _data_link_lost(system: System, moment: Moment) -> Trigger | None:
    # Vehicles that send nothing may still receive: a pending descent is commanded first.
    if getattr(moment.sequence, "descent_pending", False):
        return None
    latest, timeout = max(link.received_at for link in system.team.links), system.settings.data_link_timeout
    lost = math.isfinite(latest) and moment.now - latest > timeout
    return Trigger(f"no message of any vehicle for {timeout:g} s") if lost else None


def _obstacle_sensing_lost(system: System, moment: Moment) -> Trigger | None:
    if moment.phase not in IN_AIR or system.obstacle_map is None or not system.obstacle_map.sensing_lost:
        return None
    return Trigger("no vehicle detects obstacles, or what all of them detect is impossible")


def _map_offset(system: System, moment: Moment) -> Trigger | None:
    if moment.phase not in IN_AIR or system.obstacle_map is None or not system.obstacle_map.map_offset_detected:
        return None
    return Trigger("no vehicle detects obstacles where they are on the map any more")


def _no_path(system: System, moment: Moment) -> Trigger | None:
    reason = system.guidance.blocked(moment.time) if moment.phase in IN_AIR else ""
    return Trigger(reason) if reason else None


def _payload_control_lost(system: System, moment: Moment) -> Trigger | None:
    if moment.estimate is None or not system.payload.is_out_of_control(moment.time, moment.estimate):
        return None
    return Trigger("control of the payload is lost", source="payload")


def _descent_stalled(system: System, moment: Moment) -> Trigger | None:
    if moment.phase is not Phase.LAND or moment.estimate is None or moment.descent is None:
        return None
    stalled = system.payload.is_descent_stalled(*moment.descent, moment.estimate)
    return Trigger("the payload does not descend", source="payload") if stalled else None


def _names(links: Iterable[VehicleLink]) -> str:
    return " and ".join(str(link.system_id) for link in links)


class Failsafe(AlarmCode):
    """The table. In ``meaning``, names in braces are fields of :class:`~gcs.config.flight_settings.FailsafeSettings`.

    Of several that hold at once the one with the most severe reaction counts, then that of the first vehicle, then the
    first of the table.
    """

    check: Check
    condition: Condition | None
    """None: an event, raised where it happens."""
    reaction: Reaction

    def __init__(
        self,
        check: Check,
        condition: Condition | None,
        reaction: Reaction,
        severity: Severity,
        meaning: str,
        action: str,
    ) -> None:
        self.check, self.condition, self.reaction = check, condition, reaction
        self.severity, self.meaning, self.action = severity, meaning, action

    def evaluate(self, system: System, moment: Moment) -> Trigger | None:
        """Return the trigger if the condition holds."""
        return None if self.condition is None else self.condition(system, moment)

    # fmt: off
    INTERRUPTED = (
        Check.EVENT, None, Reaction.BRAKE_AND_LAND, Severity.NOTICE,
        "the user has interrupted the flight (SIGINT, SIGTERM)", "none",
    )
    INTERRUPTED_TWICE = (
        Check.EVENT, None, Reaction.END_CONTROL, Severity.ALERT,
        "the user has interrupted the flight again", "watch the vehicles land",
    )
    SIMULATION_LOST = (
        Check.EVENT, None, Reaction.END_CONTROL, Severity.ALERT,
        "vehicle-sim has ended, or does not answer", "read its messages",
    )
    CONNECT_TIMEOUT = (
        Check.CONNECT, _connect_timeout, Reaction.REFUSE, Severity.ERROR,
        "a vehicle has not sent all that a flight needs within {connect_timeout:g} s",
        "check the vehicle's power, address and system id",
    )
    PARAMETER_MISMATCH = (
        Check.PREFLIGHT, _parameter_mismatch, Reaction.REFUSE, Severity.ERROR,
        "a parameter of a vehicle differs from the system file by more than {parameter_tolerance}, relative",
        "correct the system file or the vehicle",
    )
    ALREADY_ARMED = (
        Check.PREFLIGHT, _already_armed, Reaction.REFUSE, Severity.ERROR,
        "a vehicle is armed", "disarm it; look for another ground station",
    )
    PREARM_CHECK_FAILED = (
        Check.PREFLIGHT, _prearm_check_failed, Reaction.REFUSE, Severity.ERROR,
        "a vehicle fails its pre-arm checks", "follow its text",
    )
    POSITION_UNKNOWN = (
        Check.PREFLIGHT, _position_unknown, Reaction.REFUSE, Severity.ERROR,
        "a vehicle or the payload unit has sent no position within {connect_timeout:g} s", "check its navigation",
    )
    MISPLACED = (
        Check.PREFLIGHT, _misplaced, Reaction.REFUSE, Severity.ERROR,
        "a vehicle is more than {placement_tolerance} m from its place over the payload",
        "place it, or check its position",
    )
    ARMING_FAILED = (
        Check.COMMAND, _sequence_failed(Phase.ARM), Reaction.DISARM, Severity.ERROR,
        "a vehicle refuses OFFBOARD or arming, or all are not armed within {arm_timeout:g} s", "follow its text",
    )
    DISARMING_FAILED = (
        Check.COMMAND, _sequence_failed(Phase.DISARM), Reaction.END_CONTROL, Severity.ALERT,
        "a vehicle refuses to disarm, or not all are disarmed within {disarm_timeout:g} s", "keep away; disarm by hand",
    )
    LANDING_UNCONFIRMED = (
        Check.COMMAND, _sequence_failed(Phase.AUTONOMOUS_LANDING), Reaction.END_CONTROL, Severity.ALERT,
        "not all vehicles have reported that they have landed within {landing_timeout:g} s", "look for the vehicles",
    )
    STATES_UNKNOWN = (
        Check.LINK, _states_unknown, Reaction.AUTONOMOUS_LANDING, Severity.ALERT,
        "position and attitude of two or more vehicles cannot be estimated", "check their sensors",
    )
    ALL_TELEMETRY_LOST = (
        Check.LINK, _all_telemetry_lost, Reaction.AUTONOMOUS_LANDING, Severity.ALERT,
        "no vehicle has sent telemetry for {telemetry_timeout} s", "check the ground's radio",
    )
    TELEMETRY_LOST = (
        Check.LINK, _telemetry_lost, Reaction.AUTONOMOUS_LANDING, Severity.ALERT,
        "one vehicle has sent no telemetry for {telemetry_timeout} s", "check its link",
    )
    LINK_LATENCY_EXCEEDED = (
        Check.LINK, _link_latency_exceeded, Reaction.AUTONOMOUS_LANDING, Severity.ALERT,
        "datagrams of one vehicle usually, or all for {latency_window} s, take more than {latency_limit} s one way",
        "check its link for congestion",
    )
    DISARMED_IN_FLIGHT = (
        Check.LINK, _disarmed_in_flight, Reaction.AUTONOMOUS_LANDING, Severity.ALERT,
        "a vehicle has disarmed itself", "follow its text",
    )
    OFFBOARD_LEFT = (
        Check.LINK, _offboard_left, Reaction.AUTONOMOUS_LANDING, Severity.ALERT,
        "a vehicle no longer flies the ground's set-points", "follow its text",
    )
    TELEMETRY_INCOMPLETE = (
        Check.LINK, _telemetry_incomplete, Reaction.AUTONOMOUS_LANDING, Severity.ALERT,
        "two or more vehicles have sent no position or no attitude for {telemetry_timeout} s", "check their sensors",
    )
    DATA_LINK_LOST = (
        Check.STEP, _data_link_lost, Reaction.END_CONTROL, Severity.ALERT,
        "no message of any vehicle for {data_link_timeout:g} s, once the descent has been commanded",
        "watch the vehicles land",
    )
    OBSTACLE_SENSING_LOST = (
        Check.STEP, _obstacle_sensing_lost, Reaction.BRAKE_AND_LAND, Severity.CRITICAL,
        "no vehicle detects obstacles, or what all of them detect is impossible", "check the range sensors",
    )
    MAP_OFFSET = (
        Check.STEP, _map_offset, Reaction.BRAKE_AND_LAND, Severity.CRITICAL,
        "all vehicles detect the obstacles of the map away from their places", "check positions and range sensors",
    )
    NO_PATH = (
        Check.STEP, _no_path, Reaction.BRAKE_AND_LAND, Severity.CRITICAL,
        "the search for a detour has found none for long (`give_up` of the navigator)", "replan the mission",
    )
    PAYLOAD_CONTROL_LOST = (
        Check.ESTIMATE, _payload_control_lost, Reaction.AUTONOMOUS_LANDING, Severity.ALERT,
        "the payload is tilted by more than {tilt_limit:.2f} rad, or its state is unknown, for {tilt_time} s",
        "check links and load",
    )
    DESCENT_STALLED = (
        Check.ESTIMATE, _descent_stalled, Reaction.AUTONOMOUS_LANDING, Severity.ALERT,
        "the payload is still high {descent_timeout:g} s after the planned end of its descent",
        "check wind, load and positions",
    )
    # fmt: on


_BY_CHECK = {check: tuple(failsafe for failsafe in Failsafe if failsafe.check is check) for check in Check}


class FailsafeState:
    """Failsafes that have been raised in a flight: the present reaction, and the first reason."""

    def __init__(self, system: System, alarms: AlarmLog) -> None:
        self.system, self.alarms = system, alarms
        self.reaction = Reaction.NONE
        self.reason = ""
        """Why the flight was ended early, the first reason; empty: it was not."""
        self.time = math.nan
        """When that was found (s, team time)."""
        self.raised: set[Failsafe] = set()

    @property
    def interrupted(self) -> bool:
        """Whether the user has interrupted the flight."""
        return not self.raised.isdisjoint({Failsafe.INTERRUPTED, Failsafe.INTERRUPTED_TWICE})

    def evaluate(self, check: Check, moment: Moment) -> tuple[Failsafe, Trigger] | None:
        """Return what counts among the conditions of ``check`` that call for more than is under way; None: none."""
        held = [
            (failsafe, trigger)
            for failsafe in _BY_CHECK[check]
            if failsafe.reaction.in_phase(moment.phase) > self.reaction
            and (trigger := failsafe.evaluate(self.system, moment)) is not None
        ]
        return min(held, key=lambda each: (-each[0].reaction, each[1].vehicle), default=None)

    def raise_failsafe(self, time: float, phase: Phase, failsafe: Failsafe, trigger: Trigger) -> Reaction:
        """Record it at ``time`` (s); return its reaction, NONE if a more severe one is under way."""
        links = self.system.team.links
        source = f"vehicle {links[trigger.vehicle].system_id}" if 0 <= trigger.vehicle < len(links) else trigger.source
        self.alarms.raise_alarm(time, source, failsafe, trigger.reason)
        self.raised.add(failsafe)
        if not self.reason:
            self.reason, self.time = trigger.reason, time
        reaction = failsafe.reaction.in_phase(phase)
        if reaction < self.reaction:
            return Reaction.NONE
        self.reaction = reaction
        return reaction
