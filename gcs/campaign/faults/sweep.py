"""Plans of flights with faults (``gcs faults``): every case in every mission with every seed."""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.console import RenderableType

from gcs.campaign.engine import FlightPlan, PlanGenerator
from gcs.campaign.faults.judgement import COLUMNS, WITHIN_LIMITS, judge, meets
from gcs.campaign.folder import digest, plain
from gcs.campaign.result import Result
from gcs.errors import UnusableInput
from gcs.mission.model import Fault

if TYPE_CHECKING:
    from gcs.campaign.faults.campaign_file import CampaignFile

MAX_FLIGHTS = 1_000_000
CLEAN = "no fault"
"""The name of the case without one."""


@dataclass(frozen=True)
class SweptFault:
    """A fault at one severity, of the campaign's table ``table`` (from 0).

    ``start_between`` (s, s): its start is drawn between these, for every seed another.
    """

    fault: Fault
    table: int
    start_between: tuple[float, float] | None = None


@dataclass(frozen=True)
class Case:
    """Faults that are flown together, at the ``level``-th (from 1) of their severities; ``severity`` is its label."""

    name: str
    level: int
    severity: str
    faults: tuple[SweptFault, ...]

    @property
    def kind(self) -> str:
        """The kind of fault; of several, all of them."""
        return " + ".join(dict.fromkeys(swept.fault.kind for swept in self.faults))

    def faults_for(self, seed: int) -> tuple[Fault, ...]:
        """Return the faults with the starts of a seed, which are the same at every severity."""
        return tuple(
            swept.fault
            if swept.start_between is None
            else replace(swept.fault, start=_start(swept.start_between, self.name, i, seed))
            for i, swept in enumerate(self.faults)
        )


class FaultFlights(PlanGenerator):
    """Every case of a campaign file in every mission with every seed, in this order.

    A name holds a digest of everything that the flight is flown by, except the program: another flight has another.
    """

    columns = COLUMNS
    shown = (
        ("clearance", "clearance_min_m", "m"),
        ("tilt", "tilt_max_deg", "deg"),
        ("separation", "uav_separation_min_m", "m"),
        ("error", "position_rmse_m", "m"),
    )

    def __init__(self, file: CampaignFile) -> None:
        """Raises :class:`UnusableInput` for too many flights."""
        self.file = file
        count = len(file.cases) * len(file.missions) * len(file.seeds)
        if count > MAX_FLIGHTS:
            raise UnusableInput(f"{count} flights are more than {MAX_FLIGHTS}: list fewer faults, missions or seeds")
        if file.require != WITHIN_LIMITS:
            self.passed_means = "set down safely, with their limits held"

    @property
    def settings(self) -> dict[str, Any]:
        """The name: a campaign may grow."""
        return {"faults": self.file.name}

    def plans(self, out: Path) -> Iterator[FlightPlan]:
        """Yield all flights, by case, then mission, then seed."""
        file, folder = self.file, out / "missions"
        flights = [(case, mission, seed) for case in file.cases for mission in file.missions for seed in file.seeds]
        for number, (case, mission, seed) in enumerate(flights, start=1):
            base = file.missions[mission]
            title = " ".join(part for part in (mission, case.name, case.severity) if part)
            text = base.text(title, seed, case.faults_for(seed), file.limits)
            name = plain(" ".join([case.name, case.severity, Path(mission).stem, f"seed{seed}"]))
            name += f"-{digest(text, file.controller)}"
            path = folder / f"{name}.toml"
            yield FlightPlan(
                number,
                name,
                path,
                ("--controller", file.controller),
                partial(judge, len(case.faults)),
                {"fault": case.name, "kind": case.kind, "level": case.level, "severity": case.severity,
                 "mission": mission, "seed": seed},
                {path: text, **{folder / file_name: content for file_name, content in base.files.items()}},
            )  # fmt: skip

    def passes(self, result: Result) -> bool:
        """Return whether a flight meets the requirement of the campaign file."""
        return meets(self.file.require, result)

    def report(self, results: Sequence[Result], out: Path) -> tuple[list[RenderableType], list[Path]]:
        """Write ``results.csv``, ``results.parquet``, ``rates.csv`` and the matrix."""
        from gcs.campaign.faults.report import report  # matplotlib takes long to import

        return report(self.file.name, results, out)


def label(values: Mapping[str, Any]) -> str:
    """Return a severity for people: ``probability 0.3``."""
    return ", ".join(f"{key} {_value(value)}" for key, value in values.items())


def _value(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, list | tuple):
        return "[" + " ".join(map(_value, value)) + "]"
    return str(value)


def _start(between: tuple[float, float], name: str, index: int, seed: int) -> float:
    random = np.random.default_rng([seed, zlib.crc32(name.encode()), index])
    return round(float(random.uniform(*between)), 3)
