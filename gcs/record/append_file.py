"""A file that only grows, record by record; its failure never ends a flight."""

import contextlib
import os
from pathlib import Path
from typing import Self

from gcs.errors import UnusableInput


class AppendOnlyFile:
    """Appends whole records to a new file; a killed process leaves whole records.

    Every record goes to the operating system at once. A record that cannot be written (full disk) is taken
    back to the last whole record; writing then stops, ``error`` says why, and the flight goes on.
    ``close()`` may be called more than once; records after it are dropped.

    Raises :class:`UnusableInput` if the file exists already or cannot be created.
    """

    def __init__(self, path: Path | str) -> None:
        self.path = Path(path)
        self.error: OSError | None = None
        try:
            # Exclusive creation: records of an earlier flight are never overwritten.
            self._file = self.path.open("xb", buffering=0)
        except FileExistsError:
            raise UnusableInput(f"{self.path}: there is a record of another flight already") from None
        except OSError as error:
            raise UnusableInput(f"{self.path}: cannot be written: {error.strerror}") from None
        self._whole = 0

    def append(self, record: bytes) -> None:
        """Append one record; does nothing once the file is closed or has failed."""
        if self._file.closed or self.error is not None:
            return
        try:
            rest = record
            while (written := self._file.write(rest)) < len(rest):  # an unbuffered write may take only a part
                rest = rest[written:]
            self._whole += len(record)
        except OSError as error:
            self.error = error
            with contextlib.suppress(OSError):
                os.truncate(self.path, self._whole)

    def close(self) -> None:
        """Close the file; harmless when it is closed already."""
        if not self._file.closed:
            try:
                self._file.close()
            except OSError as error:
                self.error = self.error or error

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
