"""The tables of a run folder that is still written."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from gcs.errors import UnusableInput
from gcs.record.reader import Table, parse_table
from gcs.record.run_data import RunTables
from gcs.record.tables import OBSTACLES


class GrowingTables(RunTables):
    """The tables so far, by file; :meth:`grow` reads on, from the last whole line that was there before.

    Raises :class:`UnusableInput` as :func:`~gcs.record.reader.read_table` does.
    """

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._headers: dict[str, str] = {}
        self._read: dict[str, int] = {}  # bytes
        self._taken: dict[str, int] = {}  # rows

    def __missing__(self, file: str) -> Table:
        self[file] = table = parse_table(self._folder / file, "", "")
        self._append(file)
        return self.get(file, table)

    def grow(self) -> None:
        """Read what has been written since."""
        for file in list(self):
            self._append(file)

    def new(self) -> RunTables:
        """Return the tables with the rows alone that have not been taken; of obstacles all rows."""
        return _NewRows(self, self._taken)

    def take(self) -> None:
        """Take all rows so far."""
        self._taken = {file: len(table) for file, table in self.items()}

    def _append(self, file: str) -> None:
        path = self._folder / file
        try:
            with path.open("rb") as stream:
                stream.seek(self._read.get(file, 0))
                lines = stream.read()
        except FileNotFoundError:
            return
        except OSError as error:
            raise UnusableInput(f"{path}: cannot be read: {error.strerror}") from None
        lines = lines[: lines.rfind(b"\n") + 1]
        if not lines:
            return
        self._read[file] = self._read.get(file, 0) + len(lines)
        text = lines.decode("utf-8", errors="replace")
        if file not in self._headers:
            self._headers[file], _, text = text.partition("\n")
        rows = parse_table(path, self._headers[file], text)
        self[file] = np.concatenate([self[file], rows]) if len(self[file]) else rows


class _NewRows(RunTables):
    """The rows of growing tables from a number of each on."""

    def __init__(self, tables: GrowingTables, begins: dict[str, int]) -> None:
        self._tables, self._begins = tables, begins

    def __missing__(self, file: str) -> Table:
        table = self._tables[file]
        # Where an obstacle stands, and since when, is not in its latest row.
        self[file] = rows = table if file == OBSTACLES else table[self._begins.get(file, 0) :]
        return rows
