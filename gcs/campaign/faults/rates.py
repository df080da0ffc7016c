"""The rates of success of a campaign of faults, with their confidence intervals."""

from collections.abc import Sequence
from dataclasses import dataclass

from scipy.stats import binomtest

from gcs.campaign.faults.judgement import is_safe
from gcs.campaign.result import Result

CONFIDENCE = 0.95


@dataclass(frozen=True)
class Rates:
    """Counts of all flights with one fault at one severity, and rates with the ends of their Wilson intervals.

    ``safe``: set down without contact, in any phase.
    """

    fault: str
    kind: str
    level: int
    severity: str
    flights: int
    within_limits: int
    within_limits_rate: float
    within_limits_low: float
    within_limits_high: float
    safe: int
    safe_rate: float
    safe_low: float
    safe_high: float


def rates_of(results: Sequence[Result]) -> list[Rates]:
    """Return the rates of each fault and severity that was flown, in the order of the results."""
    groups: dict[tuple[str, int], list[Result]] = {}
    for result in results:
        groups.setdefault((result.fault, result.level), []).append(result)
    rates = []
    for group in groups.values():
        first, count = group[0], len(group)
        within = sum(result.within_limits for result in group)
        safe = sum(is_safe(result) for result in group)
        rates.append(
            Rates(
                first.fault, first.kind, first.level, first.severity, count,
                within, within / count, *interval(within, count), safe, safe / count, *interval(safe, count),
            )
        )  # fmt: skip
    return rates


def interval(successes: int, trials: int) -> tuple[float, float]:
    """Return Wilson's confidence interval of a rate, at :data:`CONFIDENCE`."""
    found = binomtest(successes, trials).proportion_ci(confidence_level=CONFIDENCE, method="wilson")
    return float(found.low), float(found.high)
