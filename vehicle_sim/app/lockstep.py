"""Lockstep: the swarm and one ground station share a virtual clock; see :mod:`gcs.mavlink.lockstep`."""

import math
import time
from collections.abc import Iterator

from gcs.mavlink.address import Address
from gcs.mavlink.lockstep import Done, LockstepTime, Tick, decode_done
from gcs.mavlink.udp import arrived
from vehicle_sim.app.ending import Ending
from vehicle_sim.app.sockets import SwarmSockets
from vehicle_sim.app.swarm_log import LOG, SwarmLog
from vehicle_sim.swarm import Swarm

ANSWER_TIME = 5.0  # s of wall time for the ground to answer a tick


class LockstepDriver:
    """Runs a swarm for one ground after the other; time stops while there is none.

    A ground that leaves, or does not answer, leaves vehicles in the air: time then runs on without it, as fast as it
    can, until they have landed.
    """

    def __init__(self, swarm: Swarm, sockets: SwarmSockets, ending: Ending, answer_time: float = ANSWER_TIME) -> None:
        """``sockets`` with a clock socket; ``answer_time`` in s of wall time."""
        if sockets.clock is None:
            raise ValueError("lockstep needs a clock socket")
        self._swarm = swarm
        self._sockets = sockets
        self._clock = sockets.clock
        self._ending = ending
        self._answer_time = answer_time
        self._time = LockstepTime(swarm.time)
        self._serial = 0
        self._joining: Address | None = None
        self._log = SwarmLog(swarm)

    def run(self) -> None:
        """Run until the end is requested, or when the parent has ended and the vehicles have landed.

        With a parent there is no second ground: it ends after the first.
        """
        ending = self._ending
        while not ending.requested:
            ground = self._wait_for_ground()
            if ground is None:
                return
            self._serve(ground)
            LOG.info("%.2f s: the ground station has left", self._swarm.time)
            self._let_land()
            if ending.has_parent:
                return

    def _wait_for_ground(self) -> Address | None:
        """Return the ground of the latest join request; None when the end came first."""
        ending = self._ending
        while not ending.requested and not ending.parent_gone:
            for _ in self._from_ground(None):
                pass
            if self._joining is not None:
                ground, self._joining = self._joining, None
                LOG.info("%.2f s: ground station at %s:%d joins", self._swarm.time, *ground)
                return ground
            ending.wait([self._clock], None)
        return None

    def _from_ground(self, ground: Address | None) -> Iterator[Done]:
        """Yield what ``ground`` answers to ticks; the join request of another ground is kept for later."""
        for datagram, sender in arrived(self._clock):
            done = decode_done(datagram)
            if done is None:
                continue
            if sender == ground:
                yield done
            elif done.leaving:
                self._joining = None if sender == self._joining else self._joining
            elif done.serial == 0:
                self._joining = sender

    def _serve(self, ground: Address) -> None:
        """Tick until the ground leaves, does not answer for too long, or the end comes."""
        while True:
            self._send()
            # Serial 0 is the ground's join request.
            self._serial = self._serial % 0xFFFFFFFF + 1
            self._tick(ground)
            done = self._answer(ground)
            self._receive()
            if done is None or done.leaving:
                return
            self._time.advance(self._swarm.next_timer(), done.next_us)

    def _tick(self, ground: Address) -> None:
        """Send the time to ``ground``. A tick that cannot be sent has no answer."""
        try:
            self._clock.sendto(Tick(self._serial, self._time.us).encode(), ground)
        except OSError:
            return

    def _answer(self, ground: Address) -> Done | None:
        """Return the ground's answer to the last tick; None when there is none in time, or the end comes.

        The ground that started this process has all the time it needs: its end is noticed at once.
        """
        ending = self._ending
        answer_time = math.inf if ending.has_parent else self._answer_time
        deadline = time.monotonic() + answer_time
        left = answer_time
        while left > 0.0 and not ending.requested and not ending.parent_gone:
            ending.wait([self._clock], min(left, self._answer_time))
            for done in self._from_ground(ground):
                if done.serial == self._serial or done.leaving:
                    return done
            left = deadline - time.monotonic()
        return None

    def _let_land(self) -> None:
        """Time runs freely until the vehicles have landed and disarmed."""
        give_up = self._time.us + round(self._swarm.failsafe.landing_timeout * 1e6)
        while not self._swarm.at_rest and self._time.us < give_up and not self._ending.requested:
            self._time.run_free(self._swarm.next_timer())
            self._send()
            self._receive()
        self._ending.look()

    def _send(self) -> None:
        now = self._time.world
        self._swarm.advance_to(now)
        self._log.update()
        for vehicle, datagram, address in self._swarm.datagrams_to_send(now):
            self._sockets.send(vehicle, datagram, address)

    def _receive(self) -> None:
        now = self._time.world
        for vehicle, datagram, sender in self._sockets.received():
            self._swarm.receive(vehicle, datagram, sender, now)
