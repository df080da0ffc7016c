"""The table of detection: fault x source, with the delay of the first alarm, and the limits that it is held to."""

import statistics
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from gcs.campaign.faults.cases import Seeds
from gcs.campaign.faults.sources import ISOLATIONS, NONE
from gcs.campaign.result import Result
from gcs.config.validate import Positive, strict
from gcs.mission.model import Name


@strict
@dataclass(frozen=True)
class DetectionRow:
    """``[[row]]`` of a campaign: the cases of a row, and the limits (s) of their delays; with one, all are detected.

    A case is named by its fault, which stands for all of its severities, or as ``fault: severity``. ``seeds``: of its
    flights, in place of the campaign's.
    """

    name: Name
    faults: Annotated[tuple[Name, ...], Field(min_length=1, max_length=1000)]
    median: Positive | None = None
    worst: Positive | None = None
    seeds: Seeds | None = None


@dataclass(frozen=True)
class Detections:
    """The flights of a row. Delays (s) are from the start of the fault to the first alarm.

    The delay of a random fault is a draw: median and worst are those of the middle seed, each by itself, the medians of
    what every seed has.
    """

    fault: str
    true_source: str
    flights: int
    right: int
    ambiguous: int
    wrong: int
    none: int
    named_wrongly: str
    first_alarms: str
    median_s: float | None
    worst_s: float | None
    latest_s: float | None
    """Of all seeds."""
    median_limit_s: float | None
    worst_limit_s: float | None

    @property
    def problems(self) -> Iterator[str]:
        """The limits that are not held, compared as they are printed."""
        limits = (("median", self.median_s, self.median_limit_s), ("worst", self.worst_s, self.worst_limit_s))
        if self.none and any(limit is not None for _, _, limit in limits):
            yield f"{self.fault}: {self.none} of {self.flights} not detected"
        for name, delay, limit in limits:
            if delay is not None and limit is not None and float(seconds(delay)) > limit:
                yield f"{self.fault}: detected within {seconds(delay)} s ({name}; limit {seconds(limit)} s)"


def case_name(fault: str, severity: str) -> str:
    """Return the name of a case at one severity."""
    return f"{fault}: {severity}" if severity else fault


def row_of(rows: Sequence[DetectionRow], fault: str, severity: str) -> DetectionRow:
    """Return the row of a case; each fault that no row names, at the severities that none does, is its own."""
    named = (row for name in (case_name(fault, severity), fault) for row in rows if name in row.faults)
    return next(named, DetectionRow(fault, (fault,)))


def detections(rows: Sequence[DetectionRow], results: Sequence[Result]) -> list[Detections]:
    """Return the rows that were flown."""
    flown: dict[DetectionRow, list[Result]] = {row: [] for row in rows}
    for result in results:
        if result.isolation:
            flown.setdefault(row_of(rows, result.fault, result.severity), []).append(result)
    return [_row(row, group) for row, group in flown.items() if group]


def _row(row: DetectionRow, group: Sequence[Result]) -> Detections:
    count = Counter(result.isolation for result in group)
    delays: dict[int, list[float]] = {}
    for result in group:
        if result.detected_s is not None:
            delays.setdefault(result.seed, []).append(result.detected_s)
    return Detections(
        fault=row.name,
        true_source="; ".join(dict.fromkeys(result.true_source for result in group)),
        flights=len(group),
        **{verdict: count[verdict] for verdict in ISOLATIONS},
        named_wrongly="; ".join(dict.fromkeys(result.named_source for result in group if result.named_source)),
        first_alarms=_codes(group),
        median_s=statistics.median(map(statistics.median, delays.values())) if delays else None,
        worst_s=statistics.median(map(max, delays.values())) if delays else None,
        latest_s=max(map(max, delays.values()), default=None),
        median_limit_s=row.median,
        worst_limit_s=row.worst,
    )


def _codes(group: Sequence[Result]) -> str:
    """Return the codes of the first alarms, the most frequent first."""
    found = Counter(result.detected_as.split(",")[0] for result in group if result.isolation != NONE)
    return ", ".join(code for code, _ in found.most_common())


def seconds(time: float) -> str:
    """Return a time (s) to two digits, and to no more than 0.01 s."""
    return f"{time:.{2 if time < 0.995 else 1 if time < 9.95 else 0}f}"
