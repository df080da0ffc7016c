"""The campaign file: which faults, how severe, in which missions, with which seeds. Read strictly."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from gcs.campaign.faults.base_mission import BaseMission, read_base
from gcs.campaign.faults.cases import CLEAN, Case, Seeds, SweptFault, label
from gcs.campaign.faults.detection_table import DetectionRow, case_name, row_of
from gcs.campaign.faults.drawn_mission import DrawnMission, ScenarioTable
from gcs.campaign.faults.fault_pairs import PairedFault, PairsTable, pair_cases
from gcs.campaign.scenarios.field import FIELD
from gcs.config import UnusableFile
from gcs.config.toml_file import ParsedFile, read_toml
from gcs.config.validate import Key, NotNegative, strict
from gcs.errors import UnusableInput
from gcs.mission.faults import fault_problems, read_fault
from gcs.mission.model import Limits, Name
from gcs.mission.own import named

Severity = Annotated[dict[str, Annotated[tuple[Any, ...], Field(min_length=1, max_length=1000)]], Field(min_length=1)]
_OWN_KEYS = ("name", "severity", "start_between", "one_vehicle", "wind_max")

_OTHER_FILES = {
    "mission": "this is a mission, no campaign: gcs fly flies it",
    "uav": "this is a system file, no campaign: missions name it",
}


@strict
@dataclass(frozen=True)
class CampaignTable:
    """``[campaign]``. Missions are beside the file; seeds are listed, or counted from ``first_seed``."""

    name: Name
    missions: Annotated[tuple[Annotated[str, Field(min_length=1)], ...], Field(min_length=1, max_length=1000)]
    seeds: Seeds | None = None
    first_seed: Annotated[int, Field(ge=0, lt=2**62)] | None = None
    seed_count: Annotated[int, Field(ge=1, le=10_000)] | None = None
    clean: bool = False
    controller: Literal["idc", "mpc", "paper"] = "idc"
    require: Literal["within limits", "safe", "safe and disarmed"] = "within limits"


@strict
@dataclass(frozen=True)
class SweptTable:
    """Keys that a ``[[fault]]`` of a campaign has beside those of a mission's."""

    name: Name
    severity: Severity | None = None
    start_between: tuple[NotNegative, NotNegative] | None = None
    one_vehicle: bool = False
    wind_max: NotNegative | None = None


@strict
@dataclass(frozen=True)
class CampaignTables:
    """The whole file."""

    campaign: CampaignTable
    fault: Annotated[tuple[SweptTable, ...], Field(max_length=1000)] = ()
    limits: Limits | None = field(default=None)
    row: Annotated[tuple[DetectionRow, ...], Field(max_length=1000)] = ()
    scenario: Annotated[tuple[ScenarioTable, ...], Field(max_length=1000)] = ()
    pairs: PairsTable | None = None


@dataclass(frozen=True)
class CampaignFile:
    """A campaign as read: its missions by the names they go by, and the cases that each is flown with."""

    name: str
    missions: Mapping[str, BaseMission]
    seeds: tuple[int, ...]
    cases: tuple[Case, ...]
    limits: Limits | None
    controller: str
    require: str
    rows: tuple[DetectionRow, ...]

    @property
    def is_of_pairs(self) -> bool:
        """Return True if the faults are flown alone and in pairs."""
        return any(case.factors for case in self.cases)

    def seeds_of(self, case: Case) -> tuple[int, ...]:
        """Return the seeds of a case: its own, those of its row, or the campaign's."""
        if case.seed is not None:
            return (case.seed,)
        return row_of(self.rows, case.name, case.severity).seeds or self.seeds


def read_campaign(path: Path) -> CampaignFile:
    """Read a campaign with its missions; ``path`` may be the name of one of the package's own.

    Raises :class:`UnusableFile` with every reason found.
    """
    file = read_toml(named(path, "campaign"))
    for other, use in _OTHER_FILES.items():
        if other in file.data and "campaign" not in file.data:
            raise UnusableFile([file.problem((other,), use)])
    raw = file.data.get("fault")
    data = dict(file.data)
    if isinstance(raw, list):
        data["fault"] = [
            {key: value for key, value in table.items() if key in _OWN_KEYS} if isinstance(table, dict) else table
            for table in raw
        ]
    tables = file.validated(CampaignTables, data)
    problems = [*_disagreements(file, tables)]
    cases, bad = _cases(file, tables)
    problems += bad
    problems += _row_problems(file, tables.row, cases)
    missions, bad = _missions(file, tables)
    problems += bad
    problems += [
        file.problem(("fault", swept.table, key), reason)
        for base in missions.values()
        for case in cases
        for swept in case.faults
        for key, reason in fault_problems(swept.fault, base.system)
    ]
    if problems:
        raise UnusableFile(list(dict.fromkeys(problems)))
    table = tables.campaign
    if tables.pairs is not None:
        team = min(base.system.team.vehicles for base in missions.values())
        paired = [_paired_fault(tables, case) for case in cases]
        try:
            cases = tuple(case for seed in _seeds(table) for case in pair_cases(tables.pairs, paired, seed, team))
        except UnusableInput as error:
            raise UnusableFile([file.problem(("pairs",), str(error))]) from None
    if table.clean:
        cases = (Case(CLEAN, 1, "", ()), *cases)
    return CampaignFile(
        table.name, missions, _seeds(table), cases, tables.limits, table.controller, table.require, tables.row
    )


def _paired_fault(tables: CampaignTables, case: Case) -> PairedFault:
    one_vehicle = tuple(tables.fault[swept.table].one_vehicle for swept in case.faults)
    limits = (tables.fault[swept.table].wind_max for swept in case.faults)
    wind_max = min((limit for limit in limits if limit is not None), default=math.inf)
    return PairedFault(case_name(case.name, case.severity), case.faults, one_vehicle, wind_max)


def _seeds(table: CampaignTable) -> tuple[int, ...]:
    if table.seeds is not None:
        return table.seeds
    first = 1 if table.first_seed is None else table.first_seed
    return tuple(range(first, first + (table.seed_count or 1)))


def _disagreements(file: ParsedFile, tables: CampaignTables) -> Iterator[str]:
    table = tables.campaign
    if table.seeds is not None:
        for key in ("first_seed", "seed_count"):
            if getattr(table, key) is not None:
                yield file.problem(("campaign", key), "seeds are listed already, by `seeds`")
    elif table.seed_count is None:
        yield file.problem(("campaign",), "needs either seeds or seed_count")
    for key in ("seeds", "missions"):
        yield from _repeated(file, ("campaign", key), getattr(table, key))
    if not tables.fault and not table.clean:
        yield file.problem(("campaign",), "has no fault: needs [[fault]], or clean = true")
    if table.clean and any(fault.name == CLEAN for fault in tables.fault):
        yield file.problem(("campaign", "clean"), f"a fault is named '{CLEAN}', as the flights without are")


def _repeated(file: ParsedFile, key: Key, values: Sequence[Any] | None) -> Iterator[str]:
    for value, number in Counter(values or ()).items():
        if number > 1:
            yield file.problem(key, f"{value} appears {number} times")


def _missions(file: ParsedFile, tables: CampaignTables) -> tuple[dict[str, BaseMission], list[str]]:
    """Missions go by the stem of their file; by all of it where two have the same. Scenarios have names."""
    entries = tables.campaign.missions
    problems: list[str] = []
    missions: dict[str, BaseMission] = {}
    stems = Counter(Path(entry).stem for entry in entries)
    for i, entry in enumerate(entries):
        path = file.path.parent / entry
        if not path.is_file():
            problems.append(file.problem(("campaign", "missions", i), f"there is no file {entry}"))
            continue
        try:
            missions[Path(entry).stem if stems[Path(entry).stem] == 1 else entry] = read_base(path)
        except UnusableFile as error:
            problems += error.reasons
    for i, table in enumerate(tables.scenario):
        if table.name in missions:
            problems.append(file.problem(("scenario", i, "name"), f"another mission is named '{table.name}'"))
        for key in ("obstacles", "known", "duration"):
            if table.kind != FIELD and getattr(table, key) is not None:
                problems.append(file.problem(("scenario", i, key), f"is of kind '{FIELD}' only"))
            elif table.kind == FIELD and getattr(table, key) is None and key == "obstacles":
                problems.append(file.problem(("scenario", i), f"kind '{FIELD}' needs a number of obstacles"))
        missions[table.name] = DrawnMission.of(table)
    return missions, problems


def _row_problems(file: ParsedFile, rows: tuple[DetectionRow, ...], cases: tuple[Case, ...]) -> Iterator[str]:
    """Names in the rows of the table of detection that are of no case, or appear twice, and seeds that do."""
    names = {name for case in cases for name in (case.name, case_name(case.name, case.severity))}
    count = Counter(name for row in rows for name in row.faults)
    for i, row in enumerate(rows):
        yield from _repeated(file, ("row", i, "seeds"), row.seeds)
        for j, name in enumerate(row.faults):
            if name not in names or count[name] > 1:
                reason = f"'{name}' appears {count[name]} times" if name in names else f"there is no fault '{name}'"
                yield file.problem(("row", i, "faults", j), reason)


def _cases(file: ParsedFile, tables: CampaignTables) -> tuple[tuple[Case, ...], list[str]]:
    """Tables of one name are flown together, each at the severity of the same number."""
    problems: list[str] = []
    together: dict[str, list[int]] = {}
    for i, table in enumerate(tables.fault):
        together.setdefault(table.name, []).append(i)
    cases: list[Case] = []
    for name, members in together.items():
        numbers = {}
        for i in members:
            lengths = {len(values) for values in (tables.fault[i].severity or {}).values()}
            if len(lengths) > 1:
                problems.append(file.problem(("fault", i, "severity"), "lists of different lengths"))
            elif lengths:
                numbers[i] = lengths.pop()
        if len(set(numbers.values())) > 1:
            reason = f"'{name}' has another number of severities in another table"
            problems.append(file.problem(("fault", max(numbers), "severity"), reason))
            continue
        for level in range(max(numbers.values(), default=1)):
            swept = []
            for i in members:
                try:
                    swept.append(_swept_fault(file, i, tables.fault[i], level, tables.pairs))
                except UnusableFile as error:
                    problems += error.reasons
            severity = ", ".join(label(values) for i in members if (values := _at(tables.fault[i], level)))
            if any((case.name, case.faults) == (name, tuple(swept)) for case in cases):
                problems.append(file.problem(("fault", members[0], "severity"), f"'{name}': {severity} appears twice"))
            cases.append(Case(name, level + 1, severity, tuple(swept)))
    return tuple(cases), problems


def _swept_fault(file: ParsedFile, index: int, table: SweptTable, level: int, pairs: PairsTable | None) -> SweptFault:
    """The fault of one table at one severity; in ``pairs`` without its own start. Raises :class:`UnusableFile`."""
    raw = {key: value for key, value in file.data["fault"][index].items() if key not in _OWN_KEYS}
    values = _at(table, level)
    problems = []
    for key in values:
        if key in raw or key in ("kind", *_OWN_KEYS):
            reason = "appears in the table, too" if key in raw and key != "kind" else "cannot be swept"
            problems.append(file.problem(("fault", index, "severity", key), f"{key} {reason}"))
    if table.start_between is not None:
        low, high = table.start_between
        if "start" in raw or "start" in values:
            problems.append(file.problem(("fault", index, "start_between"), "goes without start"))
        if low >= high:
            problems.append(file.problem(("fault", index, "start_between"), f"{low:g} s is not before {high:g} s"))
        values = {**values, "start": low}
    if pairs is not None:
        for key in ("start", "start_phase", "start_offset", "start_between"):
            if key in file.data["fault"][index] or key in values:
                problems.append(file.problem(("fault", index, key), "[pairs] says when faults start"))
        values = {**values, "start_phase": next(iter(pairs.phases))}
    if table.one_vehicle and (pairs is None or "vehicles" in raw):
        reason = "goes with [pairs]" if pairs is None else "goes without vehicles"
        problems.append(file.problem(("fault", index, "one_vehicle"), reason))
    elif table.one_vehicle:
        values = {**values, "vehicles": (1,)}
    if table.wind_max is not None and pairs is None:
        problems.append(file.problem(("fault", index, "wind_max"), "goes with [pairs]"))
    if problems:
        raise UnusableFile(problems)
    # An error in a swept value is reported at the line of its list.
    severity = ("fault", index, "severity")
    lines: dict[Key, int] = {("fault", index, key): file.line((*severity, key)) for key in values}
    fault = read_fault(replace(file, lines={**file.lines, **lines}), index, {**raw, **values})
    return SweptFault(fault, index, table.start_between)


def _at(table: SweptTable, level: int) -> dict[str, Any]:
    return {key: values[level] for key, values in (table.severity or {}).items() if level < len(values)}
