"""Conditions of failsafes before the take-off: vehicles that do not connect, do not fit, or are not in their places."""

import math

import numpy as np

from gcs.flight.autopilot_requirements import missing
from gcs.flight.condition import Moment, System, Trigger, of_a_vehicle
from gcs.flight.link_conditions import link_latency_exceeded
from gcs.flight.phase import Phase
from gcs.mavlink import px4
from gcs.mavlink.vehicle_link import VehicleLink
from idc_controller.estimation.measurements import PAYLOAD

already_armed = of_a_vehicle(
    lambda link: "is armed already: another ground station may be flying it" if link.status.armed else ""
)
prearm_check_failed = of_a_vehicle(
    lambda link: "" if link.status.prearm_ok else f"fails its pre-arm checks{link.status.last_text}"
)


def connect_timeout(system: System, moment: Moment) -> Trigger | None:
    late = moment.now - system.preflight.connect_start > system.settings.connect_timeout
    return Trigger(system.preflight.missing) if late else None


def duplicate_system_id(system: System, moment: Moment) -> Trigger | None:
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


def parameter_mismatch(system: System, moment: Moment) -> Trigger | None:
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

    return of_a_vehicle(problem)(system, moment)


def position_unknown(system: System, moment: Moment) -> Trigger | None:
    preflight = system.preflight
    since = max(preflight.positions_until, preflight.check_start)
    if moment.time - since <= system.settings.connect_timeout:
        return None
    return Trigger("no position of every vehicle and of the payload")


def misplaced(system: System, moment: Moment) -> Trigger | None:
    preflight, p, limit = system.preflight, system.team.parameters, system.settings.placement_tolerance
    if not (preflight.has_positions and preflight.is_settled(moment.time)):
        return None
    expected = preflight.payload + p.p - p.l[:, None] * np.array([0.0, 0.0, 1.0])
    for i, distance in enumerate(np.linalg.norm(preflight.vehicles - expected, axis=1)):
        if distance > limit:
            name = f"vehicle {system.team.links[i].system_id}"
            return Trigger(f"{name} stands {distance:.1f} m from its place over the payload (limit {limit:g} m)", (i,))
    return None


def autopilot_unfit(system: System, moment: Moment) -> Trigger | None:
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


def link_unfit(system: System, moment: Moment) -> Trigger | None:
    if not system.preflight.is_settled(moment.time) or (late := link_latency_exceeded(system, moment)) is None:
        return None
    link = system.team.links[late.vehicles[0]]
    if not system.preflight.queues(link):
        return late
    rate = link.clock.queue.fit().rate * 1e-3
    return Trigger(f"{late.reason}: its link carries {rate:.1f} kB/s, less than its telemetry needs", late.vehicles)


def obstructed(system: System, moment: Moment) -> Trigger | None:
    preflight = system.preflight
    if not (preflight.has_positions and preflight.is_settled(moment.time)):
        return None
    found = system.obstruction(moment.time, preflight.payload, 0.0)
    place = "where the payload stands" if preflight.landed else "on the pad"
    return None if found is None else Trigger(f"{place}, {found.lacking(0.0)}", source=found.name)
