"""When the ground station detected the faults of a flight, and its false alarms."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from gcs.errors import UnusableInput
from gcs.faults import KINDS
from gcs.faults.record import FAULTS_FILE
from gcs.record.tables import ALARMS, read_text_table


@dataclass(frozen=True)
class Detection:
    """``after`` (s): from the start of the case's first fault to the first alarm since; None: no alarm.

    ``alarm``: that alarm and its source. ``false``: alarms before the flight's first fault.
    """

    after: float | None
    alarm: str
    false: int | None


def first_start(run_dir: Path, count: int | None = None) -> float | None:
    """Return when the first of the last ``count`` faults of a flight (None: of all) came, in time of the tables (s).

    The faults before them are the mission's own; among them wind and load count only where nothing else is wrong.
    None: none came, or there is no record of them.
    """
    try:
        record = json.loads((run_dir / FAULTS_FILE).read_text(encoding="utf-8"))
        faults = record["faults"][0 if count is None else len(record["faults"]) - count :]
        if count is not None:
            faults = [fault for fault in faults if not _is_of_world(fault.get("kind"))] or faults
        starts = [fault["activations"][0][0] for fault in faults if fault["activations"]]
        return float(record["take_off_s"] + min(starts))
    except (OSError, ValueError, KeyError, TypeError, IndexError):
        return None


def _is_of_world(kind: str | None) -> bool:
    return kind in KINDS and KINDS[kind].family == "world"


def detection(run_dir: Path, count: int) -> Detection:
    """Return the detection of the last ``count`` faults of a flight, from its tables of alarms and faults."""
    try:
        alarms = read_text_table(run_dir / ALARMS)
        times = [float(time) for time in alarms["time_s"]]
    except (UnusableInput, ValueError, KeyError):
        return Detection(None, "", None)
    first, begin = first_start(run_dir), first_start(run_dir, count) if count else None
    false = sum(first is None or time < first for time in times)
    rows = ((t, f"{alarms['code'][i]}, {alarms['source'][i]}") for i, t in enumerate(times))
    found = min(
        (each for each in rows if begin is not None and each[0] >= begin), default=None, key=lambda each: each[0]
    )
    if begin is None or found is None:
        return Detection(None, "", false)
    return Detection(round(found[0] - begin, 3), found[1], false)
