"""Replay of late measurements: they are kept in order of their time, with snapshots of the filter to return to."""

import bisect
import math
from dataclasses import dataclass
from operator import attrgetter
from typing import NamedTuple

from idc_controller.arrays import Array
from idc_controller.estimation.health.sensor_health import HealthSnapshot
from idc_controller.estimation.measurements import PAYLOAD, Measurement, SensorKey


@dataclass
class Moment:
    """Measurements of one ``time`` (s) by source and kind; of the payload with all relayed copies."""

    time: float
    measurements: dict[SensorKey, list[Measurement]]


class MeasurementHistory:
    """Moments, the earliest first. Times in s."""

    def __init__(self, simultaneous: float) -> None:
        """``simultaneous``: measurements closer than this (s) are of one moment."""
        self._simultaneous = simultaneous
        self._times: list[float] = []
        self._moments: list[Moment] = []

    def add(self, measurement: Measurement, applied: float) -> float | None:
        """Add one; return the time of its moment, or None if it adds nothing to what was ``applied`` until then (s)."""
        time, times = measurement.time, self._times
        at = bisect.bisect_left(times, time - self._simultaneous)
        if at == len(times) or times[at] > time + self._simultaneous:
            times.insert(at, time)
            self._moments.insert(at, Moment(time, {}))
        moment, key = self._moments[at], (measurement.source, type(measurement))
        copies = moment.measurements.get(key)
        if copies is None:
            moment.measurements[key] = [measurement]
        elif measurement.source == PAYLOAD and moment.time <= applied:
            return None  # another vehicle's relay of what was applied already
        else:
            copies.append(measurement)
        return moment.time

    def after(self, time: float) -> list[Moment]:
        """Return the moments after ``time`` (s)."""
        return self._moments[bisect.bisect_right(self._times, time) :]

    def has(self, key: SensorKey, since: float) -> bool:
        """Return whether there is a measurement of a source and kind after ``since`` (s)."""
        return any(key in moment.measurements for moment in self.after(since))

    def forget(self, until: float) -> None:
        """Discard all moments until that time (s)."""
        old = bisect.bisect_right(self._times, until)
        del self._times[:old], self._moments[:old]


class Snapshot(NamedTuple):
    """The filter after the measurements of one time (s)."""

    time: float
    x: Array
    """Absolute state (n,)."""
    P: Array
    """(n, n)"""
    health: HealthSnapshot


class ReplayBuffer:
    """Measurements and snapshots of the last ``duration`` (s)."""

    def __init__(self, duration: float, simultaneous: float) -> None:
        """``simultaneous``: measurements closer than this (s) are of one moment."""
        self._duration, self._simultaneous = duration, simultaneous
        self.measurements = MeasurementHistory(simultaneous)
        self.snapshots: list[Snapshot] = []

    def start(self, first: Snapshot) -> None:
        """Discard all and begin with a snapshot."""
        self.measurements = MeasurementHistory(self._simultaneous)
        self.snapshots = [first]

    @property
    def time(self) -> float:
        """Time of the last measurement that was applied (s); -inf before the start."""
        return self.snapshots[-1].time if self.snapshots else -math.inf

    def add(self, measurement: Measurement) -> bool:
        """Add a measurement and return to before it; returns False for one that is too old."""
        applied = self.snapshots[-1].time
        if measurement.time <= self.snapshots[0].time or measurement.time <= applied - self._duration:
            return False
        moment = self.measurements.add(measurement, applied)
        if moment is not None and moment <= applied:
            self.rewind(moment)
        return True

    def rewind(self, time: float) -> None:
        """Return to before ``time`` (s), as far as there are snapshots."""
        while len(self.snapshots) > 1 and self.snapshots[-1].time >= time:
            self.snapshots.pop()

    def pending(self) -> list[Moment]:
        """Return the moments that are not applied yet."""
        return self.measurements.after(self.time)

    def forget(self) -> float:
        """Discard what is older than the duration; return the oldest time that is left (s)."""
        horizon = self.time - self._duration
        keep = max(bisect.bisect_right(self.snapshots, horizon, key=attrgetter("time")) - 1, 0)
        del self.snapshots[:keep]
        oldest = self.snapshots[0].time
        self.measurements.forget(oldest)
        return oldest
