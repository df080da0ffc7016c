"""The settings of an autopilot that differ without a payload."""

import math
from dataclasses import replace

from gcs.config.vehicle_settings import AutopilotSettings


def free_settings(settings: AutopilotSettings) -> AutopilotSettings:
    """Return ``settings`` for a free vehicle.

    The last set-point is flown until they count as lost, as by PX4, and the land detector leaves touch-downs to
    :class:`.FreeAutopilot`: in a hover, such a vehicle is as light as one whose payload the ground carries.
    """
    return replace(
        settings,
        setpoints=replace(settings.setpoints, hold=math.inf),
        land_detector=replace(settings.land_detector, vertical_speed_max=0.0),
    )
