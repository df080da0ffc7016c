"""``truth.csv``, ``obstacles.csv`` and ``modes.csv``: the true state, written by the world."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from gcs.record.obstacle_shapes import write_shapes
from gcs.record.run_folder import make_folder
from gcs.record.tables import MODE_COLUMNS, OBSTACLE_COLUMNS, TableWriter, truth_columns
from idc_controller.arrays import Array

if TYPE_CHECKING:  # the physics engine is not needed to write down what it found
    from vehicle_sim.world.obstacle_bodies import Obstacle

_POSE_COLUMNS = 7  # of a row of a state: position and attitude


class TruthLog:
    """Writes ``truth.csv``; ``obstacles.csv`` and ``modes.csv`` from their first row on.

    Rows are equal to the byte for equal states. Raises ``gcs.errors.UnusableInput`` if the folder cannot be
    written or holds a truth already; it is made if it is absent. A full disk stops the writing, not the
    world: see ``error``.
    """

    def __init__(self, run_dir: Path | str, number_of_uavs: int) -> None:
        self._run_dir = make_folder(run_dir)
        self._truth = TableWriter(self._run_dir / "truth.csv", truth_columns(number_of_uavs))
        self._obstacles: TableWriter | None = None
        self._rows: dict[str, tuple[Obstacle, bytes]] = {}
        """Obstacles as they were last written, with their rows without the time."""
        self._modes: TableWriter | None = None
        self._flown: dict[int, tuple[str, bool, bool]] = {}
        self._closed = False

    @property
    def error(self) -> OSError | None:
        """Error that stopped writing before ``close()``, if any."""
        return next((table.error for table in self._tables if table.error is not None), None)

    @property
    def _tables(self) -> list[TableWriter]:
        return [table for table in (self._truth, self._obstacles, self._modes) if table is not None]

    def write(
        self, time: float, states: Array, thrusts: Sequence[float], contacts: int, obstacles: Sequence[Obstacle] = ()
    ) -> None:
        """Append the state at a ``time`` (s), and the obstacles at that time.

        ``states`` (N + 1, 13) as in :mod:`.state_kernels`, ``thrusts`` (N) of the UAVs; ``contacts`` is the number of
        touching pairs, pad and cradles excluded. Raises ``ValueError`` for another number of UAVs.
        """
        payload, *uavs = states.tolist()
        row = [time, *payload]
        for uav, thrust in zip(uavs, thrusts, strict=True):
            row += uav[:_POSE_COLUMNS]
            row.append(thrust)
        row.append(contacts)
        self._truth.write_numbers(row)
        if not obstacles or self._closed:
            return
        if self._obstacles is None:
            self._obstacles = TableWriter(self._run_dir / "obstacles.csv", OBSTACLE_COLUMNS)
            write_shapes(self._run_dir, {obstacle.name: obstacle.shape for obstacle in obstacles})
        table = self._obstacles
        table.write_behind(time, [self._row(table, obstacle) for obstacle in obstacles])

    def _row(self, table: TableWriter, obstacle: Obstacle) -> bytes:
        """Return the row of an obstacle without its time; of one that has not moved since, the same again."""
        last, row = self._rows.get(obstacle.name, (None, b""))
        if last is not obstacle:
            shape = obstacle.shape
            numbers = (*obstacle.position_in_world, shape.columns.radius, *shape.columns.size, shape.columns.yaw)
            row = table.rest([obstacle.name, shape.kind, *map(float, numbers)])
            self._rows[obstacle.name] = obstacle, row
        return row

    def write_mode(self, time: float, vehicle: int, mode: str, armed: bool, failsafe: bool) -> None:
        """Append what a vehicle (its system id) flies from ``time`` (s) on, if it is not what it flew before."""
        if self._closed or self._flown.get(vehicle) == (mode, armed, failsafe):
            return
        self._flown[vehicle] = mode, armed, failsafe
        if self._modes is None:
            self._modes = TableWriter(self._run_dir / "modes.csv", MODE_COLUMNS)
        self._modes.write([float(time), vehicle, mode, armed, failsafe])

    def close(self) -> None:
        """Close all files; harmless when they are closed already."""
        self._closed = True
        for table in self._tables:
            table.close()

    def __enter__(self) -> TruthLog:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
