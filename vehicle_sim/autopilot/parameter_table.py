"""A vehicle's parameters, as the MAVLink parameter protocol shows them."""

import math
import struct
from dataclasses import dataclass
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config.flight_settings import FailsafeSettings
from gcs.config.vehicle_settings import AutopilotSettings, HoldSettings, VehicleFailsafeSettings
from gcs.mavlink import px4
from idc_controller.settings import METADATA_KEY, Setting
from vehicle_sim.autopilot.airframe import Airframe
from vehicle_sim.world.errors import SimulationError

REAL: int = mavlink.MAV_PARAM_TYPE_REAL32
INTEGER: int = mavlink.MAV_PARAM_TYPE_INT32


class ParameterRefusalError(SimulationError):
    """A parameter that does not exist or may not take the value; ``str`` says why."""


@dataclass
class Parameter:
    """One parameter. ``limits`` None: the ground may read it only."""

    name: str
    value: float
    type: int = REAL
    limits: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        if self.type == REAL:
            self.value = _float32(self.value)  # what is read back is what is used


class ParameterTable:
    """Parameters by name and by index, sorted by name as PX4 does."""

    def __init__(self, parameters: list[Parameter]) -> None:
        self._parameters = sorted(parameters, key=lambda parameter: parameter.name)
        self._by_name = {parameter.name: parameter for parameter in self._parameters}
        self._index = {parameter.name: i for i, parameter in enumerate(self._parameters)}
        if len(self._index) != len(self._parameters) or any(len(name) > 16 for name in self._index):
            raise SimulationError("parameter names must be unique and at most 16 characters long")

    def __len__(self) -> int:
        return len(self._parameters)

    def __getitem__(self, name: str) -> float:
        return self._by_name[name].value

    def by_index(self, index: int) -> Parameter | None:
        """The parameter at an index of the list, None outside."""
        return self._parameters[index] if 0 <= index < len(self._parameters) else None

    def by_name(self, name: str) -> Parameter | None:
        """The parameter of a name, None if there is none."""
        return self._by_name.get(name)

    def index_of(self, name: str) -> int:
        """Position of an existing parameter in the list."""
        return self._index[name]

    def set_from_wire(self, name: str, wire: float, parameter_type: int) -> None:
        """Store what a PARAM_SET carries. Raises :class:`ParameterRefusalError` and then changes nothing."""
        parameter = self.by_name(name)
        if parameter is None:
            raise ParameterRefusalError(f"{name}: no such parameter")
        if parameter.limits is None:
            raise ParameterRefusalError(f"{name}: read-only")
        if parameter_type != parameter.type:
            raise ParameterRefusalError(f"{name}: sent as type {parameter_type}, is of type {parameter.type}")
        value = px4.parameter_from_wire(wire, parameter_type)
        low, high = parameter.limits
        if not low <= value <= high:  # NaN, too
            raise ParameterRefusalError(f"{name}: {value:g} is outside {low:g} .. {high:g}")
        parameter.value = value


def vehicle_parameters(
    airframe: Airframe, system_id: int, onboard_rate: int, settings: AutopilotSettings = AutopilotSettings()
) -> ParameterTable:
    """The parameters of one vehicle with their defaults; ``onboard_rate`` of the attitude loop in Hz."""
    failsafe = settings.failsafe
    return ParameterTable(
        [
            Parameter(px4.PARAM_THRUST_MAX, airframe.rotors.thrust_max),
            Parameter(px4.PARAM_MASS, airframe.mass),
            Parameter(px4.PARAM_ATTITUDE_KP, airframe.attitude_kp),
            Parameter(px4.PARAM_ATTITUDE_KD, airframe.attitude_kd),
            Parameter(px4.PARAM_MOTOR_LAG, airframe.motor_time_constant),
            Parameter(px4.PARAM_ONBOARD_RATE, onboard_rate, INTEGER),
            Parameter(px4.PARAM_SYSTEM_ID, system_id, INTEGER),
            Parameter("MAV_TYPE", mavlink.MAV_TYPE_QUADROTOR, INTEGER),
            Parameter("SYS_AUTOSTART", 4001, INTEGER),
            Parameter("SYS_AUTOCONFIG", 0, INTEGER),
            Parameter("CAL_GYRO0_ID", 1, INTEGER),
            Parameter("CAL_ACC0_ID", 1, INTEGER),
            Parameter("CAL_MAG0_ID", 1, INTEGER),
            _settable(px4.PARAM_SETPOINT_LOSS, failsafe.setpoint_loss, FailsafeSettings, "telemetry_timeout"),
            _settable(px4.PARAM_LAND_DELAY, failsafe.land_delay, VehicleFailsafeSettings, "land_delay"),
            _settable(px4.PARAM_LINK_LOSS, failsafe.link_loss, VehicleFailsafeSettings, "link_loss", INTEGER),
            _settable(px4.PARAM_LAND_SPEED, settings.hold.land_speed, HoldSettings, "land_speed"),
            _settable(px4.PARAM_TAKEOFF_ALTITUDE, settings.takeoff_altitude, AutopilotSettings, "takeoff_altitude"),
        ]
    )


def _settable(name: str, value: float, settings: type[Any], key: str, kind: int = REAL) -> Parameter:
    """Return a parameter that the ground may set within the bounds that the setting ``key`` is declared with."""
    declared: Setting = settings.__dataclass_fields__[key].metadata[METADATA_KEY]
    assert declared.ge is not None and declared.le is not None
    return Parameter(name, value, kind, (declared.ge, declared.le))


def _float32(value: float) -> float:
    number: float = struct.unpack("<f", struct.pack("<f", value))[0]
    if not math.isfinite(number):
        raise SimulationError(f"{value} cannot be a parameter")
    return number
