"""One telemetry log for each vehicle and one for the payload unit, from that of the run."""

from collections import defaultdict
from pathlib import Path

from gcs.view.export.output import write_file
from gcs.view.export.systems import file_stem, is_of_team, nothing_recorded
from gcs.view.export.tlog_records import records


def export_tlog(run_dir: Path) -> list[Path]:
    """Write the logs into the run folder, and return their paths.

    Each has the messages of its system, those of the payload unit as often as vehicles forwarded them, and what other
    systems sent to it by its id. Raises :class:`gcs.errors.UnusableInput`.
    """
    logs: dict[int, list[bytes]] = defaultdict(list)
    senders = set()
    for record in records(run_dir):
        senders.add(record.sender)
        for system in {record.sender, record.target}:
            if is_of_team(system):
                logs[system].append(record.record)
    systems = sorted(senders & logs.keys())
    if not systems:
        raise nothing_recorded(run_dir)
    return [write_file(run_dir / f"{file_stem(system)}.tlog", b"".join(logs[system])) for system in systems]
