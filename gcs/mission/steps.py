"""Steps of a route as a mission file has them: the program that :class:`~gcs.mission.route.Route` runs."""

from dataclasses import dataclass

from gcs.mission.commands import GripperAction


@dataclass(frozen=True)
class Place:
    """A place in m from home's ground point: (north, east), altitude above it. None: as it is then."""

    horizontal: tuple[float, float] | None = None
    altitude: float | None = None


@dataclass(frozen=True)
class Step:
    """One step of the program; ``source`` names the line or item it comes from."""

    source: str


@dataclass(frozen=True)
class Climb(Step):
    """Take-off: straight up to the altitude, then to the place."""

    place: Place


@dataclass(frozen=True)
class Go(Step):
    """Fly to a place, and hold there (s)."""

    place: Place
    hold: float = 0.0
    spline: bool = False


@dataclass(frozen=True)
class Turn(Step):
    """Around a place (m)."""

    place: Place
    radius: float
    turns: float
    clockwise: bool


@dataclass(frozen=True)
class Stay(Step):
    """Fly to a place, and hold there until stopped."""

    place: Place


@dataclass(frozen=True)
class Wait(Step):
    """Hold here, or stand on the ground (s)."""

    seconds: float


@dataclass(frozen=True)
class Grip(Step):
    """Release or grab what a gripper holds, on the ground; gripper 0: all of them."""

    action: GripperAction
    gripper: int


@dataclass(frozen=True)
class Descend(Step):
    """Fly to above a place, and land."""

    place: Place


@dataclass(frozen=True)
class PlacePayload(Step):
    """Land at a place, release all grippers, stand for ``seconds``, and take off to the altitude before.

    ``releases``: False without grippers. ``descent_max`` (m): the ground must be no farther below; None: however far.
    """

    place: Place
    seconds: float
    releases: bool = True
    descent_max: float | None = None


@dataclass(frozen=True)
class Return(Step):
    """Fly to above home at the present altitude, and land."""


@dataclass(frozen=True)
class Speed(Step):
    """Speed from here on (m/s); None: the route's own."""

    speed: float | None


@dataclass(frozen=True)
class Jump(Step):
    """Jump to the step of index ``target``, ``repeats`` times (None: always), then go on."""

    target: int
    repeats: int | None


class RouteError(Exception):
    """A step that cannot be flown where the program meets it: ``source``, field and reason."""

    def __init__(self, source: str, field: str, reason: str) -> None:
        super().__init__(reason)
        self.source, self.field, self.reason = source, field, reason
