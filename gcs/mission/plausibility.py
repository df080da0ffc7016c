"""Notes on what no team flies: altitudes, distances and durations, and degrees in place of metres."""

import math

from gcs.mission.flown_legs import FlownLegs, flown_legs
from gcs.mission.model import Lissajous, Mission

HIGHEST = 120.0
"""m above the ground: up to there the open category of the EU (2019/947) and Part 107 of the FAA (400 ft) let fly."""
FARTHEST = 500.0
"""m from the pilot: about as far as a quadrotor is in sight, as both rules require."""
LONGEST = 1800.0
"""s: longer than a charge of a quadrotor lasts that carries a load."""
_DEGREES = 0.01
"""m between places that are degrees, at most; a hundred times the length of a real leg of 100 m in them."""


def implausible(mission: Mission) -> list[str]:
    """Return notes, one line each, on what of a mission no team flies."""
    if isinstance(mission.reference, Lissajous):
        farthest, highest = math.hypot(*mission.reference.amplitude), mission.reference.altitude
        return _notes((farthest, "the curve"), (highest, "the curve"), mission.reference.duration)
    flight = flown_legs(mission.reference, mission.system)
    far = max(flight.legs, key=lambda leg: math.hypot(leg.north, leg.east))
    high = max(flight.legs, key=lambda leg: leg.altitude)
    farthest = math.hypot(far.north, far.east)
    notes = _notes((farthest, far.source), (high.altitude, high.source), flight.time)
    if _is_in_degrees(flight):
        like = "all waypoints lie within 1 cm of each other, far from home"
        notes.append(f"{like}: are these degrees? Points are in metres")
    return notes


def _notes(farthest: tuple[float, str], highest: tuple[float, str], time: float) -> list[str]:
    notes = []
    if highest[0] > HIGHEST:
        notes.append(f"{highest[1]}: {highest[0]:.0f} m above home: most rules let fly up to {HIGHEST:g} m")
    if farthest[0] > FARTHEST:
        notes.append(f"{farthest[1]}: {farthest[0]:.0f} m from home: beyond about {FARTHEST:g} m it is out of sight")
    if time > LONGEST:
        notes.append(f"about {time / 60.0:.0f} min: a charge lasts less than {LONGEST / 60.0:g} min with a load")
    return notes


def _is_in_degrees(flight: FlownLegs) -> bool:
    """Return whether the waypoints look like latitudes and longitudes."""
    places = {(leg.north, leg.east) for leg in flight.legs if math.hypot(leg.north, leg.east) > 1.0}
    if len(places) < 2:
        return False
    norths, easts = zip(*places, strict=True)
    extent = max(max(norths) - min(norths), max(easts) - min(easts))
    return bool(extent < _DEGREES and max(map(abs, norths)) <= 90.0)
