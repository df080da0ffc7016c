"""Records of the world: modes as they change, and files that are closed when the log is."""

from pathlib import Path

from truth_rows import write_state

from gcs.record.tables import MODE_COLUMNS
from vehicle_sim.world.truth_log import TruthLog
from vehicle_sim.world.world_state import UavState, WorldState

LEVEL, REST = (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0)


def state(time: float) -> WorldState:
    return WorldState(time, REST, LEVEL, REST, REST, (UavState(REST, LEVEL, REST, REST, 1.0, False),))


def opened(folder: Path) -> set[str]:
    """Names of the folder's files that this process has open."""
    files = (entry.resolve() for entry in Path("/proc/self/fd").iterdir())
    return {file.name for file in files if file.parent == folder}


def test_mode_is_recorded_for_each_vehicle_as_it_changes(tmp_path: Path) -> None:
    with TruthLog(tmp_path, 1) as log:
        for row in ((0.0, 1, "HOLD", True, False), (0.5, 1, "HOLD", True, False), (0.5, 2, "HOLD", True, False),
                    (1.0, 1, "HOLD", False, False), (1.5, 1, "HOLD", False, True), (2.0, 1, "LAND", False, True),
                    (2.5, 1, "HOLD", True, False)):  # fmt: skip
            log.write_mode(*row)
    header, *rows = (tmp_path / "modes.csv").read_text().splitlines()
    assert header.split(",") == list(MODE_COLUMNS)
    assert [row.split(",")[:3] for row in rows] == [
        ["0.0", "1", "HOLD"], ["0.5", "2", "HOLD"], ["1.0", "1", "HOLD"], ["1.5", "1", "HOLD"], ["2.0", "1", "LAND"],
        ["2.5", "1", "HOLD"],
    ]  # fmt: skip


def test_closed_log_holds_no_file_and_takes_no_more_rows(tmp_path: Path) -> None:
    log = TruthLog(tmp_path, 1)
    write_state(log, state(0.0), 0)
    log.write_mode(0.0, 1, "HOLD", True, False)
    assert opened(tmp_path) == {"truth.csv", "modes.csv"}
    log.close()
    log.close()
    assert opened(tmp_path) == set()
    before = [(tmp_path / name).read_bytes() for name in ("truth.csv", "modes.csv")]
    log.write_mode(1.0, 1, "LAND", True, False)
    assert [(tmp_path / name).read_bytes() for name in ("truth.csv", "modes.csv")] == before
    assert before[0].count(b"\n") == before[1].count(b"\n") == 2
