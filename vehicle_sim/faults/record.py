"""Record of the faults of a flight: ``faults.json`` in the run folder."""

from pathlib import Path
from typing import Any

from gcs.record.faults import FAULTS_FILE
from gcs.record.run_folder import write_json
from vehicle_sim.faults.fault_injector import FaultInjector

_LISTED = 1000  # occurrences that are listed


def record_faults(folder: Path, injector: FaultInjector, end: float) -> Path:
    """Write the file; ``end`` of the flight in s. Raises :class:`gcs.record.run_folder.UnwritableFile`."""
    return write_json(folder / FAULTS_FILE, faults_record(injector, end))


def faults_record(injector: FaultInjector, end: float) -> dict[str, Any]:
    """Return the content of the file."""
    take_off = injector.faults[0].schedule.take_off if injector.faults else None
    return {
        "take_off_s": take_off,
        "end_s": end,
        "faults": [
            {
                "number": fault.number,
                "kind": fault.fault.kind,
                "line": fault.fault.line,
                "start": fault.fault.start,
                "vehicles": list(fault.vehicles) if fault.kind.of_vehicles else None,
                "direction": fault.direction,
                "occurrences": (happened := fault.schedule.occurrences(end, _LISTED))[0],
                "activations": happened[1],
                "seen": fault.seen,
                "disturbed": fault.disturbed,
            }
            for fault in injector.faults
        ],
    }
