"""A wall clock for programs that wait for sockets: time passes only while every one of them waits."""

import contextlib
import select
import threading

from gcs.drivers.realtime import run_in_real_time
from vehicle_sim.app.drivers import RealTimeDriver
from vehicle_sim.app.ending import Ending
from vehicle_sim.app.swarm_sockets import SwarmSockets
from vehicle_sim.swarm import Swarm
from vehicle_sim.world.truth_log import TruthLog

GROUND, WORLD = "ground", "world"


class VirtualTime:
    """Lets threads run one at a time, in an order that depends on nothing but what they do.

    A thread that waits is woken when one of its sockets can be read, or when its time has come and nobody's comes
    earlier. ``stalls``: [who, from (s), duration (s)], during which a busy machine does not let ``who`` run.
    """

    def __init__(self, parties, stalls=()):
        self.now = 0.0
        self._turn = threading.Condition()
        self._waiting = dict.fromkeys(parties, ((), 0.0))  # who -> (sockets, when it wakes)
        self._running = None
        self._stalls = stalls

    def read(self):
        return self.now

    def begin(self, who):
        """First words of a thread: returns when it may run."""
        with self._turn:
            self._wait_for_turn(who)

    def wait(self, who, sockets, timeout):
        """Like ``select`` for reading."""
        with self._turn:
            self._waiting[who] = (tuple(sockets), self.now + timeout)
            self._pass_on()
            self._wait_for_turn(who)

    def leave(self, who):
        """Last words of a thread."""
        with self._turn:
            self._waiting.pop(who, None)
            self._pass_on()

    def _wait_for_turn(self, who):
        if self._running is None:
            self._pass_on()
        self._turn.wait_for(lambda: self._running == who)
        self._waiting.pop(who)

    def _pass_on(self):
        times = {who: self._wakes(who) for who in self._waiting}
        self._running = min(times, key=times.get, default=None)
        if self._running is not None:
            self.now = max(self.now, times[self._running])
        self._turn.notify_all()

    def _wakes(self, who):
        sockets, at = self._waiting[who]
        if sockets and select.select(sockets, (), (), 0.0)[0]:
            at = self.now
        for stalled, start, duration in self._stalls:
            if stalled == who and start <= max(at, self.now) < start + duration:
                at = start + duration
        return at


@contextlib.contextmanager
def swarm_in_real_time(time, mission, folder, ground_address=None):
    """The party ``WORLD``: a swarm with its driver of real time, in a thread; the addresses of its vehicles."""

    class WorldsEnd(Ending):
        def wait(self, sockets, timeout):
            time.wait(WORLD, sockets, timeout)

    ending, number = WorldsEnd(), mission.system.team.vehicles
    with (
        SwarmSockets("127.0.0.1", 0, number, with_clock=False) as sockets,
        Swarm(mission.system, seed=mission.seed, ground_address=ground_address) as swarm,
    ):
        swarm.record(TruthLog(folder, number))
        driver = RealTimeDriver(swarm, sockets, ending, wall=time.read)

        def run():
            time.begin(WORLD)
            try:
                driver.run()
            finally:
                time.leave(WORLD)

        thread = threading.Thread(target=run)
        thread.start()
        try:
            yield [socket.getsockname() for socket in sockets.vehicles]
        finally:
            ending.request()
            thread.join()


def run_ground(time, station, connection, *arguments, **options):
    """The party ``GROUND``, whose ``connection`` waits in ``time``: run it in real time to its end."""
    time.begin(GROUND)
    try:
        run_in_real_time(station, connection, *arguments, **options, clock=time.read)
    finally:
        time.leave(GROUND)
