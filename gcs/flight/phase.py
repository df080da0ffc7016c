"""Where a flight is."""

from __future__ import annotations

from enum import Enum


class Phase(Enum):
    """Where the flight is."""

    CONNECT = "connect"
    CHECK = "check"
    ARM = "arm"
    SPOOL_UP = "spool up"
    CLIMB = "climb"
    FLY = "fly"
    HOLD = "hold"
    LAND = "land"
    ON_THEIR_OWN = "vehicles land on their own"
    SPOOL_DOWN = "spool down"
    DISARM = "disarm"
    ENDED = "ended"


IN_THE_AIR = (Phase.CLIMB, Phase.FLY, Phase.HOLD, Phase.LAND)
CLEAR_OF_GROUND = (Phase.FLY, Phase.HOLD)
