"""Mission files: read, checked and described, from three formats into one :class:`Mission`."""

from gcs.mission.describe import describe
from gcs.mission.model import (
    DEFAULT_HOME,
    RESTING_ALTITUDE,
    AnyMotion,
    CircleMotion,
    Fault,
    HarmonicMotion,
    Home,
    Limits,
    LinearMotion,
    Lissajous,
    Mission,
    Obstacle,
    RandomWalkMotion,
    WaypointsMotion,
)
from gcs.mission.motion import mover
from gcs.mission.read import read_mission
from gcs.mission.route import Circle, FlyTo, HoldForever, Land, Leg, Route, TakeOff

__all__ = [
    "DEFAULT_HOME",
    "RESTING_ALTITUDE",
    "AnyMotion",
    "Circle",
    "CircleMotion",
    "Fault",
    "FlyTo",
    "HarmonicMotion",
    "HoldForever",
    "Home",
    "Land",
    "Leg",
    "Limits",
    "LinearMotion",
    "Lissajous",
    "Mission",
    "Obstacle",
    "RandomWalkMotion",
    "Route",
    "TakeOff",
    "WaypointsMotion",
    "describe",
    "mover",
    "read_mission",
]
