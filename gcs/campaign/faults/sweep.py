"""What is flown: every case in every mission with every seed."""

from __future__ import annotations

import re
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gcs.campaign.faults.base_mission import digest
from gcs.mission.model import Fault

if TYPE_CHECKING:
    from gcs.campaign.faults.campaign_file import CampaignFile

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
    """Faults that are flown together, at the ``level``-th (from 1) of their severities, which ``severity`` tells."""

    name: str
    level: int
    severity: str
    faults: tuple[SweptFault, ...]

    @property
    def kind(self) -> str:
        """Of fault; of several, all of them."""
        return " + ".join(dict.fromkeys(swept.fault.kind for swept in self.faults))

    def faults_for(self, seed: int) -> tuple[Fault, ...]:
        """With the starts of a seed, which are the same at every severity."""
        return tuple(
            swept.fault
            if swept.start_between is None
            else replace(swept.fault, start=_start(swept.start_between, self.name, i, seed))
            for i, swept in enumerate(self.faults)
        )


@dataclass(frozen=True)
class FaultFlight:
    """One flight of a campaign; ``name`` is also that of its files, ``text`` its mission."""

    number: int
    name: str
    case: Case
    mission: str
    seed: int
    text: str


def flights_of(campaign: CampaignFile) -> Iterator[FaultFlight]:
    """All flights, by case, then mission, then seed.

    A name holds a digest of everything that the flight is flown by, except the program: another flight has another.
    """
    number = 0
    for case in campaign.cases:
        for mission, base in campaign.missions.items():
            for seed in campaign.seeds:
                number += 1
                told = " ".join(part for part in (mission, case.name, case.severity) if part)
                text = base.text(told, seed, case.faults_for(seed), campaign.limits)
                name = plain(" ".join([case.name, case.severity, Path(mission).stem, f"seed{seed}"]))
                name += f"-{digest(text, campaign.controller)}"
                yield FaultFlight(number, name, case, mission, seed, text)


def label(values: Mapping[str, Any]) -> str:
    """A severity as people read it: ``probability 0.3``."""
    return ", ".join(f"{key} {_value(value)}" for key, value in values.items())


def plain(text: str) -> str:
    """As part of a file name."""
    return re.sub(r"[^\w.]+", "-", text).strip("-.")[:120] or "flight"


def _value(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, list | tuple):
        return "[" + " ".join(map(_value, value)) + "]"
    return str(value)


def _start(between: tuple[float, float], name: str, index: int, seed: int) -> float:
    random = np.random.default_rng([seed, zlib.crc32(name.encode()), index])
    return round(float(random.uniform(*between)), 3)
