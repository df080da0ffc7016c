"""Whatever stands in a file, reading it ends in a mission or in a plain refusal."""

import json
from itertools import islice
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from gcs.config import UnusableFile, read_system
from gcs.mission.read import read_mission
from gcs.mission.route import HoldForever, Land, Route, TakeOff

MISSIONS = Path(__file__).parents[2] / "missions"
FUZZ = settings(max_examples=75, suppress_health_check=[HealthCheck.function_scoped_fixture])

numbers = st.one_of(
    st.integers(-3, 12), st.sampled_from([-1, 0, 16, 17, 18, 20, 21, 22, 93, 177, 178, 600, 601, 2000, 5001, 10**30]),
    st.floats(allow_nan=True, allow_infinity=True), st.floats(-100.0, 100.0),
)  # fmt: skip
junk = st.recursive(
    st.none() | st.booleans() | numbers | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=6), inner, max_size=3),
    max_leaves=6,
)


def read_or_refuse(path: Path, content: bytes) -> None:
    path.write_bytes(content)
    try:
        mission = read_mission(path)
    except UnusableFile as error:
        assert error.reasons
        assert all("\n" not in reason for reason in error.reasons)
        return
    if isinstance(mission.reference, Route):
        legs = list(islice(mission.reference.legs(), 3000))
        assert isinstance(legs[0], TakeOff)
        assert len(legs) == 3000 or isinstance(legs[-1], Land | HoldForever)
        assert all(not isinstance(leg, TakeOff) for leg in legs[1:])


@pytest.mark.parametrize("name", ["square.waypoints", "delivery.plan", "figure_eight.toml", "hover.toml"])
@FUZZ
@given(data=st.data())
def test_mutated_bytes_are_read_or_refused(tmp_path: Path, name: str, data: st.DataObject) -> None:
    content = bytearray((MISSIONS / name).read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        start = data.draw(st.integers(0, len(content)))
        end = min(len(content), start + data.draw(st.integers(0, 20)))
        tokens = st.sampled_from([b"nan", b"-1", b"[[", b"}", b"\n", b"1e999"])
        content[start:end] = data.draw(st.binary(max_size=6) | tokens)
    read_or_refuse(tmp_path / name, bytes(content))


@FUZZ
@given(rows=st.lists(st.tuples(*[numbers] * 10), max_size=8))
def test_wpl_of_any_numbers_is_read_or_refused(tmp_path: Path, rows: list[tuple[float, ...]]) -> None:
    lines = ["QGC WPL 110", "0 1 0 16 0 0 0 0 47.397742 8.545594 488 1"]
    lines += [f"{i} 0 {' '.join(map(repr, row[:9]))} 1" for i, row in enumerate(rows, start=1)]
    read_or_refuse(tmp_path / "fuzz.waypoints", "\n".join(lines).encode())


@FUZZ
@given(data=st.data())
def test_wpl_of_known_commands_is_read_or_refused(tmp_path: Path, data: st.DataObject) -> None:
    """Mostly well-formed, so that routes, jumps and loops are reached."""
    commands = st.sampled_from([16, 16, 16, 17, 18, 19, 20, 21, 22, 82, 93, 177, 177, 178, 600, 601])
    rows = data.draw(st.lists(commands, max_size=10))
    lines = ["QGC WPL 110", "0 1 0 16 0 0 0 0 47.397742 8.545594 488 1"]
    for i, command in enumerate(rows, start=1):
        first, second = data.draw(st.integers(0, 10)), data.draw(st.integers(-1, 3))
        place = data.draw(st.sampled_from(["0 0 0", "47.3978 8.5456 5", "0 0 9", "47.3979 8.5455 12"]))
        lines.append(f"{i} 0 3 {command} {first} {second} 5 0 {place} 1")
    read_or_refuse(tmp_path / "fuzz.waypoints", "\n".join(lines).encode())


def places(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    found = [path] if path else []
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, inner in items:
        found += places(inner, (*path, key))
    return found


@FUZZ
@given(data=st.data())
def test_plan_with_any_values_is_read_or_refused(tmp_path: Path, data: st.DataObject) -> None:
    document = json.loads((MISSIONS / "delivery.plan").read_text())
    document["geoFence"]["circles"] = [
        {"circle": {"center": [47.3977, 8.5459], "radius": 3.0}, "inclusion": False, "version": 1}
    ]
    document["geoFence"]["polygons"] = [
        {"polygon": [[47.39, 8.54], [47.40, 8.54], [47.40, 8.56], [47.39, 8.55]], "inclusion": True, "version": 1}
    ]
    for _ in range(data.draw(st.integers(1, 3))):
        *path, last = data.draw(st.sampled_from(places(document)))
        table = document
        for key in path:
            table = table[key]
        table[last] = data.draw(junk)
    read_or_refuse(tmp_path / "fuzz.plan", json.dumps(document).encode())


@FUZZ
@given(text=st.binary(max_size=60))
def test_any_system_file_is_read_or_refused(tmp_path: Path, text: bytes) -> None:
    path = tmp_path / "system.toml"
    path.write_bytes(text)
    with pytest.raises(UnusableFile):
        read_system(path)
