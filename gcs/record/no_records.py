"""A recorder that keeps nothing, for a ground station that waits for a flight."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gcs.flight.alarms import Alarm
    from gcs.flight.control_loop import StepRecord
    from gcs.flight.flight import Flight
    from idc_controller.control.controller import Decision
    from idc_controller.perception.obstacle_map import ObstacleMap


class NoRecords:
    """A :class:`.Recorder` without a file."""

    def datagrams(self, now: float, datagrams: Sequence[bytes]) -> None:
        """Keep nothing."""

    def end_exchange(self) -> None:
        """Keep nothing."""

    def step(self, flight: Flight, time: float, record: StepRecord | None) -> None:
        """Keep nothing."""

    def compute_times(self, time: float, decision: Decision, parts: Sequence[float]) -> None:
        """Keep nothing."""

    def obstacles(self, obstacle_map: ObstacleMap, time: float) -> None:
        """Keep nothing."""

    def alarm(self, alarm: Alarm) -> None:
        """Keep nothing."""
