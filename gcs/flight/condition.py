"""Conditions of failsafes: what they are evaluated on and when, and what they return."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum
from typing import NamedTuple

from gcs.config.flight_settings import DEFAULTS, FailsafeSettings
from gcs.config.tables import MotionConfig
from gcs.flight.command_sequences import CommandSequence
from gcs.flight.control_loop import ControlLoop
from gcs.flight.landing_place import LandingPlace
from gcs.flight.payload_monitor import PayloadMonitor
from gcs.flight.phase import Phase
from gcs.flight.plan_monitor import ImpactMonitor, PlanMonitor
from gcs.flight.preflight import Preflight
from gcs.flight.team import Team
from gcs.flight.team_clock import StepIntervals
from gcs.mavlink.vehicle_link import VehicleLink
from gcs.mission.model import Mission
from idc_controller.arrays import Array
from idc_controller.control.load_adaptation import LoadAdaptation
from idc_controller.estimation.estimator import Estimator
from idc_controller.estimation.grounded_links import GroundedLinks
from idc_controller.estimation.measurements import Estimate
from idc_controller.geometry.formation import Formation
from idc_controller.guidance.progress import Guidance
from idc_controller.perception.obstacle_map import ObstacleMap
from idc_controller.safety.separation import Obstruction, obstruction
from idc_controller.trajectory.trajectory import Trajectory


class Check(Enum):
    """Moments at which a condition is evaluated."""

    EVENT = "when it happens"
    CONNECT = "while connecting"
    PREFLIGHT = "before arming"
    COMMAND = "while a command sequence is carried out"
    LINK = "whenever the ground has received or is to send, from spool-up to the end of spool-down"
    STEP = "at every control step"
    IN_AIR = "at every control step in the air"
    ESTIMATE = "at every control step in the air, on the new estimate"

    __hash__ = object.__hash__  # looked up at every exchange; Enum's own hashes the name, in Python


@dataclass(eq=False)
class System:
    """The objects that conditions are evaluated on."""

    team: Team
    estimator: Estimator
    guidance: Guidance
    payload: PayloadMonitor
    preflight: Preflight
    plan: PlanMonitor
    impact: ImpactMonitor
    obstacle_map: ObstacleMap
    settings: FailsafeSettings = DEFAULTS.failsafe
    kept_clearance: float = 0.6
    """What plans keep from obstacles (m): the margin, and the bound on the payload's deviation from its plan."""
    control_interval: float = 0.05
    """s; telemetry must not come less often."""
    steps: StepIntervals = field(default_factory=StepIntervals)
    """Of the control steps that were made."""
    landing_place: LandingPlace | None = None
    """None: it is not watched."""
    load: LoadAdaptation | None = None
    """The load as it is learnt; None: it is not."""
    links: GroundedLinks | None = None
    """Over a payload on the ground; None: not estimated."""
    landing_speed: float = MotionConfig.landing_speed
    """Of the payload at touch-down (m/s)."""

    @classmethod
    def of(
        cls, mission: Mission, team: Team, control: ControlLoop, obstacle_map: ObstacleMap, landing_place: LandingPlace
    ) -> System:
        """Return the objects of a flight of ``mission`` that has not begun."""
        config, parameters = mission.system, control.controller.parameters
        settings = config.flight
        return cls(
            team,
            control.estimator,
            control.controller.guidance,
            PayloadMonitor(parameters, settings),
            Preflight(team, settings),
            PlanMonitor(parameters.number_of_uavs, settings.failsafe),
            ImpactMonitor(team.links),
            obstacle_map,
            settings.failsafe,
            kept_clearance=config.avoidance.margin + config.safety.planner.tracking,
            control_interval=1.0 / config.rates.control,
            landing_place=landing_place,
            load=control.controller.load,
            links=control.links,
            landing_speed=config.motion.landing_speed,
        )

    def obstruction(self, time: float, place: Array, within: float) -> Obstruction | None:
        """Return what is nearer than ``within`` (m) to the formation at rest at ``place`` (3,), by the obstacle map."""
        return obstruction(Formation(self.team.parameters), self.obstacle_map, time, place, within)


class Moment(NamedTuple):
    """The moment of the evaluation; times in s, ``time`` the team's, ``now`` the ground's."""

    phase: Phase
    time: float
    now: float
    sequence: CommandSequence | None = None
    estimate: Estimate | None = None
    descent: tuple[float, Trajectory] | None = None
    """Progress along the mission trajectory, and that trajectory."""


@dataclass(frozen=True)
class Trigger:
    """A condition that holds."""

    reason: str
    """For the operator: what is wrong, the value, the limit."""
    vehicles: tuple[int, ...] = ()
    """Indices of the vehicles (0 .. N-1) that are its cause; empty: the whole team."""
    source: str = "team"
    """Source of the alarm where the cause is not one vehicle."""


Condition = Callable[[System, Moment], Trigger | None]


def of_a_vehicle(problem: Callable[[VehicleLink], str]) -> Condition:
    """Return the condition that a vehicle has a ``problem``, the text that follows its name; the first one counts."""

    def condition(system: System, moment: Moment) -> Trigger | None:
        for i, link in enumerate(system.team.links):
            if text := problem(link):
                return Trigger(f"vehicle {link.system_id} {text}", (i,))
        return None

    return condition
