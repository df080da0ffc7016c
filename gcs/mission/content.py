"""What a waypoint file holds, before it is made into a route: the readers' common answer."""

from __future__ import annotations

from dataclasses import dataclass

from gcs.mission.items import MissionItem
from gcs.mission.model import Obstacle

ITEM_LIMIT = 10_000


@dataclass(frozen=True)
class FileHome:
    """Home as the file has it (deg, m above mean sea level); the altitude may not be known."""

    latitude: float
    longitude: float
    altitude: float | None


@dataclass(frozen=True)
class Fence:
    """A geofence in m about home."""

    obstacles: tuple[Obstacle, ...] = ()
    boundary: tuple[tuple[float, float], ...] | None = None


@dataclass(frozen=True)
class WaypointFile:
    """Home, items, fence, and notes on what is left out."""

    home: FileHome
    items: tuple[MissionItem, ...]
    fence: Fence = Fence()
    notes: tuple[str, ...] = ()
