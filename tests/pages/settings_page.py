"""``docs/settings.md``, written from the declarations: ``python tests/pages/settings_page.py`` prints it."""

from collections.abc import Iterator
from dataclasses import MISSING, dataclass, fields
from itertools import groupby
from typing import Any

from gcs.config.system import SystemConfig
from idc_controller.settings import DERIVED_KEY, METADATA_KEY, Setting, SettingsTable

_INTRODUCTION = """\
# Settings

What users set, by table of the system file. A file names what differs from these defaults; an unknown key, a wrong type
and a value out of range are refused with file, line and reason (exit status 2).
[`missions/system.toml`](../missions/system.toml) shows the main tables. `--set PATH=VALUE` (`gcs fly`, `gcs check`,
`vehicle-sim`) and `gcs.fly(..., settings={...})` take their place: `--set avoidance.margin=0.4`. Every other number
that decides flight behaviour is set in the same ways: its path is that of its default in a `settings.py`.

This page is written from the declarations by `make docs`.
"""


@dataclass(frozen=True)
class ListedSetting:
    """One setting with its table and key in the system file."""

    table: str
    key: str
    default: Any
    setting: Setting


def listed_settings(values: Any = None, table: str = "") -> Iterator[ListedSetting]:
    """Yield every setting that is declared as such, in the order of declaration."""
    values = SystemConfig() if values is None else values
    for field in fields(values):
        value = getattr(values, field.name)
        if DERIVED_KEY in field.metadata:
            continue
        if isinstance(value, tuple) and value and isinstance(value[0], SettingsTable):
            yield from (
                ListedSetting(f"[{field.name}]", key.name, key.default, key.metadata[METADATA_KEY])
                for key in fields(type(value[0]))
            )
        elif isinstance(value, SettingsTable):
            yield from listed_settings(value, f"{table}.{field.name}" if table else field.name)
        elif METADATA_KEY in field.metadata:
            yield ListedSetting(table, field.name, value, field.metadata[METADATA_KEY])


def settings_page() -> str:
    """Return the page: a table of key, default, unit, range and meaning for each table of the system file."""
    parts = [_INTRODUCTION]
    for table, listed in groupby(listed_settings(), lambda listed: listed.table):
        rows = [
            f"| `{entry.key}` | {_value(entry.default)} | {entry.setting.unit} | {_range(entry.setting)} "
            f"| {entry.setting.meaning} |"
            for entry in listed
        ]
        header = ["| key | default | unit | range | meaning |", "|---|---|---|---|---|"]
        parts.append("\n".join([f"## `[{table}]`", "", *header, *rows]) + "\n")
    return "\n".join(parts)


def _value(value: Any) -> str:
    if value is None:
        return "none"
    if value is MISSING:
        return "required"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return "[" + ", ".join(map(_value, value)) + "]"
    return str(value)


def _range(setting: Setting) -> str:
    bounds = ((">", setting.gt), ("≥", setting.ge), ("<", setting.lt), ("≤", setting.le))
    return ", ".join(f"{sign} {bound:g}" for sign, bound in bounds if bound is not None)


if __name__ == "__main__":
    print(settings_page(), end="")
