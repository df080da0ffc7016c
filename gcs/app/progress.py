"""The progress of a flight, at a terminal or elsewhere."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Sequence

from rich.columns import Columns
from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.text import Text

from gcs.app.flight_status import Figure, FlightStatus
from gcs.flight.flight import Flight
from gcs.flight.phase import Phase

DRAW_INTERVAL = 0.5
"""s of flight time after which the figures at a terminal are taken anew."""
STATUS_INTERVAL = 10.0
"""s of flight time from one print of the figures to the next elsewhere."""


class FlightProgress:
    """At a terminal a block of a few lines that is redrawn, above it a line for each phase; elsewhere lines only.

    Alarms are of the log (:mod:`gcs.app.flight_log`); while there is a block, they stand above it as well.
    """

    def __init__(self, console: Console, *, phases_logged: bool = False) -> None:
        """``phases_logged``: the log prints them at the terminal already."""
        self._console, self._redrawn, self._phases_logged = console, console.is_interactive, phases_logged
        self._interval = DRAW_INTERVAL if self._redrawn else STATUS_INTERVAL
        self._bar = Progress(
            SpinnerColumn(),
            TextColumn("{task.description:<10}"),
            BarColumn(bar_width=None),
            TextColumn("{task.fields[flown]}"),
            TimeElapsedColumn(),
            console=console,
            expand=True,
        )
        self._task = self._bar.add_task("connect", total=None, flown="")
        self._block: RenderableType = self._bar
        self._live = Live(
            get_renderable=lambda: self._block,
            console=console,
            refresh_per_second=4,
            transient=True,
            redirect_stderr=sys.stderr.isatty(),  # a file keeps what is for it
        )
        self._phase: Phase | None = None
        self._due = 0
        self._status: FlightStatus | None = None

    def update(self, flight: Flight) -> None:
        """Print or draw what has changed since the last exchange."""
        changed = flight.phase is not self._phase
        if changed:
            self._phase = flight.phase
            if not self._redrawn:
                self._console.print(f"{flight.elapsed:8.2f} s  {flight.phase.value}")
            elif not self._phases_logged:
                self._console.print(f"{flight.elapsed:.2f} s: phase {flight.phase.value}")
        due = math.floor(flight.elapsed / self._interval)
        if due == self._due and not changed:
            return
        if self._status is None:
            self._status = FlightStatus(flight)
        if self._redrawn:
            self._draw(flight.phase, self._status)
        elif due != self._due:
            self._print(flight.elapsed, self._status)
        self._due = due

    def _draw(self, phase: Phase, status: FlightStatus) -> None:
        time, end = status.times()
        completed, total = (time, end) if math.isfinite(end) else (0.0, None)
        self._bar.update(self._task, description=phase.value, completed=completed, total=total, flown=_flown(time, end))
        self._block = Group(self._bar, _columns(status.payload()), _columns(status.links()))

    def _print(self, elapsed: float, status: FlightStatus) -> None:
        begin = f"{elapsed:8.2f} s  "
        width = self._console.width - len(begin)
        for texts in ([_flown(*status.times()), *_texts(status.payload())], _texts(status.links())):
            for line in _lines(texts, width):
                self._console.print(begin + line, soft_wrap=True)
                begin = " " * len(begin)

    def __enter__(self) -> FlightProgress:
        if self._redrawn:
            self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._live.stop()


def _flown(time: float, end: float) -> str:
    """Return the time flown of the expected one (s), as far as they are known."""
    if math.isnan(time):
        return ""
    return f"{time:.0f} of {end:.0f} s" if math.isfinite(end) else f"{time:.0f} s"


def _columns(figures: Sequence[Figure]) -> RenderableType:
    """Return the figures side by side, in as many lines as they need."""
    return Columns([Text(figure.text, style=figure.state.value) for figure in figures], padding=(0, 2))


def _texts(figures: Sequence[Figure]) -> list[str]:
    return [" ".join(figure.text.split()) for figure in figures]


def _lines(texts: Iterable[str], width: int) -> list[str]:
    """Return lines of up to ``width`` characters in which the texts that are not empty stand one after the other."""
    lines: list[str] = []
    for text in filter(None, texts):
        if lines and len(lines[-1]) + len(text) + 2 <= width:
            lines[-1] += f"; {text}"
        else:
            lines.append(text)
    return lines
