"""Uploaded plans of the team: read as the QGroundControl ``.plan`` that they would be saved as."""

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config.validate import UnusableFile
from gcs.mavlink.services.mission_item import MissionItem, PlanType
from gcs.mission.commands import command_name
from gcs.mission.model import Mission
from gcs.mission.read import mission_of_plan
from gcs.serve.parameters import TAKEOFF_ALTITUDE

UPLOADED = Path("plan")
"""In place of a file's name, where a plan was uploaded."""
_POLYGONS = {
    mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION: True,
    mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION: False,
}
_CIRCLES = {
    mavlink.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION: True,
    mavlink.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION: False,
}
_PX4, _MULTICOPTER = mavlink.MAV_AUTOPILOT_PX4, mavlink.MAV_TYPE_QUADROTOR

_TAKE_OFF = MissionItem(
    mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT,
    mavlink.MAV_CMD_NAV_TAKEOFF,
    True,
    0.0,
    0.0,
    0.0,
    math.nan,
    0,
    0,
    TAKEOFF_ALTITUDE,
)

Plans = Mapping[PlanType, Sequence[MissionItem]]


def label(item: MissionItem, number: int) -> str:
    """Return how reasons name item ``number`` (from 0) of a plan: by its place from 1, as ground stations do."""
    return f"item {number + 1} ({command_name(item.command)})"


def mission_of(plans: Plans, world: Mission) -> Mission:
    """Return the mission of uploaded plans, flown in ``world``: its system, home and obstacles.

    As PX4 it holds where a mission without a landing ends. Without a mission it is one for the sake of the fence, that
    takes off. Raises :class:`UnusableFile` with every reason found.
    """
    if not plans[PlanType.MISSION]:
        plans = {**plans, PlanType.MISSION: [_TAKE_OFF]}
    return mission_of_plan(UPLOADED, json.dumps(plan_file(plans, world)), world)


def plan_file(plans: Plans, world: Mission) -> dict[str, Any]:
    """Return plans as the content of a QGroundControl ``.plan``. Raises :class:`UnusableFile` for a broken fence."""
    home = world.home
    return {
        "fileType": "Plan",
        "version": 1,
        "groundStation": "QGroundControl",
        "mission": {
            "version": 2,
            "firmwareType": _PX4,
            "vehicleType": _MULTICOPTER,
            "plannedHomePosition": [home.latitude, home.longitude, home.altitude],
            "items": [_simple_item(item, number) for number, item in enumerate(plans[PlanType.MISSION])],
        },
        "geoFence": _fence(plans[PlanType.FENCE]),
        "rallyPoints": {
            "version": 2,
            "points": [[*item.place, item.z] for item in plans[PlanType.RALLY]],
        },
    }


def _simple_item(item: MissionItem, number: int) -> dict[str, Any]:
    params = [None if value is None or math.isnan(value) else value for value in item.parameters]
    return {
        "type": "SimpleItem",
        "frame": item.frame,
        "command": item.command,
        "params": params,
        "doJumpId": number,
        "autoContinue": item.autocontinue,
    }


def _fence(items: Sequence[MissionItem]) -> dict[str, Any]:
    circles: list[dict[str, Any]] = []
    polygons: list[dict[str, Any]] = []
    number = 0
    while number < len(items):
        item = items[number]
        if (inclusion := _CIRCLES.get(item.command)) is not None:
            circle = {"center": [*item.place], "radius": item.param1}
            circles.append({"version": 1, "inclusion": inclusion, "circle": circle})
            number += 1
            continue
        if (inclusion := _POLYGONS.get(item.command)) is None:
            raise UnusableFile([f"{UPLOADED}: fence item {number + 1}: {command_name(item.command)}: not supported"])
        count = int(item.param1) if math.isfinite(item.param1) else 0
        corners = items[number : number + count]
        same = [each for each in corners if (each.command, each.param1) == (item.command, item.param1)]
        if count < 3 or len(same) < count:
            raise UnusableFile([f"{UPLOADED}: fence item {number + 1}: {len(same)} of {item.param1:g} corners"])
        polygons.append({"version": 1, "inclusion": inclusion, "polygon": [[*corner.place] for corner in corners]})
        number += count
    return {"version": 2, "circles": circles, "polygons": polygons}
