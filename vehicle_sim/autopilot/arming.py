"""Prearm checks."""

import math

from gcs.mavlink import px4
from vehicle_sim.autopilot.flight_state import FlightState


def arming_problem(state: FlightState, now: float) -> str | None:
    """Return why the vehicle cannot be armed now, None if it can."""
    measured, limits = state.navigation.estimate, state.settings.arming
    if measured is None or not state.navigation.is_valid(now):
        return "no navigation data"
    _, x, y, _ = measured.attitude
    if 1.0 - 2.0 * (x * x + y * y) < math.cos(math.radians(limits.tilt_max_deg)):
        return "the vehicle lies on its side"
    if math.hypot(*measured.velocity) > limits.speed_max or math.hypot(*measured.rates) > limits.rate_max:
        return "the vehicle moves"
    if state.mode == px4.MODE_OFFBOARD and not state.has_fresh_setpoints(now):
        return "OFFBOARD without set-points"
    return None
