"""The reader of run folders: tables as structured arrays, and objects of JSON."""

import io
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gcs.errors import UnusableInput
from gcs.record.tables import COLUMNS, LATER_COLUMNS, TEXT_COLUMNS, TRUTH, truth_columns

Table = NDArray[np.void]
"""Rows with a field a column: float64, text in those of :data:`TEXT_COLUMNS`."""


def read_table(path: Path | str) -> Table:
    """Return a table of a run folder (rows,); without rows where there is none, or none to its header's end.

    A last line without its line break, as a killed process may leave, is left out. Columns of
    :data:`~gcs.record.tables.LATER_COLUMNS` that the file lacks are nan. Raises :class:`UnusableInput` for a
    file that cannot be read, that is not such a table, or that lacks a column of :data:`COLUMNS`.
    """
    path = Path(path)
    header, _, rows = _text(path).rpartition("\n")[0].partition("\n")
    return parse_table(path, header, rows)


def parse_table(path: Path, header: str, rows: str) -> Table:
    """Return the table of these lines of ``path``, as :func:`read_table` does, which names what it raises."""
    needed = COLUMNS.get(path.name, ())
    columns = header.split(",") if header else [*needed]
    if path.name == TRUTH:
        uavs = sum(name.endswith("_thrust_n") for name in columns)
        free = truth_columns(uavs, payload=False)  # vehicles without a payload
        needed = free if uavs and [*free] == columns else truth_columns(uavs)
    missing = [name for name in needed if name not in columns]
    if never_written := [name for name in missing if name not in LATER_COLUMNS]:
        raise UnusableInput(f"{path}, line 1: column {never_written[0]} is missing")
    empty = without_rows([*columns, *missing])
    if not rows:
        return empty
    form = without_rows(columns).dtype
    try:
        read = np.loadtxt(io.StringIO(rows), form, comments=None, delimiter=",", quotechar='"', ndmin=1)
    except ValueError as error:
        raise UnusableInput(f"{path}, below the header: {error}") from None
    if not missing:
        return read
    table = np.empty(len(read), empty.dtype)
    for name in empty.dtype.names or ():
        table[name] = np.nan if name in missing else read[name]
    return table


def without_rows(columns: Iterable[str]) -> Table:
    """Return a table of ``columns`` without rows (0,)."""
    return np.empty(0, [(name, object if name in TEXT_COLUMNS else float) for name in columns])


def read_json(path: Path | str) -> dict[str, Any]:
    """Return a file of one JSON object; empty where there is none, or nothing in it. Raises :class:`UnusableInput`."""
    try:
        content = json.loads(_text(Path(path)) or "{}")
    except ValueError as error:
        raise UnusableInput(f"{path}: is not JSON: {error}") from None
    if not isinstance(content, dict):
        raise UnusableInput(f"{path}: is not a JSON object")
    return content


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except FileNotFoundError:
        return ""
    except OSError as error:
        raise UnusableInput(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise UnusableInput(f"{path}: is not a text file") from None
