"""A file that only grows, record by record; its failure never ends a flight."""

import contextlib
import os
from pathlib import Path
from typing import Self

from gcs.errors import UnusableInput
from gcs.record.incomplete import IncompleteRecords


class AppendOnlyFile:
    """Appends whole records to a new file; a killed process leaves whole records.

    Every record goes to the operating system at once. A record that cannot be written (full disk) is taken
    back to the last whole record; writing then stops, ``error`` says why, it is added to ``incomplete``, and the flight
    goes on. ``close()`` may be called more than once; records after it are dropped.
    """

    def __init__(
        self,
        path: Path | str,
        incomplete: IncompleteRecords | None = None,
        *,
        head: bytes = b"",
        when_needed: bool = False,
    ) -> None:
        """Create the file, with ``head`` as its first record; ``when_needed``: before the first :meth:`append`.

        Raises :class:`UnusableInput` if it is created here, and exists already or cannot be written.
        """
        self.path = Path(path)
        self.error: OSError | None = None
        self._incomplete = incomplete or IncompleteRecords()
        self._head = head
        self._whole = 0
        self.closed = False
        self._descriptor: int | None = None
        if when_needed:
            return
        try:
            self._create()
        except FileExistsError:
            raise UnusableInput(f"{self.path}: there is a record of another flight already") from None
        except OSError as error:
            self.close()
            raise UnusableInput(f"{self.path}: cannot be written: {error.strerror}") from None

    def append(self, record: bytes) -> None:
        """Append one record; does nothing once the file is closed or has failed."""
        if self.closed or self.error is not None:
            return
        try:
            if self._descriptor is None:
                self._create()
            self._write(record)
        except OSError as error:
            self._fail(error)
            with contextlib.suppress(OSError):
                os.truncate(self.path, self._whole)

    def close(self) -> None:
        """Close the file; harmless when it is closed already."""
        self.closed = True
        descriptor, self._descriptor = self._descriptor, None
        if descriptor is None:
            return
        try:
            os.close(descriptor)
        except OSError as error:  # of a file on another machine, what was written before may be lost
            self._fail(error)

    def _create(self) -> None:
        # Exclusive creation: records of an earlier flight are never overwritten.
        self._descriptor = os.open(self.path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666)
        self._write(self._head)

    def _write(self, record: bytes) -> None:
        assert self._descriptor is not None
        rest = record
        while rest:  # a write may take only a part
            rest = rest[os.write(self._descriptor, rest) :]
        self._whole += len(record)

    def _fail(self, error: OSError) -> None:
        if self.error is None:
            self.error = error.with_traceback(None)  # whose frames would keep the whole flight in memory
            self._incomplete.add(self.path, error)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
