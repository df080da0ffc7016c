"""The system file: payload, UAVs, team, sensors, rates, motion limits, world and controller.

Every key is required and every unknown key refused, so that the file tells the whole configuration. To add a key, add
a field here and a line to ``missions/system.toml``; the default is that file itself, packaged (``system.toml`` beside
this module is a link to it).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field, TypeAdapter

from gcs.config.problems import UnusableFile
from gcs.config.toml_file import TomlFile, read_toml, strict
from gcs.errors import UnusableInput
from idc_controller.errors import ParameterError
from idc_controller.parameters import SystemParameters, polygon_attachments

Positive = Annotated[float, Field(gt=0.0)]
NotNegative = Annotated[float, Field(ge=0.0)]
Count = Annotated[int, Field(gt=0, le=1_000_000)]
Vector = tuple[float, float, float]
PositiveVector = tuple[Positive, Positive, Positive]
Weights = tuple[NotNegative, NotNegative, NotNegative]
Angle = Annotated[float, Field(gt=0.0, lt=90.0)]


@strict
@dataclass(frozen=True)
class PayloadConfig:
    """Mass (kg), principal inertias (kg m2) and edge lengths (m) of the payload, in its frame."""

    mass: Positive
    inertia: PositiveVector
    size: PositiveVector


@strict
@dataclass(frozen=True)
class UavConfig:
    """One UAV; all are alike. Lengths in m, thrust in N for the four rotors together."""

    mass: Positive
    inertia: PositiveVector
    disc_radius: Positive
    arm_length: Positive
    thrust_max: Positive
    motor_time_constant: Positive
    torque_to_thrust: Positive
    rotor_speed_max: Positive
    attitude_kp: Positive
    attitude_kd: Positive


@strict
@dataclass(frozen=True)
class TeamConfig:
    """How many UAVs, and where their links are attached to the payload (m)."""

    vehicles: Annotated[int, Field(ge=3, le=254)]
    spacing: Positive
    link_length: Positive
    attachments: tuple[Vector, ...] | None = None


@strict
@dataclass(frozen=True)
class SensorsConfig:
    """Standard deviations of the white noise on every axis; 0 switches a channel's noise off."""

    position: NotNegative
    attitude_deg: NotNegative
    uav_velocity: NotNegative
    uav_rates: NotNegative
    payload_velocity: NotNegative
    payload_rates: NotNegative


@strict
@dataclass(frozen=True)
class RangeSensorConfig:
    """The obstacle sensor of every vehicle: how far it sees (m), how often (Hz), noise along the line of sight (m)."""

    range: Positive
    rate: Count
    noise: NotNegative


@strict
@dataclass(frozen=True)
class RatesConfig:
    """How often things happen (Hz)."""

    physics: Annotated[int, Field(ge=500, le=100_000)]
    onboard: Count
    telemetry: Count
    control: Count


@strict
@dataclass(frozen=True)
class MotionConfig:
    """What the payload's trajectories keep to (m and s)."""

    speed: Positive
    speed_max: Positive
    acceleration: Positive
    jerk: Positive
    snap: Positive
    climb_speed: Positive
    landing_speed: Positive
    curve_speed: Positive
    curve_acceleration: Positive
    curve_jerk: Positive
    curve_snap: Positive


@strict
@dataclass(frozen=True)
class WorldConfig:
    """How the simulated world differs from what the ground believes."""

    payload_mass_factor: Positive


@strict
@dataclass(frozen=True)
class WeightsConfig:
    """Diagonals of the controller's cost: per axis where three are given. See ``MpcWeights``."""

    position: Weights
    velocity: Weights
    attitude: Weights
    rates: Weights
    link_tilt: NotNegative
    link_rate: NotNegative
    differential_link_tilt: NotNegative
    differential_link_rate: NotNegative
    uav_tilt: NotNegative
    uav_tilt_rate: NotNegative
    thrust: NotNegative
    tilt_setpoint: Positive
    thrust_setpoint: Positive


@dataclass(frozen=True)
class ControllerConfig:
    """The model predictive controller."""

    horizon: Annotated[int, Field(ge=2, le=200)]
    payload_tilt_limit_deg: Angle
    uav_tilt_limit_deg: Angle
    weights: WeightsConfig


@strict
@dataclass(frozen=True)
class AvoidanceConfig:
    """The safety filter: room to keep between hull and obstacles (m), rates of the exponential barrier (1/s)."""

    margin: Positive
    barrier_rates: tuple[Positive, ...]


@strict
@dataclass(frozen=True)
class SystemConfig:
    """A whole system file. SI units; see ``missions/system.toml`` for each key's meaning."""

    payload: PayloadConfig
    uav: UavConfig
    team: TeamConfig
    sensors: SensorsConfig
    range_sensor: RangeSensorConfig
    rates: RatesConfig
    motion: MotionConfig
    world: WorldConfig
    controller: ControllerConfig
    avoidance: AvoidanceConfig

    def parameters(self) -> SystemParameters:
        """The system as the controller believes it to be.

        Raises :class:`idc_controller.errors.ParameterError` when it could not fly; :func:`read_system` has seen to it.
        """
        n = self.team.vehicles
        if self.team.attachments is not None:
            p = np.array(self.team.attachments)
        else:
            p = polygon_attachments(n, self.team.spacing, -self.payload.size[2] / 2.0)
        return SystemParameters(
            m_0=self.payload.mass,
            J_0=np.diag(self.payload.inertia),
            payload_size=np.array(self.payload.size),
            m=np.full(n, self.uav.mass),
            J=np.tile(np.diag(self.uav.inertia), (n, 1, 1)),
            p=p,
            l=np.full(n, self.team.link_length),
            disc_radius=self.uav.disc_radius,
            thrust_max=self.uav.thrust_max,
            motor_time_constant=self.uav.motor_time_constant,
            attitude_kp=self.uav.attitude_kp,
            attitude_kd=self.uav.attitude_kd,
        )

    def true_parameters(self) -> SystemParameters:
        """The system as the simulated world makes it: the payload's mass by ``world.payload_mass_factor``."""
        return self.parameters().with_payload_mass(self.payload.mass * self.world.payload_mass_factor)

    def with_vehicles(self, vehicles: int) -> SystemConfig:
        """The same system with another number of vehicles, on a polygon of the same spacing.

        Raises :class:`UnusableInput` when the attachments are given one by one, or when it could not fly.
        """
        if vehicles == self.team.vehicles:
            return self
        if self.team.attachments is not None:
            raise UnusableInput(
                f"{vehicles} vehicles: team.attachments of the system file is for {self.team.vehicles} of them"
            )
        changed = replace(self, team=replace(self.team, vehicles=vehicles))
        try:
            changed.true_parameters()
        except ParameterError as error:
            raise UnusableInput(f"{vehicles} vehicles: {error}") from error
        return changed


@cache
def _adapter() -> TypeAdapter[SystemConfig]:
    return TypeAdapter(SystemConfig)


def default_system_path() -> Path:
    """The packaged system file, for missions that name none and have none beside them."""
    return Path(__file__).with_name("system.toml")


def read_system(path: Path | None = None) -> SystemConfig:
    """Read a system file; the packaged default when none is named.

    Raises :class:`UnusableFile` with file, line, table.key and reason: syntax, unknown or missing keys, values
    without a meaning, values that do not agree, a team that could not hover.
    """
    file = read_toml(default_system_path() if path is None else path)
    config = file.validated(_adapter())
    if problems := _disagreements(config, file):
        raise UnusableFile(problems)
    for key, parameters in (("team",), config.parameters), (("world", "payload_mass_factor"), config.true_parameters):
        try:
            parameters()
        except ParameterError as error:
            raise UnusableFile([file.problem(key, str(error))]) from error
    return config


def _disagreements(config: SystemConfig, file: TomlFile) -> list[str]:
    problems = []
    rates, team, motion = config.rates, config.team, config.motion
    for name in ("onboard", "telemetry", "control"):
        if rates.physics % getattr(rates, name):
            problems.append(
                file.problem(("rates", name), f"{getattr(rates, name)} Hz does not divide physics, {rates.physics} Hz")
            )
    if rates.physics % config.range_sensor.rate:
        reason = f"{config.range_sensor.rate} Hz does not divide physics, {rates.physics} Hz"
        problems.append(file.problem(("range_sensor", "rate"), reason))
    if config.range_sensor.rate > rates.telemetry:
        reason = f"{config.range_sensor.rate} Hz is faster than telemetry, {rates.telemetry} Hz"
        problems.append(file.problem(("range_sensor", "rate"), reason))
    if rates.control > rates.telemetry:
        problems.append(
            file.problem(("rates", "control"), f"{rates.control} Hz is faster than telemetry, {rates.telemetry} Hz")
        )
    if team.attachments is not None and len(team.attachments) != team.vehicles:
        problems.append(
            file.problem(("team", "attachments"), f"{len(team.attachments)} points for {team.vehicles} vehicles")
        )
    if motion.speed > motion.speed_max:
        problems.append(file.problem(("motion", "speed"), f"{motion.speed} is more than speed_max, {motion.speed_max}"))
    return problems
