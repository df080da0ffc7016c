"""The live view of a run, as a program beside those that fly it."""

from __future__ import annotations

import contextlib
import socket
import subprocess
import sys
from pathlib import Path

from gcs.mavlink.address import THIS_MACHINE

_PROGRAM = "gcs.view.live"
_END_TIMEOUT = 25.0  # s, after which it has ended by itself


class LiveView:
    """Shows a run folder in a browser of this machine while it is written; a context manager that ends it.

    It only reads the folder: what flies neither waits for it nor knows whether a browser looks.
    """

    def __init__(self, run_dir: Path) -> None:
        with socket.create_server((THIS_MACHINE, 0)) as listener:
            self.url = f"http://{THIS_MACHINE}:{listener.getsockname()[1]}/"
            # -P: nothing of the folder in which the program was started is imported.
            command = [sys.executable, "-P", "-m", _PROGRAM, str(run_dir), str(listener.fileno())]
            # In a session of its own: Ctrl-C at the terminal is for the ground, which lands the vehicles first.
            self._process = subprocess.Popen(
                command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, pass_fds=[listener.fileno()],
                start_new_session=True,
            )  # fmt: skip

    def end(self) -> None:
        """Let it send the whole report to the browsers that look, and then end by itself."""
        assert self._process.stdin is not None
        with contextlib.suppress(OSError):
            self._process.stdin.close()

    def close(self) -> None:
        """Let it send the whole report, and wait until it has ended."""
        self.end()
        try:
            self._process.wait(_END_TIMEOUT)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def __enter__(self) -> LiveView:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
