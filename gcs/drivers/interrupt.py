"""Signals that end the programs: Ctrl-C, SIGTERM, and SIGHUP, which a terminal sends when it is closed."""

from __future__ import annotations

import signal
import threading
from collections.abc import Sequence
from types import FrameType
from typing import Any

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Interrupt:
    """While in use, each of ``signals`` raises :class:`KeyboardInterrupt`, except in a flight and after it.

    In a flight the first one is a request, and only a second Ctrl-C or SIGTERM raises it; after it, while records are
    closed, none does. SIGHUP, which comes from the terminal and again from the shell, is never a second one, and of no
    effect where it was ignored before (``nohup``). A context manager; outside the main thread it does nothing.
    """

    def __init__(self, signals: Sequence[signal.Signals] = SIGNALS) -> None:
        self.requested = False
        self._signals = signals
        self._in_flight = self._flown = self._hung_up = False
        self._previous: dict[int, Any] = {}

    def begin_flight(self) -> None:
        """From here on the first signal is a request: see :attr:`requested`."""
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

    def __exit__(self, *_: object) -> None:
        for number, handler in self._previous.items():
            signal.signal(number, handler)

    def _on_signal(self, number: int, frame: FrameType | None) -> None:
        again, self._hung_up = self._hung_up, self._hung_up or number == signal.SIGHUP
        if self._flown or (number == signal.SIGHUP and (again or self.requested)):
            return
        if not self._in_flight:
            raise KeyboardInterrupt
        if self.requested:
            self.end_flight()
            raise KeyboardInterrupt
        self.requested = True
