"""Failsafes of the ground, which end or change a flight: the table of conditions, reactions, severities, alarm codes.

Whoever ends or changes a flight raises a member of :class:`Failsafe`; the more severe reaction wins. To add one, add a
member here, with its condition. Those of a vehicle, which act without the ground, are in
``vehicle_sim/autopilot/failsafe.py``; the states that both lead to in ``gcs/mavlink/team_failsafe.py``.
"""

from gcs.flight import in_air_conditions as in_air
from gcs.flight import link_conditions as link
from gcs.flight import preflight_conditions as preflight
from gcs.flight.alarms import AlarmCode, Severity
from gcs.flight.attitude_error import attitude_misaligned, attitude_wrong
from gcs.flight.condition import Check, Condition
from gcs.flight.phase import Phase
from gcs.mavlink.team_failsafe import Reaction


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
        super().__init__(severity or Severity(reaction.severity), action, meaning)
        self.check, self.condition, self.reaction = check, condition, reaction

    # fmt: off
    INTERRUPTED = (Check.EVENT, None, Reaction.BRAKE_AND_LAND, "none",
        "the user has interrupted the flight (SIGINT, SIGTERM)", Severity.NOTICE)
    INTERRUPTED_TWICE = (Check.EVENT, None, Reaction.END_CONTROL, "stay clear until the vehicles have landed",
        "the user has interrupted the flight again")
    SIMULATION_LOST = (Check.EVENT, None, Reaction.END_CONTROL, "see the output of vehicle-sim",
        "vehicle-sim has ended, or does not answer")
    CONNECT_TIMEOUT = (Check.CONNECT, preflight.connect_timeout, Reaction.REFUSE,
        "check the vehicle's power, address and system id",
        "a vehicle has not sent all that a flight needs within {connect_timeout:g} s")
    DUPLICATE_SYSTEM_ID = (Check.STEP, preflight.duplicate_system_id, Reaction.REFUSE,
        "give every vehicle a system id of its own, or end the second swarm",
        "before arming, one system id is heard from two addresses within {duplicate_id_window:g} s")
    PARAMETER_MISMATCH = (Check.PREFLIGHT, preflight.parameter_mismatch, Reaction.REFUSE,
        "correct the system file or the vehicle",
        "a parameter of a vehicle differs from the system file by more than {parameter_tolerance}, relative")
    ALREADY_ARMED = (Check.PREFLIGHT, preflight.already_armed, Reaction.REFUSE,
        "disarm it; check for another ground station",
        "a vehicle is armed")
    PREARM_CHECK_FAILED = (Check.PREFLIGHT, preflight.prearm_check_failed, Reaction.REFUSE, "act on its STATUSTEXT",
        "a vehicle fails its pre-arm checks")
    POSITION_UNKNOWN = (Check.PREFLIGHT, preflight.position_unknown, Reaction.REFUSE, "check its navigation",
        "a vehicle or the payload unit has sent no position within {connect_timeout:g} s")
    MISPLACED = (Check.PREFLIGHT, preflight.misplaced, Reaction.REFUSE, "place it, or check its position",
        "a vehicle is more than {placement_tolerance} m from its place over the payload")
    AUTOPILOT_UNFIT = (Check.PREFLIGHT, preflight.autopilot_unfit, Reaction.REFUSE,
        "see docs/autopilots.md; set its message intervals, or reduce `rates.control`",
        "before arming, a vehicle does not answer TIMESYNC, its clock goes at another rate, or its positions come less "
        "often than set-points are sent")
    LINK_UNFIT = (Check.PREFLIGHT, preflight.link_unfit, Reaction.REFUSE,
        "reduce its message rates, or use a faster link; of a simulation on a busy machine lower `--speed`",
        "before arming, datagrams of one vehicle usually take more than {latency_limit} s one way")
    OBSTRUCTED = (Check.PREFLIGHT, preflight.obstructed, Reaction.REFUSE, "clear the pad",
        "an obstacle of the map, or one that the range sensors see, reaches into the formation on the pad, or where it "
        "has landed")
    ATTITUDE_MISALIGNED = (Check.STEP, attitude_misaligned, Reaction.BRAKE_AND_LAND,
        "check its navigation, and how it sits in its cradle",
        "until it is lifted from its cradle, a vehicle reports an attitude more than {pad_attitude_error} rad off the "
        "payload's; where it has landed, and until the climb: off that by its body rates")
    ARMING_FAILED = (Check.COMMAND, link.sequence_failed(Phase.ARM), Reaction.DISARM, "act on its STATUSTEXT",
        "a vehicle refuses OFFBOARD or arming, or all are not armed within {arm_timeout:g} s")
    DISARMING_FAILED = (Check.COMMAND, link.sequence_failed(Phase.DISARM), Reaction.END_CONTROL,
        "stay clear; disarm with the RC or kill switch",
        "a vehicle refuses to disarm, or not all are disarmed within {disarm_timeout:g} s")
    LANDING_UNCONFIRMED = (Check.COMMAND, link.sequence_failed(Phase.AUTONOMOUS_LANDING), Reaction.END_CONTROL,
        "locate the vehicles; stay clear",
        "not all vehicles have reported that they have landed within {landing_timeout:g} s")
    ALL_TELEMETRY_LOST = (Check.LINK, link.all_telemetry_lost, Reaction.AUTONOMOUS_LANDING,
        "check the ground's telemetry radio",
        "no vehicle has sent telemetry for {telemetry_timeout} s")
    TELEMETRY_LOST = (Check.LINK, link.telemetry_lost, Reaction.AUTONOMOUS_LANDING, "check its MAVLink link",
        "one vehicle has sent no telemetry for {telemetry_timeout} s")
    LINK_LATENCY_EXCEEDED = (Check.LINK, link.link_latency_exceeded, Reaction.AUTONOMOUS_LANDING,
        "check its MAVLink link for congestion; of a simulation on a busy machine lower `--speed`",
        "datagrams of one vehicle usually, or all for {latency_window} s, take more than {latency_limit} s one way, or "
        "down to {latency_any_loss} s where set-points are lost; or TIMESYNC is not answered for {timesync_timeout} s")
    DISARMED_IN_FLIGHT = (Check.LINK, link.disarmed_in_flight, Reaction.AUTONOMOUS_LANDING, "act on its STATUSTEXT",
        "a vehicle has disarmed itself")
    OFFBOARD_LEFT = (Check.LINK, link.offboard_left, Reaction.AUTONOMOUS_LANDING, "act on its STATUSTEXT",
        "a vehicle no longer flies the ground's set-points")
    TELEMETRY_INCOMPLETE = (Check.LINK, link.telemetry_incomplete, Reaction.AUTONOMOUS_LANDING, "check their sensors",
        "two or more vehicles have sent no attitude or no position for {telemetry_timeout} s, one at least no attitude")
    POSITIONS_LOST = (Check.LINK, link.positions_lost, Reaction.BRAKE_AND_LAND, "check their navigation",
        "two or more vehicles have sent no position for {telemetry_timeout} s, or position and velocity of them are "
        "isolated; their links are then known by attitudes, set-points and the payload's motion")
    POSE_MISSING = (Check.LINK, link.pose_missing, Reaction.DISARM, "check its sensors",
        "while the rotors spool up one vehicle has sent no position or no attitude for {telemetry_timeout} s")
    LIFTED_AGAIN = (Check.STEP, in_air.lifted_again, Reaction.AUTONOMOUS_LANDING, "check the load",
        "after touch-down the payload rises faster than it bounces: than the landing speed")
    DATA_LINK_LOST = (Check.STEP, link.data_link_lost, Reaction.END_CONTROL,
        "stay clear until the vehicles have landed",
        "no message of any vehicle for {data_link_timeout:g} s, once the descent has been commanded")
    CONTROL_OVERRUN = (Check.STEP, link.control_overrun, Reaction.AUTONOMOUS_LANDING,
        "end other programs, or use a faster machine; of a simulation lower `--speed`",
        "from spool-up to touchdown control steps are usually more than {overrun_limit:g} control periods apart")
    OBSTACLE_SENSING_LOST = (Check.IN_AIR, in_air.obstacle_sensing_lost, Reaction.BRAKE_AND_LAND,
        "check the range sensors",
        "no vehicle detects obstacles, or what all of them detect is impossible")
    MAP_OFFSET = (Check.IN_AIR, in_air.map_offset, Reaction.BRAKE_AND_LAND, "check positions and range sensors",
        "all vehicles detect the obstacles of the map away from their places")
    NO_PATH = (Check.IN_AIR, in_air.no_path, Reaction.BRAKE_AND_LAND, "replan the mission",
        "the search for a detour has found none for long (`give_up` of the navigator)")
    LANDING_ABORTED = (Check.IN_AIR, in_air.landing_aborted, Reaction.RETURN, "clear the landing place",
        "a landing place has been taken for {landing_wait:g} s")
    PAYLOAD_CONTROL_LOST = (Check.ESTIMATE, in_air.payload_control_lost, Reaction.AUTONOMOUS_LANDING,
        "check the rigid links and the load",
        "the payload is tilted by more than {tilt_limit:.2f} rad, or its state is unknown, for {tilt_time} s")
    OFF_PLAN = (Check.IN_AIR, in_air.off_plan, Reaction.AUTONOMOUS_LANDING, "locate the vehicles; stay clear",
        "half of the vehicles have been more than {deviation_limit} m off the plan for {deviation_time} s")
    OVERTURNED = (Check.IN_AIR, in_air.overturned, Reaction.AUTONOMOUS_LANDING, "locate the vehicles; stay clear",
        "the payload's own unit reports a tilt beyond {tilt_limit:.2f} rad, and a vehicle is off its place")
    IMPACT = (Check.ESTIMATE, in_air.impact, Reaction.BRAKE_AND_LAND, "inspect the vehicles and what was touched",
        "an accelerometer has exceeded its range since the payload is clear of the ground")
    ATTITUDE_WRONG = (Check.ESTIMATE, attitude_wrong, Reaction.BRAKE_AND_LAND, "check its navigation",
        "a vehicle pulls aside, as if its attitude were wrong on board by more than {attitude_error} rad, with a "
        "probability of {attitude_certainty}")
    WIND_EXCEEDED = (Check.ESTIMATE, in_air.wind_exceeded, Reaction.AUTONOMOUS_LANDING, "wait for less wind",
        "the drag of the wind on the payload at rest is estimated as more than {wind_drag:.0%} of its weight, and "
        "positions are not lost as in `positions_lost`")
    CLIMB_STALLED = (Check.ESTIMATE, in_air.climb_stalled, Reaction.BRAKE_AND_LAND,
        "check the load, and what holds it",
        "the payload is still on the ground, below its plan by more than the margin and the bound on its deviation")
    DESCENT_STALLED = (Check.ESTIMATE, in_air.descent_stalled, Reaction.AUTONOMOUS_LANDING,
        "check wind, load and positions",
        "the payload has not touched down {descent_timeout:g} s after the planned end of its descent")
    # fmt: on
