"""Set-points and stop plans read from messages, or the reason why they cannot be flown."""

import math
from typing import Any, NamedTuple

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config.vehicle_settings import SetpointSettings
from gcs.mavlink.stop_plan import StopPlanContent
from idc_controller.rotations_float import Quaternion, Vector
from vehicle_sim.world.errors import SimulationError

_IGNORE_RATE = (
    mavlink.ATTITUDE_TARGET_TYPEMASK_BODY_ROLL_RATE_IGNORE,
    mavlink.ATTITUDE_TARGET_TYPEMASK_BODY_PITCH_RATE_IGNORE,
    mavlink.ATTITUDE_TARGET_TYPEMASK_BODY_YAW_RATE_IGNORE,
)
_IGNORE_THRUST = mavlink.ATTITUDE_TARGET_TYPEMASK_THROTTLE_IGNORE
_IGNORE_ATTITUDE = mavlink.ATTITUDE_TARGET_TYPEMASK_ATTITUDE_IGNORE
# Bit 32, THRUST_BODY_SET, is not among them: rotors of this kind cannot push sideways.
_KNOWN_BITS = sum(_IGNORE_RATE) | _IGNORE_THRUST | _IGNORE_ATTITUDE

THRUST_TOLERANCE = 1e-4
HOLD_MAX = 4000.0  # s; from a stop to the descent: beyond the largest CLFT_LAND_DELAY


class SetpointError(SimulationError):
    """A set-point that cannot be flown; ``str`` says which field, its value and the limit."""


class AttitudeSetpoint(NamedTuple):
    """Set-point of the attitude loop.

    ``attitude``: unit quaternion body to world, or None to control the rates alone; ``rates`` in the body frame
    (rad/s, those not given are zero); ``thrust`` 0 .. 1 of the largest, or None to keep the last one;
    ``time_boot_ms``: the sender's stamp.
    """

    attitude: Quaternion | None
    rates: Vector
    thrust: float | None
    time_boot_ms: int


def read_setpoint(fields: tuple[Any, ...], limits: SetpointSettings) -> AttitudeSetpoint:
    """Return the set-point in the ``fields`` of a SET_ATTITUDE_TARGET, in the order of the wire.

    The type mask's bits as MAVLink defines them. Without an attitude all three rates must be given.
    Raises :class:`SetpointError`.
    """
    time_boot_ms, w, x, y, z, roll_rate, pitch_rate, yaw_rate, share, _, _, mask = fields
    rate_max = limits.rate_max
    if mask & ~_KNOWN_BITS:
        raise SetpointError(f"type_mask {mask} has bits that cannot be flown")
    rates = (
        0.0 if mask & _IGNORE_RATE[0] else roll_rate,
        0.0 if mask & _IGNORE_RATE[1] else pitch_rate,
        0.0 if mask & _IGNORE_RATE[2] else yaw_rate,
    )
    # Comparisons are written so that NaN fails them.
    if not (abs(rates[0]) <= rate_max and abs(rates[1]) <= rate_max and abs(rates[2]) <= rate_max):
        raise SetpointError(f"body rates {rates} are outside +-{rate_max} rad/s")

    attitude: Quaternion | None = None
    if not mask & _IGNORE_ATTITUDE:
        norm = math.sqrt(w * w + x * x + y * y + z * z)
        if not abs(norm - 1.0) <= limits.quaternion_norm_error_max:
            raise SetpointError(f"quaternion {(w, x, y, z)} has the norm {norm}")
        attitude = (w / norm, x / norm, y / norm, z / norm)
    elif mask & sum(_IGNORE_RATE):
        raise SetpointError(f"type_mask {mask} gives neither an attitude nor all three rates")

    thrust: float | None = None
    if not mask & _IGNORE_THRUST:
        if not -THRUST_TOLERANCE <= share <= 1.0 + THRUST_TOLERANCE:
            raise SetpointError(f"thrust {share} is outside 0 .. 1")
        thrust = min(max(share, 0.0), 1.0)
    return AttitudeSetpoint(attitude, rates, thrust, time_boot_ms)


class StopPlan(NamedTuple):
    """The stop to fly if no set-point follows; see :class:`~vehicle_sim.autopilot.hold_control.HoldPlan`.

    ``start`` of the stop and ``descent`` of all vehicles in the vehicle's boot time (s), ``duration`` in s, five
    ``control_points`` in NED (m), ``yaw`` in rad.
    """

    start: float
    descent: float
    duration: float
    control_points: tuple[Vector, ...]
    yaw: float
    hover_force: Vector | None = None
    """Thrust that holds the vehicle at rest (N, NED); None: not known."""


def checked_stop_plan(content: StopPlanContent, limits: SetpointSettings) -> StopPlan:
    """Return the plan that a message holds. Raises :class:`SetpointError`."""
    _, _, start, descent, duration, yaw, points, (north, east, down) = content
    if not math.isfinite(sum(map(sum, points))):
        raise SetpointError("a control point is not finite")
    if not 0.0 < duration <= limits.stop_duration_max:
        raise SetpointError(f"duration {duration} is outside 0 .. {limits.stop_duration_max} s")
    if not points[2] == points[3] == points[4]:  # velocity and acceleration at the end
        raise SetpointError("it does not end at rest")
    # At the start, too: with the end at rest that bounds every control point.
    speed = max(math.dist(points[0], points[4]), 4.0 * math.dist(points[0], points[1])) / duration
    if not speed <= limits.stop_speed_max:
        raise SetpointError(f"it is faster than {limits.stop_speed_max} m/s")
    if not abs(descent - start) <= HOLD_MAX:
        raise SetpointError(f"the descent begins {descent - start} s after the stop, limit {HOLD_MAX} s")
    if not math.isfinite(yaw):
        raise SetpointError("yaw is not finite")
    force = (north, east, down) if down < 0.0 and math.isfinite(north + east + down) else None
    return StopPlan(start, descent, duration, tuple((x, y, z) for x, y, z in points), yaw, force)
