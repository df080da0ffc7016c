"""Failsafes, which end or change a flight: one table of conditions, thresholds, reactions, severities and alarm codes.

Whoever ends or changes a flight raises a member of :class:`Failsafe`; the more severe reaction wins. To add one, add a
member here, with its condition. ``docs/failsafes.md`` is made from this table.
"""

import math
from collections.abc import Callable, Iterable

import numpy as np

from gcs.flight.alarms import AlarmCode, Severity
from gcs.flight.attitude_error import attitude_misaligned, attitude_wrong
from gcs.flight.autopilot_requirements import missing
from gcs.flight.condition import Check, Condition, Moment, Reaction, System, Trigger
from gcs.flight.link_limit import latency_exceeded
from gcs.flight.phase import IN_AIR, Phase
from gcs.mavlink import px4
from gcs.mavlink.vehicle_link import VehicleLink
from idc_controller.arrays import Array
from idc_controller.estimation.measurements import PAYLOAD
from idc_controller.geometry.formation import Formation
from idc_controller.safety.separation import Obstruction, obstruction


def _of_a_vehicle(problem: Callable[[VehicleLink], str]) -> Condition:
    """Return the condition that a vehicle has a ``problem``, the text that follows its name; the first one counts."""

    def condition(system: System, moment: Moment) -> Trigger | None:
        for i, link in enumerate(system.team.links):
            if text := problem(link):
                return Trigger(f"vehicle {link.system_id} {text}", (i,))
        return None

    return condition


_already_armed = _of_a_vehicle(
    lambda link: "is armed already: another ground station may be flying it" if link.status.armed else ""
)
_prearm_check_failed = _of_a_vehicle(
    lambda link: "" if link.status.prearm_ok else f"fails its pre-arm checks{link.status.last_text}"
)
_disarmed_in_flight = _of_a_vehicle(
    lambda link: "" if link.status.armed else f"has disarmed itself{link.status.last_text}"
)


def _connect_timeout(system: System, moment: Moment) -> Trigger | None:
    late = moment.now - system.preflight.connect_start > system.settings.connect_timeout
    return Trigger(system.preflight.missing) if late else None


def _duplicate_system_id(system: System, moment: Moment) -> Trigger | None:
    if moment.phase not in (Phase.CONNECT, Phase.CHECK, Phase.ON_GROUND):
        return None
    since = moment.now - system.settings.duplicate_id_window
    for i, link in enumerate(system.team.links):
        first, second = link.address, link.conflict.second_address
        if first and second and min(link.received_at, link.conflict.second_address_at) >= since:
            places = f"{first[0]}:{first[1]} and from {second[0]}:{second[1]}"
            return Trigger(
                f"system id {link.system_id} is heard from {places}: every vehicle needs one of its own", (i,)
            )
    return None


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
            reported = link.status.parameters[name]
            # Less thrust than assumed is unsafe, more is not.
            too_low = reported < value * (1.0 - tolerance)
            if too_low or (name != px4.PARAM_THRUST_MAX and reported > value * (1.0 + tolerance)):
                return f"has {name} = {reported:g}, the system file says {value:g}"
        return ""

    return _of_a_vehicle(problem)(system, moment)


def _position_unknown(system: System, moment: Moment) -> Trigger | None:
    preflight = system.preflight
    since = max(preflight.positions_until, preflight.check_start)
    if moment.time - since <= system.settings.connect_timeout:
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
            return Trigger(f"{name} stands {distance:.1f} m from its place over the payload (limit {limit:g} m)", (i,))
    return None


def _autopilot_unfit(system: System, moment: Moment) -> Trigger | None:
    preflight, links = system.preflight, system.team.links
    if not preflight.is_settled(moment.time):
        return None
    for i, link in enumerate(links):
        if lacking := missing(link, -math.inf, at_connect=False):
            return Trigger(f"vehicle {link.system_id} has not sent {', '.join(lacking)}", (i,))
    if (wrong := preflight.wrong_clock) is not None:
        link, rate = wrong
        text = f"the clock of vehicle {link.system_id} goes {rate:.2f} s a second: simulate at the ground's --speed"
        return Trigger(text, tuple(i for i, each in enumerate(links) if each is link))
    if (slow := preflight.slow_source(system.control_interval)) is None:
        return None
    source, interval = slow
    name = "the payload unit" if source == PAYLOAD else f"vehicle {links[source].system_id}"
    needed = f"a flight needs {1.0 / system.control_interval:g} Hz (rates.control)"
    return Trigger(
        f"{name} sends positions at {1.0 / interval:.3g} Hz; {needed}", () if source == PAYLOAD else (source,)
    )


def _link_unfit(system: System, moment: Moment) -> Trigger | None:
    if not system.preflight.is_settled(moment.time) or (late := _link_latency_exceeded(system, moment)) is None:
        return None
    link = system.team.links[late.vehicles[0]]
    if not system.preflight.queues(link):
        return late
    rate = link.clock.queue.fit().rate * 1e-3
    return Trigger(f"{late.reason}: its link carries {rate:.1f} kB/s, less than its telemetry needs", late.vehicles)


def _obstructed(system: System, moment: Moment) -> Trigger | None:
    preflight = system.preflight
    if not (preflight.has_positions and preflight.is_settled(moment.time)):
        return None
    found = _obstruction(system, moment.time, preflight.payload, 0.0)
    place = "where the payload stands" if preflight.landed else "on the pad"
    return None if found is None else Trigger(f"{place}, {found.lacking(0.0)}", source=found.name)


def _obstruction(system: System, time: float, place: Array, within: float) -> Obstruction | None:
    """Return what is nearer than ``within`` (m) to the formation at rest at ``place`` (3,), by the obstacle map."""
    return obstruction(Formation(system.team.parameters), system.obstacle_map, time, place, within)


def _sequence_failed(phase: Phase) -> Condition:
    """Return the condition that the command sequence of ``phase`` has a problem."""

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
    for link in system.team.links:
        if moment.now - link.telemetry_received_at <= timeout:
            return None
    return Trigger(f"no vehicle sends telemetry for {timeout:g} s")


def _telemetry_lost(system: System, moment: Moment) -> Trigger | None:
    timeout = system.settings.telemetry_timeout
    for i, link in enumerate(system.team.links):
        if moment.now - link.telemetry_received_at > timeout:
            return Trigger(f"vehicle {link.system_id} sends no telemetry for {timeout:g} s", (i,))
    return None


def _link_latency_exceeded(system: System, moment: Moment) -> Trigger | None:
    return latency_exceeded(system.team.links, system.settings, system.control_interval, moment.now)


def _offboard_left(system: System, moment: Moment) -> Trigger | None:
    for i, link in enumerate(system.team.links):
        if not link.status.offboard:
            mode = px4.mode_name(link.status.custom_mode)
            return Trigger(f"vehicle {link.system_id} has left OFFBOARD for {mode}{link.status.last_text}", (i,))
    return None


def _telemetry_incomplete(system: System, moment: Moment) -> Trigger | None:
    # The estimator can do without the attitude or the position of one vehicle, but not of several.
    links, timeout = system.team.links, system.settings.telemetry_timeout
    partial = [i for i, link in enumerate(links) if moment.now - link.complete_telemetry_received_at > timeout]
    if len(partial) < 2:
        return None
    names = _names(links[i] for i in partial)
    return Trigger(f"vehicles {names} do not send all telemetry for {timeout:g} s", tuple(partial))


def _data_link_lost(system: System, moment: Moment) -> Trigger | None:
    if moment.phase is Phase.ON_GROUND:
        return None  # all are disarmed; before the next take-off they must have connected again
    # Vehicles that send nothing may still receive: a pending descent is commanded first.
    if moment.sequence is not None and moment.sequence.descent_pending:
        return None
    latest, timeout = max(link.received_at for link in system.team.links), system.settings.data_link_timeout
    lost = math.isfinite(latest) and moment.now - latest > timeout
    return Trigger(f"no message of any vehicle for {timeout:g} s") if lost else None


def _control_overrun(system: System, moment: Moment) -> Trigger | None:
    usual, limit = system.steps.usual, system.settings.overrun_limit * system.control_interval
    if moment.phase not in (*IN_AIR, Phase.SPOOL_UP) or usual <= limit:
        return None
    return Trigger(
        f"control steps are made every {usual * 1e3:.0f} ms (limit {limit * 1e3:.0f} ms): this machine is too busy"
    )


def _obstacle_sensing_lost(system: System, moment: Moment) -> Trigger | None:
    if not system.obstacle_map.sensing_lost:
        return None
    return Trigger("no vehicle detects obstacles, or what all of them detect is impossible")


def _map_offset(system: System, moment: Moment) -> Trigger | None:
    if not system.obstacle_map.map_offset_detected:
        return None
    return Trigger("no vehicle detects obstacles where they are on the map any more")


def _no_path(system: System, moment: Moment) -> Trigger | None:
    reason = system.guidance.blocked(moment.time)
    return Trigger(reason) if reason else None


def _landing_aborted(system: System, moment: Moment) -> Trigger | None:
    place, wait = system.landing_place, system.settings.landing_wait
    if place is None or place.taken is None or not place.waited(moment.time) > wait:
        return None
    return Trigger(f"landing place taken by {place.taken.name} for {wait:g} s", source=place.taken.name)


def _payload_control_lost(system: System, moment: Moment) -> Trigger | None:
    lost = moment.estimate is not None and system.payload.is_out_of_control(moment.time, moment.estimate)
    return Trigger("control of the payload is lost", source="payload") if lost else None


def _off_plan(system: System, moment: Moment) -> Trigger | None:
    if not system.plan.is_off(moment.time):
        return None
    far = float(np.nanmedian(system.plan.deviations))
    return Trigger(f"the vehicles report positions {far:.1f} m off the plan (median): a collision, or out of control")


def _overturned(system: System, moment: Moment) -> Trigger | None:
    return Trigger("its own unit reports it overturned", source="payload") if system.plan.is_overturned else None


def _impact(system: System, moment: Moment) -> Trigger | None:
    if moment.estimate is None:
        return None
    hit = system.impact.impacts(clear=system.payload.is_clear(moment.estimate))
    if not hit:
        return None
    links = system.team.links
    names = ["the payload" if i == len(links) else f"vehicle {links[i].system_id}" for i in hit]
    vehicles = tuple(i for i in hit if i < len(links))
    text = f"an impact: the accelerometer of {' and '.join(names)} clipped"
    return Trigger(text, vehicles, source="team" if vehicles else "payload")


def _wind_exceeded(system: System, moment: Moment) -> Trigger | None:
    if moment.estimate is None or (air := system.guidance.air) is None:
        return None
    p, limit = system.team.parameters, system.settings.wind_drag
    weight = (p.m_0 + moment.estimate.mass_excess) * p.g + float(moment.estimate.force[2])
    drag = math.hypot(*air.on_payload(np.zeros(3))[:2])
    if drag <= limit * max(weight, 0.0):
        return None
    return Trigger(f"the wind pushes the payload aside by {drag:.1f} N, of {weight:.1f} N weight (limit {limit:.0%})")


def _climb_stalled(system: System, moment: Moment) -> Trigger | None:
    if moment.phase is not Phase.CLIMB or moment.estimate is None or system.payload.is_clear(moment.estimate):
        return None
    below, limit = system.plan.below_plan(moment.estimate.x[2]), system.kept_clearance
    if not below > limit:
        return None
    reason = f"the payload does not rise: it is {below:.1f} m below its plan (limit {limit:g} m)"
    return Trigger(reason, source="payload")


def _descent_stalled(system: System, moment: Moment) -> Trigger | None:
    if moment.estimate is None or moment.descent is None:
        return None
    if not system.payload.is_descent_stalled(*moment.descent, moment.estimate):
        return None
    _, descent = moment.descent
    below = descent.position(descent.end)
    landed = np.array([below[0], below[1], -system.team.parameters.payload.below])
    keep = system.kept_clearance
    found = _obstruction(system, moment.time, landed, keep)
    return Trigger(
        "the payload does not descend" + (f": at the landing place, {found.lacking(keep)}" if found else ""),
        source="payload",
    )


def _names(links: Iterable[VehicleLink]) -> str:
    return " and ".join(str(link.system_id) for link in links)


class Failsafe(AlarmCode):
    """The table. In ``meaning``, names in braces are fields of :class:`~gcs.config.flight_settings.FailsafeSettings`.

    Of several that hold at once the most severe reaction counts, then the cause: the whole team, the first vehicle,
    several vehicles; then the order of the table.
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
        action: str,
        meaning: str,
        severity: Severity | None = None,
    ) -> None:
        super().__init__(severity or reaction.severity, action, meaning)
        self.check, self.condition, self.reaction = check, condition, reaction

    # fmt: off
    INTERRUPTED = (Check.EVENT, None, Reaction.BRAKE_AND_LAND, "none",
        "the user has interrupted the flight (SIGINT, SIGTERM)", Severity.NOTICE)
    INTERRUPTED_TWICE = (Check.EVENT, None, Reaction.END_CONTROL, "stay clear until the vehicles have landed",
        "the user has interrupted the flight again")
    SIMULATION_LOST = (Check.EVENT, None, Reaction.END_CONTROL, "see the output of vehicle-sim",
        "vehicle-sim has ended, or does not answer")
    CONNECT_TIMEOUT = (Check.CONNECT, _connect_timeout, Reaction.REFUSE,
        "check the vehicle's power, address and system id",
        "a vehicle has not sent all that a flight needs within {connect_timeout:g} s")
    DUPLICATE_SYSTEM_ID = (Check.STEP, _duplicate_system_id, Reaction.REFUSE,
        "give every vehicle a system id of its own, or end the second swarm",
        "before arming, one system id is heard from two addresses within {duplicate_id_window:g} s")
    PARAMETER_MISMATCH = (Check.PREFLIGHT, _parameter_mismatch, Reaction.REFUSE,
        "correct the system file or the vehicle",
        "a parameter of a vehicle differs from the system file by more than {parameter_tolerance}, relative")
    ALREADY_ARMED = (Check.PREFLIGHT, _already_armed, Reaction.REFUSE, "disarm it; check for another ground station",
        "a vehicle is armed")
    PREARM_CHECK_FAILED = (Check.PREFLIGHT, _prearm_check_failed, Reaction.REFUSE, "act on its STATUSTEXT",
        "a vehicle fails its pre-arm checks")
    POSITION_UNKNOWN = (Check.PREFLIGHT, _position_unknown, Reaction.REFUSE, "check its navigation",
        "a vehicle or the payload unit has sent no position within {connect_timeout:g} s")
    MISPLACED = (Check.PREFLIGHT, _misplaced, Reaction.REFUSE, "place it, or check its position",
        "a vehicle is more than {placement_tolerance} m from its place over the payload")
    AUTOPILOT_UNFIT = (Check.PREFLIGHT, _autopilot_unfit, Reaction.REFUSE,
        "see docs/autopilots.md; set its message intervals, or reduce `rates.control`",
        "before arming, a vehicle does not answer TIMESYNC, its clock goes at another rate, or its positions come less "
        "often than set-points are sent")
    LINK_UNFIT = (Check.PREFLIGHT, _link_unfit, Reaction.REFUSE,
        "reduce its message rates, or use a faster link; of a simulation on a busy machine lower `--speed`",
        "before arming, datagrams of one vehicle usually take more than {latency_limit} s one way")
    OBSTRUCTED = (Check.PREFLIGHT, _obstructed, Reaction.REFUSE, "clear the pad",
        "an obstacle of the map, or one that the range sensors see, reaches into the formation on the pad, or where it "
        "has landed")
    ATTITUDE_MISALIGNED = (Check.STEP, attitude_misaligned, Reaction.BRAKE_AND_LAND,
        "check its navigation, and how it sits in its cradle",
        "until it is lifted from its cradle, a vehicle reports an attitude more than {pad_attitude_error} rad off the "
        "payload's; where it has landed: off that by its body rates")
    ARMING_FAILED = (Check.COMMAND, _sequence_failed(Phase.ARM), Reaction.DISARM, "act on its STATUSTEXT",
        "a vehicle refuses OFFBOARD or arming, or all are not armed within {arm_timeout:g} s")
    DISARMING_FAILED = (Check.COMMAND, _sequence_failed(Phase.DISARM), Reaction.END_CONTROL,
        "stay clear; disarm with the RC or kill switch",
        "a vehicle refuses to disarm, or not all are disarmed within {disarm_timeout:g} s")
    LANDING_UNCONFIRMED = (Check.COMMAND, _sequence_failed(Phase.AUTONOMOUS_LANDING), Reaction.END_CONTROL,
        "locate the vehicles; stay clear",
        "not all vehicles have reported that they have landed within {landing_timeout:g} s")
    STATES_UNKNOWN = (Check.LINK, _states_unknown, Reaction.AUTONOMOUS_LANDING, "check their sensors",
        "position and attitude of two or more vehicles cannot be estimated")
    ALL_TELEMETRY_LOST = (Check.LINK, _all_telemetry_lost, Reaction.AUTONOMOUS_LANDING,
        "check the ground's telemetry radio",
        "no vehicle has sent telemetry for {telemetry_timeout} s")
    TELEMETRY_LOST = (Check.LINK, _telemetry_lost, Reaction.AUTONOMOUS_LANDING, "check its MAVLink link",
        "one vehicle has sent no telemetry for {telemetry_timeout} s")
    LINK_LATENCY_EXCEEDED = (Check.LINK, _link_latency_exceeded, Reaction.AUTONOMOUS_LANDING,
        "check its MAVLink link for congestion; of a simulation on a busy machine lower `--speed`",
        "datagrams of one vehicle usually, or all for {latency_window} s, take more than {latency_limit} s one way, or "
        "down to {latency_any_loss} s where set-points are lost; or TIMESYNC is not answered for {timesync_timeout} s")
    DISARMED_IN_FLIGHT = (Check.LINK, _disarmed_in_flight, Reaction.AUTONOMOUS_LANDING, "act on its STATUSTEXT",
        "a vehicle has disarmed itself")
    OFFBOARD_LEFT = (Check.LINK, _offboard_left, Reaction.AUTONOMOUS_LANDING, "act on its STATUSTEXT",
        "a vehicle no longer flies the ground's set-points")
    TELEMETRY_INCOMPLETE = (Check.LINK, _telemetry_incomplete, Reaction.AUTONOMOUS_LANDING, "check their sensors",
        "two or more vehicles have sent no position or no attitude for {telemetry_timeout} s")
    DATA_LINK_LOST = (Check.STEP, _data_link_lost, Reaction.END_CONTROL, "stay clear until the vehicles have landed",
        "no message of any vehicle for {data_link_timeout:g} s, once the descent has been commanded")
    CONTROL_OVERRUN = (Check.STEP, _control_overrun, Reaction.AUTONOMOUS_LANDING,
        "end other programs, or use a faster machine; of a simulation lower `--speed`",
        "from spool-up to touchdown control steps are usually more than {overrun_limit:g} control periods apart")
    OBSTACLE_SENSING_LOST = (Check.IN_AIR, _obstacle_sensing_lost, Reaction.BRAKE_AND_LAND, "check the range sensors",
        "no vehicle detects obstacles, or what all of them detect is impossible")
    MAP_OFFSET = (Check.IN_AIR, _map_offset, Reaction.BRAKE_AND_LAND, "check positions and range sensors",
        "all vehicles detect the obstacles of the map away from their places")
    NO_PATH = (Check.IN_AIR, _no_path, Reaction.BRAKE_AND_LAND, "replan the mission",
        "the search for a detour has found none for long (`give_up` of the navigator)")
    LANDING_ABORTED = (Check.IN_AIR, _landing_aborted, Reaction.RETURN, "clear the landing place",
        "a landing place has been taken for {landing_wait:g} s")
    PAYLOAD_CONTROL_LOST = (Check.ESTIMATE, _payload_control_lost, Reaction.AUTONOMOUS_LANDING,
        "check the rigid links and the load",
        "the payload is tilted by more than {tilt_limit:.2f} rad, or its state is unknown, for {tilt_time} s")
    OFF_PLAN = (Check.IN_AIR, _off_plan, Reaction.AUTONOMOUS_LANDING, "locate the vehicles; stay clear",
        "half of the vehicles have been more than {deviation_limit} m off the plan for {deviation_time} s")
    OVERTURNED = (Check.IN_AIR, _overturned, Reaction.AUTONOMOUS_LANDING, "locate the vehicles; stay clear",
        "the payload's own unit reports a tilt beyond {tilt_limit:.2f} rad, and a vehicle is off its place")
    IMPACT = (Check.ESTIMATE, _impact, Reaction.BRAKE_AND_LAND, "inspect the vehicles and what was touched",
        "an accelerometer has exceeded its range since the payload is clear of the ground")
    ATTITUDE_WRONG = (Check.ESTIMATE, attitude_wrong, Reaction.BRAKE_AND_LAND, "check its navigation",
        "a vehicle pulls aside, as if its attitude were wrong on board by more than {attitude_error} rad, with a "
        "probability of {attitude_certainty}")
    WIND_EXCEEDED = (Check.ESTIMATE, _wind_exceeded, Reaction.AUTONOMOUS_LANDING, "wait for less wind",
        "the drag of the wind on the payload at rest is estimated as more than {wind_drag:.0%} of its weight")
    CLIMB_STALLED = (Check.ESTIMATE, _climb_stalled, Reaction.BRAKE_AND_LAND, "check the load, and what holds it",
        "the payload is still on the ground, below its plan by more than the margin and the bound on its deviation")
    DESCENT_STALLED = (Check.ESTIMATE, _descent_stalled, Reaction.AUTONOMOUS_LANDING, "check wind, load and positions",
        "the payload is still high {descent_timeout:g} s after the planned end of its descent")
    # fmt: on
