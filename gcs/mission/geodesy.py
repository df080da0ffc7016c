"""Places on the WGS 84 ellipsoid, as mission files have them, and metres about home."""

import math

from gcs.config.tables import Vector

SEMI_MAJOR_AXIS = 6378137.0
"""m"""
SEMI_MINOR_AXIS = 6356752.31424518
"""m"""


def north_east(
    latitude: float, longitude: float, home_latitude: float, home_longitude: float, altitude: float
) -> tuple[float, float]:
    """Return how far north and east of home a place is (m), in the plane that touches the ellipsoid there.

    Latitudes and longitudes in deg; both places are at ``altitude`` above the ellipsoid (m).
    """
    place = _earth_centred(latitude, longitude, altitude)
    home = _earth_centred(home_latitude, home_longitude, altitude)
    x, y, z = (a - b for a, b in zip(place, home, strict=True))
    phi, theta = math.radians(home_latitude), math.radians(home_longitude)
    outwards = math.cos(theta) * x + math.sin(theta) * y
    east = -math.sin(theta) * x + math.cos(theta) * y
    north = -math.sin(phi) * outwards + math.cos(phi) * z
    return north, east


def angle_between(latitude: float, longitude: float, other_latitude: float, other_longitude: float) -> float:
    """Return the angle between two places as seen from the centre of a sphere (deg), by the haversine formula."""
    phi, other_phi = math.radians(latitude), math.radians(other_latitude)
    half = math.sin((phi - other_phi) / 2.0) ** 2
    half += math.cos(phi) * math.cos(other_phi) * math.sin(math.radians(longitude - other_longitude) / 2.0) ** 2
    return math.degrees(2.0 * math.asin(math.sqrt(min(half, 1.0))))


def _earth_centred(latitude: float, longitude: float, altitude: float) -> Vector:
    """Return earth-centred, earth-fixed coordinates (m)."""
    a, b = SEMI_MAJOR_AXIS, SEMI_MINOR_AXIS
    phi, theta = math.radians(latitude), math.radians(longitude)
    # Radius of curvature of the prime vertical.
    curvature = a**2 / math.hypot(a * math.cos(phi), b * math.sin(phi))
    from_axis = (curvature + altitude) * math.cos(phi)
    up = (curvature * (b / a) ** 2 + altitude) * math.sin(phi)
    return from_axis * math.cos(theta), from_axis * math.sin(theta), up
