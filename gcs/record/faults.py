"""Faults in the records of a run folder."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from gcs.errors import UnusableInput
from gcs.record.reader import read_json

FAULTS_FILE = "faults.json"


def fault_notes(run_dir: Path) -> list[str]:
    """Return a line for every fault whose time never came, or that found nothing to disturb; none without a record."""
    try:
        return notes_of(read_json(run_dir / FAULTS_FILE))
    except (UnusableInput, KeyError, TypeError):
        return []


def notes_of(record: Mapping[str, Any]) -> list[str]:
    """Return the same from the contents of the file."""
    notes = []
    take_off = record["take_off_s"]
    for fault in record["faults"]:
        who = f"fault {fault['number']}, {fault['kind']} (line {fault['line']} of the mission)"
        phase = fault.get("start_phase")
        if phase is not None and not fault["occurrences"]:
            entered = (record.get("phases_s") or {}).get(phase)
            when = "was not entered" if entered is None else f"began at {entered:.1f} s"
            start = f"it was to start {fault['start']:g} s into {phase}, which {when}"
            notes.append(f"{who}, never came: {start}, and the end was at {record['end_s']:.1f} s")
        elif take_off is None and phase is None:
            notes.append(f"{who}, never came: nothing took off")
        elif not fault["occurrences"]:
            flown = record["end_s"] - take_off
            start = f"it was to start {fault['start']:g} s after take-off"
            notes.append(f"{who}, never came: {start}, and the end was at {flown:.1f} s")
        elif not fault["disturbed"]:
            what = f"of {fault['seen']} datagrams or samples none was changed" if fault["seen"] else "nothing passed it"
            notes.append(f"{who}, disturbed nothing: {what}")
    return notes
