"""The parameters of a vehicle, with their defaults and limits."""

from typing import Any

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config.flight_settings import FailsafeSettings
from gcs.config.vehicle_settings import AutopilotSettings, HoldSettings, VehicleFailsafeSettings
from gcs.mavlink import px4
from gcs.mavlink.services.parameter_table import INTEGER, REAL, Parameter, ParameterTable
from idc_controller.settings import METADATA_KEY, Setting
from vehicle_sim.autopilot.airframe import Airframe
from vehicle_sim.autopilot.free.parameters import free_parameters

_HOLD_ACTION = 5
"""Of COM_OBL_RC_ACT."""
_NO_STICKS = 4
"""Of COM_RC_IN_MODE."""


def vehicle_parameters(
    airframe: Airframe,
    system_id: int,
    onboard_rate: int,
    settings: AutopilotSettings = AutopilotSettings(),
    *,
    free: bool = False,
) -> ParameterTable:
    """The parameters of one vehicle with their defaults; ``onboard_rate`` of the attitude loop in Hz.

    ``free``: it has no payload.
    """
    parameters = [
        *_properties(airframe, system_id, onboard_rate),
        *_failsafes(settings),
        _settable(
            px4.PARAM_TAKEOFF_ALTITUDE, settings.takeoff_altitude, AutopilotSettings, "takeoff_altitude",
            meaning="height of a take-off (m); on a payload the team's ground takes off",
        ),
    ]  # fmt: skip
    own = free_parameters(airframe) if free else []
    replaced = {parameter.name for parameter in own}
    return ParameterTable([*(parameter for parameter in parameters if parameter.name not in replaced), *own])


def _properties(airframe: Airframe, system_id: int, onboard_rate: int) -> list[Parameter]:
    """Return what can only be read."""
    calibrated = "a calibrated sensor"
    return [
        Parameter(px4.PARAM_THRUST_MAX, airframe.rotors.thrust_max, meaning="force of thrust 1 (N)"),
        Parameter(px4.PARAM_MASS, airframe.mass, meaning="mass of the vehicle (kg)"),
        Parameter(px4.PARAM_ATTITUDE_KP, airframe.attitude_kp, meaning="attitude gain (1/s2)"),
        Parameter(px4.PARAM_ATTITUDE_KD, airframe.attitude_kd, meaning="rate gain (1/s)"),
        Parameter(px4.PARAM_MOTOR_LAG, airframe.motor_time_constant, meaning="time constant of the motors (s)"),
        Parameter(px4.PARAM_ONBOARD_RATE, onboard_rate, INTEGER, meaning="rate of the onboard loop (Hz)"),
        Parameter(px4.PARAM_SYSTEM_ID, system_id, INTEGER, meaning="system id"),
        Parameter("MAV_TYPE", mavlink.MAV_TYPE_QUADROTOR, INTEGER, meaning="MAV_TYPE_QUADROTOR"),
        Parameter("SYS_AUTOSTART", 4001, INTEGER, meaning="PX4's generic quadrotor"),
        Parameter("SYS_AUTOCONFIG", 0, INTEGER, meaning="nothing is to be configured"),
        Parameter("CAL_GYRO0_ID", 1, INTEGER, meaning=calibrated),
        Parameter("CAL_ACC0_ID", 1, INTEGER, meaning=calibrated),
        Parameter("CAL_MAG0_ID", 1, INTEGER, meaning=calibrated),
    ]


def _failsafes(settings: AutopilotSettings) -> list[Parameter]:
    """Return what the ground may set of failsafes and descents, and the actions of PX4 that are taken."""
    failsafe, link = settings.failsafe, VehicleFailsafeSettings
    link_actions = (px4.LINK_LOSS_NOTHING, px4.LINK_LOSS_LAND)
    return [
        _settable(
            px4.PARAM_SETPOINT_LOSS, failsafe.setpoint_loss, FailsafeSettings, "telemetry_timeout",
            meaning="without set-points in OFFBOARD until it brakes (s)",
        ),
        _settable(
            px4.PARAM_LAND_DELAY, failsafe.land_delay, link, "land_delay", meaning="from that hold to the descent (s)"
        ),
        _settable(
            px4.PARAM_LINK_LOSS, failsafe.link_loss, link, "link_loss", INTEGER,
            meaning="without any ground until a holding vehicle does NAV_DLL_ACT (s)",
        ),
        Parameter(
            px4.PARAM_LINK_LOSS_ACTION, px4.LINK_LOSS_LAND, INTEGER, (min(link_actions), max(link_actions)),
            "without any ground, in HOLD: 0 nothing, 3 land", link_actions,
        ),
        Parameter(
            "COM_OBL_RC_ACT", _HOLD_ACTION, INTEGER, (_HOLD_ACTION, _HOLD_ACTION),
            "without set-points in OFFBOARD: 5, hold",
        ),
        Parameter("COM_RCL_EXCEPT", 0, INTEGER, (0, 31), "modes without failsafe of a lost remote: there is none"),
        Parameter("NAV_RCL_ACT", 0, INTEGER, (0, 6), "action of a lost remote: there is none"),
        Parameter("COM_RC_IN_MODE", _NO_STICKS, INTEGER, (_NO_STICKS, _NO_STICKS), "4: sticks are not read"),
        _settable(
            px4.PARAM_LAND_SPEED, settings.hold.land_speed, HoldSettings, "land_speed",
            meaning="speed of the descent (m/s)",
        ),
    ]  # fmt: skip


def _settable(name: str, value: float, settings: type[Any], key: str, kind: int = REAL, *, meaning: str) -> Parameter:
    """Return a parameter that the ground may set within the bounds that the setting ``key`` is declared with."""
    declared: Setting = settings.__dataclass_fields__[key].metadata[METADATA_KEY]
    assert declared.ge is not None and declared.le is not None
    return Parameter(name, value, kind, (declared.ge, declared.le), meaning)
