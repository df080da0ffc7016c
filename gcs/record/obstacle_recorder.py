"""Recorder of the obstacles that the ground has detected: tracks, and what stands."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from gcs.record.incomplete import IncompleteRecords
from gcs.record.tables import OBSTACLE_ESTIMATE_COLUMNS, STANDING_OBSTACLE_COLUMNS, Grid, TableWriter

if TYPE_CHECKING:
    from idc_controller.arrays import Array
    from idc_controller.geometry.shape import Shape
    from idc_controller.perception.obstacle_map import ObstacleMap

INTERVAL, STANDING_INTERVAL = 0.1, 1.0
"""s, between rows of the tracks, and of what stands."""
_NOTHING = (0.0,) * 7
"""Columns of a piece that is no more."""


class ObstacleRecorder:
    """Writes both tables of a run, each once there is something for it."""

    def __init__(self, run_dir: Path, incomplete: IncompleteRecords | None = None) -> None:
        self._tracks, self._standing = (
            TableWriter(run_dir / name, columns, incomplete, when_needed=True)
            for name, columns in (
                ("obstacles_estimate.csv", OBSTACLE_ESTIMATE_COLUMNS),
                ("obstacles_standing.csv", STANDING_OBSTACLE_COLUMNS),
            )
        )
        self._pieces: dict[str, tuple[Shape, Array]] = {}
        self._grid, self._standing_grid = Grid(INTERVAL), Grid(STANDING_INTERVAL)

    def record(self, obstacle_map: ObstacleMap, time: float) -> None:
        """Record tracked obstacles at team ``time`` (s), ten times a second, and changes of the standing ones, once."""
        if not self._grid.is_due(time):
            return
        for track in obstacle_map.confirmed_tracks(time):
            shape, columns = track.shape, track.shape.columns
            self._tracks.write(
                [round(time, 6), track.name, shape.kind, *track.position.tolist(), *track.velocity.tolist(),
                 columns.radius, *columns.size, columns.yaw, track.growth]
            )  # fmt: skip
        if self._standing_grid.is_due(time):
            self._record_standing(obstacle_map.seen.pieces, time)

    def close(self) -> None:
        """Close the tables; harmless when they are closed."""
        self._tracks.close()
        self._standing.close()

    def _record_standing(self, pieces: Sequence[tuple[str, Shape, Array]], time: float) -> None:
        """Record which pieces are new, have changed or are no more since the last time."""
        before, self._pieces = self._pieces, {name: (shape, centre) for name, shape, centre in pieces}
        gone = [(name, *_NOTHING) for name in before if name not in self._pieces]
        changed = [
            (name, *centre.tolist(), *shape.columns.size, shape.columns.yaw)
            for name, shape, centre in pieces
            if name not in before or before[name][0] is not shape
        ]
        if rows := [(round(time, 6), *row) for row in (*gone, *changed)]:
            self._standing.write(*rows)
