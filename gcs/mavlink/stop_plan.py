"""The stop plan on the wire: TUNNEL, so that it names its vehicle, and routers hand it to no other."""

import math
import struct
from collections.abc import Sequence
from itertools import chain
from typing import Any, NamedTuple

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from gcs.mavlink.layout import LAYOUTS, Packed

PAYLOAD_TYPE = 0xC11F
"""Of TUNNEL; those from 32768 on are private."""
POINTS = 5
"""Control points of a quartic."""
LAG_MAX = 2.0
"""Times of set-point loss (COM_OF_LOSS_T) by which a stop plan may begin earlier than the set-points that it goes out
with: by then the loss of a vehicle that confirms none has been detected.
"""

_TUNNEL = LAYOUTS[mavlink.MAVLINK_MSG_ID_TUNNEL]
_HEAD = struct.Struct("<H3B")
"""Fields of TUNNEL before its content: packed number by number, that would take longer than all the rest."""
_CONTENT = struct.Struct(f"<2I2q2f3f{3 * POINTS}f")
_US = 1e6


class StopPlanContent(NamedTuple):
    """A stop plan for one vehicle; times by its boot time (s).

    ``session``: a number of the ground's own, another one whenever it is started anew; ``number``: of the plan in that
    session, rising. ``start`` of the stop and ``duration`` (s); ``descent``: when all vehicles descend. ``yaw`` (rad);
    ``control_points``: five of its path (m, NED). ``hover_force``: of the thrust that holds the vehicle and its share
    of the payload at rest, in the wind as it is (N, NED); NaN: not known.
    """

    session: int
    number: int
    start: float
    descent: float
    duration: float
    yaw: float
    control_points: Sequence[Sequence[float]]
    hover_force: Sequence[float] = (math.nan,) * 3


def stop_plan_message(system_id: int, plan: StopPlanContent) -> Packed:
    """Return TUNNEL with a plan for vehicle ``system_id``."""
    session, number, start, descent, duration, yaw, points, hover_force = plan
    content = _CONTENT.pack(
        session,
        number,
        round(start * _US),
        round(descent * _US),
        duration,
        yaw,
        *hover_force,
        *chain.from_iterable(points),
    )
    head = _HEAD.pack(PAYLOAD_TYPE, system_id, px4.AUTOPILOT_COMPONENT, len(content))
    return _TUNNEL, (head + content).rstrip(b"\0")


def read_stop_plan(fields: tuple[Any, ...]) -> StopPlanContent | None:
    """Return the plan in the ``fields`` of a TUNNEL, in the order of the wire; None: it holds another thing."""
    payload_type, target_system, _, length = fields[:4]
    if payload_type != PAYLOAD_TYPE or length != _CONTENT.size or not target_system:
        return None
    session, number, start, descent, duration, yaw, *numbers = _CONTENT.unpack(bytes(fields[4 : 4 + length]))
    force, *points = zip(*[iter(numbers)] * 3, strict=True)
    return StopPlanContent(session, number, start / _US, descent / _US, duration, yaw, tuple(points), force)
