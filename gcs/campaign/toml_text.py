"""Missions and system files as text: the project's ``.toml``, from the model's own objects."""

import dataclasses
import json
from collections.abc import Mapping, Sequence
from typing import Any

from gcs.mission.model import Limits, Lissajous, Obstacle
from gcs.mission.obstacle_table import keys_of


def mission_text(
    name: str,
    seed: int,
    reference: Lissajous | Mapping[str, Any],
    obstacles: Sequence[Obstacle],
    limits: Limits,
    comments: Sequence[str] = (),
) -> str:
    """Return a mission file. ``reference`` is a figure eight or the keys of a table of kind waypoints."""
    keys = {"kind": "waypoints", **reference} if isinstance(reference, Mapping) else _fields(reference)
    tables = {"mission": {"name": name, "seed": seed}, "reference": keys}
    text = tables_text({**tables, "obstacle": [*map(keys_of, obstacles)], "limits": _fields(limits)})
    return "".join(f"# {comment}\n" for comment in comments) + ("\n" if comments else "") + text


def tables_text(data: Mapping[str, Any]) -> str:
    """Return a file of the tables and arrays of tables ``data``, as :mod:`tomllib` reads them; values are inline."""
    tables = [
        _table(f"[[{name}]]" if array else f"[{name}]", table)
        for name, value in data.items()
        for array in [not isinstance(value, Mapping)]
        for table in (value if array else [value])
    ]
    empty = [f"{name} = []" for name, value in data.items() if not value and not isinstance(value, Mapping)]
    return "\n\n".join([*empty, *tables]) + "\n"


def _fields(value: Any) -> dict[str, Any]:
    """The fields of a dataclass that are set, what it is first."""
    fields = {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
    first = [key for key in ("name", "kind", "shape") if key in fields]
    order = [*first, *(key for key in fields if key not in first)]
    return {key: fields[key] for key in order if fields[key] is not None}


def _table(header: str, keys: Mapping[str, Any]) -> str:
    return "\n".join([header, *(f"{key} = {toml_value(value)}" for key, value in keys.items())])


def toml_value(value: Any) -> str:
    """Return a value as TOML."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        # A basic string of TOML, which has no surrogates and wants one more character escaped.
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return repr(value)
    if dataclasses.is_dataclass(value):
        value = _fields(value)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {toml_value(v)}" for key, v in value.items()) + " }"
    return "[" + ", ".join(toml_value(item) for item in value) + "]"
