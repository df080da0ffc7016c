"""One ULog for each vehicle and one for the payload, from the tables and the telemetry log of a run."""

from pathlib import Path

from gcs.mavlink.px4 import PAYLOAD_UNIT_SYSTEM
from gcs.record.run_data import RunData
from gcs.view.export.output import write_file
from gcs.view.export.systems import file_stem, nothing_recorded
from gcs.view.export.telemetry import read_telemetry
from gcs.view.export.topics import alarms_of, payload_topics, texts_of, vehicle_topics
from gcs.view.export.ulog_file import LoggedMessage, Topic, ulog


def export_ulog(run: RunData) -> list[Path]:
    """Write the logs into the run folder, and return their paths. Raises :class:`gcs.errors.UnusableInput`."""
    telemetry = read_telemetry(run.folder)
    systems = [system for system in telemetry.systems if system != PAYLOAD_UNIT_SYSTEM]
    logs: dict[int, tuple[dict[str, Topic], list[LoggedMessage]]] = {
        system: (
            vehicle_topics(run.tables, telemetry, system),
            [*alarms_of(run.tables, f"vehicle {system}"), *texts_of(telemetry, system)],
        )
        for system in systems
    }
    of_payload = payload_topics(run.tables)
    if any(map(len, of_payload.values())):
        logs[PAYLOAD_UNIT_SYSTEM] = of_payload, alarms_of(run.tables, None)
    if not logs:
        raise nothing_recorded(run.folder)
    version = str((run.manifest.get("versions") or {}).get("cooplift", "unknown"))
    mission = (run.manifest.get("mission") or {}).get("name")
    return [
        write_file(run.folder / f"{file_stem(system)}.ulg", ulog(topics, _information(system, version, mission), texts))
        for system, (topics, texts) in logs.items()
    ]


def _information(system: int, version: str, mission: object) -> dict[str, str]:
    """Return the information of a log: PX4's keys, then which system it is of and the mission's name."""
    about = {"sys_name": "cooplift", "ver_sw": version, "system": file_stem(system)}
    return {**about, "mission": mission} if isinstance(mission, str) else about
