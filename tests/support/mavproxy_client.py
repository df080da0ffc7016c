"""MAVProxy as a program of its own, to which lines are typed, and what it prints."""

from __future__ import annotations

import contextlib
import queue
import re
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

from programs import ENVIRONMENT, PATIENCE


class MavProxy:
    """A running MAVProxy."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self._process = process
        self._lines: queue.Queue[str | None] = queue.Queue()
        self.printed: list[str] = []
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self._lines.put(line.rstrip("\n"))
        self._lines.put(None)

    def type(self, command: str) -> None:
        """Type a command."""
        assert self._process.stdin is not None
        self._process.stdin.write(command + "\n")
        self._process.stdin.flush()

    def until(self, pattern: str) -> re.Match[str]:
        """Wait for a line that has a pattern in it; those before it are passed over."""
        with contextlib.suppress(queue.Empty):
            while (line := self._lines.get(timeout=PATIENCE)) is not None:
                self.printed.append(line)
                if found := re.search(pattern, line):
                    return found
        raise AssertionError(f"no line with {pattern!r}:\n" + "\n".join(self.printed))

    def command(self, command: str, pattern: str) -> re.Match[str]:
        """Type a command, and wait for a line that has a pattern in it."""
        self.type(command)
        return self.until(pattern)


def mavproxy(port: int, folder: Path) -> contextlib.AbstractContextManager[MavProxy]:
    """Start MAVProxy for the vehicle that sends to a port."""
    return started(["mavproxy.py", f"--master=udpin:127.0.0.1:{port}"], folder)


@contextlib.contextmanager
def started(words: list[str], folder: Path) -> Iterator[MavProxy]:
    """Start MAVProxy by a command, with its files in a folder, and wait until it has the parameters of a vehicle."""
    environment = {**ENVIRONMENT, "PYTHONUNBUFFERED": "1", "HOME": str(folder)}
    program = Path(sys.executable).parent / words[0]
    with subprocess.Popen(
        [program, *words[1:], f"--state-basedir={folder}"], cwd=folder, env=environment, text=True,
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    ) as process:  # fmt: skip
        try:
            running = MavProxy(process)
            running.until(r"Received \d+ parameters")
            yield running
            running.type("exit")
            assert process.stdin is not None
            process.stdin.close()  # its thread of input ends only then
            process.wait(PATIENCE)
        finally:
            process.kill()
