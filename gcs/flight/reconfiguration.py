"""Settings that change in flight: what takes them, at once or with the next trajectory."""

from dataclasses import replace

from gcs.config import SystemConfig
from gcs.flight import stack
from gcs.flight.flight import Flight
from idc_controller.guidance.progress import AdaptiveGuidance
from idc_controller.guidance.resting_place import RestingPlace
from idc_controller.safety.safety_filter import AvoidanceFilter


def reconfigure(flight: Flight, config: SystemConfig) -> None:
    """Have another margin and another link tilt of detours at once, other limits of the motion with the next legs.

    To be called between two control steps. The planner and the stop plans keep the limits that they had at arming: a
    plan may always have its reference's acceleration. Other settings of ``config`` must be the flight's.
    """
    flight.mission = replace(flight.mission, system=config)
    if flight.flown.trajectory is not None:
        flight.flown.trajectory.set_motion(config.motion)
    margin, control, guidance = config.avoidance.margin, flight.control, flight.system.guidance
    flight.system.landing_speed = config.motion.landing_speed
    flight.system.kept_clearance = margin + config.safety.planner.tracking
    if isinstance(control.controller.safety, AvoidanceFilter):
        control.controller.safety.set_margin(margin)
    if isinstance(control.brake, RestingPlace):
        control.brake.set_margin(margin)
    if isinstance(guidance, AdaptiveGuidance):
        guidance.set_settings(
            stack.navigator_settings(config), stack.speed_by_sight(config, flight.system.obstacle_map)
        )
