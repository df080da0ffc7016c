"""Times at which the vehicles left OFFBOARD, from ``modes.csv`` of a run folder."""

from pathlib import Path

from gcs.record.tables import MODE_COLUMNS, read_text_table

MODES = "modes.csv"
OFFBOARD = "OFFBOARD"


def stops_after(run_dir: Path | str, since: float) -> dict[int, float]:
    """Return when each vehicle first left OFFBOARD, or its failsafe took over, from ``since`` on (s), by system id.

    Without those that did not, and empty without the file. Raises :class:`gcs.errors.UnusableInput` for a damaged one.
    """
    path = Path(run_dir) / MODES
    if not path.exists() or path.stat().st_size == 0:
        return {}
    table = read_text_table(path)
    stops: dict[int, float] = {}
    for time, vehicle, mode in zip(*(table[name] for name in MODE_COLUMNS[:3]), strict=True):
        if float(time) >= since and mode != OFFBOARD:
            stops.setdefault(int(vehicle), float(time))
    return stops
