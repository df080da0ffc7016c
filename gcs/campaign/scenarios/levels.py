"""Levels of evidence: all courses on the planning level, and those that nearly fail in full, within a budget of CPU."""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor

from rich.console import Console, RenderableType
from rich.text import Text
from scipy.stats import binomtest

from gcs.campaign.engine import Campaign
from gcs.campaign.flight import FlightPlan
from gcs.campaign.progress import fly_with_progress
from gcs.campaign.result import Result
from gcs.campaign.tables import extreme, text_table

CONFIDENCE = 0.95
COST = 3.0
"""CPU time of a full flight in that of planning, as long as none has been flown."""
SHOWN = 20


def fly_levels(planning: Campaign, full: Campaign, budget: float | None, executor: Executor, console: Console) -> None:
    """Fly all of ``planning``, then of the same courses in ``full`` what ``budget`` holds (see :func:`affordable`)."""
    fly_with_progress(planning, executor, console)
    while chosen := affordable(full.plans, planning.results, full.results, budget):
        fly_with_progress(full, executor, console, chosen)


def affordable(
    plans: Sequence[FlightPlan], planned: Sequence[Result], full: Sequence[Result], budget: float | None
) -> list[FlightPlan]:
    """Return the flights to be flown in full next, the least planned clearance first.

    Those that ``budget`` (s of CPU time, of both levels together; None: any) is expected to hold, at the cost of what
    has been flown so far.
    """
    flown = {result.name: result for result in full}
    by_name = {result.name: result for result in planned}
    waiting = sorted((plan for plan in plans if plan.name not in flown), key=lambda plan: nearness(by_name[plan.name]))
    if budget is None:
        return waiting
    of_planning = sum(cost(by_name[name]) for name in flown)
    ratio = sum(map(cost, full)) / of_planning if of_planning else COST
    left = budget - sum(map(cost, [*planned, *full]))
    chosen = []
    for plan in waiting:
        left -= ratio * cost(by_name[plan.name])
        if left < 0.0:
            break
        chosen.append(plan)
    return chosen


def nearness(result: Result) -> tuple[float, int]:
    """Return by what courses are ordered, those that nearly fail first."""
    return (float("inf") if result.clearance_min_m is None else result.clearance_min_m), result.number


def contact_bound(contacts: int, flights: int) -> float:
    """Return the upper bound of the rate of contacts (:data:`CONFIDENCE`, one-sided, by Clopper and Pearson)."""
    if not flights:
        return 1.0
    return float(binomtest(contacts, flights, alternative="less").proportion_ci(CONFIDENCE, "exact").high)


def undecided(planned: Sequence[Result], full: Sequence[Result]) -> list[Result]:
    """Return the courses of the planning level alone, those that nearly fail first."""
    flown = {result.name for result in full}
    return sorted((result for result in planned if result.name not in flown), key=nearness)


def levels_report(planned: Sequence[Result], full: Sequence[Result]) -> list[RenderableType]:
    """Return both levels in a table, verdicts that differ, and what was not decided with its bound of contacts."""
    parts: list[RenderableType] = [text_table([_row("planning", planned), _row("full", full)], left=("level",))]
    parts += [Text(line, "red") for line in differences(planned, full)]
    if left := undecided(planned, full):
        nearer = {result.name for result in planned if nearness(result) < nearness(left[0])}
        contacts = [bool(result.contacts) for result in full if result.name in nearer]
        bound = contact_bound(sum(contacts), len(contacts))
        parts.append(Text(
            f"{len(left)} not decided, with {_clearance(left)} or more of planned clearance. Contacts in full flights "
            f"of less: {sum(contacts)} of {len(contacts)}. If more planned clearance makes none likelier, at most "
            f"{bound:.1%} of those not decided have one ({CONFIDENCE:.0%}, Clopper-Pearson):"
        ))  # fmt: skip
        parts += [Text(f"  {course.name}: {_verdict(course)}, {_clearance([course])}") for course in left[:SHOWN]]
        if len(left) > SHOWN:
            parts.append(Text(f"  ... and {len(left) - SHOWN} more"))
    return parts


def differences(planned: Sequence[Result], full: Sequence[Result]) -> list[str]:
    """Return the courses whose verdicts differ, a line each."""
    flown = {result.name: result for result in full}
    pairs = [(result, flown[result.name]) for result in planned if result.name in flown]
    return [
        f"{plan.name}: {_verdict(plan)} by planning, {_clearance([plan])}; in full {_verdict(flight)}, "
        f"{_clearance([flight])}"
        for plan, flight in pairs
        if plan.passed != flight.passed
    ]


def _row(level: str, results: Sequence[Result]) -> Mapping[str, str]:
    return {
        "level": level,
        "flown": str(len(results)),
        "passed": str(sum(result.passed for result in results)),
        "contacts": str(sum(bool(result.contacts) for result in results)),
        "least clearance": _clearance(results),
        "CPU": f"{sum(map(cost, results)) / 60.0:.1f} min",
    }


def _clearance(results: Sequence[Result]) -> str:
    return extreme(results, "clearance_min_m", min, 2, "m")


def _verdict(result: Result) -> str:
    return "passed" if result.passed else f"failed ({result.failures})"


def cost(result: Result) -> float:
    """Return the CPU time of a flight (s), or the wall time of one without a summary."""
    return result.wall_s if result.cpu_s is None else result.cpu_s
