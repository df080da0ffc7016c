"""Run folder and manifest: whole, refused where unusable."""

from __future__ import annotations

import enum
import json
import math
import multiprocessing
import os
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from gcs.errors import UnusableInput
from gcs.record.run_folder import open_run_folder, to_json, write_json, write_manifest


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


def test_json_of_uncommon_types_is_written() -> None:
    assert to_json({1: {3, 1, 2}, "p": Path("a/b"), "t": (True, None, -math.inf), "c": 1j}) == {
        "1": [1, 2, 3], "p": "a/b", "t": [True, None, "-inf"], "c": "1j",
    }  # fmt: skip


def test_json_that_cannot_be_written_is_refused(tmp_path) -> None:
    with pytest.raises(UnusableInput, match=r"absent/x\.json: cannot be written"):
        write_json(tmp_path / "absent" / "x.json", {})
