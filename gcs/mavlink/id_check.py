"""Detection of swapped system ids: by configuration, cabling or a router, two vehicles may send as each other.

Their telemetry is plausible in itself, and a loop that is closed over it pushes both vehicles in the wrong direction.
Their positions show it: each is at the other's estimate.
"""

import math

from gcs.mavlink.settings import IdCheckSettings
from idc_controller.arrays import Array
from idc_controller.estimation.measurements import PAYLOAD, Measurement, Position


class SystemIdCheck:
    """Check of the telemetry of N vehicles, 0 .. N-1."""

    def __init__(self, number_of_uavs: int, settings: IdCheckSettings | None = None) -> None:
        self._settings = settings or IdCheckSettings()
        self._vehicle_of = list(range(number_of_uavs))
        self._positions: dict[int, list[float]] = {}
        self._suspected: dict[int, int] = {}
        self._steps = 0

    def vehicle_of(self, sender: int) -> int:
        """Return the vehicle that sends as ``sender``."""
        return self._vehicle_of[sender]

    @property
    def swapped(self) -> dict[int, int]:
        """Senders that are another vehicle, and that vehicle."""
        return {sender: vehicle for sender, vehicle in enumerate(self._vehicle_of) if vehicle != sender}

    def add(self, sample: Measurement) -> None:
        """Take a sample that was received as of the vehicle that is its source."""
        if sample.source != PAYLOAD and isinstance(sample, Position) and sample.has_pose:
            self._positions[sample.source] = sample.pose.tolist()

    def compare(self, places: Array) -> None:
        """Compare the samples since the last time with the estimated ``places`` (N, 3); once a control step."""
        found = _swapped(self._positions, places.tolist(), self._settings.distance_ratio)
        self._positions = {}
        self._steps = self._steps + 1 if found and found == self._suspected else int(bool(found))
        self._suspected = found
        if self._steps >= self._settings.steps:
            self._vehicle_of = [found.get(vehicle, vehicle) for vehicle in self._vehicle_of]
            self._suspected, self._steps = {}, 0


def _swapped(positions: dict[int, list[float]], places: list[list[float]], distance_ratio: float) -> dict[int, int]:
    """Return vehicles whose ``positions`` are at each other's ``places`` (N, 3), and at which; otherwise none."""
    at = {}
    for vehicle, position in positions.items():
        away = [math.dist(position, place) for place in places]
        nearest = away.index(min(away))
        if away[nearest] * distance_ratio < away[vehicle]:
            at[vehicle] = nearest
    return at if set(at) == set(at.values()) else {}
