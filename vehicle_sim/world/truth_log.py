"""``truth.csv``, ``forces.csv``, ``obstacles.csv``, ``modes.csv``, ``cargo.csv``: the true state, by the world."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from gcs.record.incomplete import IncompleteRecords
from gcs.record.obstacle_shapes import OBSTACLE_SHAPES, write_shapes
from gcs.record.run_folder import make_folder
from gcs.record.tables import (
    CARGO,
    CARGO_COLUMNS,
    FORCES,
    MODE_COLUMNS,
    OBSTACLE_COLUMNS,
    TableWriter,
    force_columns,
    truth_columns,
)
from idc_controller.arrays import Array

if TYPE_CHECKING:  # the physics engine is not needed to write down what it found
    from vehicle_sim.world.grippers import GripperAction
    from vehicle_sim.world.obstacle_bodies import Obstacle

_POSE_COLUMNS = 7  # of a row of a state: position and attitude
_FORCE_DIGITS = 4  # a tenth of a millinewton


class TruthLog:
    """Writes ``truth.csv``; ``forces.csv``, ``obstacles.csv``, ``modes.csv`` and ``cargo.csv`` from their first row on.

    Rows are equal to the byte for equal states. Raises ``gcs.errors.UnusableInput`` if the folder cannot be
    written or holds a truth already; it is made if it is absent. A full disk stops the writing, not the
    world: see ``incomplete``.
    """

    def __init__(self, run_dir: Path | str, number_of_uavs: int, payload: bool = True) -> None:
        """``payload``: False for vehicles without one, whose truth has no columns of it."""
        self._run_dir = folder = make_folder(run_dir)
        self.incomplete = incomplete = IncompleteRecords()
        self._truth = TableWriter(folder / "truth.csv", truth_columns(number_of_uavs, payload), incomplete)
        self._forces = TableWriter(folder / FORCES, force_columns(number_of_uavs), incomplete, when_needed=True)
        self._obstacles = TableWriter(folder / "obstacles.csv", OBSTACLE_COLUMNS, incomplete, when_needed=True)
        self._modes = TableWriter(folder / "modes.csv", MODE_COLUMNS, incomplete, when_needed=True)
        self._cargo = TableWriter(folder / CARGO, CARGO_COLUMNS, incomplete, when_needed=True)
        self._has_payload = payload
        self._shapes_written = False
        self._flown: dict[int, tuple[str, bool, bool]] = {}

    def write(
        self, time: float, states: Array, thrusts: Sequence[float], contacts: int, obstacles: Sequence[Obstacle] = ()
    ) -> None:
        """Append the state at a ``time`` (s), and ``obstacles``: at first all, then those that move.

        ``states`` (N + 1, 13) as in :mod:`.state_kernels`, without a payload (N, 13); ``thrusts`` (N) of the UAVs;
        ``contacts`` is the number of touching pairs, pad and cradles excluded. Raises ``ValueError`` for another number
        of UAVs.
        """
        self.incomplete.time = time
        uavs = states.tolist()
        row = [time]
        if self._has_payload:
            row += uavs.pop(0)
        for uav, thrust in zip(uavs, thrusts, strict=True):
            row += uav[:_POSE_COLUMNS]
            row.append(thrust)
        row.append(contacts)
        self._truth.write_numbers(row)
        if not obstacles or self._obstacles.closed:
            return
        if not self._shapes_written:
            self._shapes_written = True
            self._write_shapes(obstacles)
        self._obstacles.write(*[_row(time, obstacle) for obstacle in obstacles])

    def _write_shapes(self, obstacles: Sequence[Obstacle]) -> None:
        """Write those shapes that the columns do not hold; without them the obstacles cannot be read."""
        try:
            write_shapes(self._run_dir, {obstacle.name: obstacle.shape for obstacle in obstacles})
        except OSError as error:
            path = self._run_dir / OBSTACLE_SHAPES
            path.unlink(missing_ok=True)
            self.incomplete.add(path, error)
            self._obstacles.close()

    def write_tensions(self, time: float, tensions: Sequence[float]) -> None:
        """Append the tension of each link (N) (N) at a ``time`` (s)."""
        self._forces.write_numbers([time, *[round(tension, _FORCE_DIGITS) for tension in tensions]])

    def write_mode(self, time: float, vehicle: int, mode: str, armed: bool, failsafe: bool) -> None:
        """Append what a vehicle (its system id) flies from ``time`` (s) on, if it is not what it flew before."""
        if self._flown.get(vehicle) == (mode, armed, failsafe):
            return
        self._flown[vehicle] = mode, armed, failsafe
        self._modes.write([float(time), vehicle, mode, armed, failsafe])

    def write_cargo(self, action: GripperAction) -> None:
        """Append what a gripper has done."""
        self._cargo.write([*action])

    def close(self) -> None:
        """Close all files; harmless when they are closed already."""
        for table in (self._truth, self._forces, self._obstacles, self._modes, self._cargo):
            table.close()

    def __enter__(self) -> TruthLog:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _row(time: float, obstacle: Obstacle) -> list[float | str]:
    columns = obstacle.shape.columns
    numbers = (*obstacle.position_in_world, columns.radius, *columns.size, columns.yaw)
    return [time, obstacle.name, obstacle.shape.kind, *map(float, numbers)]
