"""Lockstep: the world's clock is the ground's clock (see :mod:`gcs.mavlink.lockstep`)."""

import socket
import time
from collections.abc import Callable

from gcs.config.flight_settings import DriverSettings
from gcs.drivers.connection import LockstepConnection
from gcs.drivers.interrupt import Interrupt
from gcs.drivers.participant import InterruptWatch, Participant
from gcs.flight.failsafe import Failsafe
from gcs.mavlink.address import Address
from gcs.mavlink.lockstep import Done, Tick, decode_tick, next_call_us

_REFUSAL_TIME = 0.2  # s of wall time in which a closed port is reported


class Pace:
    """Holds the world's clock back to ``speed`` simulated seconds a wall second; delays are not made up for."""

    def __init__(
        self,
        speed: float,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self._speed, self._clock, self._sleep = speed, clock, sleep
        self._offset: float | None = None  # of simulated from wall time (s of wall time)

    def hold(self, now: float) -> None:
        """Wait until the simulated time ``now`` (s) is due."""
        due = now / self._speed
        if self._offset is None:  # the world may have served another ground before
            self._offset = due - self._clock()
        early = due - (self._clock() + self._offset)
        if early > 0.0:
            self._sleep(early)
        else:
            self._offset += early


def run_in_lockstep(
    station: Participant,
    connection: LockstepConnection,
    clock_address: Address,
    interrupt: Interrupt,
    settings: DriverSettings,
    *,
    pace: Pace | None = None,
    progress: Callable[[], None] = lambda: None,
    end_reason: Callable[[], str | None] = lambda: None,
    hint: str = "",
) -> None:
    """Run ``station`` until its flight has ended, one exchange with the world at a time, no faster than ``pace``.

    ``end_reason`` returns why the world has ended, None while it runs; ``hint`` what to do where none answers.
    """
    join = Done(0, None).encode()
    connection.send(join, clock_address)
    waited = now = 0.0
    joined, watch = False, InterruptWatch(interrupt, station)
    inbox: list[tuple[bytes, Address]] = []
    while not station.ended:
        # The world has yet to compute: a look at the socket before would be in vain.
        arrived = connection.wait(settings.join_interval)
        station.resume()
        if not arrived:
            if watch.ends(now):
                break
            waited += settings.join_interval
            reason = end_reason()
            if reason is None and waited >= settings.tick_timeout:
                reason = f"the simulated world does not answer for {settings.tick_timeout:g} s"
                if not joined:
                    reason += hint
            if reason is not None:
                station.raise_failsafe(now, Failsafe.SIMULATION_LOST, reason)
                break
            if not joined:
                connection.send(join, clock_address)
            continue
        tick = _next_tick(connection, clock_address, inbox)
        if tick is None:
            continue
        joined, waited = True, 0.0
        now = tick.time_us * 1e-6
        if watch.ends(now):
            break
        station.receive_all(inbox, now)
        inbox.clear()
        for datagram, address in station.datagrams_to_send(now):
            connection.send(datagram, address)
        station.sent()
        progress()
        if pace is not None:
            pace.hold(now)
        next_us = next_call_us(station.next_timer(), tick.time_us)
        connection.send(Done(tick.serial, next_us, station.ended).encode(), clock_address)
    if joined:
        connection.send(Done(0, None, leaving=True).encode(), clock_address)


def is_refused(clock_address: Address) -> bool:
    """Return True if it is certain that no world in lockstep can be joined at ``clock_address``: the port is closed.

    The machine answers for a closed port; one that is far away may not.
    """
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.settimeout(_REFUSAL_TIME)
        try:
            probe.connect(clock_address)
            probe.send(Done(0, None, leaving=True).encode())  # changes nothing, and is not answered
            probe.recv(1)
        except OSError as error:
            return not isinstance(error, TimeoutError)
    return False


def _next_tick(
    connection: LockstepConnection, clock_address: Address, inbox: list[tuple[bytes, Address]]
) -> Tick | None:
    """Return the next tick that has come, None: none; put all datagrams before it into ``inbox``."""
    for datagram, sender in connection.receive():
        if sender == clock_address:
            if (tick := decode_tick(datagram)) is not None:
                return tick
        else:
            inbox.append((datagram, sender))
    return None
