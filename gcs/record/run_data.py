"""The records of a run folder, finished or cut off, as arrays."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from copy import copy
from dataclasses import dataclass, fields, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from gcs.config.system import SystemConfig
from gcs.config.tables import PadSettings
from gcs.errors import UnusableInput
from gcs.mission.fence import boundary_walls
from gcs.record.clearance import Formation, ObstacleTrack
from gcs.record.obstacle_shapes import OBSTACLE_SHAPES, read_shape
from gcs.record.reader import Table, read_json, read_table
from gcs.record.run_folder import MANIFEST, SUMMARY
from gcs.record.tables import ESTIMATE, OBSTACLES, PAYLOAD_COLUMNS, REFERENCE, REFERENCE_COLUMNS, STEPS, TRUTH
from idc_controller.arrays import Array
from idc_controller.errors import ShapeError
from idc_controller.geometry.shape import Columns
from idc_controller.parameters import PayloadHull


class RunTables(dict[str, Table]):
    """The tables of a run folder by file, each read when it is first asked for; see :func:`read_table`."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def __missing__(self, file: str) -> Table:
        self[file] = table = read_table(self._folder / file)
        return table


@dataclass(frozen=True, eq=False)
class RunData:
    """The records of a flight: T rows of N UAVs. NED, SI, w-first quaternions body to world.

    ``source`` is ``truth``, or ``estimate`` when the folder has no truth; N is 0 then and ``contacts`` is None.
    ``tables`` are without rows, ``manifest`` and ``summary``, the JSON objects, empty when absent.
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
    tables: Mapping[str, Table]
    manifest: Mapping[str, Any]
    summary: Mapping[str, Any]

    @property
    def number_of_uavs(self) -> int:
        """Number of UAVs on record, N; 0 for an estimate."""
        return int(self.uav_position.shape[1])

    @property
    def reference(self) -> Table:
        """The payload's reference by the mission."""
        return self.tables[REFERENCE]

    @property
    def steps(self) -> Table:
        """The compute times of the control steps."""
        return self.tables[STEPS]

    @property
    def reference_position(self) -> Array:
        """The reference's position (rows, 3)."""
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
        return tuple(
            ObstacleTrack(wall.name, wall.shape, np.broadcast_to(wall.position, (len(self.time), 3)))
            for wall in boundary_walls(boundary)
        )

    @property
    def barriers(self) -> tuple[ObstacleTrack, ...]:
        """All that the formation keeps clear of: the obstacles, then the fence."""
        return (*self.obstacles, *self.fence)

    @cached_property
    def clearance(self) -> Array:
        """Distance from the formation to the nearest of the barriers (T,) (m), NaN where unknown."""
        return self.formation(slice(None)).clearance(self.barriers)

    def clearances(self, rows: slice) -> Array:
        """Return the distance to each of the barriers (K, number of them) (m) in some rows, NaN where unknown."""
        return self.formation(rows).clearances([replace(b, position=b.position[rows]) for b in self.barriers])

    def formation(self, rows: slice) -> Formation:
        """Return the formation at some rows."""
        return Formation(
            self.payload_position[rows], self.payload_quaternion[rows], self.uav_position[rows],
            self.uav_quaternion[rows], self.payload, self.setting("uav", "disc_radius"),
        )  # fmt: skip

    def level_formation(self, places: Array) -> Formation:
        """Return the formation with its payload at ``places`` (K, 3), all level and all links upright."""
        upright = self.uav_position[0] - self.payload_position[0]
        level = np.tile([1.0, 0.0, 0.0, 0.0], (len(places), len(upright), 1))
        uavs = places[:, None] + upright
        return replace(
            self.formation(slice(0)),
            payload_position=places, payload_quaternion=level[:, 0], uav_position=uavs, uav_quaternion=level,
        )  # fmt: skip

    def barriers_at(self, times: Array) -> list[ObstacleTrack]:
        """Return the barriers at ``times`` (K,) (s) within the flight."""
        return [
            replace(b, position=np.column_stack([np.interp(times, self.time, axis) for axis in b.position.T]))
            for b in self.barriers
        ]


def position_error(run: RunData) -> tuple[Array, Array]:
    """Return times (K,) (s) within the reference's span, and position minus reference then (K, 3) (m)."""
    if not len(run.reference):
        return np.empty(0), np.empty((0, 3))
    at = run.reference["time_s"]
    inside = (run.time >= at[0]) & (run.time <= at[-1])
    time = run.time[inside]
    wanted = [np.interp(time, at, axis) for axis in run.reference_position.T]
    return time, run.payload_position[inside] - np.column_stack(wanted)


def read_run(run_dir: Path | str, tables: Mapping[str, Table] | None = None) -> RunData:
    """Read a run folder; files and rows that a cut-off flight did not write are just absent.

    ``tables`` are those of the folder that have been read already, or some of their rows. T is 0 where nothing was
    recorded. Raises :class:`UnusableInput` for a folder that is not a run and for a
    damaged file.
    """
    folder = Path(run_dir)
    if not folder.is_dir():
        raise UnusableInput(f"{folder}: is not a folder")
    if not any((folder / name).exists() for name in (MANIFEST, TRUTH, ESTIMATE)):
        raise UnusableInput(f"{folder}: is not a run folder: it holds no {MANIFEST}, {TRUTH} or {ESTIMATE}")
    tables = RunTables(folder) if tables is None else tables
    # A truth of no rows (its world never ran) must not hide what the ground recorded.
    from_truth = len(tables[TRUTH]) > 0
    state = tables[TRUTH if from_truth else ESTIMATE]
    if from_truth and PAYLOAD_COLUMNS[0] not in (state.dtype.names or ()):
        raise UnusableInput(f"{folder}: vehicles without a payload flew here: nothing but its tables can be shown")
    n = sum(name.endswith("_thrust_n") for name in state.dtype.names or ())

    def stack(prefix: str, parts: Iterable[str]) -> Array:
        return np.column_stack([state[f"{prefix}_{part}"] for part in parts])

    def uavs(*parts: str) -> Array:
        each = [stack(f"uav{i}", parts) for i in range(1, n + 1)]
        return np.stack(each, axis=1) if each else np.empty((len(state), 0, len(parts)))

    position, quaternion = ("x_m", "y_m", "z_m"), ("qw", "qx", "qy", "qz")
    return RunData(
        folder=folder,
        source="truth" if from_truth else "estimate",
        time=np.ascontiguousarray(state["time_s"]),
        payload_position=stack("payload", position),
        payload_quaternion=stack("payload", quaternion),
        payload_velocity=stack("payload", ("vx_mps", "vy_mps", "vz_mps")),
        uav_position=uavs(*position),
        uav_quaternion=uavs(*quaternion),
        thrust=uavs("thrust_n")[:, :, 0],
        contacts=np.ascontiguousarray(state["contacts"]) if from_truth else None,
        obstacles=_obstacles(tables[OBSTACLES], state["time_s"], folder) if from_truth else (),
        tables=tables,
        manifest=read_json(folder / MANIFEST),
        summary=read_json(folder / SUMMARY),
    )


def _obstacles(table: Table, time: Array, folder: Path) -> tuple[ObstacleTrack, ...]:
    """Return the obstacles over the times of the truth; NaN where a cut-off flight left no row of one that moves."""
    rows_of: dict[str, list[int]] = {}
    for row, name in enumerate(table["name"]):
        rows_of.setdefault(name, []).append(row)
    shapes = read_json(folder / OBSTACLE_SHAPES)
    tracks = []
    for name, rows in rows_of.items():
        found = table[rows]
        kind, radius, *size, yaw = found[["shape", "radius_m", "size_x_m", "size_y_m", "size_z_m", "yaw_rad"]][0].item()
        places = np.column_stack([found[axis] for axis in ("x_m", "y_m", "z_m")])
        if len(rows) == 1:  # it stands
            track = np.broadcast_to(places, (len(time), 3))
        else:
            track = np.full((len(time), 3), np.nan)
            _, at, known = np.intersect1d(time, found["time_s"], return_indices=True)
            track[at] = places[known]
        try:
            shape = read_shape(kind, Columns(radius, (size[0], size[1], size[2]), yaw), shapes.get(name))
        except ShapeError as error:
            raise UnusableInput(f"{folder / OBSTACLES}: obstacle {name}: {error}") from error
        tracks.append(ObstacleTrack(name, shape, track))
    return tuple(tracks)
