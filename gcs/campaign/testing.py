"""Flights with faults in tests: the fixture ``fly_with_faults`` (:mod:`gcs.campaign.pytest_plugin`)."""

import dataclasses
import shlex
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import gcs
from gcs.campaign.folder import plain, shown
from gcs.errors import GcsError
from gcs.faults import KINDS
from gcs.mission.model import Fault, Mission

AnyFault = Fault | Mapping[str, Any] | Any
"""A :class:`Fault`, the keys of a ``[[fault]]`` table, or the parameters of a kind (``gcs.faults.link.PacketLoss``)."""


def fault(
    parameters: Any,
    start: float | None = None,
    duration: float | None = None,
    *,
    every: float | None = None,
    times: int | None = None,
    vehicles: Sequence[int] | None = None,
    direction: Any = None,
    start_phase: Any = None,
    start_offset: float | None = None,
    start_flight: int | None = None,
) -> Fault:
    """A fault with ``parameters`` of a kind, such as ``gcs.faults.link.PacketLoss(probability=0.3)``.

    The rest is as in a mission file (s); with neither a start nor a phase it starts at take-off.

    Raises :class:`TypeError` for what are not the parameters of a kind.
    """
    names = [kind.name for kind in KINDS.values() if type(parameters) is kind.settings]
    if not names:
        raise TypeError(f"{parameters!r} are not the parameters of a kind of fault")
    named = None if vehicles is None else tuple(vehicles)
    settings = dataclasses.asdict(parameters)
    start = 0.0 if start is None and start_phase is None else start
    return Fault(
        names[0], start, duration, every, times, named, direction, settings, start_phase=start_phase,
        start_offset=start_offset, start_flight=start_flight,
    )  # fmt: skip


class FaultFlights:
    """Calls :func:`gcs.fly`; missions are looked for in ``beside`` first, run folders are in ``folder``."""

    def __init__(self, folder: Path, beside: Path) -> None:
        self._folder, self._beside = folder, beside
        self.log: list[str] = []
        """Verdict, figures, alarms, run folder and replay command of every flight."""

    def __call__(self, mission: Path | str | Mission, faults: Iterable[AnyFault] = (), **options: Any) -> "gcs.Flight":
        """Fly ``mission`` with ``faults`` after its own; ``options`` and errors are those of :func:`gcs.fly`."""
        __tracebackhide__ = True
        if not isinstance(mission, Mission) and (self._beside / mission).is_file():
            mission = self._beside / mission
        name = mission.name if isinstance(mission, Mission) else Path(mission).stem
        run_dir = self._folder / f"{len(self.log) + 1}-{plain(name)[:60]}"
        try:
            flight = gcs.fly(mission, faults=faults, run_dir=run_dir, **options)
        except GcsError as error:
            self.log.append(f"{name}: not flown")
            raise error.with_traceback(None) from None
        self.log.append("\n  ".join(_report(flight)))
        return flight


def _report(flight: "gcs.Flight") -> Iterable[str]:
    """Yield the lines on a flight for who reads why a test has failed."""
    yield repr(flight)
    names = ("duration_s", "contacts", "clearance_min_m", "uav_separation_min_m")
    yield ", ".join(f"{name} {flight.figures[name]}" for name in names)
    for name, entry in flight.figures["limits"].items():
        yield f"{name} {entry['value']} (limit {entry['limit']}{'' if entry['held'] else ', not held'})"
    for time, source, code, severity, text in flight.alarms.tolist():
        yield f"{time:.2f} s {severity}: {source}: {code}: {text}"
    if flight.run_dir is not None:
        yield f"run folder {shown(flight.run_dir)}"
    yield shlex.join(["python", "-c", f"import gcs; print({flight.replay})"])
