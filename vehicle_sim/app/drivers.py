"""The two drivers of a swarm, whose vehicles are on UDP sockets.

Real time: on the machine's monotonic clock. Lockstep: the swarm and one ground station share a virtual clock, see
:mod:`gcs.mavlink.lockstep`.
"""

import logging
import math
import time
from collections.abc import Callable, Iterator

from gcs.mavlink import px4
from gcs.mavlink.address import Address
from gcs.mavlink.lockstep import Done, LockstepTime, Tick, decode_done
from gcs.mavlink.udp import arrived
from vehicle_sim.app.ending import Ending
from vehicle_sim.app.swarm_sockets import SwarmSockets
from vehicle_sim.swarm import Swarm

LOG = logging.getLogger("vehicle_sim")

STRIDE = 0.005  # s of simulated time between looks at the clock when nothing else is due
STRIDE_MAX = 0.02  # s of simulated time at most between looks at the sockets
LAG_RESERVE = 0.06  # s of the set-point loss time, which a lag of the world behind its clock must not reach


class _Driver:
    """Hands on what the vehicles send and receive, and logs their modes and failsafes as they change."""

    def __init__(self, swarm: Swarm, sockets: SwarmSockets, ending: Ending) -> None:
        self._swarm, self._sockets, self._ending = swarm, sockets, ending
        self._changes = [-1 for _ in swarm.vehicles]

    def _send(self, now: float) -> None:
        self._swarm.advance_to(now)
        for i, vehicle in enumerate(self._swarm.vehicles):
            autopilot = vehicle.autopilot
            if autopilot.changes == self._changes[i]:
                continue
            self._changes[i] = autopilot.changes
            mode, armed = px4.mode_name(autopilot.mode), "armed" if autopilot.armed else "disarmed"
            level = logging.WARNING if autopilot.failsafe else logging.INFO
            state = "failsafe, " if autopilot.failsafe else ""
            LOG.log(level, "%.2f s: vehicle %d: %s%s, %s", self._swarm.time, vehicle.system_id, state, mode, armed)
        for number, datagram, address in self._swarm.datagrams_to_send(now):
            self._sockets.send(number, datagram, address)

    def _receive(self, now: float) -> None:
        for vehicle, datagram, sender in self._sockets.received():
            self._swarm.receive(vehicle, datagram, sender, now)


class RealTimeClock:
    """Simulated time that follows a wall clock at a ratio, and is set back when it cannot be followed."""

    def __init__(self, start: float, speed: float, lag_max: float, wall: Callable[[], float] = time.monotonic) -> None:
        """``start`` in simulated s; ``speed`` simulated over wall time; beyond ``lag_max`` (s) it is set back."""
        self._lag_max = lag_max * max(1.0, speed)
        self._wall = wall
        self._speed = speed
        self._origin = start
        self._wall_origin = wall()

    def now(self) -> float:
        """Simulated time (s)."""
        return self._origin + (self._wall() - self._wall_origin) * self._speed

    def follow(self, reached: float) -> float:
        """Simulated time (s), which is set back if the world, at ``reached``, is too far behind to catch up.

        After a stall (a busy machine, a laptop asleep) time goes on from where it was, not with a rush.
        """
        now = self.now()
        if now - reached > self._lag_max:
            self._origin -= now - reached - self._lag_max
            now = reached + self._lag_max
        return now

    def wall_until(self, then: float) -> float:
        """Return the wall time (s) until ``then``, not less than 0."""
        return max(0.0, (then - self.now()) / self._speed)


class RealTimeDriver(_Driver):
    """Runs a swarm until the end is requested."""

    def __init__(
        self,
        swarm: Swarm,
        sockets: SwarmSockets,
        ending: Ending,
        speed: float = 1.0,
        wall: Callable[[], float] = time.monotonic,
    ) -> None:
        """``speed``: simulated over wall time, positive; ``wall``: a clock (s) that never goes back."""
        super().__init__(swarm, sockets, ending)
        self._speed, self._wall = speed, wall

    def run(self) -> None:
        """Run until the end is requested, or when the parent has ended and the vehicles have landed."""
        swarm, sockets, ending = self._swarm, self._sockets, self._ending
        reached = swarm.time
        clock = RealTimeClock(reached, self._speed, swarm.failsafe.telemetry_timeout - LAG_RESERVE, self._wall)
        give_up: float | None = None
        while not ending.requested:
            goal = min(clock.follow(reached), reached + STRIDE_MAX)
            # What is due within the interval is sent when it is due, so that it carries what is measured then.
            while (due := self._next_due(reached)) <= goal and not ending.requested:
                reached = due
                self._send(reached)
            reached = max(reached, goal)
            swarm.advance_to(reached)
            self._receive(reached)
            self._send(reached)
            if ending.parent_gone:
                give_up = reached + swarm.failsafe.landing_timeout if give_up is None else give_up
                if swarm.at_rest or reached >= give_up:
                    return
            wake = min(reached + STRIDE, self._next_due(reached))
            ending.wait(sockets.vehicles, clock.wall_until(wake))

    def _next_due(self, now: float) -> float:
        timer = self._swarm.next_timer()
        return float("inf") if timer is None else max(timer, now)


ANSWER_TIME = 5.0  # s of wall time for the ground to answer a tick


class LockstepDriver(_Driver):
    """Runs a swarm for one ground after the other; time stops while there is none.

    A ground that leaves, or does not answer, leaves vehicles in the air: time then runs on without it, as fast as it
    can, until they have landed.
    """

    def __init__(self, swarm: Swarm, sockets: SwarmSockets, ending: Ending, answer_time: float = ANSWER_TIME) -> None:
        """``sockets`` with a clock socket; ``answer_time`` in s of wall time."""
        if sockets.clock is None:
            raise ValueError("lockstep needs a clock socket")
        super().__init__(swarm, sockets, ending)
        self._clock, self._answer_time = sockets.clock, answer_time
        self._time = LockstepTime(swarm.time)
        self._serial = 0
        self._joining: Address | None = None

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
            self._send(self._time.world)
            # Serial 0 is the ground's join request.
            self._serial = self._serial % 0xFFFFFFFF + 1
            self._tick(ground)
            done = self._answer(ground)
            self._receive(self._time.world)
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
            self._send(self._time.world)
            self._receive(self._time.world)
        self._ending.look()
