"""Items of a mission as the wire carries them, in the local frame of a free vehicle."""

import math
from collections.abc import Callable, Sequence

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.services.local_frame import LocalFrame
from gcs.mavlink.services.mission_item import UNKNOWN, MissionItem
from gcs.mission.commands import Command
from idc_controller.rotations_float import Vector
from vehicle_sim.autopilot.free.mission import Action, MissionStep

_ABOVE_HOME = (mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT)
_NONE: Vector = (math.nan, math.nan, math.nan)

Reader = Callable[[MissionItem, Vector], MissionStep]


def steps_of(items: Sequence[MissionItem], frame: LocalFrame, home: Vector) -> tuple[MissionStep, ...]:
    """Return what is flown for ``items``; ``home`` NED (m).

    What is not in :data:`COMMANDS` is passed over, as cameras and what else such a vehicle does not have.
    """
    return tuple(_step(item, frame, home) for item in items)


def _step(item: MissionItem, frame: LocalFrame, home: Vector) -> MissionStep:
    read = COMMANDS.get(item.command)
    return MissionStep(Action.NOTHING) if read is None else read(item, _place(item, frame, home))


def _place(item: MissionItem, frame: LocalFrame, home: Vector) -> Vector:
    """Return the item's place (NED, m); without latitude and longitude (both 0) only the altitude."""
    if item.command not in _PLACES:
        return _NONE
    altitude = item.z
    if item.frame in _ABOVE_HOME:
        altitude += frame.altitude - home[2]
    if (item.x, item.y) in ((0, 0), (UNKNOWN, UNKNOWN)):
        return math.nan, math.nan, frame.altitude - altitude
    if math.isnan(altitude):  # flown to at the altitude where it is
        return *frame.local(item.x * 1e-7, item.y * 1e-7, frame.altitude)[:2], math.nan
    return frame.local(item.x * 1e-7, item.y * 1e-7, altitude)


def _radius(item: MissionItem, radius: float) -> float:
    return radius if math.isfinite(radius) and radius > 0.0 else math.nan


def _positive(value: float) -> float:
    return value if math.isfinite(value) and value > 0.0 else 0.0


def _yaw(item: MissionItem) -> float:
    return math.radians(item.param4) if math.isfinite(item.param4) else math.nan


def _waypoint(item: MissionItem, place: Vector) -> MissionStep:
    return MissionStep(
        Action.FLY, place, hold=_positive(item.param1), radius=_radius(item, item.param2), yaw=_yaw(item)
    )


def _take_off(item: MissionItem, place: Vector) -> MissionStep:
    return MissionStep(Action.TAKE_OFF, place, yaw=_yaw(item))


def _loiter(item: MissionItem, place: Vector) -> MissionStep:
    return MissionStep(Action.FLY, place, hold=math.inf, yaw=_yaw(item))


def _loiter_time(item: MissionItem, place: Vector) -> MissionStep:
    return MissionStep(Action.FLY, place, hold=_positive(item.param1))


def _land(item: MissionItem, place: Vector) -> MissionStep:
    return MissionStep(Action.LAND, place, yaw=_yaw(item))


def _delay(item: MissionItem, place: Vector) -> MissionStep:
    return MissionStep(Action.FLY, place, hold=_positive(item.param1))


def _speed(item: MissionItem, place: Vector) -> MissionStep:
    return MissionStep(Action.SPEED, speed=item.param2)


def _jump(item: MissionItem, place: Vector) -> MissionStep:
    return MissionStep(Action.JUMP, target=round(_positive(item.param1)), repeat=round(item.param2))


COMMANDS: dict[int, Reader] = {
    mavlink.MAV_CMD_NAV_WAYPOINT: _waypoint,
    mavlink.MAV_CMD_NAV_LOITER_UNLIM: _loiter,
    mavlink.MAV_CMD_NAV_LOITER_TIME: _loiter_time,
    mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: lambda item, place: MissionStep(Action.RETURN),
    mavlink.MAV_CMD_NAV_LAND: _land,
    mavlink.MAV_CMD_NAV_TAKEOFF: _take_off,
    mavlink.MAV_CMD_NAV_LOITER_TO_ALT: lambda item, place: MissionStep(Action.FLY, place),
    Command.CONDITION_GATE: lambda item, place: MissionStep(Action.FLY, place),
    mavlink.MAV_CMD_NAV_DELAY: _delay,
    mavlink.MAV_CMD_CONDITION_DELAY: _delay,
    mavlink.MAV_CMD_DO_CHANGE_SPEED: _speed,
    mavlink.MAV_CMD_DO_JUMP: _jump,
}
"""What each command of an item is flown as."""

_PLACES = (
    mavlink.MAV_CMD_NAV_WAYPOINT,
    mavlink.MAV_CMD_NAV_LOITER_UNLIM,
    mavlink.MAV_CMD_NAV_LOITER_TIME,
    mavlink.MAV_CMD_NAV_LOITER_TO_ALT,
    Command.CONDITION_GATE,
    mavlink.MAV_CMD_NAV_LAND,
    mavlink.MAV_CMD_NAV_TAKEOFF,
)
