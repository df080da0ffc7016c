"""False alarms per flight hour: of flights without a fault, and of others until their first."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from scipy.stats import chi2

from gcs.campaign.faults.cases import CLEAN
from gcs.campaign.result import Result

CONFIDENCE = 0.95
ALL = "all"


@dataclass(frozen=True)
class FalseAlarms:
    """Flights of one mission: before any fault ``alarms`` in ``flights_with_alarms`` of them, in ``hours``.

    ``per_hour_bound``: upper bound of the rate at :data:`CONFIDENCE`.
    """

    mission: str
    flights: int
    hours: float
    alarms: int
    flights_with_alarms: int
    codes: str
    per_hour: float
    per_hour_bound: float
    not_counted: int
    """Flights without a record of their alarms or of their duration."""


def false_alarms(results: Sequence[Result]) -> list[FalseAlarms]:
    """Return a row for each mission, flown without a fault or until the first, then one of all of them."""
    groups: dict[str, list[Result]] = {}
    for result in sorted(results, key=lambda result: result.fault != CLEAN):
        what = result.mission if result.fault == CLEAN else f"{result.mission}, until the fault"
        groups.setdefault(what, []).append(result)
    if len(groups) > 1:
        groups[ALL] = [result for group in groups.values() for result in group]
    return [_row(mission, group) for mission, group in groups.items()]


def _row(mission: str, group: Sequence[Result]) -> FalseAlarms:
    known = [(r.clean_s, r.false_alarms) for r in group if r.clean_s is not None and r.false_alarms is not None]
    hours = sum(time for time, _ in known) / 3600.0
    alarms = sum(number for _, number in known)
    rate = alarms / hours if hours else 0.0
    with_alarms = sum(number > 0 for _, number in known)
    bound = upper_bound(alarms, hours)
    codes = Counter(code for result in group for code in result.false_codes.split())
    named = ", ".join(f"{number} {code}" for code, number in codes.most_common())
    return FalseAlarms(mission, len(known), hours, alarms, with_alarms, named, rate, bound, len(group) - len(known))


def upper_bound(events: int, exposure: float) -> float:
    """Return the exact upper bound of a Poisson rate, at :data:`CONFIDENCE`, after ``events`` in ``exposure``."""
    return float(chi2.ppf(CONFIDENCE, 2 * (events + 1)) / 2.0 / exposure) if exposure > 0.0 else float("inf")
