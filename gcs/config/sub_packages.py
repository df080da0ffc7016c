"""The tables of the system file by sub-package: each assembles the settings that the sub-package declares."""

from dataclasses import dataclass, field

from idc_controller.control.settings import ControllerSettings, GroundControlSettings, MpcSettings
from idc_controller.estimation.settings import EstimatorSettings, InnovationMonitorSettings, WindSettings
from idc_controller.guidance.settings import (
    DetourSettings,
    NavigatorSettings,
    ProgressSettings,
    RestingPlaceSettings,
    SightSettings,
)
from idc_controller.safety.settings import FilterSettings, PlannerSettings
from idc_controller.settings import SettingsTable
from idc_controller.trajectory.settings import BrakingSettings


@dataclass(frozen=True, eq=False, repr=False)
class EstimationConfig(SettingsTable):
    """Estimator, wind estimate and the monitor of its innovations."""

    estimator: EstimatorSettings = field(default_factory=EstimatorSettings)
    wind: WindSettings = field(default_factory=WindSettings)
    innovation_monitor: InnovationMonitorSettings = field(default_factory=InnovationMonitorSettings)


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
