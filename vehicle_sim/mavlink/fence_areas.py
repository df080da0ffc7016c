"""Items of a fence and rally points as the wire carries them, in the local frame of a free vehicle."""

from collections.abc import Sequence

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.services.local_frame import LocalFrame
from gcs.mavlink.services.mission_item import MissionItem
from idc_controller.rotations_float import Vector
from vehicle_sim.autopilot.free.fence import Circle, Fence, Point, Polygon

_ABOVE_HOME = (mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT)
_CORNERS = (mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION, mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION)
_INCLUSIONS = (
    mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION,
    mavlink.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION,
)


def fence_of(items: Sequence[MissionItem], frame: LocalFrame) -> Fence:
    """Return the fence of ``items`` that were checked: every polygon has all its corners."""
    inclusions: list[Polygon | Circle] = []
    exclusions: list[Polygon | Circle] = []
    number = 0
    while number < len(items):
        item = items[number]
        areas = inclusions if item.command in _INCLUSIONS else exclusions
        if item.command in _CORNERS:
            corners = items[number : number + round(item.param1)]
            areas.append(Polygon(tuple(_point(corner, frame) for corner in corners)))
            number += len(corners)
        else:
            areas.append(Circle(_point(item, frame), item.param1))
            number += 1
    return Fence(tuple(inclusions), tuple(exclusions))


def rally_points_of(items: Sequence[MissionItem], frame: LocalFrame, home: Vector) -> tuple[Vector, ...]:
    """Return the rally points (NED, m); ``home`` NED (m)."""
    return tuple(
        (*_point(item, frame), frame.altitude - item.z if item.frame not in _ABOVE_HOME else home[2] - item.z)
        for item in items
    )


def _point(item: MissionItem, frame: LocalFrame) -> Point:
    return frame.local(item.x * 1e-7, item.y * 1e-7, frame.altitude)[:2]
