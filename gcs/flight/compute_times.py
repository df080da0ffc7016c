"""Compute times of a control step, part by part, by a stopwatch that the caller hands in."""

from collections.abc import Callable
from enum import IntEnum


class Part(IntEnum):
    """Part of what the ground computes in a control period."""

    TELEMETRY = 0
    """Receiving: decoding, links, clocks, measurements into the estimator; datagrams put by for the telemetry log."""
    ESTIMATION = 1
    PERCEPTION = 2
    """Obstacle map."""
    PLANNING = 3
    """Guidance and safety filter."""
    CONTROL = 4
    """Reference and tracker."""
    STOP_PLAN = 5
    MONITORING = 6
    """Failsafes, phases, system-id check, detectors of alarms."""
    RECORDING = 7
    SETPOINTS = 8
    """Sending: set-points, requests, heartbeats, and their encoding."""


class ComputeTimes:
    """Compute times (s) since the last control step was recorded; waiting between two datagrams counts for nothing."""

    def __init__(self, stopwatch: Callable[[], float]) -> None:
        self._stopwatch = stopwatch
        self._last = stopwatch()
        self._spent = [0.0] * len(Part)

    def resume(self) -> None:
        """Begin a lap after an idle time."""
        self._last = self._stopwatch()

    def lap(self, part: Part) -> None:
        """Add the time since the last lap to ``part``, and begin another."""
        now = self._stopwatch()
        self._spent[part] += now - self._last
        self._last = now

    def shift(self, duration: float, giver: Part, taker: Part) -> None:
        """Count ``duration`` (s) of one part to another."""
        self._spent[giver] -= duration
        self._spent[taker] += duration

    def take(self) -> tuple[float, ...]:
        """Return the times of all parts since the last call (s), in the order of :class:`Part`."""
        spent = tuple(self._spent)
        self._spent = [0.0] * len(Part)
        return spent
