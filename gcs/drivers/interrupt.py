"""Signals that end the programs: Ctrl-C, SIGTERM, and SIGHUP, which a terminal sends when it is closed."""

from __future__ import annotations

import signal
import threading
from collections.abc import Sequence
from types import FrameType, TracebackType
from typing import Any

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Interrupt:
    """While in use, each of ``signals`` raises :class:`KeyboardInterrupt`, except in a flight and after it.

    In a flight they are requests, which the driver obeys between two steps: an exception would come out of whatever is
    being computed. A second Ctrl-C or SIGTERM requests the end of control; after the flight, while records are closed,
    signals are without effect. SIGHUP, which comes from the terminal and again from the shell, is never a second one,
    and of no effect where it was ignored before (``nohup``). A context manager, without effect outside the main thread.
    """

    def __init__(self, signals: Sequence[signal.Signals] = SIGNALS) -> None:
        self.requested = self.requested_again = False
        self._signals = signals
        self._in_flight = self._flown = self._hung_up = self._raised = False
        self._previous: dict[int, Any] = {}

    def begin_flight(self) -> None:
        """From here on signals are requests: see :attr:`requested` and :attr:`requested_again`."""
        self._in_flight = True

    def end_flight(self) -> None:
        """From here on signals are without effect."""
        self._flown = True

    def __enter__(self) -> Interrupt:
        if threading.current_thread() is threading.main_thread():
            for number in self._signals:
                if number != signal.SIGHUP or signal.getsignal(number) != signal.SIG_IGN:
                    self._previous[number] = signal.signal(number, self._on_signal)
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None) -> None:
        for number, handler in self._previous.items():
            signal.signal(number, handler)
        if self._raised and isinstance(error, SystemError):  # by compiled code that was to pass it on
            raise KeyboardInterrupt from error

    def _on_signal(self, number: int, frame: FrameType | None) -> None:
        again, self._hung_up = self._hung_up, self._hung_up or number == signal.SIGHUP
        if self._flown or (number == signal.SIGHUP and (again or self.requested)):
            return
        if not self._in_flight:
            self._raised = True
            raise KeyboardInterrupt
        self.requested_again, self.requested = self.requested, True
