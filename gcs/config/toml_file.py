"""Strict reading of TOML: parse, validate against dataclasses, and point at the line of every error."""

import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from gcs.config.text_file import read_text, why_unparsed
from gcs.config.validate import Key, Suggestions, T, UnusableFile, Validator, dotted, validated

_HEADER = re.compile(r"^\s*(\[\[?)\s*([^\[\]]+?)\s*\]\]?\s*(#.*)?$")
_ENTRY = re.compile(r"""^\s*([A-Za-z0-9_."'-]+(?:\s*\.\s*[A-Za-z0-9_"'-]+)*)\s*=""")


@dataclass(frozen=True)
class ParsedFile:
    """A parsed file of tables (TOML, YAML) that knows the line of every key."""

    path: Path
    data: dict[str, Any]
    lines: dict[Key, int] = field(repr=False)
    """Line (from 1) of every table header and key; arrays carry their index: ("obstacle", 0, "radius")."""

    def line(self, key: Sequence[str | int]) -> int:
        """Return the line of a key, or of the nearest table around it."""
        for end in range(len(key), 0, -1):
            if tuple(key[:end]) in self.lines:
                return self.lines[tuple(key[:end])]
        return 1

    def problem(self, key: Sequence[str | int], reason: str) -> str:
        """Return a message of one line: file, line, table.key, reason."""
        return f"{self.path}: line {self.line(key)}: {dotted(key)}: {reason}"

    def validated(
        self,
        kind: Validator[T] | type[T],
        data: dict[str, Any] | None = None,
        under: Key = (),
        suggestions: Suggestions = Suggestions(),
    ) -> T:
        """Return the file's data (or ``data`` in its place, of the same keys below ``under``) as ``kind``.

        Raises :class:`UnusableFile` with every unknown key, missing key and wrong value.
        """
        return validated(
            kind,
            self.data if data is None else data,
            lambda key, reason: self.problem((*under, *key), reason),
            {"folder": self.path.parent},
            suggestions,
        )


class GivenTables(ParsedFile):
    """Tables that a program has given, in place of a file; ``path`` is what messages call them."""

    def problem(self, key: Sequence[str | int], reason: str) -> str:
        """Return a message of one line: name, table.key, reason."""
        return f"{self.path}: {dotted(key)}: {reason}"


def read_toml(path: Path) -> ParsedFile:
    """Parse a TOML file. Raises :class:`UnusableFile` with the line of a syntax error."""
    text = read_text(path)
    try:
        data = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        if isinstance(error, RecursionError):
            raise UnusableFile([f"{path}: nested too deeply"]) from error
        at = re.search(r"^(.*) \(at (?:line (\d+), column \d+|end of document)\)$", str(error), re.DOTALL)
        line = (at[2] or len(text.splitlines())) if at else 1
        raise UnusableFile([f"{path}: line {line}: not valid TOML: {at[1] if at else why_unparsed(error)}"]) from error
    return ParsedFile(path, data, _lines_of_keys(text))


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
