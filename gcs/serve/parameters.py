"""Parameters of the team: what a ground station may change between flights and in flight, within ranges."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config import SystemConfig
from gcs.config.overrides import with_settings
from gcs.errors import UnusableInput
from gcs.mavlink import px4
from gcs.mavlink.services.parameter_table import INTEGER, REAL, Parameter, ParameterRefusalError, ParameterTable

CRUISE_SPEED = "MPC_XY_CRUISE"
"""PX4's name of the speed where a mission names none."""


class _Setting(NamedTuple):
    """A setting of the system file, the range of its parameter, and what it does."""

    path: str
    low: float
    high: float
    meaning: str


SETTINGS: Mapping[str, _Setting] = {
    "CLFT_MARGIN": _Setting("avoidance.margin", 0.2, 2.0, "clearance to keep from obstacles (m), at once"),
    "CLFT_TILT_MAX": _Setting(
        "guidance.navigator.link_tilt", 0.05, 0.4, "link tilt for which a detour leaves clearance (rad), at once"
    ),
    CRUISE_SPEED: _Setting("motion.speed", 0.1, 3.0, "speed where a mission names none (m/s), at once"),
    "MPC_ACC_HOR": _Setting("motion.acceleration", 0.1, 2.0, "acceleration between waypoints (m/s2), of the next legs"),
    "MPC_Z_V_AUTO_UP": _Setting("motion.climb_speed", 0.2, 2.0, "speed of climb and descent (m/s), of the next"),
    px4.PARAM_LAND_SPEED: _Setting("motion.landing_speed", 0.1, 0.5, "speed at touch-down (m/s), of the next landing"),
}
"""By the name of a parameter."""
TAKEOFF_ALTITUDE = 3.0
"""m; default of MIS_TAKEOFF_ALT."""


class TeamParameters(ParameterTable):
    """The parameters, with the system file's values first; what they change is handed over as a system."""

    def __init__(self, config: SystemConfig, system_id: int) -> None:
        settable = []
        for name, (path, low, high, meaning) in SETTINGS.items():
            value = _value(config, path)
            limits = min(low, value), max(high, value)
            settable.append(Parameter(name, value, REAL, limits, meaning))
        settable.append(
            Parameter(
                px4.PARAM_TAKEOFF_ALTITUDE, TAKEOFF_ALTITUDE, REAL, (1.0, 120.0), "height of a take-off above home (m)"
            )
        )
        super().__init__([*settable, *_read_only(system_id)])
        self._config, self._set = config, dict[str, float]()
        self.on_change: Callable[[SystemConfig], None] = lambda config: None
        """Called with the system that the parameters ask for, when they ask for another."""

    def set_from_wire(self, name: str, wire: float, parameter_type: int) -> None:
        """See :meth:`.ParameterTable.set_from_wire`; values that do not agree with the others are refused, too."""
        parameter = self.by_name(name)
        before = None if parameter is None else parameter.value
        super().set_from_wire(name, wire, parameter_type)
        try:
            self._apply()
        except UnusableInput as error:
            assert parameter is not None and before is not None
            parameter.value = before
            reason = str(error).splitlines()[0].partition(": ")[2]
            raise ParameterRefusalError(f"{name}: {reason}", mavlink.MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE) from None

    def restore(self) -> None:
        """See :meth:`.ParameterTable.restore`."""
        super().restore()
        self._apply()

    def reset(self) -> None:
        """See :meth:`.ParameterTable.reset`."""
        super().reset()
        self._apply()

    def _apply(self) -> None:
        changed = {name: parameter for name in SETTINGS if (parameter := self.by_name(name)) is not None}
        # A value in single precision as it was typed: its rounding is not the setting.
        wanted = {
            SETTINGS[name].path: float(f"{parameter.value:.7g}")
            for name, parameter in changed.items()
            if parameter.value != parameter.default
        }
        if wanted != self._set:
            config = with_settings(self._config, wanted)
            self._set = wanted
            self.on_change(config)


def _read_only(system_id: int) -> list[Parameter]:
    return [
        Parameter(px4.PARAM_SYSTEM_ID, system_id, INTEGER, meaning="system id"),
        Parameter("MAV_TYPE", mavlink.MAV_TYPE_QUADROTOR, INTEGER, meaning="MAV_TYPE_QUADROTOR"),
        Parameter("SYS_AUTOSTART", 4001, INTEGER, meaning="PX4's generic quadrotor"),
        Parameter("SYS_AUTOCONFIG", 0, INTEGER, meaning="nothing is to be configured"),
        Parameter("CAL_GYRO0_ID", 1, INTEGER, meaning="a calibrated sensor"),
        Parameter("CAL_ACC0_ID", 1, INTEGER, meaning="a calibrated sensor"),
        Parameter("CAL_MAG0_ID", 1, INTEGER, meaning="a calibrated sensor"),
    ]


def _value(config: SystemConfig, path: str) -> float:
    value: Any = config
    for name in path.split("."):
        value = getattr(value, name)
    return float(value)
