"""Real time: the swarm on the machine's monotonic clock, its vehicles on UDP sockets."""

import time
from collections.abc import Callable

from vehicle_sim.app.ending import Ending
from vehicle_sim.app.sockets import SwarmSockets
from vehicle_sim.app.swarm_log import SwarmLog
from vehicle_sim.swarm import Swarm

STRIDE = 0.005  # s of simulated time between looks at the clock when nothing else is due
STRIDE_MAX = 0.02  # s of simulated time at most between looks at the sockets
LAG_RESERVE = 0.06  # s of the set-point loss time, which a lag of the world behind its clock must not reach


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


class RealTimeDriver:
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
        self._swarm = swarm
        self._sockets = sockets
        self._ending = ending
        self._speed = speed
        self._wall = wall
        self._log = SwarmLog(swarm)

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
            for vehicle, datagram, sender in sockets.received():
                swarm.receive(vehicle, datagram, sender, reached)
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

    def _send(self, now: float) -> None:
        self._swarm.advance_to(now)
        self._log.update()
        for vehicle, datagram, address in self._swarm.datagrams_to_send(now):
            self._sockets.send(vehicle, datagram, address)
