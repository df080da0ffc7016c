"""Tables of a run folder that is still written: what was read stays, and whole lines are added."""

import numpy as np
import pytest
from recorded_run import write_reference, write_truth

from gcs.errors import UnusableInput
from gcs.record.growing import GrowingTables
from gcs.record.reader import read_table

ALARMS = "time_s,source,code,severity,text\n"


def test_rows_are_added_as_whole_lines_come_to_be_there(tmp_path):
    write_truth(tmp_path)
    write_reference(tmp_path)
    growing, growing_folder = None, tmp_path / "growing"
    growing_folder.mkdir()
    content = {name: (tmp_path / name).read_bytes() for name in ("truth.csv", "reference.csv")}
    growing = GrowingTables(growing_folder)
    assert len(growing["truth.csv"]) == 0
    lengths, together = [], []
    # Cuts fall within the header, within a line and at its end.
    for share in (0.001, 0.01, 0.3, 0.31, 0.7, 1.0):
        for name, whole in content.items():
            (growing_folder / name).write_bytes(whole[: round(share * len(whole))])
        growing.grow()
        lengths.append(len(growing["truth.csv"]))
        together.append(growing.new()["truth.csv"])
        growing.take()
    for name in content:
        assert np.array_equal(growing[name], read_table(tmp_path / name))
    assert lengths == sorted(lengths) and lengths[0] == 0 and lengths[-1] == 101
    assert np.array_equal(np.concatenate([rows for rows in together if len(rows)]), read_table(tmp_path / "truth.csv"))


def test_no_row_is_new_where_none_came(tmp_path):
    write_truth(tmp_path)
    growing = GrowingTables(tmp_path)
    assert len(growing["truth.csv"]) == len(growing.new()["truth.csv"]) == 101
    growing.grow()
    assert len(growing["truth.csv"]) == len(growing.new()["truth.csv"]) == 101, "nobody has taken them"
    growing.take()
    assert len(growing["truth.csv"]) == 101 and len(growing.new()["truth.csv"]) == 0


def test_text_is_read_on_and_what_is_no_table_is_refused(tmp_path):
    path = tmp_path / "alarms.csv"
    path.write_text(ALARMS + '1.5,vehicle 1,bias,warning,"a, b"\n2.5,')
    growing = GrowingTables(tmp_path)
    assert growing["alarms.csv"]["text"].tolist() == ["a, b"]
    growing.take()
    with path.open("a") as file:
        file.write("payload,noise,error,c\n")
    growing.grow()
    assert growing["alarms.csv"]["source"].tolist() == ["vehicle 1", "payload"]
    assert growing.new()["alarms.csv"]["time_s"].tolist() == [2.5]
    with path.open("a") as file:
        file.write("three,columns,only\n")
    with pytest.raises(UnusableInput, match="below the header"):
        growing.grow()
