"""The progress of a flight, at a terminal or elsewhere."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Sequence
from datetime import timedelta
from itertools import cycle

from rich.console import Console, Group
from rich.live import Live
from rich.text import Text

from gcs.flight.flight import Flight
from gcs.flight.flight_status import Figure, FlightStatus
from gcs.flight.phase import Phase

DRAW_INTERVAL = 0.5
"""s of flight time after which the figures at a terminal are taken anew."""
STATUS_INTERVAL = 10.0
"""s of flight time from one print of the figures to the next elsewhere."""

CONNECT_INTERVAL = 2.0
"""s of ground time after which a ground that still connects says what it waits for, and for the next time."""


class FlightProgress:
    """At a terminal a block of a few lines that is redrawn, above it a line for each phase; elsewhere lines only.

    Alarms are of the log (:mod:`gcs.app.flight_log`); while there is a block, they stand above it as well.
    """

    def __init__(self, console: Console, *, phases_logged: bool = False) -> None:
        """``phases_logged``: the log prints them at the terminal already."""
        self._console, self._redrawn, self._phases_logged = console, console.is_interactive, phases_logged
        self._interval = DRAW_INTERVAL if self._redrawn else STATUS_INTERVAL
        self._phase: Phase | None = None
        self._due = 0
        self._status: FlightStatus | None = None
        self._begin, self._frames = time.monotonic(), cycle("-\\|/")
        self._times = math.nan, math.inf
        self._waits, self._waits_at = "", 0.0
        self._figures: list[Text] = []
        self._is_shown = False
        self._live = Live(
            get_renderable=self._block,
            console=console,
            refresh_per_second=2,
            transient=True,
            redirect_stderr=sys.stderr.isatty(),  # a file keeps what is for it
        )

    def update(self, flight: Flight) -> None:
        """Print or draw what has changed since the last exchange."""
        changed = flight.phase is not self._phase
        if changed:
            self._phase = flight.phase
            if not self._redrawn:
                self._console.print(f"{flight.elapsed:8.2f} s  {flight.phase.value}")
            elif not self._phases_logged:
                self._console.print(f"{flight.elapsed:.2f} s: phase {flight.phase.value}")
        if flight.phase is Phase.CONNECT:
            self._print_waits(flight)
        due = math.floor(flight.elapsed / self._interval)
        # A flight faster than real time has more figures than are shown.
        if not changed and (due == self._due or (self._redrawn and not self._is_shown)):
            return
        if self._status is None:
            self._status = FlightStatus(flight)
        if self._redrawn:
            self._draw(self._status)
            if changed:
                self._live.refresh()
        elif due != self._due:
            self._print(flight.elapsed, self._status)
        self._due = due

    def _print_waits(self, flight: Flight) -> None:
        """Print what the ground waits for, unless it has been printed."""
        now, waits = flight.ground_time, flight.system.preflight.missing
        if now - self._waits_at >= CONNECT_INTERVAL and waits != self._waits:
            self._waits, self._waits_at = waits, now
            self._console.print(f"{flight.elapsed:8.2f} s  waits: {waits}", soft_wrap=True)

    def _draw(self, status: FlightStatus) -> None:
        self._is_shown = False
        rows = [row for group in (status.payload(), status.links()) for row in _rows(group, self._console.width)]
        self._figures = [Text("  ").join(Text(figure.text, style=figure.state) for figure in row) for row in rows]
        self._times = status.times()

    def _block(self) -> Group:
        """Return what is drawn. Texts only: tables would cost several times as much."""
        self._is_shown = True
        phase, (flown, end) = self._phase or Phase.CONNECT, self._times
        begin = f"{next(self._frames)} {phase.value:<10} "
        rest = f" {_flown(flown, end)} {timedelta(seconds=int(time.monotonic() - self._begin))}"
        width = max(self._console.width - len(begin) - len(rest), 0)
        done = round(width * min(flown / end, 1.0)) if math.isfinite(end) else 0
        line = "-" if self._console.options.ascii_only else "━"
        bar = Text.assemble(begin, (line * done, "bar.complete"), (line * (width - done), "bar.back"), rest)
        return Group(bar, *self._figures)

    def _print(self, elapsed: float, status: FlightStatus) -> None:
        begin, flown = f"{elapsed:8.2f} s  ", _flown(*status.times())
        for group in ([Figure(flown)] if flown else []) + status.payload(), status.links():
            figures = [Figure(" ".join(figure.text.split())) for figure in group]
            for row in _rows(figures, self._console.width - len(begin)):
                self._console.print(begin + "; ".join(figure.text for figure in row), soft_wrap=True)
                begin = " " * len(begin)

    def __enter__(self) -> FlightProgress:
        if self._redrawn:
            self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._live.stop()
        # Or the flight, and with it the solvers, would live on in the cycle of this and its display, and be reported at
        # the end of the program as leaked.
        self._status = None


def _flown(flown: float, end: float) -> str:
    """Return the time flown of the expected one (s), as far as they are known."""
    if math.isnan(flown):
        return ""
    return f"{flown:.0f} of {end:.0f} s" if math.isfinite(end) else f"{flown:.0f} s"


def _rows(figures: Sequence[Figure], width: int) -> list[list[Figure]]:
    """Return the figures in rows of up to ``width`` characters, with two between one and the next."""
    rows: list[list[Figure]] = []
    free = 0
    for figure in figures:
        free -= len(figure.text) + 2
        if free < 0 or not rows:
            rows.append([])
            free = width - len(figure.text)
        rows[-1].append(figure)
    return rows
