"""Records of the world: the contract's columns, modes as they change, and files that are closed when the log is."""

from pathlib import Path

import pytest
from recorded_run import CORNERS, LEVEL, REST, world_state
from truth_rows import write_state

from gcs.record.tables import MODE_COLUMNS
from vehicle_sim.world.truth_log import TruthLog
from vehicle_sim.world.world_state import UavState, WorldState


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


def test_truth_columns_are_in_order_of_the_contract(tmp_path) -> None:
    with TruthLog(tmp_path / "new", 2) as log:
        uavs = (
            UavState((10, 11, 12), (0, 1, 0, 0), (0, 0, 0), (0, 0, 0), 16, True),
            UavState((13, 14, 15), (0, 0, 1, 0), (0, 0, 0), (0, 0, 0), 17, False),
        )
        write_state(log, WorldState(0.02, (1, 2, 3), (1, 0, 0, 0), (4, 5, 6), (7, 8, 9), uavs), 3)
    header, row = (tmp_path / "new" / "truth.csv").read_text().splitlines()
    assert dict(zip(header.split(","), map(float, row.split(",")), strict=True)) == {
        "time_s": 0.02, "payload_x_m": 1, "payload_y_m": 2, "payload_z_m": 3,
        "payload_qw": 1, "payload_qx": 0, "payload_qy": 0, "payload_qz": 0,
        "payload_vx_mps": 4, "payload_vy_mps": 5, "payload_vz_mps": 6,
        "payload_wx_radps": 7, "payload_wy_radps": 8, "payload_wz_radps": 9,
        "uav1_x_m": 10, "uav1_y_m": 11, "uav1_z_m": 12,
        "uav1_qw": 0, "uav1_qx": 1, "uav1_qy": 0, "uav1_qz": 0, "uav1_thrust_n": 16,
        "uav2_x_m": 13, "uav2_y_m": 14, "uav2_z_m": 15,
        "uav2_qw": 0, "uav2_qx": 0, "uav2_qy": 1, "uav2_qz": 0, "uav2_thrust_n": 17, "contacts": 3,
    }  # fmt: skip
    assert row.endswith(",3")
    assert not (tmp_path / "new" / "obstacles.csv").exists()


def test_state_of_another_number_of_uavs_is_an_error(tmp_path) -> None:
    with TruthLog(tmp_path, 3) as log, pytest.raises(ValueError, match="47 values for 39 columns"):
        write_state(log, world_state(0.0, (0.0, 0.0, 0.0), LEVEL, CORNERS, [0.0] * 4), 0)
