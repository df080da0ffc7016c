"""Faults alone and in ordered pairs, in phases of the flight: a covering sample of all combinations.

Every two values of two factors that can be flown together are in one flight of the sample at least: of first fault,
second fault (or none), moment of the first (a phase; at its start or within it), delay of the second, and wind.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, product
from typing import Annotated, Any, NamedTuple

import numpy as np
from pydantic import Field

from gcs.campaign.faults.cases import Case, SweptFault
from gcs.config.validate import NotNegative, strict
from gcs.errors import UnusableInput
from gcs.mission.model import Fault, StartPhase

_LEAST_OFFSET = 0.1  # s; of a moment within a phase
MOST = 200_000
"""Combinations of which a sample is drawn, at most."""
_Values = Annotated[tuple[NotNegative, ...], Field(min_length=1, max_length=20)]


@strict
@dataclass(frozen=True)
class PairsTable:
    """``[pairs]``: the campaign's faults are flown alone and in ordered pairs.

    ``phases``: the length of each phase in the mission (s), within which the first fault starts; 0: at its start only.
    ``delays``: of the second fault after the first (s). ``wind``: steady from lift-off on, at once (m/s).
    """

    phases: Annotated[dict[StartPhase, NotNegative], Field(min_length=1)]
    delays: _Values = (0.0,)
    wind: _Values = (0.0,)


@dataclass(frozen=True)
class PairedFault:
    """A fault of one name: its tables, each of the campaign file's table of that number (from 0).

    ``one_vehicle``: of each, whether it is of one vehicle, which is drawn for each flight. ``wind_max``: what wind can
    be flown with it (m/s): that of the flight is no stronger.
    """

    name: str
    faults: tuple[SweptFault, ...]
    one_vehicle: tuple[bool, ...]
    wind_max: float = math.inf

    @property
    def is_wind(self) -> bool:
        """Return True if it is wind of its own."""
        return any(swept.fault.kind == "wind" for swept in self.faults)


class Combination(NamedTuple):
    """One flight; ``second`` None: the first alone. ``within``: in the phase, else at its start. s, m/s."""

    first: PairedFault
    second: PairedFault | None
    moment: tuple[StartPhase, bool]
    delay: float
    wind: float

    @property
    def can_be_flown(self) -> bool:
        """Return False for one fault twice, and for wind beside a fault that is wind."""
        if self.first is self.second:
            return False
        return not (self.wind and (self.first.is_wind or (self.second is not None and self.second.is_wind)))


def covering_sample(
    factors: Sequence[Sequence[Any]], allowed: Callable[[tuple[Any, ...]], bool], generator: np.random.Generator
) -> list[tuple[Any, ...]]:
    """Return rows of a value of each factor with every pair of values of two factors that any allowed row has.

    Greedy: always a row with the most pairs that are still lacking, of several a random one.
    """
    rows = [row for row in product(*(range(len(values)) for values in factors))
            if allowed(tuple(values[i] for values, i in zip(factors, row, strict=True)))]  # fmt: skip
    columns = np.array(rows, dtype=int).reshape(-1, len(factors))
    columns = columns[generator.permutation(len(rows))]
    numbers, offset = [], 0
    for a, b in combinations(range(len(factors)), 2):
        numbers.append(offset + columns[:, a] * len(factors[b]) + columns[:, b])
        offset += len(factors[a]) * len(factors[b])
    pairs = np.stack(numbers, axis=1)
    lacking = np.zeros(offset, dtype=bool)
    lacking[pairs] = True
    found = []
    while lacking.any():
        best = int(lacking[pairs].sum(axis=1).argmax())
        lacking[pairs[best]] = False
        found.append(tuple(values[i] for values, i in zip(factors, columns[best].tolist(), strict=True)))
    return found


def combinations_of(table: PairsTable, faults: Sequence[PairedFault], seed: int) -> list[Combination]:
    """Return the covering sample of a seed. Raises :class:`UnusableInput` if that is nothing, or of too many."""
    moments = [(phase, within) for phase, length in table.phases.items()
               for within in ((False, True) if length > _LEAST_OFFSET else (False,))]  # fmt: skip
    factors = (faults, (None, *faults), moments, table.delays, table.wind)
    if (number := math.prod(map(len, factors))) > MOST:
        raise UnusableInput(f"{number} combinations are more than {MOST}: list fewer faults, phases, delays or winds")

    def allowed(row: tuple[Any, ...]) -> bool:
        combination = Combination(*row)
        alone = combination.second is None and combination.delay != table.delays[0]  # there is nothing to delay
        return combination.can_be_flown and not alone

    sample = covering_sample(factors, allowed, np.random.default_rng([seed, 0]))
    if not sample:
        raise UnusableInput("no combination can be flown: wind beside wind only")
    return [Combination(*row) for row in sample]


def pair_cases(table: PairsTable, faults: Sequence[PairedFault], seed: int, team: int) -> tuple[Case, ...]:
    """Return a case for each combination of a seed, with what is drawn: offset, vehicles, direction of the wind.

    The flights' own seeds follow on ``seed``. ``team``: number of vehicles.
    """
    return tuple(
        _case(table, combination, seed + number, team)
        for number, combination in enumerate(combinations_of(table, faults, seed))
    )


def _case(table: PairsTable, combination: Combination, seed: int, team: int) -> Case:
    generator = np.random.default_rng([seed, 1])
    first, second, (phase, within), delay, wind = combination
    wind_max = min(paired.wind_max for paired in (first, second) if paired is not None)
    wind = min(wind, wind_max)
    offset = round(float(generator.uniform(_LEAST_OFFSET, table.phases[phase])), 3) if within else 0.0

    def placed(paired: PairedFault, later: float) -> list[SweptFault]:
        vehicle = int(generator.integers(1, team + 1))
        return [
            replace(swept, fault=replace(_no_stronger(swept.fault, wind_max), start_phase=phase,
                                         start_offset=round(offset + later, 3),
                                         vehicles=(vehicle,) if one else swept.fault.vehicles))
            for swept, one in zip(paired.faults, paired.one_vehicle, strict=True)
        ]  # fmt: skip

    swept = [*placed(first, 0.0), *(placed(second, delay) if second is not None else ())]
    parts = [f"{offset:g} s into {phase}" if within else phase]
    if second is not None:
        parts.append(f"after {delay:g} s")
    if wind:
        heading = float(generator.uniform(0.0, 2.0 * np.pi))
        velocity = [round(wind * float(np.cos(heading)), 2), round(wind * float(np.sin(heading)), 2), 0.0]
        parts.append(f"wind {wind:g} m/s")
        own = Fault("wind", 0.0, settings={"velocity": velocity, "rise": 0.0})
        swept.insert(0, SweptFault(own, 0))
    name = first.name if second is None else f"{first.name}, then {second.name}"
    factors = {"first": first.name, "second": second.name if second is not None else "", "phase": phase,
               "within": within, "delay": delay, "wind": combination.wind}  # fmt: skip
    return Case(name, 1, ", ".join(parts), tuple(swept), seed, factors)


def _no_stronger(fault: Fault, limit: float) -> Fault:
    """Return a fault whose wind, if it is one, is no stronger than ``limit`` (m/s)."""
    if fault.kind != "wind" or (speed := math.hypot(*fault.settings["velocity"])) <= limit:
        return fault
    velocity = [round(component * limit / speed, 2) for component in fault.settings["velocity"]]
    return replace(fault, settings={**fault.settings, "velocity": velocity})
