"""An excerpt of records: the rows of one flight out of those of a world in which several were flown."""

from pathlib import Path

from gcs.record.tables import FORCES, TRUTH

_LASTING = ("modes.csv", "obstacles.csv")
"""Tables whose rows hold until the next one."""


def take_excerpt(source: Path, folder: Path, since: float, until: float) -> None:
    """Copy what the world in ``source`` has recorded from ``since`` to ``until`` (s) into the folder of a flight.

    Of modes and obstacles also what was before. What the world has not recorded is left out.
    """
    for name in (TRUTH, FORCES, *_LASTING):
        if not (source / name).exists():
            continue
        header, *rows = (source / name).read_text(encoding="utf-8").splitlines(keepends=True)
        first = 0.0 if name in _LASTING else since
        kept = (row for row in rows if row.endswith("\n") and first <= float(row.partition(",")[0]) <= until)
        (folder / name).write_text(header + "".join(kept), encoding="utf-8")
