"""Programs as forks of this process: what it has imported need not be imported again.

A fork takes milliseconds where a fresh interpreter spends seconds on imports. Modules are all that the child should
find, so fork before anything is opened or begun, and while there is one thread.
"""

from __future__ import annotations

import contextlib
import json
import multiprocessing
import os
import runpy
import signal
import sys
import tempfile
from collections.abc import Iterator, Sequence

from gcs.drivers.interrupt import SIGNALS

FORK = multiprocessing.get_context("fork")


def run_program(module: str, arguments: Sequence[str], streams: Sequence[int]) -> None:
    """Carry out ``python -m module`` with ``arguments`` in a forked child.

    Args:
        module: name of a package with a ``__main__``.
        arguments: of the command line.
        streams: file descriptors of standard input, output and error.
    """
    for number, stream in enumerate(streams):
        os.dup2(stream, number)
    sys.stdin, sys.stdout = os.fdopen(0, closefd=False), os.fdopen(1, "w", closefd=False)
    sys.stderr = os.fdopen(2, "w", buffering=1, errors="backslashreplace", closefd=False)
    sys.argv = [module, *arguments]
    runpy.run_module(module, run_name="__main__", alter_sys=True)


class ForkedProgram:
    """A program forked in advance, in a session of its own, which begins once it is given its arguments.

    Its standard input is a pipe of this process and ends with it. A context manager: a program without arguments by
    then ends.
    """

    def __init__(self, module: str) -> None:
        theirs, self._input = os.pipe()
        self._output, output = os.pipe()
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115  # closed by `close`
        streams = (theirs, output, self._errors.fileno())
        self.process = FORK.Process(target=self._wait, args=(module, streams))
        self.process.start()
        os.close(theirs)
        os.close(output)

    def _wait(self, module: str, streams: Sequence[int]) -> None:
        os.setsid()
        for number in SIGNALS:  # of the process that forked
            signal.signal(number, signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL)
        os.close(self._input)
        os.close(self._output)
        with os.fdopen(streams[0], closefd=False) as given:
            line = given.readline()
        if line:
            run_program(module, json.loads(line), streams)

    def begin(self, arguments: Sequence[str]) -> Iterator[str]:
        """Begin with ``arguments``; return the lines of its standard output as they come."""
        with contextlib.suppress(BrokenPipeError):  # it was killed: there are no lines
            os.write(self._input, json.dumps(list(arguments)).encode() + b"\n")
        return os.fdopen(self._output, closefd=False)

    def errors(self) -> str:
        """Return its standard error so far."""
        self._errors.seek(0)
        return self._errors.read().decode(errors="replace")

    def end_input(self) -> None:
        """End its standard input."""
        if self._input >= 0:
            os.close(self._input)
            self._input = -1

    def close(self) -> None:
        """End its standard input, and wait until it has ended."""
        self.end_input()
        self.process.join()
        os.close(self._output)
        self._errors.close()

    def __enter__(self) -> ForkedProgram:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
