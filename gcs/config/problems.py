"""What is wrong with a file: every reason, one line each."""

from __future__ import annotations

from collections.abc import Sequence

from gcs.errors import UnusableInput


class UnusableFile(UnusableInput):
    """A file that cannot be used.

    ``reasons`` holds every reason that was found, one line each: file, line or item, field, reason.
    ``str(error)`` is the first of them, and says how many more there are.
    """

    def __init__(self, reasons: Sequence[str]) -> None:
        lines = tuple(_one_line(reason) for reason in reasons)
        more = len(lines) - 1
        super().__init__(lines[0] + (f" (and {more} more)" if more else ""))
        self.reasons = lines


def _one_line(text: str) -> str:
    """``text`` without line breaks or control characters, which a hostile file could bring in."""
    return "".join(c if c.isprintable() else " " for c in text)[:1000]
