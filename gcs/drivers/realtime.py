"""Real time: UDP on the monotonic clock, which may run faster or slower than the world's."""

import time
from collections.abc import Callable

from gcs.config.flight_settings import DriverSettings
from gcs.drivers.connection import Connection
from gcs.drivers.interrupt import Interrupt
from gcs.drivers.participant import InterruptWatch, Participant
from gcs.flight.failsafe import Failsafe


def run_in_real_time(
    station: Participant,
    connection: Connection,
    interrupt: Interrupt,
    settings: DriverSettings,
    *,
    speed: float = 1.0,
    clock: Callable[[], float] = time.monotonic,
    progress: Callable[[], None] = lambda: None,
    end_reason: Callable[[], str | None] = lambda: None,
) -> None:
    """Run ``station`` until its flight has ended. ``speed`` is ground seconds a wall second.

    ``end_reason`` returns why the vehicles have ended, None while they run.
    """
    start = clock()
    watch = InterruptWatch(interrupt, station)
    while not station.ended:
        now = (clock() - start) * speed
        if watch.ends(now):
            break
        if (reason := end_reason()) is not None:
            station.raise_failsafe(now, Failsafe.SIMULATION_LOST, reason)
        received = [*connection.receive()]
        # Nothing may seem to arrive before it was sent, also where this process had to wait since it read the clock.
        station.receive_all(received, (clock() - start) * speed)
        for datagram, address in station.datagrams_to_send(now):
            connection.send(datagram, address)
        station.sent()
        station.add_latency((clock() - start) * speed - now)
        progress()
        due = station.next_timer()
        if due is None:
            continue
        wait = due / speed - (clock() - start)
        if wait > 0.0:
            connection.wait(min(wait, settings.wait_max))
        station.resume()
