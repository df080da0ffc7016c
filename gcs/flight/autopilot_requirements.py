"""What an autopilot must offer to carry a payload with others: one table, for preflight and for ``docs/autopilots.md``.

No requirement depends on which program a vehicle runs: what it has sent counts.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config.flight_settings import FailsafeSettings
from gcs.config.vehicle_settings import VehicleFailsafeSettings
from gcs.mavlink import px4
from gcs.mavlink.requests import WantedParameter
from gcs.mavlink.vehicle_link import VehicleLink
from idc_controller.settings import METADATA_KEY, Setting


class Requirement(NamedTuple):
    """Something that an autopilot must offer."""

    what: str
    """The message or parameter."""
    purpose: str
    is_offered: Callable[[VehicleLink, float], bool]
    """Whether it has come, and telemetry since a time (s, ground)."""
    at_control_rate: bool = False
    """Whether it must come at least as often as set-points are sent (``rates.control``)."""
    at_connect: bool = True
    """Whether the team is not connected without it; what takes several round trips is wanted before arming."""


_POSITIVE = Setting("", "", gt=0.0)


def _settable(purpose: str, settings: type[Any], key: str) -> WantedParameter:
    """Return a parameter that may be set within the bounds that the setting ``key`` is declared with."""
    return WantedParameter(purpose, settings.__dataclass_fields__[key].metadata[METADATA_KEY], is_settable=True)


PARAMETERS = {
    px4.PARAM_THRUST_MAX: WantedParameter("force of thrust 1 (N); thrust must be linear in force", _POSITIVE),
    px4.PARAM_ATTITUDE_KP: WantedParameter("attitude gain (1/s2), for the model", _POSITIVE),
    px4.PARAM_ATTITUDE_KD: WantedParameter("rate gain (1/s), for the model", _POSITIVE),
    px4.PARAM_MOTOR_LAG: WantedParameter("time constant of the motors (s), for the model", _POSITIVE),
    px4.PARAM_ONBOARD_RATE: WantedParameter("rate of the onboard loop (Hz): when a set-point takes effect", _POSITIVE),
    px4.PARAM_SETPOINT_LOSS: _settable(
        "time without set-points after which the vehicle holds by its stop plan (s)",
        FailsafeSettings,
        "telemetry_timeout",
    ),
    px4.PARAM_LAND_DELAY: _settable("time from that hold to the descent (s)", VehicleFailsafeSettings, "land_delay"),
}
"""Parameters that it must have, what for, and which values are taken: one owner for preflight and for flight."""


def _has_sent(parameter: str) -> Callable[[VehicleLink, float], bool]:
    return lambda link, since: parameter in link.status.parameters


REQUIREMENTS = (
    Requirement(
        "HEARTBEAT of MAV_AUTOPILOT_PX4",
        "arming state and PX4's modes; OFFBOARD, AUTO.LOITER and AUTO.LAND are commanded",
        lambda link, since: link.status.autopilot == mavlink.MAV_AUTOPILOT_PX4,
    ),
    Requirement(
        "ATTITUDE_QUATERNION",
        "attitude and body rates of the UAV, for the estimator",
        lambda link, since: link.attitude_received_at >= since,
        at_control_rate=True,
    ),
    Requirement(
        "LOCAL_POSITION_NED",
        "position and velocity of the UAV, for the estimator; one origin for the whole team",
        lambda link, since: link.position_received_at >= since,
        at_control_rate=True,
    ),
    Requirement(
        "ATTITUDE_QUATERNION and LOCAL_POSITION_NED of the payload unit",
        f"motion of the payload, from which and from the UAVs' positions the directions of the links follow; relayed "
        f"from system {px4.PAYLOAD_UNIT_SYSTEM}, component {px4.PAYLOAD_UNIT_COMPONENT}",
        lambda link, since: link.payload_received_at >= since,
        at_control_rate=True,
    ),
    Requirement(
        "EXTENDED_SYS_STATE",
        "landed state, by which touchdown is confirmed",
        lambda link, since: link.status.landed_state != mavlink.MAV_LANDED_STATE_UNDEFINED,
    ),
    Requirement(
        "SYS_STATUS with MAV_SYS_STATUS_PREARM_CHECK",
        "whether the vehicle is ready to be armed",
        lambda link, since: link.status.prearm_ok is not None,
    ),
    Requirement(
        "TIMESYNC answers",
        "clock and latency of the link",
        lambda link, since: math.isfinite(link.clock.round_trip_max),
        at_connect=False,
    ),
    *(Requirement(name, wanted.purpose, _has_sent(name)) for name, wanted in PARAMETERS.items()),
)
"""Evaluated in this order."""

USED_IF_OFFERED = (
    ("SET_ATTITUDE_TARGET, taken at `rates.control`", "the set-points: attitude and thrust"),
    ("TUNNEL with stop plans (`gcs/mavlink/stop_plan.py`), taken", "what is flown when set-points are lost"),
    ("ATTITUDE_TARGET", "which set-point is in force: without it the estimator assumes that all arrive"),
    ("OBSTACLE_DISTANCE_3D and OBSTACLE_DISTANCE", "returns of the range sensor: without them only the map is avoided"),
    ("VIBRATION", "clipping of the accelerometer, a sign of an impact"),
    ("STATUSTEXT", "reasons in messages to the operator"),
)
"""Not checked: what an autopilot takes cannot be seen before it flies, and flights go on without the rest."""


def missing(link: VehicleLink, since: float, at_connect: bool) -> list[str]:
    """Return all that a vehicle lacks; telemetry counts if it came at ``since`` (s, ground) or later.

    ``at_connect``: of what is wanted then, else of all.
    """
    wanted = (row for row in REQUIREMENTS if row.at_connect or not at_connect)
    return [row.what for row in wanted if not row.is_offered(link, since)]
