"""The kinds of fault as text."""

from dataclasses import dataclass, fields
from itertools import groupby
from typing import Any

from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from gcs.config.validate import adapter_of
from gcs.faults.kind import KINDS, Kind
from gcs.faults.values import ValueFault

_SHARED = tuple(field.name for field in fields(ValueFault))


@dataclass(frozen=True)
class Parameter:
    """Description of a parameter; ``default`` empty: it must be given."""

    name: str
    type: str
    unit: str
    range: str
    default: str
    description: str


def parameters(kind: Kind) -> list[Parameter]:
    """Return the parameters of a kind, in the order of its dataclass."""
    schema = adapter_of(kind.settings).json_schema()
    definitions = schema.get("$defs", {})
    required = schema.get("required", [])
    found = []
    for name, entry in schema.get("properties", {}).items():
        default = "" if name in required else _value(entry.get("default"))
        found.append(
            Parameter(name, _type(entry, definitions), entry.get("unit", ""), _range(entry), default,
                entry.get("description", ""))
        )  # fmt: skip
    return found


def kinds_list() -> RenderableType:
    """Return every kind with its parameters, for a terminal of any width."""
    width = max(len(p.name) for kind in KINDS.values() for p in parameters(kind))
    items: list[RenderableType] = []
    for family, kinds in groupby(KINDS.values(), lambda kind: kind.family):
        items += [Text(), Text(family, style="bold underline")]
        if family == "values":
            items += [Text(), Text("all that have a channel", style="italic"), _indented(shared_parameters(), width)]
        for kind in kinds:
            items += [Text(), Text(kind.name, style="bold cyan"), Padding(Text(summary(kind)), (0, 0, 0, 2))]
            items += [_indented(own, width)] if (own := own_parameters(kind)) else []
    notes = Text(
        "Every fault has kind, and start (s after take-off begins: when the first vehicle lifts off) or start_phase "
        "(arm, spool_up, climb, ...) with start_offset (s after that phase begins); it may have "
        "duration (s), every (s, from start to start) and times; vehicles where it is of vehicles; direction "
        "(telemetry, command, both) where one is named."
    )
    return Group(notes, *items)


def shared_parameters() -> list[Parameter]:
    """Return the parameters that all faults of values have."""
    return [p for p in parameters(KINDS["stuck"]) if p.name in _SHARED]


def own_parameters(kind: Kind) -> list[Parameter]:
    """Return the parameters of a kind without the shared ones."""
    found = parameters(kind)
    return [p for p in found if p.name not in _SHARED] if issubclass(kind.settings, ValueFault) else found


def _indented(found: list[Parameter], width: int) -> RenderableType:
    table = Table.grid(padding=(0, 2))
    table.add_column(min_width=width)
    table.add_column(ratio=1)
    for p in found:
        table.add_row(Text(p.name, style="cyan"), Text(f"{p.description} ({about(p)})"))
    return Padding(table, (0, 0, 0, 4))


def about(p: Parameter) -> str:
    """Return type, unit, range and default of a parameter."""
    about = ", ".join(part for part in (p.type, p.unit, p.range) if part)
    return f"{about}; default {p.default}" if p.default else about


def summary(kind: Kind) -> str:
    """Return what a kind does, and the keys that it has or needs."""
    remarks = []
    if kind.direction is not None:
        remarks.append(f"Direction: {kind.direction}, if none is given.")
    if not kind.of_vehicles:
        remarks.append("Not of single vehicles.")
    if kind.bounded:
        remarks.append("Needs a duration.")
    return " ".join([kind.summary, *remarks])


def _type(entry: dict[str, Any], definitions: dict[str, Any]) -> str:
    if "$ref" in entry:
        entry = definitions[entry["$ref"].rsplit("/", 1)[-1]]
    if "enum" in entry:
        return " or ".join(f'"{value}"' for value in entry["enum"])
    match entry.get("type"):
        case "number":
            return "number"
        case "integer":
            return "whole number"
        case "boolean":
            return "true or false"
        case "array" if entry.get("prefixItems"):
            return f"{len(entry['prefixItems'])} numbers"
        case "array":
            return "list of " + _type(entry["items"], definitions)
    return str(entry.get("type", ""))


def _range(entry: dict[str, Any]) -> str:
    if entry.get("type") not in ("number", "integer"):
        return ""
    signs = {"minimum": ">=", "exclusiveMinimum": ">", "maximum": "<=", "exclusiveMaximum": "<"}
    return ", ".join(f"{sign} {entry[key]:g}" for key, sign in signs.items() if key in entry)


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list | tuple):
        return ", ".join(map(str, value))
    return f"{value:g}" if isinstance(value, float) else str(value)
