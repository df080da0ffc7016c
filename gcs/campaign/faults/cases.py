"""Cases of a fault campaign: faults that are flown together, each at one severity."""

import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from gcs.campaign.faults.sources import FaultSource, sources_of
from gcs.mission.model import Fault

Seeds = Annotated[tuple[Annotated[int, Field(ge=0, lt=2**63)], ...], Field(min_length=1, max_length=10_000)]
"""Seeds of the flights of a case."""

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
    """Faults that are flown together, at the ``level``-th (from 1) of their severities; ``severity`` is its label.

    ``seed``: of its only flight; None: it is flown with those of the campaign. ``factors`` of a sample of pairs.
    """

    name: str
    level: int
    severity: str
    faults: tuple[SweptFault, ...]
    seed: int | None = None
    factors: Mapping[str, Any] = field(default_factory=dict)

    @property
    def kind(self) -> str:
        """The kind of fault; of several, all of them."""
        return " + ".join(dict.fromkeys(swept.fault.kind for swept in self.faults))

    @property
    def sources(self) -> tuple[FaultSource, ...]:
        """What the faults act on."""
        return sources_of([swept.fault for swept in self.faults])

    def faults_for(self, seed: int) -> tuple[Fault, ...]:
        """Return the faults with the starts of a seed, which are the same at every severity."""
        return tuple(
            swept.fault
            if swept.start_between is None
            else replace(swept.fault, start=_start(swept.start_between, self.name, i, seed))
            for i, swept in enumerate(self.faults)
        )


def label(values: Mapping[str, Any]) -> str:
    """Return a severity as text: ``probability 0.3``."""
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
