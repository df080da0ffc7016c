"""The mode ORBIT of a free vehicle: how it is entered, or why it is not."""

import math

from gcs.mavlink import px4
from gcs.mavlink.services.answer import ACCEPTED, Answer, denied, rejected_for_now
from idc_controller.rotations_float import Vector
from vehicle_sim.autopilot.free.auto_flight import filled
from vehicle_sim.autopilot.free.circling import CirclePath, Heading
from vehicle_sim.autopilot.free.modes import without_position
from vehicle_sim.autopilot.free.state import FreeFlightState

_CHECKED = 32  # points of a circle that are to be within the fence


def begin_orbit(
    state: FreeFlightState, centre: Vector, radius: float, speed: float, heading: Heading, angle: float
) -> Answer:
    """Fly to the nearest point of a circle about ``centre`` (NED, m; NaN: where it is), and on it for ``angle`` (rad).

    ``radius`` (m) is negative counter-clockwise; ``speed`` in m/s; NaN: the default.
    """
    estimate = state.estimate
    if not state.armed or not state.land.in_air or estimate is None:
        return rejected_for_now("Orbit denied: not flying")
    if state.reckoning.is_lost:
        return without_position("Orbit")
    settings = state.settings.free
    radius = settings.orbit_radius if math.isnan(radius) else radius
    speed = settings.orbit_speed if math.isnan(speed) else speed
    low, high = settings.orbit_radius_min, settings.orbit_radius_max
    if not low <= abs(radius) <= high:
        return denied(f"Orbit denied: a radius of {abs(radius):g} m is outside {low:g} .. {high:g} m", 1)
    limit = min(state.limits_of_setpoints.horizontal, math.sqrt(settings.acceleration * abs(radius)))
    if speed > limit:
        return denied(f"Orbit denied: {speed:g} m/s, on this circle the limit is {limit:.3g} m/s", 2)
    circle = CirclePath(filled(centre, estimate.position), radius, speed, heading, angle)
    x, y, z = circle.centre
    for i in range(_CHECKED):
        turn = math.tau * i / _CHECKED
        place = x + abs(radius) * math.cos(turn), y + abs(radius) * math.sin(turn), z
        if breach := state.refused_by_fence(place):
            return denied(f"Orbit denied: beyond the fence: {breach}")
    state.mode, state.failsafe, state.speed = px4.MODE_ORBIT, False, math.nan
    start = circle.start_from(estimate.position, state.motion.yaw)
    turns = heading in (Heading.CENTRE, Heading.TANGENT)
    state.fly([state.goal(start, radius=settings.orbit_radius_error, looks_ahead=turns), circle])
    return ACCEPTED
