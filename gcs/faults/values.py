"""Faults of values: a measured channel is reported wrongly.

The channels' units: position m and velocity m/s in the world (north-east-down); attitude as the rotation vector from
world to body, rad; rates rad/s in the body frame; obstacles: the places of the points, m in the body frame.
"""

from dataclasses import dataclass
from typing import Annotated, Literal

from gcs.config import SystemConfig
from gcs.faults.kind import FaultSettings, Problem, Vehicles, kind, names, parameter

Channel = Literal[
    "position", "velocity", "attitude", "rates",
    "payload_position", "payload_velocity", "payload_attitude", "payload_rates",
    "obstacles"
]  # fmt: skip
Axes = tuple[Literal["x", "y", "z"], ...]
_Amount = 1e5
_SENSORS = "sensor gps gnss position velocity imu gyro accel accelerometer rate attitude mag compass "
_SENSORS += "heading baro altitude lidar"
_CHANNELS = {
    "gps": "position", "gnss": "position", "pos": "position", "location": "position", "altitude": "position",
    "baro": "position", "speed": "velocity", "vel": "velocity", "acceleration": "velocity", "accelerometer": "velocity",
    "orientation": "attitude", "quaternion": "attitude", "heading": "attitude", "yaw": "attitude", "roll": "attitude",
    "pitch": "attitude", "compass": "attitude", "mag": "attitude", "magnetometer": "attitude", "imu": "attitude",
    "gyro": "rates", "rate": "rates", "body_rates": "rates", "angular_velocity": "rates", "lidar": "obstacles",
    "range": "obstacles", "points": "obstacles", "distance": "obstacles", "obstacle": "obstacles",
}  # fmt: skip
_AXES = {
    "roll": "x", "pitch": "y", "yaw": "z", "heading": "z", "p": "x", "q": "y", "r": "z",
    "north": "x", "east": "y", "down": "z", "up": "z", "n": "x", "e": "y", "d": "z",
    "lat": "x", "latitude": "x", "lon": "y", "longitude": "y", "alt": "z", "altitude": "z", "height": "z",
    "vx": "x", "vy": "y", "vz": "z", "forward": "x", "right": "y", "vertical": "z",
}  # fmt: skip
_AMOUNT_ALIASES = "value offset bias size magnitude"


@dataclass(frozen=True, kw_only=True)
class ValueFault(FaultSettings):
    """Settings that all but :class:`SwappedVehicles` share."""

    channel: Annotated[Channel, parameter("what is disturbed", aliases="sensor signal field", values=_CHANNELS)]
    axes: Annotated[Axes, parameter("of the channel", aliases="axis", values=_AXES, min_length=1, max_length=3)] = (
        "x",
        "y",
        "z",
    )
    at_source: Annotated[
        bool,
        parameter(
            "true: the sensor itself is wrong, so that the vehicle flies by it, or all pass on the same of the "
            "payload; false: only its telemetry"
        ),
    ] = False

    def problem(self, system: SystemConfig, vehicles: Vehicles) -> Problem:
        """Refuse single vehicles for the payload's navigation unit, which is one that all vehicles relay."""
        if self.at_source and self.channel.startswith("payload_") and vehicles is not None:
            return "vehicles", "the payload has one navigation unit: leave this out, or set at_source = false"
        return None


@kind("bias", "values", ("offset", "constant_offset", *names(_SENSORS, "bias offset")))
class Bias(ValueFault):
    """A constant is added."""

    amount: Annotated[
        float, parameter("on each of the axes", "channel's", aliases=_AMOUNT_ALIASES, ge=-_Amount, le=_Amount)
    ]


@kind("drift", "values", ("ramp", "random_walk", *names("sensor imu gyro attitude velocity", "drift ramp")))
class Drift(ValueFault):
    """The added amount grows with the time since the start of the fault."""

    rate: Annotated[float, parameter("on each of the axes", "channel's/s", ge=-_Amount, le=_Amount)]


@kind("scale", "values", ("gain", "scaling", *names("scale gain", "factor error"), *names(_SENSORS, "scale gain")))
class Scale(ValueFault):
    """Values are multiplied."""

    factor: Annotated[float, parameter("factor", ge=-1e3, le=1e3)]


@kind(
    "stuck", "values", ("frozen", "stuck_at", *names(_SENSORS, "stuck frozen freeze"), *names("frozen stuck", _SENSORS))
)
class Stuck(ValueFault):
    """Values remain those at the start of the fault; time stamps continue."""


@kind(
    "spikes",
    "values",
    ("spike", "glitch", "glitches", "outlier", "outliers", *names(_SENSORS, "spike spikes outlier outliers")),
)
class Spikes(ValueFault):
    """Single samples are off by an amount, up or down, each axis independently."""

    probability: Annotated[float, parameter("of a sample", ge=0.0, le=1.0)]
    amount: Annotated[float, parameter("size of a spike", "channel's", gt=0.0, le=_Amount)]


@kind("not_a_number", "values", ("nan", "nans", "inf", "infinity", *names(_SENSORS, "nan inf")))
class NotANumber(ValueFault):
    """Values are NaN or infinite. Messages with integer fields, which have no such value, are not sent."""

    value: Annotated[Literal["nan", "inf", "-inf"], parameter("the value")] = "nan"
    probability: Annotated[float, parameter("of a sample", ge=0.0, le=1.0)] = 1.0


@kind("quantisation", "values", ("quantization", "rounding", "resolution", *names(_SENSORS, "quantisation resolution")))
class Quantisation(ValueFault):
    """Values are rounded coarsely."""

    step: Annotated[float, parameter("step between values", "channel's", gt=0.0, le=_Amount)]


@kind("flipped_sign", "values", ("inverted", "reversed", "negated", "sign", "sign_flip", "sign_error"))
class FlippedSign(ValueFault):
    """Values have the opposite sign."""


@kind("swapped_frame", "values", ("enu", "wrong_frame", "frame_swap", "swapped_axes", "axes_swap"))
class SwappedFrame(ValueFault):
    """Values are in another frame: x and y exchanged, z reversed (east-north-up for north-east-down)."""


@kind("noise", "values", ("noisy", *names(f"white gaussian {_SENSORS}", "noise"), *names("noisy", _SENSORS)))
class Noise(ValueFault):
    """White noise is added, so that in all there is a multiple of the system file's; obstacles: on every axis."""

    factor: Annotated[float, parameter("noise with the fault over noise without", ge=1.0, le=1e3)]


@kind("intermittent", "values", ("flaky", "loose_contact", *names("intermittent flaky", _SENSORS)))
class Intermittent(ValueFault):
    """Values are stuck and true alternately, for random times; true first."""

    good: Annotated[float, parameter("mean time of true values", "s", gt=0.0, le=1e4)] = 1.0
    stuck: Annotated[float, parameter("mean time of the last value", "s", gt=0.0, le=1e4)] = 0.5


@kind(
    "swapped_vehicles", "values", ("swapped", *names("swapped", "ids id uavs"), *names("id ids vehicle", "swap mixup"))
)
class SwappedVehicles(FaultSettings):
    """Two vehicles report each other's attitude, rates, position and velocity as their own."""

    other: Annotated[int, parameter("system id of the one that swaps with the one in `vehicles`", ge=1, le=254)]

    def problem(self, system: SystemConfig, vehicles: Vehicles) -> Problem:
        """Refuse another number of vehicles than one, and a partner that is not another vehicle of the team."""
        if vehicles is None or len(vehicles) != 1:
            return "vehicles", "name the one vehicle whose data are swapped with those of `other`"
        if self.other > system.team.vehicles:
            return "other", f"there is no vehicle {self.other}: the team has {system.team.vehicles}"
        return ("other", "is the same vehicle") if self.other == vehicles[0] else None
