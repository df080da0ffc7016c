"""The verdict on a flight: its outcome and the reason for it, by the truth where there is one, else by the ground."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from gcs.mission.targets import Targets
from gcs.record.arrival import Arrival, arrival
from gcs.record.landing import TOUCHDOWN_SPEED, UPRIGHT_DEG, is_set_down, landing_figures
from gcs.record.outcome import Outcome
from gcs.record.run_data import RunData

_SEEN = re.compile(r"\b(?:piece|track) \d")
"""Names that the ground gives to what its sensors see."""
_NEAR = 0.05
"""m, within which bodies count as those that touched: they are pushed apart by the next row."""


@dataclass(frozen=True)
class GroundReport:
    """What the ground says of a flight that has ended."""

    begun: bool
    """Take-off had begun."""
    completed: bool
    """The whole mission was flown, and every vehicle disarmed."""
    landed: bool
    """Every vehicle reported that it is disarmed."""
    interrupted: bool
    reason: str
    """Why it was ended early; empty: it was not."""
    ended_at: float = math.nan
    """When it was ended early (s, the clock of the tables)."""


@dataclass(frozen=True)
class Verdict:
    """How a flight ended, why (empty when completed), and where it arrived; None: it did not come to its end."""

    outcome: Outcome
    reason: str
    arrival: Arrival | None


def verdict(
    run: RunData, ground: GroundReport, targets: Targets | None, tolerance: float, landing_on_record: bool = True
) -> Verdict:
    """Return the verdict on a flight that was to reach ``targets`` within ``tolerance`` (m); None: not checked.

    ``landing_on_record``: the records of the truth did not end before the flight.
    """
    landing = landing_figures(run) if landing_on_record else None
    arrived = arrival(run, targets, tolerance) if ground.completed and targets is not None else None
    missed = "" if arrived is None else str(arrived)
    outcome = _outcome(run, ground, landing, bool(missed))
    first = ""
    match outcome:
        case Outcome.COLLIDED:
            first = contact(run)
        case Outcome.LOST:
            first = f"the vehicles are not known to be on the ground: the records end at {_end(run)}"
        case Outcome.FAILED:
            first = _not_set_down(landing)
    early = ground.reason + _identified(run, ground)
    reason = "; ".join(part for part in (first, early, missed) if part)
    return Verdict(outcome, "" if outcome is Outcome.COMPLETED else reason or "ended early", arrived)


def _outcome(run: RunData, ground: GroundReport, landing: Mapping[str, Any] | None, missed: bool) -> Outcome:
    """Return how a flight ended; of several that hold, the worst for those on the spot counts."""
    # The ground may have lost its link to the vehicles, or be wrong about them.
    on_ground = ground.landed or bool(landing and landing["on_ground"])
    set_down = ground.landed if landing is None else is_set_down(landing)
    if run.contacts is not None and run.contacts.any():
        return Outcome.COLLIDED
    if ground.begun and not on_ground:
        return Outcome.LOST
    if ground.begun and not set_down:
        return Outcome.FAILED
    if ground.interrupted:
        return Outcome.INTERRUPTED
    if ground.reason or not ground.completed or not ground.begun:
        return Outcome.ABORTED
    return Outcome.FAILED if missed else Outcome.COMPLETED


def _identified(run: RunData, ground: GroundReport) -> str:
    """Return which obstacle of the truth the ground's reason calls by a number of its own; empty: unknown."""
    if not _SEEN.search(ground.reason) or not run.obstacles or not run.number_of_uavs:
        return ""
    row = min(int(np.searchsorted(run.time, ground.ended_at)), len(run.time) - 1)
    clearance = np.nan_to_num(run.clearances(slice(row, row + 1))[0, : len(run.obstacles)], nan=np.inf)
    nearest = int(np.argmin(clearance))
    return f" (nearest then: {run.obstacles[nearest].name}, {clearance[nearest]:.2f} m from the formation)"


def contact(run: RunData) -> str:
    """Return what touched first and when, in words, by the truth; empty: nothing did."""
    if run.contacts is None or not run.contacts.any():
        return ""
    row = int(np.flatnonzero(run.contacts)[0])
    about = slice(max(row - 1, 0), row + 1)
    nearest = np.nan_to_num(run.clearances(about), nan=np.inf).min(axis=0)
    named = [track.name for track, clearance in zip(run.obstacles, nearest, strict=False) if clearance < _NEAR]
    discs = 2.0 * float(run.setting("uav", "disc_radius"))
    for i, j in combinations(range(run.number_of_uavs), 2):
        if np.linalg.norm(run.uav_position[about, i] - run.uav_position[about, j], axis=1).min() < discs + _NEAR:
            named.append(f"vehicles {i + 1} and {j + 1} each other")
    return f"contact at {run.time[row]:.1f} s: {' and '.join(named) or 'the ground, or each other'}"


def _not_set_down(landing: Mapping[str, Any] | None) -> str:
    """Return why a payload on the ground was not set down; empty: it was."""
    if landing is None or is_set_down(landing):
        return ""
    if landing["tilt_deg"] > UPRIGHT_DEG:
        return f"the payload ended tilted by {landing['tilt_deg']:.0f} deg (limit {UPRIGHT_DEG:g} deg)"
    if (speed := landing["speed_mps"]) is not None and speed >= TOUCHDOWN_SPEED:
        return f"the payload touched the ground at {speed:.2f} m/s (limit {TOUCHDOWN_SPEED:g} m/s)"
    return "the payload does not rest on the ground at the end of the records"


def _end(run: RunData) -> str:
    return f"{run.time[-1]:.1f} s" if len(run.time) else "their beginning"
