"""The log of a flight: phases, modes, alarms, links and clocks, as they change."""

import logging
import math

from gcs.flight.alarms import Severity
from gcs.flight.ground_station import GroundStation
from gcs.flight.phase import Phase
from gcs.mavlink import px4
from gcs.mavlink.vehicle_link import VehicleLink

LOG = logging.getLogger("gcs")
_RED, _YELLOW = 31, 33
"""Colours of ANSI, in which alarms are shown at a terminal."""


class FlightLog:
    """Log of what has changed since the last exchange; times (s) begin with the ground's."""

    def __init__(self, station: GroundStation) -> None:
        self._station = station
        self._phase: Phase | None = None
        self._links = [_LinkLog(link) for link in station.links]
        self._alarms = 0
        self._uptime = 0.0

    def update(self) -> None:
        """Write what has changed."""
        flight = self._station.flight
        if flight.phase is not self._phase:
            self._phase = flight.phase
            LOG.info("%.2f s: phase %s", flight.elapsed, self._phase.value)
        uptime = flight.system.preflight.uptime
        if uptime != self._uptime:
            self._uptime = uptime
            LOG.info("vehicle 1 has been up for %.0f s: records count from there", uptime)
        for alarm in flight.failsafes.alarms.alarms[self._alarms :]:
            self._alarms += 1
            text = alarm.text and f" ({alarm.text})"
            colour = _RED if alarm.code.severity <= Severity.ERROR else _YELLOW
            line = "%.2f s: %s: %s%s"
            LOG.warning(line, alarm.time - uptime, alarm.source, alarm.code.code, text, extra={"colour": colour})
        for link in self._links:
            link.update(flight.elapsed)


class _LinkLog:
    def __init__(self, link: VehicleLink) -> None:
        self._link = link
        self._mode = (-1, False)
        self._address = link.address
        self._jumped = link.clock.jumped_at
        self._counted, self._counts = LOG.isEnabledFor(logging.DEBUG), _counts(link)

    def update(self, time: float) -> None:
        link, clock = self._link, self._link.clock
        if not math.isfinite(link.received_at):
            return
        if (mode := (link.status.custom_mode, link.status.armed)) != self._mode:
            self._mode = mode
            armed = "armed" if link.status.armed else "disarmed"
            self._write(logging.INFO, time, f"mode {px4.mode_name(link.status.custom_mode)}, {armed}")
        if link.address != self._address:
            self._address = link.address
            self._write(logging.INFO, time, f"connected from {link.address}")
        if clock.jumped_at != self._jumped:
            self._jumped = clock.jumped_at
            self._write(logging.DEBUG, time, f"clock jumped, offset {clock.offset:.3f} s")
        if self._counted and (counts := _counts(link)) != self._counts:
            for name, count in counts.items():
                if count != self._counts[name]:
                    self._write(logging.DEBUG, time, f"link: {name} {count}")
            self._counts = counts

    def _write(self, level: int, time: float, text: str) -> None:
        LOG.log(level, "%.2f s: vehicle %s: %s", time, self._link.system_id, text)


def _counts(link: VehicleLink) -> dict[str, int]:
    found = link.statistics
    return {
        "losses": found.lost,
        "out of order": found.reordered,
        "duplicates": found.duplicated,
        "damaged datagrams": found.damaged,
        "lost set-points": link.setpoints.lost,
    }
