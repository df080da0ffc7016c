"""The parameters of a vehicle, with their defaults and limits."""

from typing import Any

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config.flight_settings import FailsafeSettings
from gcs.config.vehicle_settings import AutopilotSettings, HoldSettings, VehicleFailsafeSettings
from gcs.mavlink import px4
from gcs.mavlink.services.parameter_table import INTEGER, REAL, Parameter, ParameterTable
from idc_controller.settings import METADATA_KEY, Setting
from vehicle_sim.autopilot.airframe import Airframe


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
