"""The system file: every setting by table, read strictly from TOML into frozen dataclasses.

A file may be partial: a table or key that it omits has its default. The default system is ``SystemConfig()``;
``missions/system.toml`` shows the main tables of it, ``docs/settings.md`` lists all. A sub-package declares its
settings in its ``settings.py``; they are one field of :class:`SystemConfig`.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from gcs.config.flight_settings import DriverSettings, FlightSettings
from gcs.config.schema import table_of, table_validator
from gcs.config.tables import (
    DEFAULT_CARGO,
    PAYLOAD_MASS_MIN,
    Cargo,
    MotionConfig,
    PayloadConfig,
    RangeSensorConfig,
    RatesConfig,
    SensorsConfig,
    TeamConfig,
    UavConfig,
    WorldConfig,
)
from gcs.config.toml_file import ParsedFile, read_toml
from gcs.config.validate import Key, UnusableFile
from gcs.config.vehicle_settings import AutopilotSettings, VehicleLinkSettings
from gcs.errors import UnusableInput
from gcs.mavlink.settings import MavlinkSettings
from idc_controller.arrays import Array
from idc_controller.control.settings import ControllerSettings, GroundControlSettings, MpcSettings, MpcTuning
from idc_controller.errors import ParameterError
from idc_controller.estimation.settings import (
    EstimatorSettings,
    InnovationMonitorSettings,
    LiftOffSettings,
    WindSettings,
)
from idc_controller.guidance.settings import (
    DetourSettings,
    NavigatorSettings,
    ProgressSettings,
    RestingPlaceSettings,
    SightSettings,
)
from idc_controller.parameters import SystemParameters, polygon_attachments
from idc_controller.perception.settings import PerceptionSettings
from idc_controller.safety.settings import FilterSettings, PlannerSettings
from idc_controller.settings import SettingsTable, setting
from idc_controller.trajectory.settings import AvoidanceSettings, BrakingSettings

_OTHER_FILES = {
    "mission": "this is a mission, no system file: gcs fly flies it",
    "campaign": "this is a campaign, no system file: gcs faults flies it",
}


@dataclass(frozen=True, eq=False, repr=False)
class EstimationConfig(SettingsTable):
    """Estimator, wind estimate, the monitor of its innovations, and lift-off."""

    estimator: EstimatorSettings = field(default_factory=EstimatorSettings)
    wind: WindSettings = field(default_factory=WindSettings)
    innovation_monitor: InnovationMonitorSettings = field(default_factory=InnovationMonitorSettings)
    lift_off: LiftOffSettings = field(default_factory=LiftOffSettings)


@dataclass(frozen=True, eq=False, repr=False)
class GuidanceConfig(SettingsTable):
    """Progress along the mission, speed by sight, detours, and the stop of a team without set-points."""

    progress: ProgressSettings = field(default_factory=ProgressSettings)
    navigator: NavigatorSettings = field(default_factory=NavigatorSettings)
    detour: DetourSettings = field(default_factory=DetourSettings)
    sight: SightSettings = field(default_factory=SightSettings)
    resting_place: RestingPlaceSettings = field(default_factory=RestingPlaceSettings)
    braking: BrakingSettings = field(default_factory=BrakingSettings)


@dataclass(frozen=True, eq=False, repr=False)
class SafetyConfig(SettingsTable):
    """The planner of the safety filter, and when it acts."""

    planner: PlannerSettings = field(default_factory=PlannerSettings)
    filter: FilterSettings = field(default_factory=FilterSettings)


@dataclass(frozen=True, eq=False, repr=False)
class ControlConfig(SettingsTable):
    """The controller beside table ``controller``: adaptation to the load, model predictive control, on the ground."""

    controller: ControllerSettings = field(default_factory=ControllerSettings)
    mpc: MpcSettings = field(default_factory=MpcSettings)
    ground: GroundControlSettings = field(default_factory=GroundControlSettings)


@dataclass(frozen=True)
class SystemConfig:
    """A whole system file, SI units. Each field is a table, or an array of tables."""

    payload: PayloadConfig = field(default_factory=PayloadConfig)
    cargo: tuple[Cargo, ...] = setting(DEFAULT_CARGO, "", "what the payload's grippers hold or can grab")
    uav: UavConfig = field(default_factory=UavConfig)
    team: TeamConfig = field(default_factory=TeamConfig)
    sensors: SensorsConfig = field(default_factory=SensorsConfig)
    range_sensor: RangeSensorConfig = field(default_factory=RangeSensorConfig)
    rates: RatesConfig = field(default_factory=RatesConfig)
    motion: MotionConfig = field(default_factory=MotionConfig)
    world: WorldConfig = field(default_factory=WorldConfig)
    controller: MpcTuning = field(default_factory=MpcTuning)
    avoidance: AvoidanceSettings = field(default_factory=AvoidanceSettings)
    flight: FlightSettings = field(default_factory=FlightSettings)
    mavlink: MavlinkSettings = field(default_factory=MavlinkSettings)
    drivers: DriverSettings = field(default_factory=DriverSettings)
    estimation: EstimationConfig = field(default_factory=EstimationConfig)
    perception: PerceptionSettings = field(default_factory=PerceptionSettings)
    guidance: GuidanceConfig = field(default_factory=GuidanceConfig)
    safety: SafetyConfig = field(default_factory=SafetyConfig)
    control: ControlConfig = field(default_factory=ControlConfig)
    autopilot: AutopilotSettings = field(default_factory=AutopilotSettings)
    vehicle_link: VehicleLinkSettings = field(default_factory=VehicleLinkSettings)

    def parameters(self) -> SystemParameters:
        """Return the system as the controller models it.

        Raises :class:`idc_controller.errors.ParameterError` when it could not fly; :func:`read_system` has checked it.
        """
        n = self.team.vehicles
        return SystemParameters(
            m_0=self.payload.mass,
            J_0=self.payload.inertia_tensor,
            payload=self.payload.hull,
            m=np.full(n, self.uav.mass),
            J=np.tile(np.diag(self.uav.inertia), (n, 1, 1)),
            p=self.attachment_points(),
            l=np.full(n, self.team.link_length),
            disc_radius=self.uav.disc_radius,
            thrust_max=self.uav.thrust_max,
            motor_time_constant=self.uav.motor_time_constant,
            attitude_kp=self.uav.attitude_kp,
            attitude_kd=self.uav.attitude_kd,
        )

    @property
    def resting_altitude(self) -> float:
        """Height of the payload's centre of mass above home when it is on the pad (m); nothing is flown below."""
        return self.world.pad.thickness + self.payload.hull.below

    def attachment_points(self) -> Array:
        """Return the attachment points about the payload's centre of mass (N, 3) (m)."""
        if self.team.attachments is not None:
            return np.reshape(self.team.attachments, (-1, 3)) - self.payload.centre_of_mass
        return polygon_attachments(self.team.vehicles, self.team.spacing, -self.payload.hull.above)

    def attachment_problems(self) -> list[str]:
        """Return a line for each attachment point off the surface of a mesh; at a box there may be outriggers."""
        mesh = self.payload.mesh
        return [] if mesh is None else mesh.misplaced(self.attachment_points())

    def true_parameters(self) -> SystemParameters:
        """Return the system of the simulated world: ``world.payload_mass_factor`` scales the payload's mass."""
        return self.parameters().with_payload_mass(self.payload.mass * self.world.payload_mass_factor)

    def braking(self) -> BrakingSettings:
        """Return how a team without set-points brakes: its deceleration follows the acceleration between waypoints."""
        share = self.guidance.resting_place.deceleration_share
        return replace(self.guidance.braking, deceleration=share * self.motion.acceleration)

    def onboard(self) -> AutopilotSettings:
        """Return table ``autopilot`` with what follows from other tables: set-point loss time and braking."""
        failsafe = replace(self.autopilot.failsafe, setpoint_loss=self.flight.failsafe.telemetry_timeout)
        return replace(self.autopilot, failsafe=failsafe, hold=replace(self.autopilot.hold, braking=self.braking()))

    def with_vehicles(self, vehicles: int) -> SystemConfig:
        """Return the same system with another number of vehicles, on a polygon of the same spacing.

        Raises :class:`UnusableInput` when the attachments are given one by one, or when it could not fly.
        """
        if vehicles == self.team.vehicles:
            return self
        if self.team.attachments is not None:
            raise UnusableInput(
                f"{vehicles} vehicles: team.attachments of the system file is for {self.team.vehicles} of them"
            )
        changed = replace(self, team=replace(self.team, vehicles=vehicles))
        if problems := changed.attachment_problems():
            raise UnusableInput(f"{vehicles} vehicles: {problems[0]}")
        try:
            changed.true_parameters()
        except ParameterError as error:
            raise UnusableInput(f"{vehicles} vehicles: {error}") from error
        return changed

    def tables(self) -> dict[str, Any]:
        """Return the values as a system file holds them: tables of keys, arrays as lists, absent what is None."""
        return table_of(self)


def read_system(path: Path | None = None) -> SystemConfig:
    """Read a system file; without one, return the default system.

    Raises :class:`UnusableFile` with file, line, table.key and reason: syntax, unknown keys, values
    out of range, values that do not agree, a team that could not hover.
    """
    if path is None:
        return SystemConfig()
    file = read_toml(path)
    for table, use in _OTHER_FILES.items():
        if table in file.data:
            raise UnusableFile([file.problem((table,), use)])
    return system_of(file)


def system_of(file: ParsedFile) -> SystemConfig:
    """Return the system of a parsed file. Raises :class:`UnusableFile` as :func:`read_system` does."""
    config: SystemConfig = file.validated(table_validator(SystemConfig))
    if "cargo" not in file.data and config.payload.mass != PayloadConfig.mass:
        config = replace(config, cargo=())  # the default is part of the default payload
    if problems := _disagreements(config, file):
        raise UnusableFile(problems)
    try:
        config.parameters()
        config.true_parameters()
    except ParameterError as error:
        raise UnusableFile([file.problem(_cause(config, file), str(error))]) from error
    return config


def _cause(config: SystemConfig, file: ParsedFile) -> Key:
    """Return the key of a number with whose default the system could fly; the team where no single one is the cause."""
    for table in fields(config):
        if not isinstance(getattr(config, table.name), SettingsTable):
            continue
        for key in file.data.get(table.name, ()):
            default = getattr(getattr(SystemConfig(), table.name), key)
            if not isinstance(default, int | float):
                continue
            with suppress(ParameterError):
                changed = replace(getattr(config, table.name), **{key: default})
                replace(config, **{table.name: changed}).true_parameters()
                return table.name, key
    return ("team",)


def _disagreements(config: SystemConfig, file: ParsedFile) -> list[str]:
    """Return what is wrong between keys, one line each."""
    rates, team, motion = config.rates, config.team, config.motion
    found: list[tuple[Key, str]] = []
    divided = {("rates", name): getattr(rates, name) for name in ("onboard", "telemetry", "control")}
    for key, rate in {**divided, ("range_sensor", "rate"): config.range_sensor.rate}.items():
        if rates.physics % rate:
            found.append((key, f"{rate} Hz does not divide physics, {rates.physics} Hz"))
        if rate > rates.telemetry and key != ("rates", "onboard"):
            found.append((key, f"{rate} Hz is faster than telemetry, {rates.telemetry} Hz"))
    if team.attachments is not None and len(team.attachments) != team.vehicles:
        found.append((("team", "attachments"), f"{len(team.attachments)} points for {team.vehicles} vehicles"))
    found += [(("team", "attachments"), problem) for problem in config.attachment_problems()]
    if config.payload.mesh is not None:
        given = file.data["payload"]
        found += [(("payload", key), "follows from mesh: leave it out") for key in ("size", "inertia") if key in given]
    for table, inertia in ("payload", config.payload.inertia), ("uav", config.uav.inertia):
        if inertia is not None and 2.0 * max(inertia) > sum(inertia) * (1.0 + 1e-9):
            reason = f"{list(inertia)}: no rigid body has a moment larger than the sum of the two others"
            found.append(((table, "inertia"), reason))
    for low, high, unit in ("range_min", "range", "m"), ("elevation_min_deg", "elevation_max_deg", "deg"):
        lowest, highest = getattr(config.range_sensor, low), getattr(config.range_sensor, high)
        if lowest >= highest:
            found.append((("range_sensor", low), f"{lowest} {unit} is not below {high}, {highest} {unit}"))
    if motion.speed > motion.speed_max:
        found.append((("motion", "speed"), f"{motion.speed} is more than speed_max, {motion.speed_max}"))
    return [file.problem(key, reason) for key, reason in [*found, *_cargo_problems(config)]]


def _cargo_problems(config: SystemConfig) -> Iterator[tuple[Key, str]]:
    """Yield what is wrong with the cargo: a gripper named twice, a payload of cargo alone, more than can be carried."""
    mass, rest = config.payload.mass, config.payload.mass
    heaviest = mass
    grippers: dict[int, int] = {}
    for i, cargo in enumerate(config.cargo):
        first = grippers.setdefault(cargo.gripper, i)
        if first != i:
            yield ("cargo", i, "gripper"), f"{cargo.gripper} is the gripper of cargo[{first + 1}]"
        if not cargo.loaded:
            heaviest += cargo.mass
            continue
        if rest >= PAYLOAD_MASS_MIN > rest - cargo.mass:
            reason = f"{cargo.mass:g} kg: payload.mass, {mass:g} kg, contains a container"
            yield ("cargo", i, "mass"), f"{reason} of {PAYLOAD_MASS_MIN:g} kg at least and {mass - rest:g} kg before"
        rest -= cargo.mass
    if heaviest > mass:
        with suppress(ParameterError):
            system = config.true_parameters()
            try:
                system.with_payload_mass(heaviest * config.world.payload_mass_factor)
            except ParameterError as error:
                yield ("cargo",), f"a payload of {heaviest:g} kg with all that is not loaded yet: {error}"
