"""A warm process that flies one flight after the other, each in a fork of its own (see `vehicle_sim.app.flights`)."""

from __future__ import annotations

import contextlib
import json
import os
import re
import select
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType

POLL = 0.2  # s
_END = re.compile(rb"\nexit status (-?\d+)\n\Z")


class FlightWorker:
    """A process in which flights are forked; started by the first, and anew by the next after it was killed.

    A context manager. ``stop`` ends the flight that goes on. All end with this process, however it does: the worker
    and its flight read the end of their standard input.
    """

    def __init__(self, stop: threading.Event | None = None) -> None:
        self.stop = stop or threading.Event()
        self._process: subprocess.Popen[bytes] | None = None
        self._messages = tempfile.TemporaryFile()  # noqa: SIM115  # closed by `close`

    def run(self, arguments: Sequence[str], timeout: float) -> tuple[int, str, str]:
        """Carry out ``gcs`` with ``arguments``, ``timeout`` s at most; return exit code, standard output and error."""
        deadline = time.monotonic() + timeout
        self._messages.seek(0)
        self._messages.truncate()
        process = self._process = self._process or self._started()
        assert process.stdin is not None and process.stdout is not None
        with contextlib.suppress(BrokenPipeError):  # it has ended: so has its output
            process.stdin.write(json.dumps([str(Path.cwd()), *arguments]).encode() + b"\n")
            process.stdin.flush()
        output = b""
        while not (end := _END.search(output)):
            if self.stop.is_set() or time.monotonic() > deadline:
                os.killpg(
                    process.pid, signal.SIGKILL
                )  # the simulator ends with its flight: it reads the end of its standard input
            if select.select([process.stdout], (), (), POLL)[0]:
                if not (part := os.read(process.stdout.fileno(), 65536)):
                    break
                output += part
        code = int(end[1]) if end else self._end()
        self._messages.seek(0)
        return code, _text(output[: end.start()] if end else output), _text(self._messages.read())

    def close(self) -> None:
        """End the process."""
        self._end()
        self._messages.close()

    def _started(self) -> subprocess.Popen[bytes]:
        return subprocess.Popen(
            [sys.executable, "-m", "vehicle_sim.app.flights"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._messages,
            start_new_session=True,  # Ctrl-C is for this process, which ends its flights itself
        )

    def _end(self) -> int:
        """End the process, if there is one; return its exit code."""
        if self._process is None:
            return 0
        with self._process as process:  # closes its pipes and waits
            self._process = None
        return process.returncode

    def __enter__(self) -> FlightWorker:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _text(content: bytes) -> str:
    return content.decode(errors="replace")
