"""Set-points and stop plans read from messages, or the reason why they cannot be flown."""

import math
from typing import NamedTuple

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config.vehicle_settings import SetpointSettings
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

STOP_POINTS = 5  # control points of a quartic


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


def read_setpoint(message: mavlink.MAVLink_set_attitude_target_message, limits: SetpointSettings) -> AttitudeSetpoint:
    """The set-point in a SET_ATTITUDE_TARGET message. Raises :class:`SetpointError`.

    The type mask's bits as MAVLink defines them. Without an attitude all three rates must be given.
    """
    mask, rate_max = message.type_mask, limits.rate_max
    if mask & ~_KNOWN_BITS:
        raise SetpointError(f"type_mask {mask} has bits that cannot be flown")
    rates = (
        0.0 if mask & _IGNORE_RATE[0] else message.body_roll_rate,
        0.0 if mask & _IGNORE_RATE[1] else message.body_pitch_rate,
        0.0 if mask & _IGNORE_RATE[2] else message.body_yaw_rate,
    )
    # Comparisons are written so that NaN fails them.
    if not (abs(rates[0]) <= rate_max and abs(rates[1]) <= rate_max and abs(rates[2]) <= rate_max):
        raise SetpointError(f"body rates {rates} are outside +-{rate_max} rad/s")

    attitude: Quaternion | None = None
    if not mask & _IGNORE_ATTITUDE:
        w, x, y, z = message.q
        norm = math.sqrt(w * w + x * x + y * y + z * z)
        if not abs(norm - 1.0) <= limits.quaternion_norm_error_max:
            raise SetpointError(f"quaternion {message.q} has the norm {norm}")
        attitude = (w / norm, x / norm, y / norm, z / norm)
    elif mask & sum(_IGNORE_RATE):
        raise SetpointError(f"type_mask {mask} gives neither an attitude nor all three rates")

    thrust: float | None = None
    if not mask & _IGNORE_THRUST:
        thrust = message.thrust
        if not -THRUST_TOLERANCE <= thrust <= 1.0 + THRUST_TOLERANCE:
            raise SetpointError(f"thrust {thrust} is outside 0 .. 1")
        thrust = min(max(thrust, 0.0), 1.0)
    return AttitudeSetpoint(attitude, rates, thrust, message.time_boot_ms)


class StopPlan(NamedTuple):
    """The stop to fly if no set-point follows; see :class:`~vehicle_sim.autopilot.hold_control.HoldPlan`.

    ``start`` in the vehicle's boot time (s), ``duration`` in s, five ``control_points`` in NED (m), ``yaw`` in rad.
    """

    start: float
    duration: float
    control_points: tuple[Vector, ...]
    yaw: float


def read_stop_plan(
    message: mavlink.MAVLink_trajectory_representation_bezier_message, limits: SetpointSettings
) -> StopPlan:
    """The plan in a TRAJECTORY_REPRESENTATION_BEZIER of one segment. Raises :class:`SetpointError`."""
    if message.valid_points != STOP_POINTS:
        raise SetpointError(f"a stop plan has {STOP_POINTS} control points, not {message.valid_points}")
    points = tuple(zip(message.pos_x, message.pos_y, message.pos_z, strict=True))
    if not all(math.isfinite(value) for point in points for value in point):
        raise SetpointError("a control point is not finite")
    duration, yaw = message.delta[0], message.pos_yaw[0]
    if not 0.0 < duration <= limits.stop_duration_max:
        raise SetpointError(f"delta {duration} is outside 0 .. {limits.stop_duration_max} s")
    if not math.isfinite(yaw):
        raise SetpointError("pos_yaw is not finite")
    return StopPlan(message.time_usec * 1e-6, duration, points, yaw)
