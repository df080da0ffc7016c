"""Faults of a mission: read from their tables, and checked against their kinds and the team that flies."""

from collections.abc import Collection, Iterator, Mapping
from typing import Any

from gcs.config import SystemConfig, UnusableFile
from gcs.config.toml_file import ParsedFile
from gcs.config.validate import Key, Suggestions
from gcs.errors import UnusableInput
from gcs.faults.suggestions import COMMON
from gcs.mission.model import Fault, Mission

_KEYS = ("kind", *COMMON)
"""Keys of every fault; all others are parameters of its kind."""


def fault_suggestions(kind: str = "", own: Collection[str] = ()) -> Suggestions:
    """Return what is meant in the tables of faults; with a ``kind``, in one that has the keys ``own`` besides."""

    def key_meant(key: Key, given: Collection[str]) -> str | None:
        from gcs.faults.suggestions import key_meant

        return key_meant(kind, str(key[-1]), {*own, *given}) if kind else None

    def value_meant(key: Key, value: object) -> str | None:
        from gcs.faults.suggestions import value_meant

        name = next((part for part in reversed(key) if isinstance(part, str)), "")
        return value_meant(kind, name, value)

    return Suggestions(key_meant, value_meant)


def fault_data(file: ParsedFile, index: int, table: Any) -> Any:
    """Return the table of the file's fault ``index`` (from 0) as :class:`Fault` is read from it."""
    if not isinstance(table, Mapping):
        return table
    settings = {key: value for key, value in table.items() if key not in _KEYS}
    return {k: table[k] for k in _KEYS if k in table} | {"settings": settings, "line": file.line(("fault", index))}


def read_fault(file: ParsedFile, index: int, table: Mapping[str, Any]) -> Fault:
    """Return the fault of ``table``, which is the file's fault ``index`` (from 0).

    Raises :class:`UnusableFile` for unknown kinds and keys and for wrong values; whether the fault agrees with itself
    and with a system, :func:`fault_problems` checks.
    """
    fault = file.validated(Fault, fault_data(file, index, table), ("fault", index), fault_suggestions())
    if problems := parameter_problems(file, index, fault):
        raise UnusableFile(problems)
    return fault


def parameter_problems(file: ParsedFile, index: int, fault: Fault) -> list[str]:
    """Return every reason against the start of the file's fault ``index``, its kind and its parameters."""
    if (wrong := _start_problem(fault)) is not None:
        return [file.problem(("fault", index, wrong[0]), wrong[1])]
    from gcs.faults import KINDS  # the kinds take long to import, spent only where there are faults

    if fault.kind not in KINDS:
        from gcs.faults.suggestions import kind_meant

        meant = kind_meant(fault.kind)
        hint = f": did you mean '{meant}'?" if meant else ": gcs faults --kinds lists them"
        return [file.problem(("fault", index, "kind"), f"there is no kind '{fault.kind}'{hint}")]
    try:
        given = (key for key in _KEYS if getattr(fault, key) is not None)
        suggestions = fault_suggestions(fault.kind, {*given})
        file.validated(KINDS[fault.kind].settings, dict(fault.settings), ("fault", index), suggestions)
    except UnusableFile as error:
        return list(error.reasons)
    return []


def _start_problem(fault: Fault) -> tuple[str, str] | None:
    """Return the key and the reason of what is wrong with the start of a fault; None: nothing."""
    if fault.start is None and fault.start_phase is None:
        return "start", "missing key (or start_phase)"
    if fault.start is not None and fault.start_phase is not None:
        return "start_phase", "goes without start: start_offset is the time after the phase begins"
    if fault.start_offset is not None and fault.start_phase is None:
        return "start_offset", "goes with start_phase"
    if fault.start_flight is not None and fault.start_phase is None:
        return "start_flight", "goes with start_phase"
    return None


def fault_problems(fault: Fault, system: SystemConfig) -> Iterator[tuple[str, str]]:
    """Yield key and reason of every disagreement of a fault (known kind, sane parameters) with itself or the system."""
    from gcs.faults import KINDS, read_settings

    kind = KINDS[fault.kind]
    if kind.direction is None and fault.direction is not None:
        yield "direction", f"{fault.kind} has none"
    if fault.vehicles is not None:
        if not kind.of_vehicles:
            yield "vehicles", f"{fault.kind} is not of single vehicles"
        elif not fault.vehicles:
            yield "vehicles", "names none: leave it out for all of them"
        for vehicle in fault.vehicles:
            if vehicle > system.team.vehicles:
                yield "vehicles", f"there is no vehicle {vehicle}: the team has {system.team.vehicles}"
        if len(set(fault.vehicles)) < len(fault.vehicles):
            yield "vehicles", "names one twice"
    if fault.every is None and fault.times is not None:
        yield "times", "goes with `every`"
    if fault.every is not None and fault.duration is None:
        yield "every", "needs a duration: a fault without end does not come again"
    elif fault.every is not None and fault.duration is not None and fault.every <= fault.duration:
        yield "every", f"{fault.every:g} s is not more than the duration, {fault.duration:g} s"
    if kind.bounded and fault.duration is None:
        yield "duration", f"{fault.kind} needs one"
    if (problem := read_settings(fault.kind, fault.settings).problem(system, fault.vehicles)) is not None:
        yield problem


def check_faults_of(mission: Mission) -> None:
    """Check the faults of a mission whose system has changed since it was read. Raises :class:`UnusableInput`."""
    if not mission.faults:
        return
    from gcs.faults import read_settings

    for fault in mission.faults:
        read_settings(fault.kind, fault.settings)
        for key, reason in fault_problems(fault, mission.system):
            raise UnusableInput(f"{mission.path}: line {fault.line}: fault {fault.kind}: {key}: {reason}")
