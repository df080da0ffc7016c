"""Flight phases."""

from enum import Enum

from gcs.mavlink.team_failsafe import TeamState


class Phase(Enum):
    """Phase of a flight; the value is shown to the operator."""

    CONNECT = "connect"
    CHECK = "check"
    ARM = "arm"
    SPOOL_UP = "spool up"
    CLIMB = "climb"
    FLY = "fly"
    HOLD = "hold"
    LAND = "land"
    AUTONOMOUS_LANDING = "autonomous landing"
    SPOOL_DOWN = "spool down"
    DISARM = "disarm"
    ON_GROUND = "on ground"
    """Disarmed, before the first take-off, between two flights, or after the last: MAV_LANDED_STATE_ON_GROUND."""
    ENDED = "ended"

    @property
    def state(self) -> TeamState:
        """State of the team; of a landing on board the first one, of an ended flight the one that is left."""
        return _STATES[self]

    __hash__ = object.__hash__  # looked up in sets for every measurement; Enum's own hashes the name, in Python


IN_AIR = frozenset({Phase.CLIMB, Phase.FLY, Phase.HOLD, Phase.LAND})
CONTROLLED = IN_AIR | {Phase.SPOOL_UP, Phase.SPOOL_DOWN}
"""Phases in which the estimator and the controller run."""
STANDING = frozenset({Phase.CHECK, Phase.ARM, Phase.SPOOL_DOWN, Phase.DISARM, Phase.ON_GROUND})
"""Phases in which the payload stands, before a take-off or after a landing."""

_STATES = {
    **dict.fromkeys((Phase.CONNECT, Phase.CHECK, Phase.ON_GROUND, Phase.ENDED), TeamState.DISARMED),
    **dict.fromkeys((Phase.ARM, Phase.SPOOL_UP, Phase.DISARM), TeamState.ARMED),
    **dict.fromkeys((*IN_AIR, Phase.SPOOL_DOWN), TeamState.OFFBOARD),
    Phase.AUTONOMOUS_LANDING: TeamState.HOLD,
}
