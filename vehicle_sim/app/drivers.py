"""The two drivers of a swarm, whose vehicles are on UDP sockets.

Real time: on the machine's monotonic clock. Lockstep: the swarm and one ground station share a virtual clock, see
:mod:`gcs.mavlink.lockstep`.
"""

import contextlib
import logging
import math
import select
import socket
import time
from collections.abc import Callable, Iterator

from gcs.mavlink import px4
from gcs.mavlink.address import Address
from gcs.mavlink.lockstep import Done, LockstepTime, Tick, decode_done
from gcs.mavlink.udp import DATAGRAM_MAX, RECEIVE_BUFFER, arrived
from vehicle_sim.app.ending import Ending
from vehicle_sim.swarm import Swarm
from vehicle_sim.world.errors import SimulationError

TURNS = 256
"""Datagrams that are read of one port at once: of a flood of 20,000/s what comes in 13 ms."""


class SwarmSockets(contextlib.ExitStack):
    """Opens all sockets or, with a :class:`SimulationError`, none.

    Vehicle i listens on ``base_port + i - 1``, the clock on ``base_port - 1``; with ``base_port`` 0 each takes
    whatever port is free.
    """

    def __init__(self, host: str, base_port: int, vehicles: int, with_clock: bool) -> None:
        """``host`` is a name or an IPv4 address of this machine."""
        first = base_port - 1 if with_clock else base_port
        if base_port and not (first > 0 and base_port + vehicles - 1 <= 65535):
            last = base_port + vehicles - 1
            raise SimulationError(
                f"--base-port {base_port}: needs the ports {first} .. {last}, and there are 1 .. 65535"
            )
        super().__init__()
        with contextlib.ExitStack() as opened:
            self.clock = opened.enter_context(_bound(host, base_port and base_port - 1)) if with_clock else None
            self.vehicles = [opened.enter_context(_bound(host, base_port and base_port + i)) for i in range(vehicles)]
            self.push(opened.pop_all())
        self._poll = select.poll()
        self._endpoint_at = {endpoint.fileno(): (i, endpoint) for i, endpoint in enumerate(self.vehicles, start=1)}
        for number in self._endpoint_at:
            self._poll.register(number, select.POLLIN)

    def send(self, vehicle: int, datagram: bytes, address: Address) -> None:
        """Send from the endpoint of a vehicle (its system id). What cannot be sent is lost, as may be over UDP."""
        try:
            self.vehicles[vehicle - 1].sendto(datagram, address)
        except OSError:
            return

    def received(self) -> Iterator[tuple[int, bytes, Address]]:
        """Yield all that has arrived: the vehicle's system id, bytes, sender; each vehicle's in order.

        In turns, one of every vehicle that has any: to look at all at once costs less than to find each one empty.
        No more than TURNS turns: a sender that is faster must not keep the reader from all else.
        """
        for _ in range(TURNS):
            ready = self._poll.poll(0)
            if not ready:
                return
            # In the order in which they were registered, which is the vehicles'.
            for number, _ in ready:
                vehicle, endpoint = self._endpoint_at[number]
                try:
                    datagram, sender = endpoint.recvfrom(DATAGRAM_MAX)
                except OSError:  # the echo of a datagram to a closed port: no datagram of anybody
                    continue
                yield vehicle, datagram, sender


def url(endpoint: socket.socket) -> str:
    """Return the address at which the socket listens."""
    host, port = endpoint.getsockname()
    return f"udp://{host}:{port}"


def _bound(host: str, port: int) -> socket.socket:
    endpoint = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        endpoint.setblocking(False)
        endpoint.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER)
        # No address is shared: two swarms on one port would each get a part of what is sent.
        endpoint.bind((host, port))
    except OSError as error:
        endpoint.close()
        raise SimulationError(f"cannot listen on udp://{host}:{port}: {error.strerror or error}") from None
    return endpoint


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
