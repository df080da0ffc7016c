"""A mission as read: reference, obstacles, faults and limits."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from gcs.config.system import SystemConfig
from gcs.config.validate import NotNegative, Positive, strict
from gcs.mission.motion import AnyMotion
from gcs.mission.route import Route
from idc_controller.geometry.free_space import FlightArea, Ring
from idc_controller.geometry.shape import Shape

Name = Annotated[str, Field(min_length=1, max_length=200)]


@dataclass(frozen=True)
class Home:
    """Position of the pad: latitude and longitude (deg), altitude above mean sea level (m)."""

    latitude: float
    longitude: float
    altitude: float


StartPhase = Literal[
    "arm", "spool_up", "climb", "fly", "hold", "land", "autonomous_landing", "spool_down", "disarm", "on_ground"
]  # fmt: skip
"""Phases of a flight that the simulator knows, by the names of :class:`gcs.flight.phase.Phase`."""

DEFAULT_HOME = Home(47.397742, 8.545594, 488.0)
"""The home of PX4's simulations."""


@strict
@dataclass(frozen=True)
class Lissajous:
    """The paper's curve about home: x = a sin wt, y = -b sin 2wt (m, NED), at ``altitude`` above home (m).

    ``amplitude`` is (a, b) (m), ``angular_frequency`` w (rad/s), ``duration`` in s.
    """

    amplitude: tuple[NotNegative, NotNegative]
    angular_frequency: Positive
    altitude: float
    duration: Positive
    kind: Literal["lissajous"] = "lissajous"


@dataclass(frozen=True)
class Obstacle:
    """An obstacle: its shape, and the position of its centre (NED, m) without the displacement by its ``motion``.

    ``known``: it is on the map; otherwise only range sensors detect it.
    """

    name: str
    position: tuple[float, float, float]
    shape: Shape
    known: bool = True
    motion: AnyMotion | None = None


@strict
@dataclass(frozen=True)
class Fault:
    """Something that goes wrong.

    It starts ``start`` s after take-off begins, which is when the first vehicle lifts off, or ``start_offset`` s (None:
    at once) after the flight enters ``start_phase`` for the first time; times are in s. ``start_flight``: the number of
    that flight, from take-off to landing, of a mission with several (None: the first).

    ``vehicles`` None: all of them. ``duration`` None: to the end. ``every``: it comes again at this period, ``times``
    times in all (None: without end). ``direction`` None: the kind's own. ``settings`` are the kind's parameters as
    written (:mod:`gcs.faults` has the kinds); ``line`` is that of the fault in the mission file.
    """

    kind: Name
    start: NotNegative | None = None
    duration: Positive | None = None
    every: Positive | None = None
    times: Annotated[int, Field(ge=1, le=1_000_000)] | None = None
    vehicles: tuple[Annotated[int, Field(ge=1)], ...] | None = None
    direction: Literal["telemetry", "command", "both"] | None = None
    settings: Mapping[str, Any] = field(default_factory=dict)
    line: int = 1
    start_phase: StartPhase | None = None
    start_offset: NotNegative | None = None
    start_flight: Annotated[int, Field(ge=1, le=1_000_000)] | None = None

    @property
    def start_key(self) -> str | None:
        """The phase in which it starts, with the number of the flight if that is not the first; None: in none."""
        if self.start_phase is None or self.start_flight in (None, 1):
            return self.start_phase
        return f"{self.start_phase} {self.start_flight}"


@strict
@dataclass(frozen=True)
class Limits:
    """Limits of the flight (m, s, deg, m/s); None: no limit.

    ``arrival`` holds for every flight: what it has not come as near to, waypoints and landing, it has not reached.
    """

    position_rmse: Positive | None = None
    settle: NotNegative = 10.0
    payload_tilt_deg: Positive | None = None
    clearance: NotNegative | None = None
    uav_separation: NotNegative | None = None
    touchdown_speed: Positive | None = None
    arrival: Positive = 0.3


@dataclass(frozen=True)
class Mission:
    """A mission as it will be flown.

    ``boundary``: rings about the area that must not be left, none: no boundary. ``excluded``: polygons that must not be
    entered, besides their ``obstacles``. ``notes``: what of the file is left out, capped or added, one line each.
    Positions are NED in m from home's ground point.
    """

    name: str
    path: Path
    seed: int
    system: SystemConfig
    reference: Lissajous | Route
    home: Home = DEFAULT_HOME
    obstacles: tuple[Obstacle, ...] = ()
    boundary: tuple[Ring, ...] = ()
    excluded: tuple[Ring, ...] = ()
    faults: tuple[Fault, ...] = ()
    limits: Limits | None = None
    notes: tuple[str, ...] = ()

    @property
    def area(self) -> FlightArea | None:
        """Return the area that a fence leaves to the flight; None: there is no fence."""
        return FlightArea(self.boundary, self.excluded) if self.boundary or self.excluded else None
