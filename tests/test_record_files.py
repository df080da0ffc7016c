"""Run folder, manifest, tables and telemetry log: whole, repeatable, refused where unusable."""

from __future__ import annotations

import contextlib
import enum
import json
import math
import multiprocessing
import os
import resource
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pymavlink import mavutil
from pymavlink.dialects.v20 import common as mavlink

from gcs.errors import UnusableInput
from gcs.record.append_file import AppendOnlyFile
from gcs.record.run_folder import open_run_folder, to_json, versions, write_json, write_manifest
from gcs.record.tables import (
    ESTIMATE_COLUMNS,
    REFERENCE_COLUMNS,
    TableWriter,
    read_table,
    read_text_table,
    truth_columns,
)
from gcs.record.tlog import TelemetryLog

# --- run folder ---------------------------------------------------------------------------------------------------


def test_runs_are_numbered_upwards(tmp_path) -> None:
    parent = tmp_path / "runs"
    assert open_run_folder("hover", parent=parent).name == "hover-1"
    (parent / "hover-9").mkdir()
    (parent / "hover-x").mkdir()
    (parent / "hover-night-30").mkdir()
    assert open_run_folder("hover", parent=parent).name == "hover-10"
    assert open_run_folder("hover-night", parent=parent).name == "hover-night-31"


def test_default_is_runs_in_the_current_folder(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert open_run_folder("hover") == Path("runs/hover-1")


@pytest.mark.parametrize(
    ("name", "folder"),
    [("two spheres", "two-spheres-1"), ("../../etc/x", "etc-x-1"), ("", "mission-1"), ("Höhe_2", "Höhe_2-1")],
)
def test_mission_names_become_plain_folder_names(tmp_path, name, folder) -> None:
    assert open_run_folder(name, parent=tmp_path) == tmp_path / folder


def _open_many(parent: Path, queue) -> None:
    for _ in range(20):
        queue.put(open_run_folder("hover", parent=parent).name)


def test_parallel_flights_get_separate_folders(tmp_path) -> None:
    context = multiprocessing.get_context("fork")
    queue = context.SimpleQueue()
    processes = [context.Process(target=_open_many, args=(tmp_path, queue)) for _ in range(4)]
    for process in processes:
        process.start()
    names = [queue.get() for _ in range(80)]
    for process in processes:
        process.join()
    assert len(set(names)) == 80


def test_named_folder_is_made_with_its_parents_or_used_empty(tmp_path) -> None:
    assert open_run_folder("hover", tmp_path / "a" / "b") == tmp_path / "a" / "b"
    (tmp_path / "empty").mkdir()
    assert open_run_folder("hover", str(tmp_path / "empty")) == tmp_path / "empty"


def test_named_folder_is_refused_when_it_holds_anything(tmp_path) -> None:
    open_run_folder("hover", tmp_path / "a")
    with pytest.raises(UnusableInput, match="a: the run folder is not empty"):
        open_run_folder("hover", tmp_path / "a")  # claimed, though nothing was written yet


def test_unusable_places_are_refused(tmp_path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(UnusableInput, match="is a file, not a folder"):
        open_run_folder("hover", tmp_path / "file")
    with pytest.raises(UnusableInput, match="cannot be written: Not a directory"):
        open_run_folder("hover", tmp_path / "file" / "below")
    with pytest.raises(UnusableInput, match="cannot be written"):
        open_run_folder("hover", parent=tmp_path / "file")


@pytest.mark.skipif(os.geteuid() == 0, reason="nothing is forbidden to root")
def test_forbidden_folder_is_refused(tmp_path) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(UnusableInput, match="Permission denied"):
        open_run_folder("hover", parent=tmp_path)


# --- manifest -----------------------------------------------------------------------------------------------------


class Kind(enum.Enum):
    POLE = 1


@dataclass(frozen=True)
class Inner:
    values: np.ndarray
    kind: Kind
    speed: float | None = None


@dataclass(frozen=True)
class Outer:
    name: str
    inner: tuple[Inner, ...]


def test_manifest_holds_what_was_flown(tmp_path) -> None:
    folder = open_run_folder("hover", tmp_path / "run")
    mission = Outer("hover", (Inner(np.array([[1.0, np.nan]]), Kind.POLE, math.inf),))
    path = write_manifest(
        folder, command=["gcs", "fly", "hover.toml"], seed=7, mission=mission,
        system={"m_0": np.float64(3.1), "n": np.int64(4)}, start=datetime(2026, 1, 2, 3, 4, 5, tzinfo=UTC),
    )  # fmt: skip
    assert path == folder / "manifest.json"
    content = json.loads(path.read_text(), parse_constant=pytest.fail)
    assert content["command"] == ["gcs", "fly", "hover.toml"]
    assert content["seed"] == 7
    assert content["start"] == "2026-01-02T03:04:05+00:00"
    assert content["system"] == {"m_0": 3.1, "n": 4}
    assert content["mission"] == {
        "name": "hover", "inner": [{"values": [[1.0, None]], "kind": "POLE", "speed": "inf"}],
    }  # fmt: skip
    assert {"python", "numpy", "pymavlink", "pybullet", "proxsuite"} <= set(content["versions"])
    assert [file.name for file in folder.iterdir()] == ["manifest.json"]


def test_versions_are_those_in_use() -> None:
    assert versions()["numpy"] == np.__version__


def test_json_of_uncommon_types_is_written() -> None:
    assert to_json({1: {3, 1, 2}, "p": Path("a/b"), "t": (True, None, -math.inf), "c": 1j}) == {
        "1": [1, 2, 3], "p": "a/b", "t": [True, None, "-inf"], "c": "1j",
    }  # fmt: skip


def test_json_that_cannot_be_written_is_refused(tmp_path) -> None:
    with pytest.raises(UnusableInput, match=r"absent/x\.json: cannot be written"):
        write_json(tmp_path / "absent" / "x.json", {})


# --- tables -------------------------------------------------------------------------------------------------------


def test_numbers_read_back_to_the_bit(tmp_path) -> None:
    rows = np.random.default_rng(3).normal(size=(50, 7)) * 10.0 ** np.arange(-9, 12, 3)
    with TableWriter(tmp_path / "reference.csv", REFERENCE_COLUMNS) as table:
        for row in rows:
            table.write(row)
    columns = read_table(tmp_path / "reference.csv")
    assert tuple(columns) == REFERENCE_COLUMNS
    assert np.array_equal(np.column_stack(list(columns.values())), rows)


@pytest.mark.parametrize("special", [math.nan, math.inf, -math.inf, -0.0, 5e-324, 1.7976931348623157e308, 1e-5, 1e22])
def test_rows_of_numbers_read_back_to_the_bit(tmp_path, special) -> None:
    rows = np.random.default_rng(3).normal(size=(50, 3)) * 10.0 ** np.arange(-150, 301, 150)[:3]
    with TableWriter(tmp_path / "a.csv", ("a", "b", "c", "special", "count")) as table:
        table.write_numbers(*([*row, special, 7] for row in rows.tolist()))
        table.write_numbers([np.float64(0.1), 1.0, 2.0, np.float64(special), np.int64(7)])
    assert b",7\n" in (tmp_path / "a.csv").read_bytes()
    columns = read_table(tmp_path / "a.csv")
    written = np.column_stack(list(columns.values()))
    expected = np.vstack([np.column_stack([rows, np.full(50, special), np.full(50, 7.0)]), [0.1, 1.0, 2.0, special, 7]])
    assert np.array_equal(written, expected, equal_nan=True) and np.array_equal(
        np.signbit(written), np.signbit(expected)
    )


def test_row_of_numbers_of_another_length_is_an_error(tmp_path) -> None:
    with TableWriter(tmp_path / "a.csv", ("a", "b")) as table, pytest.raises(ValueError, match="1 values for 2"):
        table.write_numbers([1.0])


def test_csv_bytes_are_independent_of_number_type(tmp_path) -> None:
    with TableWriter(tmp_path / "a.csv", ("a", "b", "c", "d")) as table:
        table.write([0.1, 2, True, float("nan")])
        table.write([np.float64(0.1), np.int32(2), np.bool_(True), np.float64("nan")])
        table.write(["with, comma", 'and "quote"', "two\nlines", -0.0])
    lines = (tmp_path / "a.csv").read_bytes().split(b"\n")
    assert lines[:3] == [b"a,b,c,d", b"0.1,2,1,nan", b"0.1,2,1,nan"]
    assert read_text_table(tmp_path / "a.csv")["a"][2] == "with, comma"
    assert read_text_table(tmp_path / "a.csv")["c"][2] == "two lines"


def test_rows_are_on_disk_at_once_and_closing_twice_is_harmless(tmp_path) -> None:
    table = TableWriter(tmp_path / "a.csv", ("a",))
    table.write([1.5])
    assert (tmp_path / "a.csv").read_bytes() == b"a\n1.5\n"
    table.close()
    table.close()
    table.write([2.5])
    assert (tmp_path / "a.csv").read_bytes() == b"a\n1.5\n"


def test_row_of_another_length_is_an_error(tmp_path) -> None:
    with TableWriter(tmp_path / "a.csv", ("a", "b")) as table, pytest.raises(ValueError, match="1 values for 2"):
        table.write([1.0])


def test_earlier_records_are_never_overwritten(tmp_path) -> None:
    (tmp_path / "a.csv").write_text("precious")
    with pytest.raises(UnusableInput, match="there is a record of another flight"):
        TableWriter(tmp_path / "a.csv", ("a",))
    assert (tmp_path / "a.csv").read_text() == "precious"


def test_absent_folder_is_refused(tmp_path) -> None:
    with pytest.raises(UnusableInput, match="cannot be written"):
        TableWriter(tmp_path / "absent" / "a.csv", ("a",))


@contextlib.contextmanager
def file_size_limit(size: int) -> Iterator[None]:
    """Let files grow to ``size`` bytes: as on a full disk, some of a record is written, the rest is not."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_full_disk_leaves_whole_records_and_no_exception(tmp_path) -> None:
    file = AppendOnlyFile(tmp_path / "a")
    with file_size_limit(8):
        for _ in range(3):
            file.append(b"12345\n")
    assert isinstance(file.error, OSError)
    file.close()
    assert (tmp_path / "a").read_bytes() == b"12345\n"


def test_truncated_last_line_is_skipped(tmp_path) -> None:
    (tmp_path / "a.csv").write_text("time_s,x\n0.0,1.0\n0.1,2.0\n0.2,3")
    assert read_table(tmp_path / "a.csv")["x"].tolist() == [1.0, 2.0]
    (tmp_path / "a.csv").write_text("time_s,x\n")
    assert read_table(tmp_path / "a.csv")["x"].tolist() == []


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("time_s,x\n0.0,1.0\n0.1,oops\n", "line 3, x: 'oops' is not a number"),
        ("time_s,x\n0.0,1.0\n0.1\n", "line 3: 1 values for 2 columns"),
        ("time_s,x\n0.0\n", "line 2: 1 values for 2 columns"),
        ("time_s,x\n0.0,1.0\n\n", "line 3: 0 values for 2 columns"),
        ("time_s,x\n0.0,1.0,2.0\n0.1,1.0,2.0\n", "line 2: 3 values for 2 columns"),
        ("time_s,x\n0.0,\n", "line 2, x: '' is not a number"),
        ("time_s,x\n0.0,1-2\n", "line 2, x: '1-2' is not a number"),
        ("time_s,x\n0.0,null\n", "line 2, x: 'null' is not a number"),
        ("time_s,x\n[0.0,1.0]\n", r"line 2, time_s: '\[0.0' is not a number"),
        ("", "line 1: the header is missing"),
    ],
)
def test_damaged_tables_are_refused_with_their_line(tmp_path, text, reason) -> None:
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(UnusableInput, match=f"a.csv, {reason}"):
        read_table(tmp_path / "a.csv")


NUMBERS = st.floats().map(lambda value: math.nan if math.isnan(value) else value)  # the text of nan has no sign


@settings(deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.tuples(NUMBERS, st.floats(allow_nan=False), st.integers(-(2**60), 2**60)), max_size=20))
def test_numbers_are_read_as_they_were_written(tmp_path, rows) -> None:
    (tmp_path / "a.csv").unlink(missing_ok=True)
    with TableWriter(tmp_path / "a.csv", ("a", "b", "c")) as table:
        for row in rows:
            table.write(row)
    columns = read_table(tmp_path / "a.csv")
    for column, values in zip(columns.values(), zip(*rows, strict=True), strict=False):
        assert column.tobytes() == np.array(values, dtype=float).tobytes()
    assert {name: column.shape for name, column in columns.items()} == dict.fromkeys("abc", (len(rows),))


@pytest.mark.parametrize("text", ["+1.0", "1.", ".5", "007", "1e400", "-inf", "nan", " 2.0", "1_000", '"3.5"'])
def test_a_number_may_have_every_form_of_pythons(tmp_path, text) -> None:
    (tmp_path / "a.csv").write_text(f"time_s,x\n0.0,{text}\n")
    assert read_table(tmp_path / "a.csv")["x"] == pytest.approx([float(text.strip('"'))], nan_ok=True)


def test_columns_follow_the_contract() -> None:
    truth = truth_columns(2)
    assert ",".join(truth[:8]) == (
        "time_s,payload_x_m,payload_y_m,payload_z_m,payload_qw,payload_qx,payload_qy,payload_qz"
    )
    assert ",".join(truth[8:14]) == (
        "payload_vx_mps,payload_vy_mps,payload_vz_mps,payload_wx_radps,payload_wy_radps,payload_wz_radps"
    )
    assert truth[14:22] == tuple(f"uav1_{p}" for p in ("x_m", "y_m", "z_m", "qw", "qx", "qy", "qz", "thrust_n"))
    assert truth[-1] == "contacts"
    assert len(truth) == 1 + 13 + 2 * 8 + 1
    assert ",".join(REFERENCE_COLUMNS) == "time_s,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps"
    assert ESTIMATE_COLUMNS[:14] == truth[:14]


# --- telemetry log ------------------------------------------------------------------------------------------------


def frames(count: int, **options) -> list[bytes]:
    sender = mavlink.MAVLink(None, srcSystem=3, srcComponent=1)
    made = []
    for i in range(count):
        message = mavlink.MAVLink_attitude_message(i * 20, 0.1, -0.2, 0.3, 0.0, 0.0, 0.0)
        made.append(message.pack(sender, **options))
        sender.seq = (sender.seq + 1) % 256
    return made


def read_back(path: Path) -> list:
    log = mavutil.mavlink_connection(str(path))
    messages = []
    while (message := log.recv_match()) is not None:
        messages.append(message)
    log.close()
    return messages


def test_pymavlink_reads_every_frame_of_every_datagram(tmp_path) -> None:
    a, b, c = frames(3)
    old = frames(1, force_mavlink1=True)[0]
    with TelemetryLog(tmp_path / "telemetry.tlog", start_epoch=1.7e9) as log:
        log.write(0.0, a + b)
        log.write(0.1, old)
        log.write(12.345678, c)
    messages = read_back(tmp_path / "telemetry.tlog")
    assert [m.get_type() for m in messages] == ["ATTITUDE"] * 4
    assert [m.time_boot_ms for m in messages] == [0, 20, 0, 40]
    assert [m.get_srcSystem() for m in messages] == [3] * 4
    stamps = [m._timestamp - 1.7e9 for m in messages]
    assert stamps == pytest.approx([0.0, 0.0, 0.1, 12.345678], abs=5e-6)


def test_bytes_are_stamp_and_frame(tmp_path) -> None:
    frame = frames(1)[0]
    for name in ("a.tlog", "b.tlog"):
        with TelemetryLog(tmp_path / name, start_epoch=100.0) as log:
            log.write(0.5, frame)
    assert (tmp_path / "a.tlog").read_bytes() == struct.pack(">Q", 100_500_000) + frame
    assert (tmp_path / "a.tlog").read_bytes() == (tmp_path / "b.tlog").read_bytes()


def test_truncated_last_record_is_skipped(tmp_path) -> None:
    path = tmp_path / "telemetry.tlog"
    with TelemetryLog(path, start_epoch=1.7e9) as log:
        for i, frame in enumerate(frames(5)):
            log.write(0.02 * i, frame)
    whole = path.read_bytes()
    record = len(whole) // 5
    for cut in (1, record // 2, record - 9, record - 4):
        path.write_bytes(whole[:-cut])
        messages = [m for m in read_back(path) if m.get_type() != "BAD_DATA"]
        assert [m.time_boot_ms for m in messages] == [0, 20, 40, 60]


def test_damaged_frames_do_not_hide_the_good_ones(tmp_path) -> None:
    rng = np.random.default_rng(8)
    path = tmp_path / "telemetry.tlog"
    good = 0
    with TelemetryLog(path, start_epoch=1.7e9) as log:
        for i, frame in enumerate(frames(200)):
            if i % 4 == 1:
                damaged = bytearray(frame)
                damaged[rng.integers(len(frame))] ^= 1 << int(rng.integers(8))
                log.write(0.02 * i, bytes(damaged))
            else:
                good += 1
                log.write(0.02 * i, frame)
    messages = [m for m in read_back(path) if m.get_type() == "ATTITUDE"]
    assert sum(m.time_boot_ms % 80 != 20 for m in messages) == good


def test_frames_of_an_exchange_are_written_at_its_end_or_when_the_log_is_closed(tmp_path) -> None:
    path, (first, second) = tmp_path / "telemetry.tlog", frames(2)
    log = TelemetryLog(path, start_epoch=1.7e9)
    log.write(0.0, first)
    assert path.read_bytes() == b""
    log.flush()
    whole = path.read_bytes()
    assert whole.endswith(first)
    log.write(0.1, second)
    log.close()
    assert path.read_bytes().endswith(second)
    assert path.read_bytes().startswith(whole)
