"""Conditions of failsafes of links and vehicles: telemetry, commands, modes, and the ground's own control steps."""

import math
from collections.abc import Callable, Iterable
from operator import attrgetter

from gcs.flight.condition import Condition, Moment, System, Trigger, of_a_vehicle
from gcs.flight.link_limit import latency_exceeded
from gcs.flight.phase import IN_AIR, Phase
from gcs.mavlink import px4
from gcs.mavlink.vehicle_link import VehicleLink

disarmed_in_flight = of_a_vehicle(
    lambda link: "" if link.status.armed else f"has disarmed itself{link.status.last_text}"
)


def sequence_failed(phase: Phase) -> Condition:
    """Return the condition that the command sequence of ``phase`` has a problem."""

    def condition(system: System, moment: Moment) -> Trigger | None:
        failed = moment.phase is phase and moment.sequence is not None and moment.sequence.problem
        return Trigger(failed) if failed else None

    return condition


def all_telemetry_lost(system: System, moment: Moment) -> Trigger | None:
    timeout = system.settings.telemetry_timeout
    for link in system.team.links:
        if moment.now - link.telemetry_received_at <= timeout:
            return None
    return Trigger(f"no vehicle sends telemetry for {timeout:g} s")


def telemetry_lost(system: System, moment: Moment) -> Trigger | None:
    return _first_late(system, moment, attrgetter("telemetry_received_at"), "sends no telemetry")


def link_latency_exceeded(system: System, moment: Moment) -> Trigger | None:
    return latency_exceeded(system.team.links, system.settings, system.control_interval, moment.now)


def offboard_left(system: System, moment: Moment) -> Trigger | None:
    for i, link in enumerate(system.team.links):
        if not link.status.offboard:
            mode = px4.mode_name(link.status.custom_mode)
            return Trigger(f"vehicle {link.system_id} has left OFFBOARD for {mode}{link.status.last_text}", (i,))
    return None


def telemetry_incomplete(system: System, moment: Moment) -> Trigger | None:
    # The estimator can do without the attitude of one vehicle, or without the positions of any.
    links, since = system.team.links, moment.now - system.settings.telemetry_timeout
    partial = [i for i, link in enumerate(links) if link.complete_telemetry_received_at < since]
    if len(partial) < 2 or all(links[i].attitude_received_at >= since for i in partial):
        return None
    names = _names(links[i] for i in partial)
    timeout = system.settings.telemetry_timeout
    return Trigger(f"vehicles {names} do not send all telemetry for {timeout:g} s", tuple(partial))


def positions_lost(system: System, moment: Moment) -> Trigger | None:
    links, since = system.team.links, moment.now - system.settings.telemetry_timeout
    isolated = system.estimator.health.isolation.uavs_without_position
    lost = [i for i, link in enumerate(links) if i in isolated or link.position_received_at < since]
    if len(lost) < 2:
        return None
    return Trigger(f"the positions of vehicles {_names(links[i] for i in lost)} are not known", tuple(lost))


def pose_missing(system: System, moment: Moment) -> Trigger | None:
    if moment.phase is not Phase.SPOOL_UP:
        return None  # in the air the others carry on
    return _first_late(system, moment, attrgetter("complete_telemetry_received_at"), "does not send all telemetry")


def data_link_lost(system: System, moment: Moment) -> Trigger | None:
    if moment.phase is Phase.ON_GROUND:
        return None  # all are disarmed; before the next take-off they must have connected again
    # Vehicles that send nothing may still receive: a pending descent is commanded first.
    if moment.sequence is not None and moment.sequence.descent_pending:
        return None
    latest, timeout = max(link.received_at for link in system.team.links), system.settings.data_link_timeout
    lost = math.isfinite(latest) and moment.now - latest > timeout
    return Trigger(f"no message of any vehicle for {timeout:g} s") if lost else None


def control_overrun(system: System, moment: Moment) -> Trigger | None:
    usual, limit = system.steps.usual, system.settings.overrun_limit * system.control_interval
    if moment.phase not in (*IN_AIR, Phase.SPOOL_UP) or usual <= limit:
        return None
    return Trigger(
        f"control steps are made every {usual * 1e3:.0f} ms (limit {limit * 1e3:.0f} ms): this machine is too busy"
    )


def _first_late(
    system: System, moment: Moment, received_at: Callable[[VehicleLink], float], what: str
) -> Trigger | None:
    """Return the first vehicle of which nothing was ``received_at`` within the timeout; ``what`` it fails to do."""
    timeout = system.settings.telemetry_timeout
    for i, link in enumerate(system.team.links):
        if moment.now - received_at(link) > timeout:
            return Trigger(f"vehicle {link.system_id} {what} for {timeout:g} s", (i,))
    return None


def _names(links: Iterable[VehicleLink]) -> str:
    return " and ".join(str(link.system_id) for link in links)
