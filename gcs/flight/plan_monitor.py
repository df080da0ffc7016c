"""What vehicles and payload report of themselves, which no estimate filters: places off the plan, and impacts."""

import math
import statistics
from collections.abc import Sequence

import numpy as np

from gcs.config.flight_settings import DEFAULTS, FailsafeSettings
from gcs.mavlink.vehicle_link import VehicleLink
from idc_controller.arrays import Array
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Measurement, Position

_OVERTURNED_SAMPLES = 3
"""Attitudes in a row by which the payload's unit reports it overturned: one may be damaged."""


class PlanMonitor:
    """Reports of one flight and the plan. Times are the team's (s).

    A wreck is known by those who do not share a fault: half of the vehicles far from their places in the plan, or the
    payload's own unit together with one vehicle that is not where a level payload would have it.
    """

    def __init__(self, number_of_uavs: int, settings: FailsafeSettings = DEFAULTS.failsafe) -> None:
        self._settings = settings
        self._positions: list[Position | None] = [None] * number_of_uavs
        self._overturned = 0
        self._off_since = math.inf
        self.deviations = np.zeros(number_of_uavs)
        """Distance of each vehicle's reported position from its place in the plan (N,) (m), nan: not known."""
        self._payload_down = math.nan

    def add(self, measurement: Measurement) -> None:
        """Take telemetry as it was sent."""
        if not measurement.has_pose:
            return
        if isinstance(measurement, Position):
            if measurement.source != PAYLOAD:
                self._positions[measurement.source] = measurement
        elif isinstance(measurement, Attitude) and measurement.source == PAYLOAD:
            _, x, y, _ = measurement.pose.tolist()
            tilt = math.acos(min(max(1.0 - 2.0 * (x * x + y * y), -1.0), 1.0))
            self._overturned = self._overturned + 1 if tilt > self._settings.tilt_limit else 0

    def below_plan(self, down: float) -> float:
        """Return how far a payload at ``down`` (m) is below its place in the last plan (m); nan: there is none."""
        return float(down - self._payload_down)

    def compare(self, time: float, places: Array, contradicted: bool = False, payload_down: float = math.nan) -> None:
        """Take the vehicles' ``places`` in the plan (N, 3) (NED, m) at ``time`` (s); once a control step.

        ``payload_down``: of the payload in it (m).

        ``contradicted``: the vehicles' positions do not follow from their velocities, while the payload's do. They say
        nothing of the plan then; those of a wreck follow from them.
        """
        self._payload_down = payload_down
        for i, (position, place) in enumerate(zip(self._positions, places, strict=True)):
            self.deviations[i] = math.nan
            if (
                position is not None
                and not contradicted
                and abs(time - position.time) < self._settings.telemetry_timeout
            ):
                moved = (time - position.time) * position.motion if position.has_motion else 0.0
                self.deviations[i] = np.linalg.norm(position.pose + moved - place)
        known = self.deviations[~np.isnan(self.deviations)]
        is_off = len(known) > 1 and statistics.median(known.tolist()) > self._settings.deviation_limit
        self._off_since = min(self._off_since, time) if is_off else math.inf

    def is_off(self, time: float) -> bool:
        """Return whether half of the vehicles have been far from their places in the plan for some time."""
        return time - self._off_since >= self._settings.deviation_time

    @property
    def is_overturned(self) -> bool:
        """Return whether the payload's unit reports it overturned, and a vehicle confirms it."""
        confirmed = bool((self.deviations > self._settings.confirming_deviation).any())
        return self._overturned >= _OVERTURNED_SAMPLES and confirmed


class ImpactMonitor:
    """Counts of clipping that vehicles and payload unit report, against those of when the ground was last touched."""

    def __init__(self, links: Sequence[VehicleLink]) -> None:
        self.links = links
        self._on_ground: list[int | None] = []

    def impacts(self, *, clear: bool) -> list[int]:
        """Return whose accelerometer has clipped since the payload became ``clear`` of the ground.

        0 .. N - 1 the vehicles', N the payload unit's. Call once a control step.
        """
        counts = [link.status.clipping for link in self.links]
        of_payload = [count for link in self.links if (count := link.status.payload_clipping) is not None]
        counts.append(max(of_payload, default=None))
        if not clear or not self._on_ground:  # touching the ground is an impact, too
            self._on_ground = counts
        # A count that is first reported in the air may be of flights before.
        self._on_ground = [c if before is None else before for c, before in zip(counts, self._on_ground, strict=True)]
        both = zip(counts, self._on_ground, strict=True)
        return [
            i for i, (count, before) in enumerate(both) if count is not None and before is not None and count > before
        ]
