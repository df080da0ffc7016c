"""Conditions of failsafes in the air: obstacles and paths, the payload's motion, wind, and the landing."""

import math

import numpy as np

from gcs.flight.condition import Moment, System, Trigger
from gcs.flight.link_conditions import positions_lost
from gcs.flight.phase import Phase


def obstacle_sensing_lost(system: System, moment: Moment) -> Trigger | None:
    if not system.obstacle_map.sensing_lost:
        return None
    return Trigger("no vehicle detects obstacles, or what all of them detect is impossible")


def map_offset(system: System, moment: Moment) -> Trigger | None:
    if not system.obstacle_map.map_offset_detected:
        return None
    return Trigger("no vehicle detects obstacles where they are on the map any more")


def no_path(system: System, moment: Moment) -> Trigger | None:
    reason = system.guidance.blocked(moment.time)
    return Trigger(reason) if reason else None


def landing_aborted(system: System, moment: Moment) -> Trigger | None:
    place, wait = system.landing_place, system.settings.landing_wait
    if place is None or place.taken is None or not place.waited(moment.time) > wait:
        return None
    return Trigger(f"landing place taken by {place.taken.name} for {wait:g} s", source=place.taken.name)


def lifted_again(system: System, moment: Moment) -> Trigger | None:
    if moment.phase is not Phase.SPOOL_DOWN or system.links is None:
        return None
    # At touch-down it bounces no faster than it came.
    rise, limit = -float(system.links.payload_velocity[2]), system.landing_speed
    if not system.payload.has_lifted_again(rise, limit):
        return None
    return Trigger(f"the payload rises at {rise:.1f} m/s after touch-down (limit {limit:g} m/s)", source="payload")


def payload_control_lost(system: System, moment: Moment) -> Trigger | None:
    lost = moment.estimate is not None and system.payload.is_out_of_control(moment.time, moment.estimate)
    return Trigger("control of the payload is lost", source="payload") if lost else None


def off_plan(system: System, moment: Moment) -> Trigger | None:
    if not system.plan.is_off(moment.time):
        return None
    far = float(np.nanmedian(system.plan.deviations))
    return Trigger(f"the vehicles report positions {far:.1f} m off the plan (median): a collision, or out of control")


def overturned(system: System, moment: Moment) -> Trigger | None:
    return Trigger("its own unit reports it overturned", source="payload") if system.plan.is_overturned else None


def impact(system: System, moment: Moment) -> Trigger | None:
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


def wind_exceeded(system: System, moment: Moment) -> Trigger | None:
    if system.load is None or (air := system.load.estimate.air) is None:
        return None
    # Both as they are learnt: for a moment a payload that has lost a part of its mass seems to weigh less than it does.
    weight, limit = system.load.payload_mass * system.team.parameters.g, system.settings.wind_drag
    drag = math.hypot(*air.on_payload(np.zeros(3))[:2])
    # Vehicles that do not know where they are hold nothing against the wind: the ground goes on.
    if drag <= limit * max(weight, 0.0) or positions_lost(system, moment):
        return None
    return Trigger(f"the wind pushes the payload aside by {drag:.1f} N, of {weight:.1f} N weight (limit {limit:.0%})")


def climb_stalled(system: System, moment: Moment) -> Trigger | None:
    if moment.phase is not Phase.CLIMB or moment.estimate is None or system.payload.is_clear(moment.estimate):
        return None
    below, limit = system.plan.below_plan(moment.estimate.x[2]), system.kept_clearance
    if not below > limit:
        return None
    reason = f"the payload does not rise: it is {below:.1f} m below its plan (limit {limit:g} m)"
    return Trigger(reason, source="payload")


def descent_stalled(system: System, moment: Moment) -> Trigger | None:
    if moment.descent is None or not system.payload.is_descent_stalled(*moment.descent):
        return None
    _, descent = moment.descent
    below = descent.position(descent.end)
    landed = np.array([below[0], below[1], -system.team.parameters.payload.below])
    keep = system.kept_clearance
    found = system.obstruction(moment.time, landed, keep)
    return Trigger(
        "the payload does not descend" + (f": at the landing place, {found.lacking(keep)}" if found else ""),
        source="payload",
    )
