"""The log of a flight: phases, modes, alarms, links and clocks, as they change."""

import logging
import math

from gcs.flight.ground_station import GroundStation
from gcs.mavlink import px4
from gcs.mavlink.vehicle_link import VehicleLink

LOG = logging.getLogger("gcs")


class FlightLog:
    """Log of what has changed since the last exchange; times are the team's (s)."""

    def __init__(self, station: GroundStation) -> None:
        self._station = station
        self._phase = ""
        self._links = [_LinkLog(link) for link in station.links]
        self._alarms = 0

    def update(self) -> None:
        """Write what has changed."""
        flight = self._station.flight
        if flight.phase.value != self._phase:
            self._phase = flight.phase.value
            LOG.info("%.2f s: phase %s", flight.time, self._phase)
        for alarm in flight.failsafes.alarms.alarms[self._alarms :]:
            self._alarms += 1
            text = alarm.text and f" ({alarm.text})"
            LOG.warning("%.2f s: %s: %s%s", alarm.time, alarm.source, alarm.code.code, text)
        for link in self._links:
            link.update(flight.time)


class _LinkLog:
    """Log of one vehicle and its link."""

    def __init__(self, link: VehicleLink) -> None:
        self._link = link
        self._mode = (-1, False)
        self._address = link.address
        self._jumped = link.clock.jumped_at
        self._counts = _counts(link)

    def update(self, time: float) -> None:
        link, clock = self._link, self._link.clock
        if not math.isfinite(link.received_at):
            return
        who = f"{time:.2f} s: vehicle {link.system_id}"
        if (link.status.custom_mode, link.status.armed) != self._mode:
            self._mode = (link.status.custom_mode, link.status.armed)
            armed = "armed" if link.status.armed else "disarmed"
            LOG.info("%s: mode %s, %s", who, px4.mode_name(link.status.custom_mode), armed)
        if link.address != self._address:
            self._address = link.address
            LOG.info("%s: connected from %s", who, link.address)
        if clock.jumped_at != self._jumped:
            self._jumped = clock.jumped_at
            LOG.debug("%s: clock jumped, offset %.3f s", who, clock.offset)
        if LOG.isEnabledFor(logging.DEBUG) and (counts := _counts(link)) != self._counts:
            for name, count in counts.items():
                if count != self._counts[name]:
                    LOG.debug("%s: link: %s %d", who, name, count)
            self._counts = counts


def _counts(link: VehicleLink) -> dict[str, int]:
    found = link.statistics
    return {
        "losses": found.lost,
        "out of order": found.reordered,
        "duplicates": found.duplicated,
        "damaged datagrams": found.damaged,
        "lost set-points": link.setpoints.lost,
    }
