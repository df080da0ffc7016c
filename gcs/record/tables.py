"""The tables (CSV) of a run folder: their columns and their writer."""

import csv
import io
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import orjson

from gcs.record.append_file import AppendOnlyFile
from gcs.record.incomplete import IncompleteRecords

PAYLOAD_COLUMNS = (
    "payload_x_m", "payload_y_m", "payload_z_m",
    "payload_qw", "payload_qx", "payload_qy", "payload_qz",
    "payload_vx_mps", "payload_vy_mps", "payload_vz_mps",
    "payload_wx_radps", "payload_wy_radps", "payload_wz_radps",
)  # fmt: skip
REFERENCE_COLUMNS = ("time_s", "x_m", "y_m", "z_m", "vx_mps", "vy_mps", "vz_mps")
# The estimate: the payload's state and the disturbance force on it, as estimated; then their standard deviations, of
# the attitude those of three angles.
_DISTURBANCE_COLUMNS = ("disturbance_x_n", "disturbance_y_n", "disturbance_z_n")
ESTIMATE_SD_COLUMNS = tuple(
    f"{name}_sd"
    for name in (
        *PAYLOAD_COLUMNS[:3], "payload_roll_rad", "payload_pitch_rad", "payload_yaw_rad", *PAYLOAD_COLUMNS[7:],
        *_DISTURBANCE_COLUMNS,
    )
)  # fmt: skip
PAYLOAD_MASS_COLUMN = "payload_mass_kg"
ESTIMATE_COLUMNS = ("time_s", *PAYLOAD_COLUMNS, *_DISTURBANCE_COLUMNS, *ESTIMATE_SD_COLUMNS, PAYLOAD_MASS_COLUMN)
# Innovation tests of each channel of each source, the largest ratio since the row before.
INNOVATION_COLUMNS = ("time_s", "source", "channel", "test_ratio", "state")
# The planned path (kind plan) and the stop plan of that moment (stop), by the stage of the safety filter's horizon.
HORIZON_COLUMNS = ("time_s", "kind", "step", "x_m", "y_m", "z_m")
# Wall-clock times stand in this table only, so that every other one repeats to the byte. ``total_ms`` is all that the
# ground computed; of ``control_ms``, ``mpc_ms`` is the tracker's.
STEP_COLUMNS = (
    "time_s", "estimator_ms", "planner_ms", "mpc_ms", "total_ms", "solver_iterations", "infeasible",
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

# What the payload's grippers have done, with the mass that moved and the payload's after it.
CARGO_COLUMNS = ("time_s", "gripper", "action", "mass_kg", "payload_mass_kg")

ALARM_COLUMNS = ("time_s", "source", "code", "severity", "text")
PHASE_COLUMNS = ("time_s", "phase")


def truth_columns(number_of_uavs: int, payload: bool = True) -> tuple[str, ...]:
    """Return the columns of ``truth.csv``; a swarm without a ``payload`` has none of it."""
    parts = ("x_m", "y_m", "z_m", "qw", "qx", "qy", "qz", "thrust_n")
    uavs = tuple(f"uav{i}_{part}" for i in range(1, number_of_uavs + 1) for part in parts)
    return ("time_s", *(PAYLOAD_COLUMNS if payload else ()), *uavs, "contacts")


def force_columns(number_of_uavs: int) -> tuple[str, ...]:
    """Return the columns of ``forces.csv``: the tension of each link."""
    return ("time_s", *[f"link{i}_n" for i in range(1, number_of_uavs + 1)])


TRUTH, OBSTACLES, MODES, ALARMS = "truth.csv", "obstacles.csv", "modes.csv", "alarms.csv"
CARGO = "cargo.csv"
PHASES = "phases.csv"
REFERENCE, ESTIMATE, PLAN, STEPS = "reference.csv", "estimate.csv", "plan.csv", "steps.csv"
FORCES, INNOVATIONS, HORIZON = "forces.csv", "innovations.csv", "horizon.csv"
COLUMNS: Mapping[str, tuple[str, ...]] = {
    TRUTH: truth_columns(0), OBSTACLES: OBSTACLE_COLUMNS, MODES: MODE_COLUMNS, ALARMS: ALARM_COLUMNS,
    REFERENCE: REFERENCE_COLUMNS, ESTIMATE: ESTIMATE_COLUMNS, PLAN: PLAN_COLUMNS, STEPS: STEP_COLUMNS,
    PHASES: PHASE_COLUMNS, CARGO: CARGO_COLUMNS,
    FORCES: force_columns(0), INNOVATIONS: INNOVATION_COLUMNS, HORIZON: HORIZON_COLUMNS,
}  # fmt: skip
"""Columns that a file has; ``truth.csv`` also those of the UAVs, ``forces.csv`` those of the links."""
LATER_COLUMNS = frozenset((*ESTIMATE_SD_COLUMNS, PAYLOAD_MASS_COLUMN))
"""Those that a file of an earlier version may lack; they are read as nan then."""
TEXT_COLUMNS = frozenset(
    ("name", "shape", "kind", "mode", "phase", "source", "channel", "state", "code", "severity", "text", "action")
)
"""Columns of text in any table; all others are of numbers."""

Cell = float | int | bool | str
GRID_TOLERANCE = 1e-6
"""s, by which a time may be before its row on a grid of times."""


class Grid:
    """Multiples of an ``interval`` (s), at each of which a row is due once."""

    def __init__(self, interval: float) -> None:
        self._interval, self._next = interval, -math.inf

    def is_due(self, time: float) -> bool:
        """Return whether a row is due at ``time`` (s); if so, the next one is at the multiple after it."""
        if time < self._next - GRID_TOLERANCE:
            return False
        self._next = (math.floor(time / self._interval + GRID_TOLERANCE) + 1) * self._interval
        return True


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

    def write(self, *rows: Iterable[Cell]) -> None:
        """Append rows, a value a column, in one record. Raises :class:`ValueError` for another number of values."""
        self.append(b"".join(map(self._row, rows)))

    def _row(self, row: Iterable[Cell]) -> bytes:
        cells = [_FORMATS.get(type(value), _cell)(value) for value in row]
        if len(cells) != len(self.columns):
            raise ValueError(f"{self.path.name}: {len(cells)} values for {len(self.columns)} columns")
        return _line(cells)

    def write_numbers(self, *rows: Sequence[float | int | str]) -> None:
        """Append rows of floats, integers and plain words in one record; see :meth:`write`."""
        for row in rows:
            if len(row) != len(self.columns):
                raise ValueError(f"{self.path.name}: {len(row)} values for {len(self.columns)} columns")
        lines = orjson.dumps(rows, option=orjson.OPT_SERIALIZE_NUMPY)[2:-2]
        if b"null" in lines:  # JSON has neither inf nor nan
            self.append(b"".join(map(self._row, rows)))
        else:
            self.append(lines.replace(b"],[", b"\n").replace(b'"', b"") + b"\n")


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
