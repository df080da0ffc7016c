"""Impacts in flight: accelerometers that clip while the payload is clear of the ground."""

from collections.abc import Sequence

from gcs.mavlink.vehicle_link import VehicleLink


class ImpactMonitor:
    """Counts of clipping that vehicles and payload unit report, against those of when the ground was last touched."""

    def __init__(self, links: Sequence[VehicleLink]) -> None:
        self.links = links
        self._on_ground: list[int] = []

    def impacts(self, *, clear: bool) -> list[int]:
        """Return whose accelerometer has clipped since the payload became ``clear`` of the ground.

        0 .. N - 1 the vehicles', N the payload unit's. Call once a control step.
        """
        counts = [link.status.clipping for link in self.links]
        counts.append(max(link.status.payload_clipping for link in self.links))
        if not clear or not self._on_ground:  # touching the ground is an impact, too
            self._on_ground = counts
        return [i for i, (count, before) in enumerate(zip(counts, self._on_ground, strict=True)) if count > before]
