"""Faults of the sensors: a measurement on board is lost or wrong."""

from typing import Annotated

from gcs.config.tables import Vector
from gcs.faults.kind import LOST, FaultSettings, kind, names, parameter

_POSITION = "gps gnss position pos local_position global_position mocap vio baro barometer altitude"
_JAMMED = "jamming jammed blackout"
_Onboard = Annotated[
    bool, parameter("true: lost on board, too, where the other sensors are used; false: only in the telemetry")
]


@kind(
    "position_lost",
    "sensors",
    ("gps", "gnss", "no_gps", "jamming", *names(f"velocity {_POSITION}", f"{LOST} {_JAMMED}")),
)
class PositionLost(FaultSettings):
    """Position and velocity are no longer measured or reported."""

    onboard: _Onboard = True


@kind("position_glitch", "sensors", names(_POSITION, "glitch glitches jump jumps step hop"))
class PositionGlitch(FaultSettings):
    """The measured position jumps away and back, level, in random directions, and the vehicle flies by it."""

    size: Annotated[float, parameter("distance", "m", gt=0.0, le=1e5)]
    rate: Annotated[float, parameter("mean rate", "1/s", gt=0.0, le=100.0)] = 0.5
    hold: Annotated[float, parameter("duration of a jump", "s", gt=0.0, le=1e3)] = 0.2


@kind("position_drift", "sensors", ("spoofing", *names(_POSITION, "drift ramp spoof spoofing spoofed")))
class PositionDrift(FaultSettings):
    """The measured position drifts away, the velocity does not, and the vehicle flies by it."""

    velocity: Annotated[Vector, parameter("of the drift, north-east-down", "m/s")]


@kind("attitude_lost", "sensors", names("attitude imu ahrs mag magnetometer compass heading yaw orientation", LOST))
class AttitudeLost(FaultSettings):
    """The attitude is no longer reported, nor the rates, which share its message."""

    onboard: _Onboard = False


@kind("rates_lost", "sensors", names("rate rates gyro gyroscope angular_rate body_rates", LOST))
class RatesLost(FaultSettings):
    """The rates are reported as NaN, MAVLink's unknown value."""

    onboard: _Onboard = False


@kind(
    "payload_unit_lost",
    "sensors",
    names("payload payload_unit payload_imu payload_gps payload_sensor payload_nav", LOST),
)
class PayloadUnitLost(FaultSettings):
    """The vehicles receive nothing from the payload's navigation unit, and relay nothing."""


@kind(
    "obstacle_sensing_lost",
    "sensors",
    names(
        "lidar radar camera depth vision obstacle obstacles obstacle_sensor obstacle_sensing range range_sensor "
        "rangefinder distance_sensor proximity",
        LOST,
    ),
)
class ObstacleSensingLost(FaultSettings):
    """The vehicles no longer detect obstacles."""

    reported: Annotated[
        bool, parameter("true: the vehicles report that their sensors have failed; false: those fall silent")
    ] = True
