"""What lets the time of a team go on that is flown from Python: a simulated world, or a thread in real time."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from typing import Any, Protocol

from gcs.drivers.connection import Connection
from gcs.drivers.in_process import InProcessLockstep
from gcs.drivers.interrupt import Interrupt
from gcs.drivers.realtime import run_in_real_time
from gcs.errors import GcsError
from gcs.flight.failsafe import Failsafe
from gcs.mavlink.address import Address
from gcs.serve.server import TeamServer


class Drive(Protocol):
    """Lets time go on."""

    server: TeamServer

    @property
    def lock(self) -> AbstractContextManager[Any, bool | None]:
        """To be held while the team is read or ordered: between two exchanges."""

    @property
    def now(self) -> float:
        """The ground's time (s)."""

    def run(self, until: Callable[[], bool], timeout: float) -> bool:
        """Go on until a condition holds, or for ``timeout`` (s); return whether it does."""

    def close(self) -> None:
        """Land what is in the air, and end."""


class LockstepDrive:
    """A simulated world in this process, whose time goes on while something waits for it."""

    def __init__(self, lockstep: InProcessLockstep[TeamServer], sent: Callable[[float, Sequence[Any]], None]) -> None:
        self._lockstep, self._sent = lockstep, sent
        self.server, self.lock = lockstep.station, nullcontext()

    @property
    def now(self) -> float:
        """See :attr:`Drive.now`."""
        return self._lockstep.now

    def run(self, until: Callable[[], bool], timeout: float) -> bool:
        """See :meth:`Drive.run`."""
        end = self.now + timeout
        while not until():
            if self.now >= end or self.server.ended:
                return False
            self._lockstep.step(lambda sent: self._sent(self.now, sent))
        return True

    def close(self) -> None:
        """See :meth:`Drive.close`."""
        self.server.raise_failsafe(self.now, Failsafe.INTERRUPTED, "closed")
        self.run(lambda: self.server.ended, math.inf)
        self._lockstep.let_land()


class YieldingConnection(Connection):
    """A connection whose thread gives up a lock while it waits."""

    def __init__(self, local: Address, lock: threading.Condition) -> None:
        super().__init__(local)
        self.lock = lock

    def wait(self, timeout: float) -> bool:
        """Wait for a datagram, without the lock; see :meth:`.Connection.wait`."""
        self.lock.release()
        try:
            return super().wait(timeout)
        finally:
            self.lock.acquire()


class RealTimeDrive:
    """A thread that runs the ground of a swarm which flies in real time.

    It holds :attr:`lock` except while it waits for the next datagram or timer: who holds that sees the team between
    two exchanges.
    """

    def __init__(self, server: TeamServer, connection: YieldingConnection) -> None:
        self.server, self.lock = server, connection.lock
        self._connection, self._interrupt = connection, Interrupt(())
        self._error: BaseException | None = None
        self._thread = threading.Thread(target=self._fly, name="team", daemon=True)
        self._thread.start()

    @property
    def now(self) -> float:
        """See :attr:`Drive.now`."""
        return self.server.now

    def _fly(self) -> None:
        settings = self.server.session.world.system.drivers
        with self.lock:
            try:
                run_in_real_time(
                    self.server, self._connection, self._interrupt, settings, progress=self.lock.notify_all
                )
            except BaseException as error:
                self._error = error
            self.lock.notify_all()

    def run(self, until: Callable[[], bool], timeout: float) -> bool:
        """See :meth:`Drive.run`."""
        with self.lock:
            end = self.now + timeout
            while not (found := until()) and self.now < end and self._thread.is_alive() and self._error is None:
                self.lock.wait(1.0)
        if self._error is not None:
            raise GcsError(f"the ground has ended: {self._error}") from self._error
        return found

    def close(self) -> None:
        """See :meth:`Drive.close`."""
        self._interrupt.requested = True
        self._thread.join()
        self.run(lambda: True, 0.0)
