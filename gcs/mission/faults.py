"""Whether a fault of a mission makes sense: with its own kind, and with the team that flies."""

from __future__ import annotations

from collections.abc import Iterator

from gcs.config import SystemConfig
from gcs.errors import UnusableInput
from gcs.faults import KINDS, read_settings
from gcs.mission.model import Fault, Mission


def fault_problems(fault: Fault, system: SystemConfig) -> Iterator[tuple[str, str]]:
    """Key and reason of everything that is wrong with a fault of a known kind and sane parameters."""
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
        yield "every", "needs a duration: what has no end does not come again"
    elif fault.every is not None and fault.duration is not None and fault.every <= fault.duration:
        yield "every", f"{fault.every:g} s is not more than the duration, {fault.duration:g} s"
    if kind.bounded and fault.duration is None:
        yield "duration", f"{fault.kind} needs one"
    if (problem := read_settings(fault.kind, fault.settings).problem(system, fault.vehicles)) is not None:
        yield problem


def check_faults_of(mission: Mission) -> None:
    """For a mission whose system has changed, or that was made in Python. Raises :class:`UnusableInput`."""
    for fault in mission.faults:
        read_settings(fault.kind, fault.settings)
        for key, reason in fault_problems(fault, mission.system):
            raise UnusableInput(f"{mission.path}: line {fault.line}: fault {fault.kind}: {key}: {reason}")
