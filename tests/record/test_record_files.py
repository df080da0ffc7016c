"""Tables of a run: whole, repeatable, refused where unusable."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from gcs.config import read_system
from gcs.errors import UnusableInput
from gcs.record.horizon_recorder import HorizonRecorder
from gcs.record.innovation_recorder import InnovationRecorder
from gcs.record.obstacle_recorder import ObstacleRecorder
from gcs.record.reader import read_table
from gcs.record.tables import (
    ALARM_COLUMNS,
    ALARMS,
    ESTIMATE,
    ESTIMATE_COLUMNS,
    HORIZON_COLUMNS,
    INNOVATION_COLUMNS,
    REFERENCE_COLUMNS,
    TableWriter,
    force_columns,
    truth_columns,
)
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Channel, Position, SensorGroup
from idc_controller.geometry.shapes import Wall
from idc_controller.trajectory.integrator_chain import Chain
from idc_controller.trajectory.stop_plan import StopPlan

FIXED = Wall((1.0, 2.0, 5.0))


def test_columns_of_text_stand_beside_numbers(tmp_path) -> None:
    (tmp_path / "a.csv").write_text('t,name\n0.5,"a, ""b"""\n1.5,c\n2.5,cut o')
    table = read_table(tmp_path / "a.csv")
    assert table.tolist() == [(0.5, 'a, "b"'), (1.5, "c")] and table.dtype.names == ("t", "name")


@pytest.mark.parametrize("text", [None, "", "time_s,sou"])
def test_table_that_was_never_begun_has_its_columns_and_no_rows(tmp_path, text) -> None:
    if text is not None:
        (tmp_path / ALARMS).write_text(text)
    table = read_table(tmp_path / ALARMS)
    assert len(table) == 0 and table.dtype.names == ALARM_COLUMNS


def test_row_of_numbers_of_another_length_is_an_error(tmp_path) -> None:
    with TableWriter(tmp_path / "a.csv", ("a", "b")) as table:
        for write in (table.write, table.write_numbers):
            with pytest.raises(ValueError, match="1 values for 2"):
                write([1.0])


def test_csv_bytes_are_independent_of_number_type(tmp_path) -> None:
    with TableWriter(tmp_path / "a.csv", ("a", "b", "c", "d")) as table:
        table.write([0.1, 2, True, float("nan")])
        table.write([np.float64(0.1), np.int32(2), np.bool_(True), np.float64("nan")])
        table.write(["with, comma", 'and "quote"', "two\nlines", -0.0])
    lines = (tmp_path / "a.csv").read_bytes().split(b"\n")
    assert lines[:3] == [b"a,b,c,d", b"0.1,2,1,nan", b"0.1,2,1,nan"]
    assert lines[3:] == [b'"with, comma","and ""quote""",two lines,-0.0', b""]


def test_rows_are_on_disk_at_once_and_closing_twice_is_harmless(tmp_path) -> None:
    table = TableWriter(tmp_path / "a.csv", ("a",))
    table.write([1.5])
    assert (tmp_path / "a.csv").read_bytes() == b"a\n1.5\n"
    table.close()
    table.close()
    table.write([2.5])
    assert (tmp_path / "a.csv").read_bytes() == b"a\n1.5\n"


def test_earlier_records_are_never_overwritten(tmp_path) -> None:
    (tmp_path / "a.csv").write_text("precious")
    with pytest.raises(UnusableInput, match="there is a record of another flight"):
        TableWriter(tmp_path / "a.csv", ("a",))
    assert (tmp_path / "a.csv").read_text() == "precious"


def test_absent_folder_is_refused(tmp_path) -> None:
    with pytest.raises(UnusableInput, match="cannot be written"):
        TableWriter(tmp_path / "absent" / "a.csv", ("a",))


def test_boxes_of_the_map_are_recorded_once_a_second_where_they_have_changed(tmp_path) -> None:
    recorder = ObstacleRecorder(tmp_path)
    for k in range(100):
        boxes = [("fixed", FIXED, np.zeros(3)), ("grows", Wall((1.0, 1.0, 1.0 + k)), np.ones(3))]
        seen = SimpleNamespace(pieces=boxes[: 2 if k < 70 else 1])
        recorder.record(SimpleNamespace(confirmed_tracks=lambda _: (), seen=seen), 3.0 + 0.05 * k)
    recorder.close()
    rows = read_table(tmp_path / "obstacles_standing.csv")[["time_s", "name", "size_z_m"]].tolist()
    assert rows == [(3.0, "fixed", 5.0), *((3.0 + k, "grows", 1.0 + 20 * k) for k in range(4)), (7.0, "grows", 0.0)]
    assert not (tmp_path / "obstacles_estimate.csv").exists()


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("time_s,x\n0.0,1.0\n0.1,oops\n", "could not convert string 'oops' to float64 at row 1, column 2"),
        ("time_s,x\n0.0,1.0\n0.1\n", "2 columns but 1 were found at row 2"),
        ("time_s,x\n0.0,1.0,2.0\n0.1,1.0,2.0\n", "2 columns but 3 were found"),
        ("time_s,x\n0.0,\n", "could not convert string ''"),
        ("time_s,x\n0.0,null\n", "could not convert string 'null'"),
        ("time_s,x\n[0.0,1.0]\n", r"could not convert string '\[0.0'"),
    ],
)
def test_damaged_tables_are_refused_with_the_reason(tmp_path, text, reason) -> None:
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(UnusableInput, match=f"a.csv, below the header: .*{reason}"):
        read_table(tmp_path / "a.csv")


NUMBERS = st.floats().map(lambda value: math.nan if math.isnan(value) else value)  # the text of nan has no sign


@settings(deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.tuples(NUMBERS, st.floats(allow_nan=False), st.integers(-(2**60), 2**60)), max_size=20))
def test_numbers_are_read_as_they_were_written(tmp_path, rows) -> None:
    (tmp_path / "a.csv").unlink(missing_ok=True)
    with TableWriter(tmp_path / "a.csv", ("a", "b", "c")) as table:
        for row in rows:
            table.write(row)
            table.write_numbers([np.float64(row[0]), *row[1:]])
    table = read_table(tmp_path / "a.csv")
    assert table.dtype.names == ("a", "b", "c") and len(table) == 2 * len(rows)
    assert table.tobytes() == np.repeat(np.array(rows, dtype=float), 2, axis=0).tobytes()


def test_columns_follow_the_contract() -> None:
    assert ",".join(REFERENCE_COLUMNS) == "time_s,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps"
    assert ESTIMATE_COLUMNS[:14] == truth_columns(2)[:14]
    assert ",".join(force_columns(3)) == "time_s,link1_n,link2_n,link3_n"
    assert ",".join(INNOVATION_COLUMNS) == "time_s,source,channel,test_ratio,state"
    assert ",".join(HORIZON_COLUMNS) == "time_s,kind,step,x_m,y_m,z_m"


def test_estimate_without_standard_deviations_and_mass_is_read_with_nan(tmp_path) -> None:
    columns = [name for name in ESTIMATE_COLUMNS if not name.endswith("_sd") and name != "payload_mass_kg"]
    with TableWriter(tmp_path / ESTIMATE, columns) as table:
        table.write(range(len(columns)), range(len(columns)))
    table = read_table(tmp_path / ESTIMATE)
    assert table.dtype.names == ESTIMATE_COLUMNS and len(table) == 2
    assert [table[name][1] for name in columns] == [*range(len(columns))]
    later = "payload_x_m_sd", "payload_yaw_rad_sd", "payload_mass_kg"
    assert all(np.isnan(table[name]).all() for name in later)
    header = (tmp_path / ESTIMATE).read_text().replace("payload_vx_mps", "payload_v_mps")
    (tmp_path / ESTIMATE).write_text(header)
    with pytest.raises(UnusableInput, match=r"estimate\.csv, line 1: column payload_vx_mps is missing"):
        read_table(tmp_path / ESTIMATE)


class _Health(SimpleNamespace):
    """Sensor health of four vehicles."""

    def __init__(self, stuck=(), isolated=(), groups=()) -> None:
        super().__init__(
            stuck_channels=[*stuck], isolation=SimpleNamespace(isolated=isolated), isolated_groups=dict(groups),
            number_of_uavs=4,
        )  # fmt: skip


def innovation_tests(time, ratios):
    """The innovation tests of one moment: ratios of pose and motion by sensor."""
    return SimpleNamespace(time=time, keys=tuple(ratios), test_ratios=np.array([*ratios.values()]))


def test_largest_test_ratio_of_each_channel_is_recorded_with_its_state(tmp_path) -> None:
    keys = [(source, kind) for source in (PAYLOAD, 0, 1, 2, 3) for kind in (Attitude, Position)]
    health = [
        _Health(),
        _Health(stuck=[Channel(0, Position, 1)], isolated=(Channel(0, Position, 1), Channel(1, Attitude, 0))),
        _Health(groups={SensorGroup(True, Position): (False, True), SensorGroup(False, Attitude): (True, False)}),
    ]
    moments = [
        [innovation_tests(0.95, {(PAYLOAD, Position): [0.2, 0.3], (2, Attitude): [0.1, np.nan]}),
         innovation_tests(0.99, {(PAYLOAD, Position): [0.1, 0.4]})],
        # The first is replayed; the second comes late, with what has been counted.
        [innovation_tests(0.99, {(PAYLOAD, Position): [9.0, 9.0]}),
         innovation_tests(0.99, {(PAYLOAD, Position): [9.0, 9.0], (3, Attitude): [1.5, 0.5]})],
        [],
    ]  # fmt: skip
    recorder = InnovationRecorder(tmp_path)
    observations = SimpleNamespace(observations=dict.fromkeys(keys))
    for k, (state, innovations) in enumerate(zip(health, moments, strict=True)):
        estimator = SimpleNamespace(health=state, measurement_model=observations)
        recorder.record(estimator, SimpleNamespace(innovations=innovations), 1.0 + 0.1 * k)
        recorder.record(estimator, SimpleNamespace(innovations=[]), 1.05 + 0.1 * k)
    recorder.close()
    table = read_table(tmp_path / "innovations.csv")
    assert table["time_s"].tolist() == [round(1.0 + 0.1 * k, 6) for k in range(3) for _ in range(20)]
    rows = {(round(t, 1), source, channel): (ratio, state) for t, source, channel, ratio, state in table.tolist()}
    assert rows[1.0, "payload", "position"] == (0.2, "ok") and rows[1.0, "payload", "velocity"] == (0.4, "ok")
    assert rows[1.0, "vehicle 3", "attitude"] == (0.1, "ok") and math.isnan(rows[1.0, "vehicle 3", "rates"][0])
    assert math.isnan(rows[1.1, "payload", "position"][0])
    assert rows[1.1, "vehicle 4", "attitude"] == (1.5, "rejected") and rows[1.1, "vehicle 4", "rates"] == (0.5, "ok")
    states = {key: state for key, (_, state) in rows.items() if state not in ("ok", "rejected")}
    assert states == {
        (1.1, "vehicle 1", "velocity"): "stuck", (1.1, "vehicle 2", "attitude"): "isolated",
        (1.2, "payload", "velocity"): "isolated",
        **{(1.2, f"vehicle {i}", "attitude"): "isolated" for i in range(1, 5)},
    }  # fmt: skip


def test_plan_and_stop_plan_are_recorded_every_third_stage_five_times_a_second(tmp_path) -> None:
    chain, parameters = Chain(0.1, (2, 4, 3)), read_system().parameters()
    hang = parameters.p - parameters.l[:, None] * [0.0, 0.0, 1.0]
    rest = SimpleNamespace(derivatives=lambda times, order: np.array([[[t, 0.0, -5.0] for t in times]]))
    recorder = HorizonRecorder(tmp_path)
    for k in range(9):
        time = 2.0 + 0.05 * k
        stop = StopPlan(time, 1.0, np.linspace([time, 0.0, -5.0], [time + 1.0, 0.0, -5.0], 5) + hang[:, None])
        recorder.record(time, rest, stop, chain, parameters)
    recorder.close()
    table = read_table(tmp_path / "horizon.csv")
    assert sorted({*table["time_s"].tolist()}) == [2.0, 2.2, 2.4]
    rows = table[table["time_s"] == 2.2][["kind", "step", "x_m", "y_m", "z_m"]].tolist()
    assert rows[:4] == [("plan", k, round(2.2 + 0.1 * k, 3), 0.0, -5.0) for k in (0, 3, 6, 9)]
    # Evenly spaced control points are passed at an even speed, to the rest.
    assert rows[4:] == [("stop", k, round(2.2 + min(0.1 * k, 1.0), 3), 0.0, -5.0) for k in (0, 3, 6, 9, 12)]
