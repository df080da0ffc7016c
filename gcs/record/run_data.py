"""The records of a run folder, finished or cut off, as arrays."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from gcs.config.system import SystemConfig
from gcs.config.tables import PadSettings
from gcs.errors import UnusableInput
from gcs.mission.fence import boundary_walls
from gcs.record.clearance import ObstacleTrack, clearance_over_time
from gcs.record.obstacle_shapes import read_shape
from gcs.record.run_folder import MANIFEST
from gcs.record.tables import (
    ESTIMATE_COLUMNS,
    OBSTACLE_COLUMNS,
    REFERENCE_COLUMNS,
    STEP_COLUMNS,
    read_table,
    read_text_table,
    truth_columns,
)
from idc_controller.arrays import Array
from idc_controller.geometry.shape import Columns, Shape
from idc_controller.payload_hull import PayloadHull

Table = dict[str, Array]

SUMMARY, TRUTH = "summary.json", "truth.csv"


@dataclass(frozen=True, eq=False)
class RunData:
    """The records of a flight: T rows of N UAVs. NED, SI, w-first quaternions body to world.

    ``source`` is ``truth``, or ``estimate`` when the folder has no truth; N is 0 then and ``contacts`` is
    None. ``reference`` and ``steps`` are the tables, None when absent; ``manifest`` and ``summary`` the JSON
    objects, empty when absent.
    """

    folder: Path
    source: str
    time: Array  # (T,)
    payload_position: Array  # (T, 3)
    payload_quaternion: Array  # (T, 4)
    payload_velocity: Array  # (T, 3)
    uav_position: Array  # (T, N, 3)
    uav_quaternion: Array  # (T, N, 4)
    thrust: Array  # (T, N)
    contacts: Array | None  # (T,)
    obstacles: tuple[ObstacleTrack, ...]
    reference: Table | None
    steps: Table | None
    manifest: Mapping[str, Any]
    summary: Mapping[str, Any]

    @property
    def number_of_uavs(self) -> int:
        """Number of UAVs on record, N; 0 for an estimate."""
        return int(self.uav_position.shape[1])

    @property
    def reference_position(self) -> Array:
        """The reference's position (rows, 3); no rows without a reference."""
        if self.reference is None:
            return np.empty((0, 3))
        return np.column_stack([self.reference[name] for name in REFERENCE_COLUMNS[1:4]])

    def setting(self, *path: str) -> Any:
        """Return the value at a path of the system file, by the manifest; where that has none, its default."""
        value, default = self.manifest.get("system"), SystemConfig()
        for key in path:
            value, default = value.get(key) if isinstance(value, Mapping) else None, getattr(default, key)
        return default if value is None else value

    @property
    def payload(self) -> PayloadHull:
        """The payload's hull."""
        mesh = self.setting("payload", "mesh")
        return PayloadHull.box(self.setting("payload", "size")) if mesh is None else PayloadHull(mesh["vertices"])

    @property
    def pad(self) -> PadSettings:
        """The pad about home, on which the payload is before take-off."""
        found = self.setting("world", "pad")
        known = {field.name for field in fields(PadSettings)}
        return (
            PadSettings(**{key: value for key, value in found.items() if key in known})
            if isinstance(found, Mapping)
            else found
        )

    @property
    def kept_clearance(self) -> float:
        """What plans keep from obstacles (m): the margin, and what is allowed for the payload's deviation from them."""
        return float(self.setting("avoidance", "margin") + self.setting("safety", "planner", "tracking"))

    def uav_separation(self) -> Array:
        """Return the smallest distance between the centres of two UAVs (T,) (m)."""
        first, second = np.triu_indices(self.number_of_uavs, k=1)
        between = self.uav_position[:, first] - self.uav_position[:, second]
        return np.asarray(np.min(np.linalg.norm(between, axis=-1), axis=1, initial=np.inf))

    def with_summary(self, summary: Mapping[str, Any]) -> RunData:
        """Return the same records, with what has been computed from them, under another summary."""
        other = copy(self)
        object.__setattr__(other, "summary", summary)
        return other

    @cached_property
    def fence(self) -> tuple[ObstacleTrack, ...]:
        """The edges of the area that must not be left, as walls on its outer side."""
        boundary = (self.manifest.get("mission") or {}).get("boundary") or ()
        if boundary and np.ndim(boundary[0]) == 1:  # of an older run, a single ring
            boundary = [boundary]
        return tuple(
            ObstacleTrack(wall.name, wall.shape, np.tile(wall.position, (len(self.time), 1)))
            for wall in boundary_walls(boundary)
        )

    @property
    def barriers(self) -> tuple[ObstacleTrack, ...]:
        """All that the formation keeps clear of: the obstacles, then the fence."""
        return (*self.obstacles, *self.fence)

    @cached_property
    def clearance(self) -> Array:
        """Distance from the formation to each of the barriers (T, number of them) (m), NaN where unknown."""
        return clearance_over_time(
            self.payload_position,
            self.payload_quaternion,
            self.uav_position,
            self.uav_quaternion,
            self.barriers,
            self.payload.vertices,
            self.setting("uav", "disc_radius"),
        )


def position_error(run: RunData) -> tuple[Array, Array]:
    """Return times (K,) (s) within the reference's span, and position minus reference then (K, 3) (m)."""
    if run.reference is None or len(run.reference["time_s"]) == 0:
        return np.empty(0), np.empty((0, 3))
    at = run.reference["time_s"]
    inside = (run.time >= at[0]) & (run.time <= at[-1])
    time = run.time[inside]
    wanted = [np.interp(time, at, axis) for axis in run.reference_position.T]
    return time, run.payload_position[inside] - np.column_stack(wanted)


def read_run(run_dir: Path | str) -> RunData:
    """Read a run folder; files and rows that a cut-off flight did not write are just absent.

    T is 0 where nothing was recorded. Raises :class:`UnusableInput` for a folder that is not a run and for a
    damaged file.
    """
    folder = Path(run_dir)
    if not folder.is_dir():
        raise UnusableInput(f"{folder}: is not a folder")
    if not any((folder / name).exists() for name in (MANIFEST, TRUTH, "estimate.csv")):
        files = "manifest.json, truth.csv or estimate.csv"
        raise UnusableInput(f"{folder}: is not a run folder: it holds no {files}")
    truth = _table(folder / TRUTH)
    # A truth of no rows (its world never ran) must not hide what the ground recorded.
    from_truth = truth is not None and len(truth["time_s"]) > 0
    state = truth if from_truth else _table(folder / "estimate.csv", ESTIMATE_COLUMNS)
    if state is None:
        state = {name: np.empty(0) for name in ESTIMATE_COLUMNS}
    n = sum(name.endswith("_thrust_n") for name in state) if from_truth else 0
    if from_truth:
        _check_columns(folder / TRUTH, state, truth_columns(n))
    time = state["time_s"]

    def stack(prefix: str, parts: tuple[str, ...]) -> Array:
        return np.column_stack([state[f"{prefix}_{part}"] for part in parts])

    def uavs(parts: tuple[str, ...]) -> Array:
        each = [stack(f"uav{i}", parts) for i in range(1, n + 1)]
        return np.stack(each, axis=1) if each else np.empty((len(time), 0, len(parts)))

    position, quaternion = ("x_m", "y_m", "z_m"), ("qw", "qx", "qy", "qz")
    return RunData(
        folder=folder,
        source="truth" if from_truth else "estimate",
        time=time,
        payload_position=stack("payload", position),
        payload_quaternion=stack("payload", quaternion),
        payload_velocity=stack("payload", ("vx_mps", "vy_mps", "vz_mps")),
        uav_position=uavs(position),
        uav_quaternion=uavs(quaternion),
        thrust=uavs(("thrust_n",))[:, :, 0],
        contacts=state["contacts"] if from_truth else None,
        obstacles=_obstacles(folder / "obstacles.csv", time) if from_truth else (),
        reference=_table(folder / "reference.csv", REFERENCE_COLUMNS),
        steps=_table(folder / "steps.csv", STEP_COLUMNS),
        manifest=_json(folder / MANIFEST),
        summary=_json(folder / SUMMARY),
    )


def _table(path: Path, columns: tuple[str, ...] = ("time_s",)) -> Table | None:
    """Return a table, None if it is absent or was cut off before its header was written."""
    if not path.exists() or path.stat().st_size == 0:
        return None
    table = read_table(path)
    _check_columns(path, table, columns)
    return table


def _check_columns(path: Path, table: Mapping[str, object], columns: tuple[str, ...]) -> None:
    for name in columns:
        if name not in table:
            raise UnusableInput(f"{path}, line 1: column {name} is missing")


def _obstacles(path: Path, time: Array) -> tuple[ObstacleTrack, ...]:
    """Return the obstacles over the times of the truth; NaN where a cut-off flight left no row."""
    if not path.exists() or path.stat().st_size == 0:
        return ()
    table = read_text_table(path)
    _check_columns(path, table, OBSTACLE_COLUMNS)
    row_of_time = {moment: row for row, moment in enumerate(time.tolist())}
    seen: Counter[tuple[str, str]] = Counter()
    shapes: dict[tuple[str, int], Shape] = {}
    tracks: dict[tuple[str, int], Array] = {}
    numbers = [table[name] for name in OBSTACLE_COLUMNS if name not in ("time_s", "name", "shape")]
    rows = zip(table["time_s"], table["name"], table["shape"], *numbers, strict=True)
    for line, (moment, name, shape, *cells) in enumerate(rows, start=2):
        try:
            at = float(moment)
            x, y, z, radius, size_x, size_y, size_z, yaw = map(float, cells)
        except ValueError:
            raise UnusableInput(f"{path}, line {line}: a value is not a number") from None
        # Two obstacles of one name are distinguished by their order at that moment.
        key = (name, seen[moment, name])
        seen[moment, name] += 1
        if key not in tracks:
            tracks[key] = np.full((len(time), 3), np.nan)
            shapes[key] = read_shape(path.parent, name, shape, Columns(radius, (size_x, size_y, size_z), yaw))
        if at in row_of_time:
            tracks[key][row_of_time[at]] = (x, y, z)
    return tuple(ObstacleTrack(key[0], shapes[key], track) for key, track in tracks.items())


def _json(path: Path) -> Mapping[str, Any]:
    try:
        text = path.read_text(encoding="utf-8")
        content = json.loads(text) if text.strip() else {}
    except FileNotFoundError:
        return {}
    except OSError as error:
        raise UnusableInput(f"{path}: cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise UnusableInput(f"{path}: is not JSON: {error}") from None
    if not isinstance(content, dict):
        raise UnusableInput(f"{path}: is not a JSON object")
    return content
