"""Standard output and error that may end before the program: a closed terminal or pipe, a full disk."""

import contextlib
import errno
import os
import sys
from collections.abc import Iterator
from typing import Any, TextIO, cast

_NOBODY_READS = (errno.EPIPE, errno.EIO)
"""A pipe whose reader has ended, a terminal that is closed."""


@contextlib.contextmanager
def output_that_may_end(*names: str) -> Iterator[None]:
    """While the block runs, what cannot be written to the streams ``names`` of :mod:`sys` is lost, without an error."""
    # A program that was started with a stream closed has None in its place.
    streams = {name: stream for name in names if (stream := getattr(sys, name)) is not None}
    for name, stream in streams.items():
        setattr(sys, name, cast(TextIO, _OutputThatMayEnd(stream)))
    try:
        yield
    finally:
        for name, stream in streams.items():
            getattr(sys, name).flush()
            setattr(sys, name, stream)


class _OutputThatMayEnd:
    """A text stream that goes nowhere once it cannot be written."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        try:
            return self._stream.write(text)
        except OSError as error:
            self._end(error)
            return len(text)

    def flush(self) -> None:
        try:
            self._stream.flush()
        except OSError as error:
            self._end(error)

    def _end(self, error: OSError) -> None:
        """Let what is buffered, and all that follows, go nowhere."""
        with contextlib.suppress(OSError):  # a stream without a file
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self._stream.fileno())
            os.close(nowhere)
        if error.errno not in _NOBODY_READS and sys.stderr is not self:
            print(f"standard output cannot be written: {error.strerror}", file=sys.stderr)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)
