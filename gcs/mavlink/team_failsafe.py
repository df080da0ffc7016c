"""The failsafe of a team as one state machine, by which ground and vehicles both act; ``docs/failsafes.md`` shows it.

Each state has one successor. The ground commands it to all vehicles as a reaction to a failsafe; a vehicle that the
ground does not reach enters it by itself when its timer has run out. So all vehicles go the same way, whoever acts. The
conditions are in ``gcs/flight/failsafe.py`` and ``vehicle_sim/autopilot/failsafe.py``.
"""

from __future__ import annotations

from enum import Enum, IntEnum

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4


class Reaction(IntEnum):
    """Reaction of the ground, in ascending severity; the more severe wins."""

    severity: int
    """MAV_SEVERITY of the alarm, unless the failsafe has another."""
    meaning: str

    def __new__(cls, value: int, severity: int, meaning: str) -> Reaction:
        """Make a member with its two attributes."""
        reaction = int.__new__(cls, value)
        reaction._value_, reaction.severity, reaction.meaning = value, severity, meaning
        return reaction

    # fmt: off
    NONE = 0, mavlink.MAV_SEVERITY_NOTICE, "the flight goes on"
    REFUSE = 1, mavlink.MAV_SEVERITY_ERROR, "the flight does not begin, nothing is armed"
    DISARM = 2, mavlink.MAV_SEVERITY_ERROR, "rotors off, on the ground"
    RETURN = 3, mavlink.MAV_SEVERITY_ERROR, "return home as the mission flies, and land there"
    BRAKE_AND_LAND = (4, mavlink.MAV_SEVERITY_CRITICAL,
        "come to rest along the path that is followed, then land there under the ground's control")
    AUTONOMOUS_LANDING = (5, mavlink.MAV_SEVERITY_ALERT,
        "all vehicles follow the same stop plan, hold, and descend on board")
    END_CONTROL = (6, mavlink.MAV_SEVERITY_ALERT,
        "the ground stops sending; each vehicle is left to its own failsafes")
    # fmt: on


class TeamState(Enum):
    """The table of states."""

    mode: int
    """Custom mode of the vehicles, and of the command by which the ground has them enter the state."""
    reactions: tuple[Reaction, Reaction]
    """The mildest and the most severe of the ground in this state, beside END_CONTROL."""
    timer: str
    """The vehicles' parameter (s) after which one without the ground enters the successor; empty: by touch-down."""

    def __init__(self, mode: int, mildest: Reaction, most_severe: Reaction, successor: str, timer: str = "") -> None:
        self.mode, self.reactions, self._successor, self.timer = mode, (mildest, most_severe), successor, timer

    # fmt: off
    DISARMED = px4.MODE_HOLD, Reaction.REFUSE, Reaction.REFUSE, "DISARMED"
    ARMED = px4.MODE_OFFBOARD, Reaction.DISARM, Reaction.DISARM, "DISARMED", px4.PARAM_SETPOINT_LOSS
    OFFBOARD = px4.MODE_OFFBOARD, Reaction.RETURN, Reaction.AUTONOMOUS_LANDING, "HOLD", px4.PARAM_SETPOINT_LOSS
    HOLD = px4.MODE_HOLD, Reaction.AUTONOMOUS_LANDING, Reaction.AUTONOMOUS_LANDING, "LAND", px4.PARAM_LAND_DELAY
    LAND = px4.MODE_LAND, Reaction.AUTONOMOUS_LANDING, Reaction.AUTONOMOUS_LANDING, "DISARMED"
    # fmt: on

    @property
    def next(self) -> TeamState:
        """The successor, in which a failsafe ends the state."""
        return TeamState[self._successor]

    def reaction(self, reaction: Reaction) -> Reaction:
        """Return what is done in this state for ``reaction``."""
        mildest, most_severe = self.reactions
        return reaction if reaction is Reaction.END_CONTROL else min(max(reaction, mildest), most_severe)
