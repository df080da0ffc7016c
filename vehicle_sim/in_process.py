"""The simulated world as :mod:`gcs` flies it in its own process: the entry point ``pybullet`` of ``cooplift.world``."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from gcs.drivers.in_process import GROUND
from gcs.errors import UnusableInput
from gcs.mavlink.address import THIS_MACHINE, VEHICLE_PORT, Address
from gcs.mission.model import Mission
from gcs.record.incomplete import Incomplete, IncompleteRecords
from vehicle_sim.world.engine_messages import greeting_of_engine_dropped

with greeting_of_engine_dropped():
    from vehicle_sim.swarm import Swarm
from vehicle_sim.world.errors import SimulationError
from vehicle_sim.world.truth_log import TruthLog

if TYPE_CHECKING:
    from vehicle_sim.faults.fault_injector import FaultInjector


class InProcessWorld:
    """A swarm without sockets, for :class:`gcs.drivers.in_process.InProcessLockstep`; records the truth in a folder."""

    def __init__(self, swarm: Swarm, run_dir: Path) -> None:
        """Take over a ``swarm``, which is closed with it. Raises :class:`UnusableInput` for an unwritable folder."""
        self.swarm = swarm
        self._truth = TruthLog(run_dir, len(swarm.vehicles))
        swarm.record(self._truth)
        self._closing = ExitStack()
        self._closing.callback(swarm.close)
        self._faults_record = IncompleteRecords()

    @property
    def addresses(self) -> list[Address]:
        """Addresses of the vehicles of the system ids 1 .. N, in this order."""
        return [_address(vehicle.system_id) for vehicle in self.swarm.vehicles]

    @property
    def time(self) -> float:
        """Time of the last physics step (s)."""
        return self.swarm.time

    @property
    def at_rest(self) -> bool:
        """True if all vehicles are disarmed, their rotors have run down, and nothing moves any more."""
        return self.swarm.at_rest

    @property
    def landing_timeout(self) -> float:
        """Time (s) after which vehicles without a ground are not waited for."""
        return self.swarm.failsafe.landing_timeout

    @property
    def incomplete(self) -> Sequence[Incomplete]:
        """Records that could not be written in full; known when it is closed."""
        return [*self._truth.incomplete.found, *self._faults_record.found]

    def advance_to(self, now: float) -> None:
        """Let the world go on to ``now`` (s)."""
        self.swarm.advance_to(now)

    def datagrams_to_send(self, now: float) -> list[tuple[bytes, Address]]:
        """Return what the vehicles send to the ground station at ``now`` (s), each with the vehicle's address."""
        return [(datagram, _address(i)) for i, datagram, to in self.swarm.datagrams_to_send(now) if to == GROUND]

    def receive(self, datagrams: Sequence[tuple[bytes, Address]], now: float) -> None:
        """Take what the ground station sends at ``now`` (s), each with the address of the vehicle that it is for."""
        for datagram, (_, port) in datagrams:
            self.swarm.receive(port - VEHICLE_PORT + 1, datagram, GROUND, now)

    def next_timer(self) -> float | None:
        """Return when :meth:`datagrams_to_send` has something to do next (s); None: never."""
        return self.swarm.next_timer()

    def record_faults(self, injector: FaultInjector, run_dir: Path) -> None:
        """Record at the end what the faults have affected."""
        from vehicle_sim.faults.fault_injector import record_faults

        self._closing.callback(lambda: record_faults(run_dir, injector, self.swarm.time, self._faults_record))

    def close(self) -> None:
        """End the world and its records; harmless when that is done."""
        self._closing.close()


def world(mission: Mission, run_dir: Path) -> InProcessWorld:
    """Open the world of ``mission``: its system, seed, home, obstacles and faults.

    ``truth.csv``, ``modes.csv``, ``obstacles.csv`` and ``faults.json`` are written to ``run_dir``. Raises
    :class:`gcs.errors.UnusableInput` for a world that cannot be simulated, and for an unwritable folder.
    """
    injector = None
    if mission.faults:
        # The kinds take long to import, spent only where there are faults.
        from vehicle_sim.faults.fault_injector import FaultInjector

        injector = FaultInjector(mission.faults, mission.seed, mission.system, mission)
    try:
        swarm = Swarm(
            mission.system, seed=mission.seed, home=mission.home, obstacles=mission.obstacles, faults=injector
        )
    except SimulationError as error:
        raise UnusableInput(str(error)) from error
    with ExitStack() as opened:
        opened.callback(swarm.close)
        found = InProcessWorld(swarm, run_dir)
        opened.pop_all()
    if injector is not None:
        found.record_faults(injector, run_dir)
    return found


def _address(system_id: int) -> Address:
    return THIS_MACHINE, VEHICLE_PORT + system_id - 1
