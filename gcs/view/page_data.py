"""The data of the report page: a JSON header, and one compressed blob of all arrays, which the header refers to.

``gcs/view/page/data.js`` decodes both. Times are those of the run folder (s), frames north-east-down, quaternions
body to world, w first.
"""

from __future__ import annotations

import base64
import shlex
import zlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from gcs.record.clearance import ObstacleTrack
from gcs.record.link_figures import link_figures
from gcs.record.reader import Table
from gcs.record.run_data import RunData
from gcs.record.run_folder import to_json
from gcs.record.tables import ESTIMATE, FORCES, HORIZON, INNOVATIONS, PLAN, STEPS
from gcs.record.witness import least_clearance
from gcs.view.page_events import events
from idc_controller.arrays import Array
from idc_controller.geometry.oriented import OrientedShape
from idc_controller.parameters import polygon_attachments

QUANTUM = {"m": 5e-4, "": 5e-5, "m/s": 1e-3, "rad/s": 1e-3, "N": 5e-3, "ms": 5e-3}
"""Steps of 16-bit columns are at most these, by unit; a column that spans more is kept as float32."""
RATE_LONG, LONG = 25.0, 120.0
"""Rows a second (Hz) that are kept of a flight longer than this (s)."""
_SERIES_MAX = 6
"""Barriers whose clearance is shown one by one: those that come nearest."""
_MISSING = 65535
_CUT_OFF = "the records end before the flight does"
_XYZ, _QUATERNION = ("x_m", "y_m", "z_m"), ("qw", "qx", "qy", "qz")
_NED = ("north", "east", "down")


class Blob:
    """Arrays, one after another, each found by the reference that :meth:`add` returns."""

    def __init__(self) -> None:
        self._parts: list[bytes] = []
        self._size = 0

    def add(self, values: Array, unit: str = "") -> dict[str, Any]:
        """Append columns (T, ...) and return their reference.

        Column by column: 16-bit numbers ``first + scale * q``, 65535 for NaN, as differences from row to row, where the
        range of all columns allows a step of :data:`QUANTUM`; otherwise float32.
        """
        columns = np.asarray(values, dtype=float).reshape(len(values), -1).T
        finite = np.where(np.isfinite(columns), columns, np.nan)
        known = np.isfinite(finite).any(axis=1)
        first, last = np.zeros(len(columns)), np.zeros(len(columns))
        first[known], last[known] = np.nanmin(finite[known], axis=1), np.nanmax(finite[known], axis=1)
        scale = (last - first) / (_MISSING - 1)
        reference: dict[str, Any] = {"shape": list(np.shape(values)), "offset": self._size}
        if np.all(scale <= QUANTUM.get(unit, 0.0)) and not np.isinf(columns).any():
            steps = np.rint((finite - first[:, None]) / np.where(scale > 0.0, scale, 1.0)[:, None])
            whole = np.where(np.isfinite(steps), steps, _MISSING).astype(np.int64)
            data = (np.diff(whole, axis=1, prepend=0) % 65536).astype("<u2")
            reference |= {"dtype": "int16", "first": first.tolist(), "scale": scale.tolist()}
        else:
            data = columns.astype("<f4")
            reference["dtype"] = "float32"
        self._append(data)
        return reference

    def add_times(self, times: Array) -> dict[str, Any]:
        """Append times (T,) (s), to the microsecond, as differences, and return their reference."""
        microseconds = np.rint(np.asarray(times) * 1e6).astype(np.int64)
        first = int(microseconds[0]) if len(microseconds) else 0
        reference = {"shape": [len(times)], "offset": self._size, "dtype": "time", "first": first}
        self._append(np.diff(microseconds, prepend=first).astype("<i4"))
        return reference

    def _append(self, data: Any) -> None:
        content = data.tobytes()
        self._parts.append(content + bytes(-len(content) % 4))
        self._size += len(self._parts[-1])

    def encoded(self) -> str:
        """Return all of it, deflated, in base64."""
        return base64.b64encode(zlib.compress(b"".join(self._parts), 6)).decode("ascii")


class PageData:
    """The header and the blob of one run.

    ``so_far``: all rows of the tables of a run that goes on, of which ``run`` has those that are new; None: it is over.
    """

    def __init__(self, run: RunData, so_far: Mapping[str, Table] | None = None) -> None:
        self._run, self._blob, self._is_over = run, Blob(), so_far is None
        self._so_far = run if so_far is None else replace(run, tables=so_far)
        self._channels: dict[str, Any] = {}
        self._times: dict[int, dict[str, Any]] = {}
        lasts = run.time[-1] - run.time[0] if len(run.time) > 1 else 0.0
        dense = lasts > (LONG if self._is_over else 0.0)
        rate = (len(run.time) - 1) / lasts if dense else 0.0
        self._rows = slice(None, None, max(round(rate / RATE_LONG), 1))
        self._motion()
        self._tables()
        self._clearances()
        self._innovations()
        nearest = least_clearance(run) if self._is_over else None
        self.header = {
            "meta": self._meta(),
            "channels": self._channels,
            "events": events(self._so_far, is_over=self._is_over),
            "obstacles": self._obstacles(),
            "tracks": self._tracks(),
            "standing": standing(self._so_far),
            "clearance": None if nearest is None else nearest.header,
        }

    @property
    def blob(self) -> str:
        """The arrays, in base64."""
        return self._blob.encoded()

    def document(self) -> tuple[Mapping[str, Any], str]:
        """Return the header, in terms of strict JSON, and the blob."""
        return to_json(self.header), self.blob

    def _add(self, name: str, time: Array, columns: Sequence[str], unit: str, values: Array) -> None:
        """Add a channel: ``values`` (T, C), or (T, S, C), at ``time`` (T,); without rows or values it is left out."""
        if not len(time) or not np.isfinite(values).any():
            return
        at = self._times.setdefault(id(time), {"of": time, "reference": self._blob.add_times(time)})
        self._channels[name] = {
            "t": at["reference"], "columns": list(columns), "unit": unit, "values": self._blob.add(values, unit),
        }  # fmt: skip

    def _motion(self) -> None:
        run, rows = self._run, self._rows
        time = run.time[rows]
        self._time = time
        state = run.tables[f"{run.source}.csv"][rows]
        self._payload(run.source, state, time)
        for i in range(run.number_of_uavs):
            self._add(f"truth.uav{i + 1}.position", time, _NED, "m", run.uav_position[rows, i])
            self._add(f"truth.uav{i + 1}.attitude", time, "wxyz", "", run.uav_quaternion[rows, i])
        uavs = [f"UAV {i + 1}" for i in range(run.number_of_uavs)]
        if uavs:
            self._add("truth.thrust", time, uavs, "N", run.thrust[rows])
        if run.number_of_uavs > 1:
            self._add("separation", time, ["nearest two"], "m", run.uav_separation()[rows, None])
        reference = self._thinned(run.reference)
        at = np.ascontiguousarray(reference["time_s"])
        self._add("reference.position", at, _NED, "m", stack(reference, _XYZ))
        self._add("reference.velocity", at, _NED, "m/s", stack(reference, ("vx_mps", "vy_mps", "vz_mps")))
        if run.source == "truth":
            estimate = self._thinned(run.tables[ESTIMATE])
            self._payload("estimate", estimate, np.ascontiguousarray(estimate["time_s"]))

    def _payload(self, source: str, table: Table, time: Array) -> None:
        def columns(names: Iterable[str], end: str = "") -> Array:
            return stack(table, [f"payload_{name}{end}" for name in names])

        velocity, rates = ("vx_mps", "vy_mps", "vz_mps"), ("wx_radps", "wy_radps", "wz_radps")
        self._add(f"{source}.payload.position", time, _NED, "m", columns(_XYZ))
        self._add(f"{source}.payload.attitude", time, "wxyz", "", columns(_QUATERNION))
        self._add(f"{source}.payload.velocity", time, _NED, "m/s", columns(velocity))
        self._add(f"{source}.payload.rates", time, ("forward", "right", "down"), "rad/s", columns(rates))
        if source == "estimate":
            self._add("estimate.payload.position_sd", time, _NED, "m", columns(_XYZ, "_sd"))
            force = stack(table, ("disturbance_x_n", "disturbance_y_n", "disturbance_z_n"))
            self._add("estimate.disturbance", time, _NED, "N", force)

    def _thinned(self, table: Table) -> Table:
        """Return the rows of a table that are kept: of a long flight at most :data:`RATE_LONG` a second."""
        if len(table) < 2 or self._rows.step == 1:
            return table
        rate = (len(table) - 1) / max(table["time_s"][-1] - table["time_s"][0], 1e-9)
        return table[:: max(round(rate / RATE_LONG), 1)]

    def _tables(self) -> None:
        plan, steps, forces = (self._thinned(self._run.tables[name]) for name in (PLAN, STEPS, FORCES))
        at = np.ascontiguousarray(plan["time_s"])
        self._add("plan.position", at, _NED, "m", stack(plan, _XYZ))
        for name, column, unit in (
            ("slack", "slack_m", "m"), ("lag", "lag_m", "m"), ("clearance", "plan_clearance_m", "m"),
            ("progress_rate", "clock_rate", ""), ("verified", "verified", ""), ("solved", "solved", ""),
        ):  # fmt: skip
            values = stack(plan, [column])
            # 1e9: no safety filter acts.
            self._add(f"plan.{name}", at, [name], unit, np.where(values > 1e8, np.nan, values))
        at = np.ascontiguousarray(steps["time_s"])
        parts = ("total", "telemetry", "estimator", "perception", "planner", "control")
        self._add("steps.time", at, parts, "ms", stack(steps, [f"{part}_ms" for part in parts]))
        links = [name for name in forces.dtype.names or () if name.startswith("link")]
        names = [f"link {name.removeprefix('link').split('_')[0]}" for name in links]
        if links:
            self._add("truth.tension", np.ascontiguousarray(forces["time_s"]), names, "N", stack(forces, links))
        self._horizons(self._run.tables[HORIZON])
        if not self._is_over:  # the telemetry log has no rows, to read on from the last
            return
        middles, systems, figures = link_figures(self._run.folder / "telemetry.tlog")
        for name, unit in (("loss", "%"), ("latency", "ms"), ("rate", "1/s")):
            if len(middles):
                self._add(f"link.{name}", middles, systems, unit, figures[name])

    def _horizons(self, table: Table) -> None:
        """Add paths (T, S, 3) as channels ``horizon.<kind>``; the steps that a path does not have are NaN."""
        if not len(table):
            return
        kinds = np.array(table["kind"], dtype=str)
        for kind in np.unique(kinds):
            rows = table[kinds == kind]
            at, moment = np.unique(rows["time_s"], return_inverse=True)
            steps, step = np.unique(rows["step"], return_inverse=True)
            paths = np.full((len(at), len(steps), 3), np.nan)
            paths[moment, step] = stack(rows, _XYZ)
            self._add(f"horizon.{kind}", at, _NED, "m", paths)

    def _clearances(self) -> None:
        run = self._run
        if not run.barriers or not run.number_of_uavs:
            return
        self._add("clearance.nearest", self._time, ["nearest"], "m", run.clearance[self._rows, None])
        barriers = run.barriers
        if len(barriers) > _SERIES_MAX:
            if not self._is_over:  # which come nearest is not yet known
                return
            coarse = slice(None, None, self._rows.step * 25)
            order = np.argsort(np.nanmin(run.clearances(coarse), axis=0, initial=np.inf))
            barriers = tuple(barriers[i] for i in sorted(order[:_SERIES_MAX].tolist()))
        each = run.formation(self._rows).clearances([at_rows(b, self._rows) for b in barriers])
        self._add("clearance.each", self._time, [b.name for b in barriers], "m", each)

    def _innovations(self) -> None:
        table = self._run.tables[INNOVATIONS]
        for source, channel, rows in by_channel(table):
            ratio = stack(rows, ["test_ratio"])
            at = np.ascontiguousarray(rows["time_s"])
            self._add(f"innovations.{source}.{channel}", at, ["test ratio"], "", ratio)

    def _tracks(self) -> list[dict[str, Any]]:
        """Return the obstacles that the ground has tracked; the size is the last."""
        table, new = (run.tables["obstacles_estimate.csv"] for run in (self._so_far, self._run))
        found = []
        for name in dict.fromkeys(table["name"] if len(table) else ()):
            rows = new[new["name"] == name]
            channel = f"track.{name}"
            self._add(channel, np.ascontiguousarray(rows["time_s"]), _NED, "m", stack(rows, _XYZ))
            last = table[table["name"] == name][-1]
            size = [float(last[f"size_{axis}_m"]) for axis in "xyz"]
            found.append(
                {"name": name, "kind": last["kind"], "radius": float(last["radius_m"]), "size": size,
                 "yaw": float(last["yaw_rad"]), "growth": float(last["growth_m"]), "channel": channel}
            )  # fmt: skip
        return found

    def _obstacles(self) -> list[dict[str, Any]]:
        of_mission = (self._run.manifest.get("mission") or {}).get("obstacles", ())
        known = {obstacle["name"]: obstacle.get("known", True) for obstacle in of_mission}
        return [self._obstacle(track, known.get(track.name, True)) for track in self._run.obstacles]

    def _obstacle(self, track: ObstacleTrack, known: bool) -> dict[str, Any]:
        shape = track.shape
        found: dict[str, Any] = {
            "name": track.name, "kind": shape.kind, "known": known,
            "quaternion": shape.quaternion, "size": list(shape.columns.size), "radius": shape.columns.radius,
            "channel": None, "position": None,
        }  # fmt: skip
        if isinstance(shape, OrientedShape):
            found |= {"corners": shape.corners.tolist(), "rounding": shape.rounding}
        if track.position.strides[0] == 0:  # it stands
            found["position"] = track.position[0].tolist() if len(track.position) else [0.0, 0.0, 0.0]
        else:
            found["channel"] = f"obstacle.{track.name}"
            self._add(found["channel"], self._time, _NED, "m", track.position[self._rows])
        return found

    def _meta(self) -> dict[str, Any]:
        run = self._run
        mission = run.manifest.get("mission") or {}
        n, attachments = run.setting("team", "vehicles"), run.setting("team", "attachments")
        hull = run.payload
        if attachments is None:
            points = polygon_attachments(n, run.setting("team", "spacing"), -hull.above)
        else:
            centre = (run.setting("payload", "mesh") or {}).get("centre_of_mass", np.zeros(3))
            points = np.reshape(attachments, (-1, 3)) - np.asarray(centre)
        excluded = mission.get("excluded") or []
        by_itself = (run.manifest.get("command") or [""])[0] == "vehicle-sim"
        cut_off = "no ground station" if by_itself else "cut off"
        outcome = run.summary.get("outcome", cut_off) if self._is_over else "in flight"
        return {
            "format": 1,
            "mission": mission.get("name") or run.folder.resolve().name,
            "run": run.folder.resolve().name,
            "seed": run.manifest.get("seed"),
            "start": run.manifest.get("start"),
            "source": run.source,
            "command": command(run.manifest.get("command") or ()),
            "outcome": outcome,
            "reason": run.summary.get("reason", _CUT_OFF if outcome == "cut off" else ""),
            "summary": run.summary,
            "begin": run.time[0] if len(run.time) else 0.0,
            "end": run.time[-1] if len(run.time) else 0.0,
            "vehicles": run.number_of_uavs or n,
            "attachments": points,
            "hull": hull.vertices,
            "disc_radius": run.setting("uav", "disc_radius"),
            "link_length": run.setting("team", "link_length"),
            "thrust_max": run.setting("uav", "thrust_max"),
            "margin": run.setting("avoidance", "margin"),
            "control_period": 1.0 / run.setting("rates", "control"),
            "fence": {"boundary": mission.get("boundary") or [], "excluded": excluded},
            "pad": {"thickness": run.pad.thickness, "margin": run.pad.margin},
        }


def stack(table: Table, columns: Iterable[str]) -> Array:
    """Return columns of a table (T, C); NaN where it has none of that name."""
    names = table.dtype.names or ()
    nothing = np.full(len(table), np.nan)
    return np.column_stack([table[name] if name in names else nothing for name in columns])


def at_rows(track: ObstacleTrack, rows: slice) -> ObstacleTrack:
    """Return the same obstacle at some rows of the flight."""
    return ObstacleTrack(track.name, track.shape, track.position[rows])


def by_channel(table: Table) -> Iterable[tuple[str, str, Table]]:
    """Yield source, channel and rows of ``innovations.csv``."""
    names = [*dict.fromkeys(zip(table["source"], table["channel"], strict=True))] if len(table) else []
    for source, channel in names:
        yield source, channel, table[(table["source"] == source) & (table["channel"] == channel)]


def command(words: Sequence[str]) -> str:
    """Return the command that flies a run again, in a folder of its own, as a shell reads it."""
    if len(words) == 1:  # a call from Python
        return words[0]
    kept, skip = [], False
    for word in words:
        if not skip and word.partition("=")[0] != "--run-dir":
            kept.append(word)
        skip = not skip and word == "--run-dir"
    return shlex.join([Path(kept[0]).name, *kept[1:]]) if kept else ""


def standing(run: RunData) -> list[dict[str, Any]]:
    """Return the boxes that cover what the range sensors have detected, each from when to when it was so."""
    table = run.tables["obstacles_standing.csv"]
    boxes: dict[str, dict[str, Any]] = {}
    found = []
    for row in table:
        if before := boxes.pop(row["name"], None):
            found.append(before | {"end": float(row["time_s"])})
        size = [float(row[f"size_{axis}_m"]) for axis in "xyz"]
        if any(size):
            place = [float(row[axis]) for axis in _XYZ]
            boxes[row["name"]] = {
                "name": row["name"], "start": float(row["time_s"]), "position": place, "size": size,
                "yaw": float(row["yaw_rad"]),
            }  # fmt: skip
    return found + [box | {"end": None} for box in boxes.values()]
