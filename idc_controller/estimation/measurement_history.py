"""Measurements in the order of the time they were true, whenever they came."""

from __future__ import annotations

import bisect
from dataclasses import dataclass

from idc_controller.estimation.measurements import PAYLOAD, Measurement

Key = tuple[int, type]


@dataclass
class Moment:
    """What was measured at one ``time`` (s): by source and kind, of the payload with all relays of it."""

    time: float
    measurements: dict[Key, list[Measurement]]


class MeasurementHistory:
    """Moments, the earliest first. Times in s."""

    def __init__(self, simultaneous: float) -> None:
        """``simultaneous``: measurements closer than this (s) are of one moment."""
        self._simultaneous = simultaneous
        self._moments: list[Moment] = []

    def add(self, measurement: Measurement, applied: float) -> float | None:
        """Take one; returns the time of its moment, None where it adds nothing to what was ``applied`` until then."""
        time = measurement.time
        at = bisect.bisect_left(self._moments, time - self._simultaneous, key=_time_of)
        if at < len(self._moments) and self._moments[at].time <= time + self._simultaneous:
            moment = self._moments[at]
        else:
            moment = Moment(time, {})
            self._moments.insert(at, moment)
        copies = moment.measurements.setdefault((measurement.source, type(measurement)), [])
        if copies and measurement.source == PAYLOAD and moment.time <= applied:
            return None  # another vehicle's relay of what was applied already
        copies.append(measurement)
        return moment.time

    def after(self, time: float) -> list[Moment]:
        """Those after ``time``."""
        return self._moments[bisect.bisect_right(self._moments, time, key=_time_of) :]

    def has(self, key: Key, since: float) -> bool:
        """Whether there is anything of a source and kind after ``since``."""
        return any(key in moment.measurements for moment in self.after(since))

    def forget(self, until: float) -> None:
        """All until that time."""
        del self._moments[: bisect.bisect_right(self._moments, until, key=_time_of)]

    def clear(self) -> None:
        """All."""
        self._moments.clear()


def _time_of(moment: Moment) -> float:
    return moment.time
