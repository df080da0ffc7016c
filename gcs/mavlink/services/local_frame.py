"""Conversions from a sample in the north-east-down frame to what MAVLink's integer and geodetic fields hold."""

import math
from typing import Protocol

from idc_controller.rotations_float import Quaternion, Vector


class Motion(Protocol):
    """A sample of an aircraft's motion.

    ``time`` in s; ``attitude`` unit quaternion body to world, w first; ``rates`` in the body frame (rad/s);
    ``position`` (m) and ``velocity`` (m/s) in the local frame, NED.
    """

    @property
    def time(self) -> float: ...  # noqa: D102
    @property
    def attitude(self) -> Quaternion: ...  # noqa: D102
    @property
    def rates(self) -> Vector: ...  # noqa: D102
    @property
    def position(self) -> Vector: ...  # noqa: D102
    @property
    def velocity(self) -> Vector: ...  # noqa: D102


class Origin(Protocol):
    """Origin of a local frame: latitude and longitude (deg), altitude above mean sea level (m)."""

    @property
    def latitude(self) -> float: ...  # noqa: D102
    @property
    def longitude(self) -> float: ...  # noqa: D102
    @property
    def altitude(self) -> float: ...  # noqa: D102


Place = tuple[int, int, int]
"""Latitude and longitude (1e-7 deg), altitude (mm)."""

_ORIGIN: Vector = (0.0, 0.0, 0.0)

# The ellipsoid of WGS 84.
_EQUATORIAL_RADIUS = 6378137.0  # m
_FLATTENING = 1.0 / 298.257223563
_POLAR_RADIUS = _EQUATORIAL_RADIUS * (1.0 - _FLATTENING)
_ECCENTRICITY_SQUARED = _FLATTENING * (2.0 - _FLATTENING)
_SECOND_ECCENTRICITY_SQUARED = _ECCENTRICITY_SQUARED / (1.0 - _ECCENTRICITY_SQUARED)


class LocalFrame:
    """The north-east-down frame at a home on the ellipsoid of WGS 84."""

    def __init__(self, home: Origin) -> None:
        self.origin: Place = round(home.latitude * 1e7), round(home.longitude * 1e7), round(home.altitude * 1e3)
        self._longitude, self.altitude = home.longitude, home.altitude
        latitude = math.radians(home.latitude)
        self._sin, self._cos = math.sin(latitude), math.cos(latitude)
        normal = _EQUATORIAL_RADIUS / math.sqrt(1.0 - _ECCENTRICITY_SQUARED * self._sin**2)
        self._from_axis = (normal + home.altitude) * self._cos
        self._above_equator = (normal * (1.0 - _ECCENTRICITY_SQUARED) + home.altitude) * self._sin

    def geodetic(self, north: float, east: float, down: float) -> tuple[float, float, float]:
        """Return latitude and longitude (deg), altitude (m) of a position (m).

        Bowring's formula: near the ground exact to a nanometre.
        """
        # Earth-fixed, with home's meridian in the plane of x and z.
        x = self._from_axis - self._sin * north - self._cos * down
        z = self._above_equator + self._cos * north - self._sin * down
        from_axis = math.hypot(x, east)
        reduced = math.atan2(_EQUATORIAL_RADIUS * z, _POLAR_RADIUS * from_axis)
        latitude = math.atan2(
            z + _SECOND_ECCENTRICITY_SQUARED * _POLAR_RADIUS * math.sin(reduced) ** 3,
            from_axis - _ECCENTRICITY_SQUARED * _EQUATORIAL_RADIUS * math.cos(reduced) ** 3,
        )
        sin, cos = math.sin(latitude), math.cos(latitude)
        altitude = from_axis * cos + z * sin - _EQUATORIAL_RADIUS * math.sqrt(1.0 - _ECCENTRICITY_SQUARED * sin * sin)
        longitude = self._longitude + math.degrees(math.atan2(east, x))
        return math.degrees(latitude), math.remainder(longitude, 360.0), altitude

    def local(self, latitude: float, longitude: float, altitude: float) -> tuple[float, float, float]:
        """Return the position (NED, m) of latitude and longitude (deg) and altitude (m): the inverse of geodetic."""
        phi, turn = math.radians(latitude), math.radians(longitude - self._longitude)
        sin = math.sin(phi)
        normal = _EQUATORIAL_RADIUS / math.sqrt(1.0 - _ECCENTRICITY_SQUARED * sin * sin)
        from_axis = (normal + altitude) * math.cos(phi)
        x = from_axis * math.cos(turn) - self._from_axis
        z = (normal * (1.0 - _ECCENTRICITY_SQUARED) + altitude) * sin - self._above_equator
        return self._cos * z - self._sin * x, from_axis * math.sin(turn), -self._cos * x - self._sin * z

    def place_of(self, measured: Motion) -> Place:
        """Return the place of a sample."""
        return self.place(measured.position)

    def place(self, position: Vector) -> Place:
        """Return the place of a position (NED, m)."""
        if position == _ORIGIN:
            return self.origin
        latitude, longitude, altitude = self.geodetic(*position)
        return clamp(latitude * 1e7, 32), clamp(longitude * 1e7, 32), clamp(altitude * 1e3, 32)


def is_finite(measured: Motion) -> bool:
    """Return True if every number of a sample is finite."""
    return math.isfinite(sum(measured.attitude) + sum(measured.rates) + sum(measured.position) + sum(measured.velocity))


def clamp(value: float, bits: int) -> int:
    """Return the nearest integer of so many bits: a value out of range must not stop the telemetry."""
    limit = (1 << (bits - 1)) - 1
    return round(min(max(value, -limit), limit))
