"""The tables (CSV) of a run folder: their columns, their writer and their reader."""

import csv
import io
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import orjson
from numpy.typing import NDArray

from gcs.errors import UnusableInput
from gcs.record.append_file import AppendOnlyFile
from gcs.record.incomplete import IncompleteRecords
from idc_controller.arrays import Array

PAYLOAD_COLUMNS = (
    "payload_x_m", "payload_y_m", "payload_z_m",
    "payload_qw", "payload_qx", "payload_qy", "payload_qz",
    "payload_vx_mps", "payload_vy_mps", "payload_vz_mps",
    "payload_wx_radps", "payload_wy_radps", "payload_wz_radps",
)  # fmt: skip
REFERENCE_COLUMNS = ("time_s", "x_m", "y_m", "z_m", "vx_mps", "vy_mps", "vz_mps")
# The estimate: the payload's state and the disturbance force on it, as estimated.
ESTIMATE_COLUMNS = ("time_s", *PAYLOAD_COLUMNS, "disturbance_x_n", "disturbance_y_n", "disturbance_z_n")
# Wall-clock times stand in this table only, so that every other one repeats to the byte.
STEP_COLUMNS = (
    "time_s", "estimator_ms", "planner_ms", "mpc_ms", "total_ms", "solver_iterations", "infeasible",
)  # fmt: skip
# What the ground computed beside ``estimator_ms`` and ``planner_ms``; all of it is ``total_ms``. Of ``control_ms``,
# ``mpc_ms`` is the tracker's.
STEP_PART_COLUMNS = (
    "telemetry_ms", "perception_ms", "control_ms", "stop_plan_ms", "monitoring_ms", "recording_ms", "setpoints_ms",
)  # fmt: skip
# What was tracked, and what the safety filter did, at every control step in the air.
PLAN_COLUMNS = (
    "time_s", "x_m", "y_m", "z_m", "ax_mps2", "ay_mps2", "az_mps2", "slack_m", "lag_m", "clock_rate", "detours",
    "payload_bound_m", "uav_bound_m", "sight_rate", "sight_m", "sight_limit", "plan_clearance_m", "verified", "solved",
)  # fmt: skip
OBSTACLE_COLUMNS = (
    "time_s", "name", "shape", "x_m", "y_m", "z_m", "radius_m", "size_x_m", "size_y_m", "size_z_m", "yaw_rad",
)  # fmt: skip
# The obstacles tracked by the vehicles' sensors, as estimated; columns as above.
OBSTACLE_ESTIMATE_COLUMNS = (
    "time_s", "name", "kind", "x_m", "y_m", "z_m", "vx_mps", "vy_mps", "vz_mps", "radius_m",
    "size_x_m", "size_y_m", "size_z_m", "yaw_rad", "growth_m",
)  # fmt: skip
# What the vehicles' sensors have seen to stand: the boxes that cover it; a row when one is new, changes, or is no more.
STANDING_OBSTACLE_COLUMNS = (
    "time_s", "name", "x_m", "y_m", "z_m", "size_x_m", "size_y_m", "size_z_m", "yaw_rad",
)  # fmt: skip
# What each vehicle flew from when on, as it stood on board, and whether against the ground's intention.
MODE_COLUMNS = ("time_s", "vehicle", "mode", "armed", "failsafe")

# Alarms of the ground.
ALARMS = "alarms.csv"
ALARM_COLUMNS = ("time_s", "source", "code", "severity", "text")

Cell = float | int | bool | str


def truth_columns(number_of_uavs: int) -> tuple[str, ...]:
    """Return the columns of ``truth.csv``."""
    parts = ("x_m", "y_m", "z_m", "qw", "qx", "qy", "qz", "thrust_n")
    uavs = tuple(f"uav{i}_{part}" for i in range(1, number_of_uavs + 1) for part in parts)
    return ("time_s", *PAYLOAD_COLUMNS, *uavs, "contacts")


class TableWriter(AppendOnlyFile):
    """Writes a CSV file: the header once, then rows; the same rows give the same bytes.

    Numbers are written in the shortest form that reads back to the same double.
    """

    def __init__(
        self,
        path: Path | str,
        columns: Sequence[str],
        incomplete: IncompleteRecords | None = None,
        *,
        when_needed: bool = False,
    ) -> None:
        """See :class:`AppendOnlyFile`."""
        self.columns = tuple(columns)
        super().__init__(path, incomplete, head=_line(self.columns), when_needed=when_needed)

    def write(self, row: Iterable[Cell]) -> None:
        """Append one row, a value a column. Raises :class:`ValueError` for another number of values."""
        self.append(self._row(row))

    def write_behind(self, first: float, rests: Iterable[bytes]) -> None:
        """Append rows in one record: the number ``first``, and behind it what :meth:`rest` has made."""
        head = repr(first).encode() + b","
        self.append(head + head.join(rests))

    def rest(self, cells: Iterable[Cell]) -> bytes:
        """Return a row without its first cell, to be written often. Raises as :meth:`write`."""
        return self._row((0, *cells)).removeprefix(b"0,")

    def _row(self, row: Iterable[Cell]) -> bytes:
        cells = [_FORMATS.get(type(value), _cell)(value) for value in row]
        if len(cells) != len(self.columns):
            raise ValueError(f"{self.path.name}: {len(cells)} values for {len(self.columns)} columns")
        return _line(cells)

    def write_numbers(self, *rows: Sequence[float | int]) -> None:
        """Append rows of floats and integers in one record; see :meth:`write`."""
        for row in rows:
            if len(row) != len(self.columns):
                raise ValueError(f"{self.path.name}: {len(row)} values for {len(self.columns)} columns")
        lines = orjson.dumps(rows, option=orjson.OPT_SERIALIZE_NUMPY)[2:-2]
        if b"null" in lines:  # JSON has neither inf nor nan
            self.append(b"".join(map(self._row, rows)))
        else:
            self.append(lines.replace(b"],[", b"\n") + b"\n")


_FORMATS: dict[type, Callable[[Any], str]] = {float: repr, int: repr, str: str}
"""How values of these types are written; others by :func:`_cell`."""


def _cell(value: Cell) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, (bool, np.bool_)):
        return "1" if value else "0"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    return repr(float(value))


def _line(cells: Sequence[str]) -> bytes:
    line = ",".join(cells)
    if '"' in line or "\n" in line or "\r" in line or line.count(",") != len(cells) - 1:
        buffer = io.StringIO()
        # A line break inside a cell would break the rule that a line is a row.
        csv.writer(buffer, lineterminator="").writerow([" ".join(cell.splitlines()) for cell in cells])
        line = buffer.getvalue()
    return (line + "\n").encode()


def read_table(path: Path | str) -> dict[str, Array]:
    """Return the columns of a numeric table, each (rows,). Otherwise like :func:`read_text_table`."""
    columns, lines = _read_lines(path)
    numbers = _plain_numbers(lines, len(columns))
    if numbers is not None:
        return dict(zip(columns, np.ascontiguousarray(numbers.T), strict=True))
    table = _text_table(path, columns, lines)
    try:
        return {name: np.array(cells, dtype=float) for name, cells in table.items()}
    except ValueError:
        raise UnusableInput(f"{path}, {_first_bad_cell(table)} is not a number") from None


def read_text_table(path: Path | str) -> dict[str, list[str]]:
    """Return the columns of a table as text.

    A last line without its line break, as a killed process may leave, is left out. Raises :class:`UnusableInput`, with
    file and line, for a file that cannot be read or is not such a table.
    """
    return _text_table(path, *_read_lines(path))


def structured_array(name: str, text: str, text_columns: Collection[str] = ()) -> NDArray[np.void]:
    """Return a table (``text`` of a file ``name``) as a structured array (rows,) with a field a column.

    Fields are float64, those of ``text_columns`` text. Raises as :func:`read_table`.
    """
    columns, lines = _lines_of(name, text)
    numbers = _plain_numbers(lines, len(columns))
    if numbers is not None:
        return np.ascontiguousarray(numbers).view([(column, float) for column in columns]).reshape(len(lines))
    table = _text_table(name, columns, lines)
    try:
        arrays = {c: np.array(cells, dtype=str if c in text_columns else float) for c, cells in table.items()}
    except ValueError:
        raise UnusableInput(f"{name}, {_first_bad_cell(table)} is not a number") from None
    found = np.empty(len(lines), dtype=[(column, array.dtype) for column, array in arrays.items()])
    for column, array in arrays.items():
        found[column] = array
    return found


def _read_lines(path: Path | str) -> tuple[list[str], list[str]]:
    """Return the names of the columns, and the complete lines below them."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except OSError as error:
        raise UnusableInput(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise UnusableInput(f"{path}: is not a text file") from None
    return _lines_of(path, text)


def _lines_of(path: Path | str, text: str) -> tuple[list[str], list[str]]:
    header, *lines = text.split("\n")
    if not lines:
        raise UnusableInput(f"{path}, line 1: the header is missing or cut off")
    return header.split(","), lines[:-1]


def _plain_numbers(lines: Sequence[str], columns: int) -> Array | None:
    """Return the rows (rows, columns) of lines that are numbers as JSON has them, None for any others."""
    text = "\n".join(lines).encode()
    if text.translate(None, b"0123456789.eE+-,\n"):
        return None
    try:
        rows = np.array(orjson.loads(b"[[" + text.replace(b"\n", b"],[") + b"]]"), dtype=float)
    except ValueError:
        return None
    return rows if rows.shape == (len(lines), columns) else None


def _text_table(path: Path | str, columns: Sequence[str], lines: Sequence[str]) -> dict[str, list[str]]:
    rows = list(csv.reader(lines))
    for number, row in enumerate(rows, start=2):
        if len(row) != len(columns):
            raise UnusableInput(f"{path}, line {number}: {len(row)} values for {len(columns)} columns")
    return (
        dict(zip(columns, map(list, zip(*rows, strict=True)), strict=True)) if rows else {name: [] for name in columns}
    )


def _first_bad_cell(table: Mapping[str, Sequence[str]]) -> str:
    for number, row in enumerate(zip(*table.values(), strict=True), start=2):
        for name, cell in zip(table, row, strict=True):
            try:
                float(cell)
            except ValueError:
                return f"line {number}, {name}: {cell!r}"
    raise AssertionError("all cells are numbers")
