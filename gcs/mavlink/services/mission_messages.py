"""Messages of the mission protocol: items, and those with the ids of plans, which pymavlink's dialect lacks."""

import math
import struct

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.layout import LAYOUTS, Layout, Packed
from gcs.mavlink.services.mission_item import UNKNOWN, MissionItem
from gcs.mavlink.services.mission_store import MissionProgress

NO_MISSION = 0xFFFF
"""Total of MISSION_CURRENT without a mission."""
_COUNT = LAYOUTS[mavlink.MAVLINK_MSG_ID_MISSION_COUNT], struct.Struct("<HBBBI")
_ACK = LAYOUTS[mavlink.MAVLINK_MSG_ID_MISSION_ACK], struct.Struct("<BBBBI")
_CURRENT = LAYOUTS[mavlink.MAVLINK_MSG_ID_MISSION_CURRENT], struct.Struct("<HHBBIII")
_PLACELESS_FRAMES = (mavlink.MAV_FRAME_MISSION,)
_INT32_MAX = 2**31 - 1

ItemMessage = mavlink.MAVLink_mission_item_int_message | mavlink.MAVLink_mission_item_message


def count(system: int, component: int, number: int, plan_type: int, opaque_id: int) -> Packed:
    """Return MISSION_COUNT with the id of the plan."""
    return _packed(_COUNT, number, system, component, plan_type, opaque_id)


def ack(system: int, component: int, result: int, plan_type: int, opaque_id: int = 0) -> Packed:
    """Return MISSION_ACK, with the id of a plan that was accepted."""
    return _packed(_ACK, system, component, result, plan_type, opaque_id)


def current(progress: MissionProgress, ids: tuple[int, int, int]) -> Packed:
    """Return MISSION_CURRENT with the ids of mission, fence and rally points."""
    return _packed(
        _CURRENT, progress.current, progress.total or NO_MISSION, progress.state, progress.mode, *ids
    )  # fmt: skip


def item_message(
    system: int, component: int, number: int, item: MissionItem, is_current: bool, plan_type: int
) -> mavlink.MAVLink_mission_item_int_message:
    """Return MISSION_ITEM_INT of item ``number`` of a plan."""
    return mavlink.MAVLink_mission_item_int_message(
        system, component, number, item.frame, item.command, is_current, item.autocontinue,
        item.param1, item.param2, item.param3, item.param4, item.x, item.y, item.z, plan_type,
    )  # fmt: skip


def item_of(message: ItemMessage) -> MissionItem:
    """Return the item of a message, whole numbers or real ones for latitude and longitude."""
    if isinstance(message, mavlink.MAVLink_mission_item_int_message):
        x, y = message.x, message.y
    else:
        scale = 1.0 if message.frame in _PLACELESS_FRAMES else 1e7
        x, y = _whole(message.x * scale), _whole(message.y * scale)
    return MissionItem(
        message.frame, message.command, bool(message.autocontinue),
        message.param1, message.param2, message.param3, message.param4, x, y, message.z,
    )  # fmt: skip


def _whole(value: float) -> int:
    """Return a number of 32 bits; the nearest that is no place on earth for one that does not fit, NaN: unknown."""
    if math.isnan(value):
        return UNKNOWN
    return max(-_INT32_MAX, round(min(max(value, -3e9), _INT32_MAX - 1.0)))


def _packed(kind: tuple[Layout, struct.Struct], *values: int) -> Packed:
    layout, fields = kind
    payload = fields.pack(*values)
    return layout, payload.rstrip(b"\0") or payload[:1]
