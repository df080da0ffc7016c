"""What :func:`gcs.fly` returns: the figures and the records of a flight."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gcs.app.fly import FlightResult
from gcs.record.faults import FAULTS_FILE
from gcs.record.outcome import Outcome
from gcs.record.reader import Table, read_json
from gcs.record.setpoints import SentSetpoints
from gcs.record.summary import limits_not_held, within_limits

if TYPE_CHECKING:
    import pandas

_TABLES = (
    "truth", "forces", "reference", "estimate", "innovations", "plan", "horizon", "obstacles", "alarms",
)  # fmt: skip


@dataclass(frozen=True, eq=False, repr=False)
class Flight:
    """A flight that is over.

    Records are structured arrays, a row a time, with the columns of the run folder's tables as fields
    (``flight.truth["payload_x_m"]``; docs/run-folder.md has all). NED, SI; quaternions body to world, w first; times in
    s of the simulation.
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
    incomplete: tuple[str, ...]
    """Names of the records that could not be written in full."""
    truth: Table
    """The true motion of payload and UAVs, thrusts and contacts (rows,), at ``rates.truth``."""
    forces: Table
    """The true tension of each link (N), at the times of ``truth``; negative: compression, nan: not known."""
    reference: Table
    """The payload's reference by the mission, before avoidance (rows,)."""
    estimate: Table
    """The estimate of the payload's state and of the force that disturbs it (N), a row a control step.

    With standard deviations, columns ``..._sd``.
    """
    innovations: Table
    """Innovation tests of each channel at 10 Hz: the largest test ratio since the row before, and its state."""
    plan: Table
    """The plan of the safety filter, a row a control step in the air."""
    horizon: Table
    """The planned path and the stop plan of the payload at 5 Hz, a row a step."""
    obstacles: Table
    """True poses of the obstacles: of one that moves at the times of ``truth``, of one that stands once."""
    alarms: Table
    """Failsafes and alarms (rows,): ``time_s``, ``source``, ``code``, ``severity``, ``text``."""
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
    def setpoints(self) -> Table:
        """Set-points as they were sent, a row a vehicle at each time.

        Fields: ``time_s``, ``vehicle`` (system id), ``qw`` .. ``qz`` (attitude, body to world), ``thrust`` (share of
        the largest, 0 to 1).
        """
        return self._sent.table()

    def frame(self, name: str) -> pandas.DataFrame:
        """Return a record as a pandas frame, by the name of its attribute, such as ``"truth"`` or ``"alarms"``.

        Raises :class:`ValueError` for another name.
        """
        import pandas  # takes long to import

        if name not in (*_TABLES, "setpoints"):
            raise ValueError(f"{name!r} is no record: {', '.join((*_TABLES, 'setpoints'))}")
        return pandas.DataFrame(getattr(self, name))

    def __repr__(self) -> str:
        limits = self.figures["limits"]
        missed = [
            f"{name} {limits[name]['value']} (limit {limits[name]['limit']})" for name in limits_not_held(self.figures)
        ]
        how = f"{self.outcome}, outside its limits" if self.completed and missed else self.outcome
        why = "; ".join(part for part in (*missed, self.reason) if part)
        return f"<flight {self.name}: {how}{f' ({why})' if why else ''}>"


def flown(result: FlightResult, sent: SentSetpoints, replay: str, *, keep: bool) -> Flight:
    """Return a flight with its records, which are read into memory; ``keep``: its run folder is to stay."""
    tables = result.records.tables
    return Flight(
        name=result.mission.name,
        figures=result.summary,
        reason=result.reason,
        faults=tuple(read_json(result.run_dir / FAULTS_FILE).get("faults", ())),
        replay=replay,
        run_dir=result.run_dir if keep else None,
        incomplete=tuple(file.name for file in result.incomplete),
        _sent=sent,
        **{name: tables[f"{name}.csv"] for name in _TABLES},
    )
