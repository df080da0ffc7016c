"""Times at which the vehicles left OFFBOARD, from ``modes.csv`` of a run folder."""

from pathlib import Path

from gcs.errors import UnusableInput
from gcs.record.reader import read_table
from gcs.record.tables import MODES

OFFBOARD = "OFFBOARD"


def stops_after(run_dir: Path | str, since: float) -> dict[int, float]:
    """Return when each vehicle first left OFFBOARD, or its failsafe took over, from ``since`` on (s), by system id.

    Without those that did not, and empty without the file. Raises :class:`gcs.errors.UnusableInput` for a damaged one.
    """
    stops: dict[int, float] = {}
    for row in read_table(Path(run_dir) / MODES):
        if row["time_s"] >= since and row["mode"] != OFFBOARD:
            stops.setdefault(int(row["vehicle"]), float(row["time_s"]))
    return stops


def armed_at_end(run_dir: Path | str) -> list[int]:
    """Return the system ids of the vehicles that were armed at the end, in rising order.

    Raises :class:`gcs.errors.UnusableInput` where the file is damaged, or absent.
    """
    if not (Path(run_dir) / MODES).exists():
        raise UnusableInput(f"{Path(run_dir) / MODES}: there is no such file")
    armed = {int(row["vehicle"]): bool(row["armed"]) for row in read_table(Path(run_dir) / MODES)}
    return sorted(vehicle for vehicle, is_armed in armed.items() if is_armed)
