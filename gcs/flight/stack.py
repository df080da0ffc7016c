"""From a system file to the mathematics that flies it: model, estimator and controller."""

import math
from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np

from gcs.config import RangeSensorConfig, SystemConfig
from gcs.mission.fence import boundary_walls
from gcs.mission.model import Mission, Obstacle
from idc_controller.control.controller import IntegratedDecisionController
from idc_controller.control.gain_schedule import ScheduledMpc
from idc_controller.estimation.estimator import Estimator
from idc_controller.estimation.grounded_links import GroundedLinks
from idc_controller.estimation.measurements import MeasurementNoise
from idc_controller.geometry.free_space import BoundingCylinder, FlightArea
from idc_controller.geometry.obstacles import ObstacleSource
from idc_controller.guidance.navigator import Navigator
from idc_controller.guidance.progress import AdaptiveGuidance, Guidance
from idc_controller.guidance.resting_place import RestingPlace
from idc_controller.guidance.settings import NavigatorSettings
from idc_controller.guidance.sight import SensorView, Sight, SpeedBySight, closing_speed
from idc_controller.model.linear import LinearModel
from idc_controller.perception.obstacle_map import ObstacleMap
from idc_controller.perception.range_sensors import RayPattern, SensorModel
from idc_controller.perception.scan_placement import SensorRays
from idc_controller.perception.settings import PerceptionSettings
from idc_controller.perception.standing_obstacles import MapObstacle
from idc_controller.safety.filter_protocol import SafetyFilter
from idc_controller.safety.planner import give_way_time
from idc_controller.safety.safety_filter import AvoidanceFilter
from idc_controller.safety.settings import PlannerSettings
from idc_controller.trajectory.stop_plan import Descent


def linear_model(config: SystemConfig) -> LinearModel:
    """Return the controller's model of the system."""
    return LinearModel(config.parameters())


def measurement_noise(config: SystemConfig) -> MeasurementNoise:
    """Return the noise of the sensors of the system file."""
    sensors = config.sensors
    return MeasurementNoise(
        position=sensors.position,
        attitude=float(np.radians(sensors.attitude_deg)),
        uav_velocity=sensors.uav_velocity,
        uav_rates=sensors.uav_rates,
        payload_velocity=sensors.payload_velocity,
        payload_rates=sensors.payload_rates,
    )


def estimator(config: SystemConfig, model: LinearModel) -> Estimator:
    """Return the filter for the sensors of the system file."""
    settings = config.estimation.estimator.at_rates(config.rates.telemetry, config.rates.control)
    return Estimator(model, measurement_noise(config), settings)


def grounded_links(config: SystemConfig, model: LinearModel) -> GroundedLinks:
    """Return the estimator of the links over a payload on the ground."""
    return GroundedLinks(model.parameters, measurement_noise(config), config.estimation.estimator.grounded_links)


def perception(config: SystemConfig) -> PerceptionSettings:
    """Return the settings of perception for the rates and the range sensors of the system file."""
    sensor = config.range_sensor
    return config.perception.of_sensors(config.rates.telemetry, sensor.rate, sensor.missed_share)


def obstacle_map(mission: Mission) -> ObstacleMap:
    """Return the obstacle map of a mission, for the sensors of its system file."""
    config = mission.system
    sensors = SensorModel(config.range_sensor.noise, config.sensors.position, math.radians(config.sensors.attitude_deg))
    return ObstacleMap(
        map_of(mission), sensors, config.range_sensor.range, sensor_rays(config.range_sensor), perception(config)
    )


def map_of(mission: Mission) -> list[MapObstacle]:
    """Return the obstacles that a mission marks as known, and the walls of its fence."""
    edges = (edge._replace(is_body=False) for edge in known_obstacles(boundary_walls(mission.boundary)))
    return [*known_obstacles(mission.obstacles), *edges]


def known_obstacles(obstacles: Iterable[Obstacle]) -> list[MapObstacle]:
    """Return those of ``obstacles`` that are marked as known."""
    return [
        MapObstacle(obstacle.name, obstacle.shape, np.array(obstacle.position), obstacle.motion is not None)
        for obstacle in obstacles
        if obstacle.known
    ]


def sensor_rays(sensor: RangeSensorConfig) -> SensorRays:
    """Return what is known of the rays of every range sensor."""
    lowest, highest = math.radians(sensor.elevation_min_deg), math.radians(sensor.elevation_max_deg)
    return SensorRays(RayPattern(sensor.rays, lowest, highest), sensor.rate, sensor.ground_height)


def avoidance(config: SystemConfig, model: LinearModel, obstacles: ObstacleSource) -> AvoidanceFilter:
    """Return the safety filter that keeps ``obstacles`` out of the hull."""
    return AvoidanceFilter(model.parameters, planner_settings(config), obstacles, config.safety.filter)


def planner_settings(config: SystemConfig) -> PlannerSettings:
    """Return the settings of the safety QP, with those that other tables own."""
    return replace(
        config.safety.planner,
        limits=config.motion.limits,
        margin=config.avoidance.margin,
        barrier_rates=config.avoidance.barrier_rates,
    )


def guidance(
    config: SystemConfig,
    model: LinearModel,
    obstacles: ObstacleSource,
    sight: Sight | None = None,
    area: FlightArea | None = None,
) -> AdaptiveGuidance:
    """Return the guidance that waits for the payload, and leads round ``obstacles`` within ``area`` (None: everywhere).

    ``sight``: what range sensors have seen, to limit the speed by; None: no range sensors.
    """
    stages = config.safety.planner.chain.times
    navigator = Navigator(model.parameters, navigator_settings(config), obstacles, stages, area)
    weight = model.parameters.m_0 * model.parameters.g
    by_sight = None if sight is None else speed_by_sight(config, sight)
    return AdaptiveGuidance(navigator, config.guidance.progress, stages, weight, by_sight)


def navigator_settings(config: SystemConfig) -> NavigatorSettings:
    """Return the settings of detours, with those that other tables own."""
    return replace(
        config.guidance.navigator,
        limits=config.motion.limits,
        margin=config.avoidance.margin,
        detour=config.guidance.detour,
    )


def speed_by_sight(config: SystemConfig, sight: Sight) -> SpeedBySight:
    """Return the limit of the progress by what range sensors have seen."""
    settings = replace(config.guidance.sight, limits=config.motion.limits, margin=config.avoidance.margin)
    formation = tilted_formation(config)
    return SpeedBySight(sight, settings, formation, sensor_view(config), reaction_time(config, formation))


def closing_speed_limit(config: SystemConfig) -> float:
    """Return the speed (m/s), the team's and a moving obstacle's together, that leaves time to give way to it."""
    formation = tilted_formation(config)
    return closing_speed(sensor_view(config), formation, reaction_time(config, formation))


def sensor_view(config: SystemConfig) -> SensorView:
    """Return what the range sensors of the vehicles can see."""
    parameters, sensor = config.parameters(), config.range_sensor
    offsets = parameters.p - np.outer(parameters.l, [0.0, 0.0, 1.0])
    lowest, highest = math.radians(sensor.elevation_min_deg), math.radians(sensor.elevation_max_deg)
    return SensorView(offsets, sensor.range, lowest, highest)


def tilted_formation(config: SystemConfig) -> BoundingCylinder:
    """Return the upright bounds of the formation, its links tilted as far as in a detour."""
    return BoundingCylinder.of(config.parameters(), config.guidance.navigator.link_tilt)


def reaction_time(config: SystemConfig, formation: BoundingCylinder) -> float:
    """Return the time (s) from which on a moving obstacle is in range until the formation has given way to it.

    The sum of its confirmation, of the planning interval, and of :func:`give_way_time` by the width of both, the margin
    and what the payload may be off its plan.
    """
    planner, sight = planner_settings(config), config.guidance.sight
    aside = formation.radius + sight.mover_radius + planner.margin + planner.tracking
    return sight.confirmation + planner.stage + give_way_time(planner, aside)


def resting_place(
    config: SystemConfig, model: LinearModel, obstacles: ObstacleSource, area: FlightArea | None = None
) -> RestingPlace:
    """Return the choice of where a team without set-points comes to rest, clear of ``obstacles`` and in ``area``."""
    settings = replace(config.guidance.resting_place, margin=config.avoidance.margin)
    return RestingPlace(model.parameters, obstacles, settings, config.braking(), area)


def descent(config: SystemConfig) -> Descent:
    """Return how the vehicles descend without the ground."""
    return Descent(config.autopilot.hold.land_speed, config.autopilot.hold.descent_ramp)


def controller(
    config: SystemConfig,
    model: LinearModel,
    safety: SafetyFilter,
    stopwatch: Callable[[], float],
    guidance: Guidance | None = None,
) -> IntegratedDecisionController:
    """Return the integrated decision controller with the MPC as its tracker."""
    period = 1.0 / config.rates.control
    mpc = replace(config.control.mpc, period=period, tuning=config.controller)
    return IntegratedDecisionController(
        model,
        ScheduledMpc(model, mpc),
        safety,
        replace(config.control.controller, period=period, wind=config.estimation.wind, ground=config.control.ground),
        stopwatch,
        guidance,
    )
