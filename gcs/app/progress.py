"""The progress line while a flight goes on."""

from __future__ import annotations

import math

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from gcs.flight.flight import Flight
from gcs.flight.phase import Phase


class FlightProgress:
    """One line at a terminal with phase, flight time and how much is left; elsewhere one line a phase."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._at_terminal = console.is_terminal  # asks the system each time
        self._progress = Progress(
            SpinnerColumn(),
            TextColumn("{task.description:<12}"),
            BarColumn(),
            TextColumn("{task.fields[flown]}"),
            TimeElapsedColumn(),
            console=console,
            transient=True,
            disable=not self._at_terminal,
        )
        self._task = self._progress.add_task("connect", total=None, flown="")
        self._phase: Phase | None = None
        self._second = -1

    def update(self, flight: Flight) -> None:
        """Draw what has changed since the last exchange."""
        changed = flight.phase is not self._phase
        time = flight.time - flight.takeoff_time
        flown = math.isfinite(time)
        if changed:
            self._phase = flight.phase
            if not self._at_terminal:
                self._console.print(f"{flight.elapsed:8.2f} s  {flight.phase.value}")
        second = math.floor(time) if flown else -1
        if self._at_terminal and (changed or second != self._second):
            self._second = second
            end = flight.expected_end - flight.takeoff_time if flown else math.inf
            self._progress.update(
                self._task,
                description=flight.phase.value,
                completed=time if flown else 0.0,
                total=end if math.isfinite(end) else None,
                flown=f"{time:5.0f} s" + (f" of {end:.0f} s" if math.isfinite(end) else "") if flown else "",
            )

    def __enter__(self) -> FlightProgress:
        self._progress.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._progress.stop()
