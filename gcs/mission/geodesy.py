"""Latitude and longitude to metres from home."""

from __future__ import annotations

import math

import pymap3d
from pymap3d.haversine import anglesep

from gcs.mission.items import ItemError

FARTHEST = 10_000.0
"""m from home. Beyond it the file's home is wrong, or the world no longer flat."""


def north_east(latitude: float, longitude: float, home: tuple[float, float, float]) -> tuple[float, float]:
    """(north, east) in m of a place, both on the ellipsoid's surface at home's altitude.

    ``home`` is latitude, longitude (deg), altitude (m). Raises :class:`ItemError` for what is no place on earth or is
    farther than :data:`FARTHEST`.
    """
    check_latitude_longitude(latitude, longitude)
    north, east, _ = pymap3d.geodetic2ned(latitude, longitude, home[2], *home)
    distance = math.hypot(north, east)
    # The chord alone does not discriminate near the antipodes.
    if distance > FARTHEST or abs(latitude - home[0]) > 1.0:
        kilometres = float(anglesep(home[1], home[0], longitude, latitude)) * 111.2
        raise ItemError("latitude, longitude", f"{kilometres:.0f} km from home (at most {FARTHEST / 1000:.0f})")
    return float(north), float(east)


def check_latitude_longitude(latitude: float, longitude: float) -> None:
    """Raises :class:`ItemError` outside -90 .. 90 and -180 .. 180 deg."""
    if not -90.0 <= latitude <= 90.0:
        raise ItemError("latitude", f"{latitude:g} is outside -90 .. 90 deg")
    if not -180.0 <= longitude <= 180.0:
        raise ItemError("longitude", f"{longitude:g} is outside -180 .. 180 deg")
