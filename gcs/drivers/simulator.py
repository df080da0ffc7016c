"""Process of ``vehicle-sim``, for flights in a simulated world of their own."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Sequence
from types import TracebackType

from gcs.drivers.settings import DriverSettings
from gcs.errors import GcsError
from gcs.mavlink.address import Address

_LINE = re.compile(r"^(?P<who>clock|vehicle \d+): udp://(?P<host>[^:]+):(?P<port>\d+)$")


class Simulator:
    """A running ``vehicle-sim``; a context manager that ends it."""

    def __init__(self, arguments: Sequence[str], settings: DriverSettings) -> None:
        """Start it and read where it listens. Raises :class:`GcsError` with its error output when it does not start."""
        self._settings = settings
        # A session of its own: Ctrl-C at the terminal is for the ground, which lands the vehicles first.
        self._process = subprocess.Popen(
            [sys.executable, "-m", "vehicle_sim", "--with-parent", *arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        self.clock_address: Address | None = None
        self.vehicles: list[Address] = []
        assert self._process.stdout is not None
        for line in self._process.stdout:
            if line.strip() == "ready":
                return
            if match := _LINE.match(line.strip()):
                address = (match["host"], int(match["port"]))
                if match["who"] == "clock":
                    self.clock_address = address
                else:
                    self.vehicles.append(address)
        assert self._process.stderr is not None
        error = self._process.stderr.read().strip()
        self._process.wait()
        raise GcsError(f"vehicle-sim did not start: {error.splitlines()[-1] if error else 'no error output'}")

    def end_reason(self) -> str | None:
        """Return how it ended; None while it runs."""
        code = self._process.poll()
        if code is None:
            return None
        how = f"was killed by signal {-code}" if code < 0 else f"ended with exit code {code}"
        return f"the simulated world has ended: vehicle-sim {how}"

    def close(self) -> None:
        """Let it end, and wait until its records are closed: without its parent's pipe it lands what is in the air."""
        s = self._settings
        for timeout, stop in ((s.landing_timeout, self._process.terminate), (s.end_timeout, self._process.kill)):
            try:
                self._process.communicate(timeout=timeout)
                return
            except subprocess.TimeoutExpired:
                stop()
        self._process.communicate()

    def __enter__(self) -> Simulator:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
