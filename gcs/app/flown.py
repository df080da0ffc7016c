"""What :func:`gcs.fly` returns: the figures and the records of a flight."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gcs.app.fly import FlightResult
from gcs.faults.record import FAULTS_FILE
from gcs.record.outcome import Outcome
from gcs.record.setpoints import SentSetpoints
from gcs.record.summary import within_limits
from gcs.record.tables import ALARM_COLUMNS, ALARMS, OBSTACLE_COLUMNS, structured_array

if TYPE_CHECKING:
    import pandas

Records = NDArray[np.void]
_FILES = {name: f"{name}.csv" for name in ("truth", "reference", "estimate", "plan", "obstacles")} | {"alarms": ALARMS}
_TEXTS = {"obstacles": ("name", "shape"), "alarms": ("source", "code", "severity", "text")}
_NO_ROWS = {"obstacles": ",".join(OBSTACLE_COLUMNS) + "\n", "alarms": ",".join(ALARM_COLUMNS) + "\n"}
"""What is read where a flight has left no such file."""


@dataclass(frozen=True, eq=False, repr=False)
class Flight:
    """A flight that is over.

    Records are structured arrays, a row a time, with the columns of the run folder's tables as fields
    (``flight.truth["payload_x_m"]``; docs/run-folder.md has all). NED, SI; quaternions body to world, w first; times in
    s of the simulation. They are read when they are first asked for.
    """

    name: str
    """The mission's name."""
    figures: Mapping[str, Any]
    """The content of ``summary.json``."""
    reason: str
    """Why it was not completed; empty: it was."""
    faults: tuple[Mapping[str, Any], ...]
    """What each fault was and has affected, as in ``faults.json``."""
    replay: str
    """The call that repeats it, as Python source; ``mission`` in it is a mission that was built in Python."""
    run_dir: Path | None
    """The folder of the records; None: none was asked for."""
    _tables: Mapping[str, str]
    _sent: SentSetpoints

    @property
    def outcome(self) -> Outcome:
        """How it ended."""
        return Outcome(self.figures["outcome"])

    @property
    def completed(self) -> bool:
        """True if every waypoint and the landing were reached, and the payload was set down."""
        return bool(self.figures["completed"])

    @property
    def within_limits(self) -> bool:
        """True if it was completed within the limits of the mission."""
        return self.completed and within_limits(self.figures)

    @cached_property
    def truth(self) -> Records:
        """The true motion of payload and UAVs, thrusts and contacts (rows,), at ``rates.truth``."""
        return self._record("truth")

    @cached_property
    def reference(self) -> Records:
        """The payload's reference by the mission, before avoidance (rows,)."""
        return self._record("reference")

    @cached_property
    def estimate(self) -> Records:
        """The estimate of the payload's state and of the force that disturbs it (N), a row a control step."""
        return self._record("estimate")

    @cached_property
    def plan(self) -> Records:
        """The plan of the safety filter, a row a control step in the air."""
        return self._record("plan")

    @cached_property
    def obstacles(self) -> Records:
        """True poses of the obstacles, a row an obstacle at the times of ``truth``; no rows without obstacles."""
        return self._record("obstacles")

    @cached_property
    def setpoints(self) -> Records:
        """Set-points as they were sent, a row a vehicle at each time.

        Fields: ``time_s``, ``vehicle`` (system id), ``qw`` .. ``qz`` (attitude, body to world), ``thrust`` (share of
        the largest, 0 to 1).
        """
        return self._sent.table()

    @cached_property
    def alarms(self) -> Records:
        """Failsafes and alarms (rows,): ``time_s``, ``source``, ``code``, ``severity``, ``text``."""
        return self._record("alarms")

    def frame(self, name: str) -> pandas.DataFrame:
        """Return a record as a pandas frame, by the name of its attribute, such as ``"truth"`` or ``"alarms"``.

        Raises :class:`ValueError` for another name.
        """
        import pandas  # takes long to import

        if name not in (*_FILES, "setpoints"):
            raise ValueError(f"{name!r} is no record: {', '.join((*_FILES, 'setpoints'))}")
        return pandas.DataFrame(getattr(self, name))

    def _record(self, name: str) -> Records:
        return structured_array(_FILES[name], self._tables[name], _TEXTS.get(name, ()))

    def __repr__(self) -> str:
        how = self.outcome if not self.completed or self.within_limits else f"{self.outcome}, outside its limits"
        return f"<flight {self.name}: {how}{f' ({self.reason})' if self.reason else ''}>"


def flown(result: FlightResult, sent: SentSetpoints, replay: str, *, keep: bool) -> Flight:
    """Return a flight with its records, which are read into memory; ``keep``: its run folder is to stay."""
    folder = result.run_dir
    tables = {}
    for name, file in _FILES.items():
        path = folder / file
        tables[name] = path.read_text(encoding="utf-8") if path.exists() else _NO_ROWS[name]
    faults = folder / FAULTS_FILE
    affected = json.loads(faults.read_text(encoding="utf-8"))["faults"] if faults.exists() else ()
    return Flight(
        name=result.mission.name,
        figures=result.summary,
        reason=result.reason,
        faults=tuple(affected),
        replay=replay,
        run_dir=folder if keep else None,
        _tables=tables,
        _sent=sent,
    )
