"""Flights with faults in tests: the fixture ``fly_with_faults`` (:mod:`gcs.campaign.pytest_plugin`)."""

import dataclasses
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, overload

from gcs.campaign.engine import replay_command
from gcs.campaign.faults.base_mission import read_base
from gcs.campaign.faults.judgement import outcome
from gcs.campaign.flight_worker import FlightWorker
from gcs.campaign.folder import plain, write_text
from gcs.campaign.process_pool import FlownProcess, fly_process
from gcs.errors import GcsError
from gcs.faults import KINDS
from gcs.mission.model import Fault, Limits
from gcs.mission.read import read_mission
from gcs.record.outcome import Outcome
from gcs.record.summary import limits_not_held

AnyFault = Fault | Mapping[str, Any] | Any
"""A :class:`Fault`, the keys of a ``[[fault]]`` table, or the parameters of a kind (``gcs.faults.link.PacketLoss``)."""


def fault(
    parameters: Any,
    start: float = 0.0,
    duration: float | None = None,
    *,
    every: float | None = None,
    times: int | None = None,
    vehicles: Sequence[int] | None = None,
    direction: Any = None,
) -> Fault:
    """A fault with ``parameters`` of a kind, such as ``gcs.faults.link.PacketLoss(probability=0.3)``.

    The rest is as in a mission file (s). Raises :class:`TypeError` for what are not the parameters of a kind.
    """
    names = [kind.name for kind in KINDS.values() if type(parameters) is kind.settings]
    if not names:
        raise TypeError(f"{parameters!r} are not the parameters of a kind of fault")
    named = None if vehicles is None else tuple(vehicles)
    settings = dataclasses.asdict(parameters)
    return Fault(names[0], start, duration, every, times, named, direction, settings)


@dataclass(frozen=True, repr=False)
class FlownWithFaults:
    """One flight: its ``summary.json``, its run folder, and the command that repeats it."""

    seed: int
    summary: dict[str, Any]
    run_dir: Path
    replay: str
    outcome: Outcome
    """How it ended, as ``summary.json`` says."""
    reason: str
    """Why it was not completed; empty: it was."""

    @property
    def within_limits(self) -> bool:
        """True if the flight was completed within its limits."""
        return self.outcome is Outcome.COMPLETED and not self.failures

    @property
    def failures(self) -> list[str]:
        """The names of the limits that were not held."""
        return limits_not_held(self.summary)

    def __repr__(self) -> str:
        limits = self.summary["limits"]
        missed = [f"{name} {limits[name]['value']} (limit {limits[name]['limit']})" for name in self.failures]
        how = f"{self.outcome}, outside its limits" if missed else self.outcome
        why = "; ".join(part for part in (*missed, self.reason) if part)
        return f"<flight of seed {self.seed}: {how}{f' ({why})' if why else ''}>"


class FaultFlights:
    """Flies missions with faults in lockstep, to be closed in the end; missions and run folders are in ``folder``.

    ``beside``: where missions are looked for first; then in the current folder.
    """

    def __init__(self, folder: Path, beside: Path, shown_from: Path) -> None:
        self.folder = folder
        self._beside, self._shown_from = beside, shown_from
        self.log: list[str] = []
        """Verdict, run folder and replay command of every flight."""
        self._count = 0
        self._worker = FlightWorker()

    def close(self) -> None:
        """End the process that flies."""
        self._worker.close()

    @overload
    def __call__(
        self, mission: Path | str, faults: Iterable[AnyFault] = ..., *, limits: Limits | Mapping[str, Any] | None = ...,
        seed: int | None = ..., seeds: None = ..., controller: str = ..., config: Path | str | None = ...,
    ) -> FlownWithFaults: ...  # fmt: skip

    @overload
    def __call__(
        self, mission: Path | str, faults: Iterable[AnyFault] = ..., *, limits: Limits | Mapping[str, Any] | None = ...,
        seeds: Iterable[int], controller: str = ..., config: Path | str | None = ...,
    ) -> list[FlownWithFaults]: ...  # fmt: skip

    def __call__(
        self,
        mission: Path | str,
        faults: Iterable[AnyFault] = (),
        *,
        limits: Limits | Mapping[str, Any] | None = None,
        seed: int | None = None,
        seeds: Iterable[int] | None = None,
        controller: str = "idc",
        config: Path | str | None = None,
    ) -> FlownWithFaults | list[FlownWithFaults]:
        """Fly ``mission`` with ``faults`` after its own; with ``seeds`` a list of flights, one a seed.

        ``limits`` and ``seed`` take the place of the mission's own; ``config`` is a system file. Parameters of a kind
        that come alone act from take-off to the end. Raises :class:`gcs.errors.UnusableInput` for what cannot be
        flown, :class:`GcsError` when a flight could not begin or did not end.
        """
        base = read_base(self._found(mission), None if config is None else Path(config))
        tables = [one if isinstance(one, Fault | Mapping) else fault(one) for one in faults]
        base.write_files(self.folder)
        flights = []
        for one in [base.seed if seed is None else seed] if seeds is None else seeds:
            self._count += 1
            path = self.folder / f"{self._count}-{plain(base.name)[:60]}-seed{one}.toml"
            write_text(path, base.text(base.name, one, tables, limits))
            read_mission(path)  # says what is wrong with faults and limits
            flights.append(self._flown(path, one, controller))
        return flights[0] if seeds is None else flights

    def _flown(self, path: Path, seed: int, controller: str) -> FlownWithFaults:
        options, run_dir = ("--controller", controller), path.with_suffix("")
        replay = replay_command(self._shown(path), options)
        process = fly_process(path, options, run_dir, self._worker) or FlownProcess(1, {}, "", 0.0)
        if not process.summary:
            self.log.append(f"seed {seed}: not flown\n  {replay}")
            raise GcsError(f"{self._shown(path)}: not flown: {process.reason}")
        flown = FlownWithFaults(seed, process.summary, run_dir, replay, outcome(process), process.reason)
        self.log.append(f"{flown}\n  run folder {self._shown(run_dir)}\n  {replay}")
        return flown

    def _found(self, mission: Path | str) -> Path:
        beside = self._beside / mission
        return beside if beside.is_file() else Path(mission)

    def _shown(self, path: Path) -> Path:
        return path.relative_to(self._shown_from) if path.is_relative_to(self._shown_from) else path
