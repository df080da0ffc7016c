"""Parameters of the team: what a ground station may change between flights and in flight, within ranges."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config import SystemConfig
from gcs.mavlink import px4
from gcs.mavlink.services.parameter_table import INTEGER, REAL, Parameter, ParameterTable

CRUISE_SPEED = "MPC_XY_CRUISE"
"""PX4's name of the speed where a mission names none."""
SETTINGS: Mapping[str, tuple[str, float, float, str]] = {
    "CLFT_MARGIN": ("avoidance.margin", 0.2, 2.0, "least clearance from obstacles that is planned for (m)"),
    "CLFT_TILT_MAX": (
        "guidance.navigator.link_tilt",
        0.05,
        0.4,
        "tilt of the links that detours are planned for (rad)",
    ),
    CRUISE_SPEED: ("motion.speed", 0.1, 3.0, "speed where a mission names none (m/s)"),
    "MPC_ACC_HOR": ("motion.acceleration", 0.1, 2.0, "acceleration between waypoints (m/s2)"),
    "MPC_Z_V_AUTO_UP": ("motion.climb_speed", 0.2, 2.0, "speed of climb and descent (m/s)"),
    px4.PARAM_LAND_SPEED: ("motion.landing_speed", 0.1, 0.5, "speed at touch-down (m/s)"),
}
"""By the name of a parameter: the setting of the system file, its range, and what it does."""
TAKEOFF_ALTITUDE = 3.0
"""m; default of MIS_TAKEOFF_ALT."""


def team_parameters(config: SystemConfig, system_id: int) -> ParameterTable:
    """Return the parameters, with the system file's values."""
    settable = [
        Parameter(name, _value(config, path), REAL, (low, max(high, _value(config, path))), meaning)
        for name, (path, low, high, meaning) in SETTINGS.items()
    ]
    return ParameterTable(
        [
            *settable,
            Parameter(
                px4.PARAM_TAKEOFF_ALTITUDE, TAKEOFF_ALTITUDE, REAL, (1.0, 120.0), "height of a take-off above home (m)"
            ),
            Parameter(px4.PARAM_SYSTEM_ID, system_id, INTEGER, meaning="system id"),
            Parameter("MAV_TYPE", mavlink.MAV_TYPE_QUADROTOR, INTEGER, meaning="MAV_TYPE_QUADROTOR"),
            Parameter("SYS_AUTOSTART", 4001, INTEGER, meaning="PX4's generic quadrotor"),
            Parameter("SYS_AUTOCONFIG", 0, INTEGER, meaning="nothing is to be configured"),
            Parameter("CAL_GYRO0_ID", 1, INTEGER, meaning="a calibrated sensor"),
            Parameter("CAL_ACC0_ID", 1, INTEGER, meaning="a calibrated sensor"),
            Parameter("CAL_MAG0_ID", 1, INTEGER, meaning="a calibrated sensor"),
        ]
    )


def settings_of(parameters: ParameterTable) -> dict[str, float]:
    """Return the settings, by dotted path, that the parameters ask for."""
    return {path: parameters[name] for name, (path, *_) in SETTINGS.items()}


def _value(config: SystemConfig, path: str) -> float:
    value: Any = config
    for name in path.split("."):
        value = getattr(value, name)
    return float(value)
