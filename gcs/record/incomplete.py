"""What of the records of a flight could not be written, and when it ended."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

INCOMPLETE = 3
"""Exit status of the programs: flown, but the records are incomplete."""
_PREFIX = "incomplete: "


@dataclass(frozen=True)
class Incomplete:
    """A file that ends at the time ``end`` (s), None: is missing, for the ``reason`` of the operating system."""

    name: str
    end: float | None
    reason: str

    def line(self) -> str:
        """Return it as a line for :func:`read_line`."""
        return _PREFIX + json.dumps(asdict(self))


class IncompleteRecords:
    """The files of one run that could not be written to their end; ``time`` (s) is that of the latest rows."""

    def __init__(self) -> None:
        self.time = 0.0
        self.found: list[Incomplete] = []

    def add(self, path: Path, error: OSError) -> None:
        """Note that ``path`` ends here or, if there is no such file, is missing."""
        self.found.append(Incomplete(path.name, self.time if path.exists() else None, error.strerror or str(error)))


def read_line(line: str) -> Incomplete | None:
    """Return what a line of :meth:`Incomplete.line` says; None for any other line."""
    if not line.startswith(_PREFIX):
        return None
    return Incomplete(**json.loads(line.removeprefix(_PREFIX)))


def in_one_line(found: Sequence[Incomplete]) -> str:
    """Return for people which records are incomplete, from when on, and why."""
    parts = []
    for reason in dict.fromkeys(file.reason for file in found):
        files = [file for file in found if file.reason == reason]
        ends = [f"{file.name} ends at {file.end:.2f} s" for file in files if file.end is not None]
        missing = [f"{file.name} is missing" for file in files if file.end is None]
        parts.append(f"{', '.join([*ends, *missing])} ({reason})")
    return f"records incomplete: {'; '.join(parts)}"
