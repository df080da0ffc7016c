"""Process of ``vehicle-sim``, for flights in a simulated world of their own."""

from __future__ import annotations

import re
from collections.abc import Sequence

from gcs.config.flight_settings import DriverSettings
from gcs.drivers.forked_program import ForkedProgram
from gcs.errors import GcsError, UnusableInput
from gcs.mavlink.address import Address

PROGRAM = "vehicle_sim"
VEHICLES_MAX = 15
"""Vehicles that it can simulate: what its physics engine can exchange of one body."""
_REFUSED = 2
"""Its exit code for unusable input."""
_LINE = re.compile(r"^(?P<who>clock|vehicle \d+): udp://(?P<host>[^:]+):(?P<port>\d+)$")


class Simulator:
    """A running ``vehicle-sim``; a context manager that ends it.

    It has a session of its own: Ctrl-C at the terminal is for the ground, which lands the vehicles first.
    """

    def __init__(self, program: ForkedProgram, arguments: Sequence[str], settings: DriverSettings) -> None:
        """Start it and read where it listens.

        Raises :class:`UnusableInput` with its reason when it refuses the arguments, and :class:`GcsError` with the last
        line of its error output when it does not start otherwise.
        """
        self._settings = settings
        self._program = program
        self._process = program.process
        self.clock_address: Address | None = None
        self.vehicles: list[Address] = []
        self.last_lines: list[str] = []
        """What it has printed since it was ready; known when it has ended."""
        self._lines = program.begin(["--with-parent", *arguments])
        for line in self._lines:
            if line.strip() == "ready":
                return
            if match := _LINE.match(line.strip()):
                address = (match["host"], int(match["port"]))
                if match["who"] == "clock":
                    self.clock_address = address
                else:
                    self.vehicles.append(address)
        self._process.join()
        lines = program.errors().strip().splitlines()
        if self._process.exitcode == _REFUSED and lines:
            raise UnusableInput(lines[-1])
        raise GcsError(f"vehicle-sim did not start: {lines[-1] if lines else 'no error output'}")

    def end_reason(self) -> str | None:
        """Return how it ended; None while it runs."""
        code = self._process.exitcode
        if code is None:
            return None
        how = f"was killed by signal {-code}" if code < 0 else f"ended with exit code {code}"
        return f"the simulated world has ended: vehicle-sim {how}"

    def close(self) -> None:
        """Let it end, and wait until its records are closed: without its parent's pipe it lands what is in the air."""
        self._end()
        self.last_lines += self._lines

    def _end(self) -> None:
        s = self._settings
        self._program.end_input()
        for timeout, stop in ((s.landing_timeout, self._process.terminate), (s.end_timeout, self._process.kill)):
            self._process.join(timeout)
            if self._process.exitcode is not None:
                return
            stop()
        self._process.join()

    def __enter__(self) -> Simulator:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
