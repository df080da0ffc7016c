"""Strict reading of TOML: parse, validate against dataclasses, and point at the line of every error."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import ConfigDict, Field, TypeAdapter, ValidationError, with_config

from gcs.config.problems import UnusableFile
from gcs.config.text_file import read_text

T = TypeVar("T")
Key = tuple[str | int, ...]
Positive = Annotated[float, Field(gt=0.0)]
NotNegative = Annotated[float, Field(ge=0.0)]

_HEADER = re.compile(r"^\s*(\[\[?)\s*([^\[\]]+?)\s*\]\]?\s*(#.*)?$")
_ENTRY = re.compile(r"""^\s*([A-Za-z0-9_."'-]+(?:\s*\.\s*[A-Za-z0-9_"'-]+)*)\s*=""")
_REASONS = {
    "missing": "missing key",
    "union_tag_not_found": "missing key",
    "unexpected_keyword_argument": "unknown key",
    "extra_forbidden": "unknown key",
    "dataclass_type": "must be a table",
    "model_type": "must be a table",
}


def strict(cls: type[T]) -> type[T]:
    """Class decorator for a dataclass that is read from TOML: no unknown keys, no infinite numbers."""
    return with_config(ConfigDict(extra="forbid", allow_inf_nan=False))(cls)


@dataclass(frozen=True)
class TomlFile:
    """A parsed TOML file that knows the line of every key."""

    path: Path
    data: dict[str, Any]
    lines: dict[Key, int] = field(repr=False)
    """Line (from 1) of every table header and key; arrays of tables carry their index: ("obstacle", 0, "radius")."""

    def line(self, key: Sequence[str | int]) -> int:
        """Line of a key, or of the nearest table around it."""
        for end in range(len(key), 0, -1):
            if tuple(key[:end]) in self.lines:
                return self.lines[tuple(key[:end])]
        return 1

    def problem(self, key: Sequence[str | int], reason: str) -> str:
        """One line: file, line, table.key, reason."""
        return f"{self.path}: line {self.line(key)}: {_dotted(key)}: {reason}"

    def validated(self, adapter: TypeAdapter[T], data: dict[str, Any] | None = None, under: Key = ()) -> T:
        """The file's data (or ``data`` in its place, of the same keys below ``under``) as the adapter's type.

        Raises :class:`UnusableFile` with every unknown key, missing key and wrong value.
        """
        data = self.data if data is None else data
        try:
            # Through JSON: strict types, yet arrays become tuples and tables dataclasses. Dates, which JSON
            # does not have, become text and are refused as such.
            return adapter.validate_json(
                json.dumps(data, default=str), strict=True, context={"folder": self.path.parent}
            )
        except ValidationError as error:
            found = error.errors(include_url=False)
        except (ValueError, RecursionError) as error:
            raise UnusableFile([f"{self.path}: {error}"]) from error
        explained = [self._explained(data, dict(e)) for e in found]
        raise UnusableFile([self.problem((*under, *key), reason) for key, reason in explained])

    @staticmethod
    def _explained(data: Any, error: dict[str, Any]) -> tuple[Key, str]:
        key: list[str | int] = []
        location = error["loc"]
        for part in location:
            if (isinstance(data, dict) and part in data) or (
                isinstance(data, list) and isinstance(part, int) and part < len(data)
            ):
                data = data[part]
                key.append(part)
            elif part == location[-1] and error["type"] == "missing":
                key.append(part)  # otherwise it is a name of pydantic's own: the tag of a union, "key", ...
        kind, context = error["type"], error.get("ctx", {})
        reason = _REASONS.get(kind, error["msg"])
        if kind.startswith("union_tag"):  # the key that distinguishes several kinds of table
            key.append(str(context["discriminator"]).strip("'"))
        if kind == "union_tag_invalid":
            reason = f"'{context['tag']}' is none of {context['expected_tags']}"
        elif kind == "value_error":
            reason = str(context["error"])
        elif kind == "too_short":
            reason = f"needs at least {context['min_length']}"
        elif kind == "missing" and key and isinstance(key[-1], int):
            reason = "missing value"
        return tuple(key), reason[0].lower() + reason[1:]


def read_toml(path: Path) -> TomlFile:
    """Parse a TOML file. Raises :class:`UnusableFile` with the line of a syntax error."""
    text = read_text(path)
    try:
        data = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        if isinstance(error, RecursionError):
            raise UnusableFile([f"{path}: nested too deeply"]) from error
        at = re.search(r"^(.*) \(at (?:line (\d+), column \d+|end of document)\)$", str(error), re.DOTALL)
        line = (at[2] or len(text.splitlines())) if at else 1
        raise UnusableFile([f"{path}: line {line}: not valid TOML: {at[1] if at else error}"]) from error
    return TomlFile(path, data, _lines_of_keys(text))


def _lines_of_keys(text: str) -> dict[Key, int]:
    """Return the line of every header and key, by a scan of what TOML files usually look like."""
    lines: dict[Key, int] = {}
    table: Key = ()
    counts: dict[Key, int] = {}
    for number, line in enumerate(text.splitlines(), start=1):
        if header := _HEADER.match(line):
            table = ()
            for part in _parts(header[2]):
                table = (*table, part)
                if table in counts:
                    table = (*table, counts[table] - 1)
            if header[1] == "[[":
                base = table[:-1] if table and isinstance(table[-1], int) else table
                counts[base] = counts.get(base, 0) + 1
                table = (*base, counts[base] - 1)
                lines.setdefault(base, number)
            lines.setdefault(table, number)
        elif entry := _ENTRY.match(line):
            lines.setdefault((*table, *_parts(entry[1])), number)
    return lines


def _parts(dotted: str) -> list[str]:
    return [part.strip().strip("\"'") for part in dotted.split(".")]


def _dotted(key: Sequence[str | int]) -> str:
    """``obstacle[1].radius``: arrays are counted from 1, as people count their tables."""
    text = ""
    for part in key:
        text += f"[{part + 1}]" if isinstance(part, int) else f".{part}"
    return text.lstrip(".") or "file"
