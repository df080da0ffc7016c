"""The rates of success of a campaign of faults, with their confidence intervals."""

from collections.abc import Sequence
from typing import Any

from scipy.stats import binomtest

from gcs.campaign.faults.judgement import is_safe
from gcs.campaign.result import Result

CONFIDENCE = 0.95


def rates_of(results: Sequence[Result]) -> list[dict[str, Any]]:
    """Return a row for each fault and severity that was flown, in the order of the results.

    Of all flights, of those within their limits and of those that were ``safe``, set down without contact in any phase,
    the number; of these the rates, too, with the ends ``low`` and ``high`` of their Wilson intervals.
    """
    groups: dict[tuple[str, int], list[Result]] = {}
    for result in results:
        groups.setdefault((result.fault, result.level), []).append(result)
    return [_row(group) for group in groups.values()]


def _row(group: Sequence[Result]) -> dict[str, Any]:
    row = {**group[0].row(("fault", "kind", "level", "severity")), "flights": len(group)}
    for name, held in (("within_limits", sum(r.within_limits for r in group)), ("safe", sum(map(is_safe, group)))):
        low, high = interval(held, len(group))
        row |= {name: held, f"{name}_rate": held / len(group), f"{name}_low": low, f"{name}_high": high}
    return row


def interval(successes: int, trials: int) -> tuple[float, float]:
    """Return Wilson's confidence interval of a rate, at :data:`CONFIDENCE`."""
    found = binomtest(successes, trials).proportion_ci(confidence_level=CONFIDENCE, method="wilson")
    return float(found.low), float(found.high)
