"""Where faults act on a swarm: its world, its samples and its datagrams; without faults, all pass as they are.

The kinds of faults take long to import, so this module imports none of them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import reduce
from typing import TYPE_CHECKING, TypeVar

from vehicle_sim.faults.phases import PhaseObserver, VehicleState
from vehicle_sim.world.free_world import FreeWorld
from vehicle_sim.world.range_sensor import RangeSample
from vehicle_sim.world.sensors import Measurement, ReportedState
from vehicle_sim.world.world import World

if TYPE_CHECKING:
    from vehicle_sim.faults.active import ActiveFault
    from vehicle_sim.faults.impairment import Datagram, LinkImpairment, SampleImpairment
    from vehicle_sim.faults.world import Forces, WorldFaults

_Sample = TypeVar("_Sample")


class Disturbances:
    """What a swarm passes its samples, datagrams and world through: faults in the mission's order, here none.

    Vehicles are numbered by their system id, from 1; times in s.
    """

    def __init__(self) -> None:
        self.faults: tuple[ActiveFault, ...] = ()
        self.of_world: WorldFaults | None = None
        """Those that act on the world."""
        self.take_off: float | None = None
        """Time at which the first vehicle lifted off (s); None: not yet."""
        self.phases: PhaseObserver | None = None
        """Observer of the phases in which faults start; None: all of them start after take-off."""
        self._arriving: dict[int, list[LinkImpairment]] = {}
        self._leaving: dict[int, list[LinkImpairment]] = {}
        self._samples: dict[tuple[str, int], list[SampleImpairment]] = {}
        self._clock_errors: dict[int, list[Callable[[float], float]]] = {}

    def took_off(self, time: float) -> None:
        """Start the schedules of the faults that start after take-off: the first vehicle has lifted off."""
        self.take_off = time
        for fault in self.faults:
            if fault.fault.start_phase is None:
                fault.schedule.origin = time

    @property
    def awaits_phase(self) -> bool:
        """Return True if a fault starts in a phase that the flight has not entered."""
        return self.phases is not None and bool(self.phases.pending)

    def observe(self, now: float, vehicles: Sequence[VehicleState], world: World) -> None:
        """Start the schedules of the faults whose phase the flight enters ``now`` (s)."""
        if self.phases is None:
            return
        entered = self.phases.observe(now, vehicles, world.states()[0, :3], standing=world.touching_ground())
        for fault in self.faults:
            if fault.fault.start_key in entered:
                fault.schedule.origin = now

    def disturb(self, world: World | FreeWorld, now: float) -> Forces | None:
        """Set the load, and return the forces of the wind on payload and UAVs; None: no force."""
        return None if self.of_world is None else self.of_world.act(world, now)

    def is_stuck(self, gripper: int, now: float) -> bool:
        """Return whether a gripper that is commanded ``now`` (s) is stuck."""
        return self.of_world is not None and self.of_world.is_stuck(gripper, now)

    # Clocks and samples

    def clock_of(self, vehicle: int) -> Callable[[float], float]:
        """Return what the vehicle's clock, the base of its stamps, shows at a time (s)."""
        if vehicle not in self._clock_errors:
            return float  # without a fault of clocks the time itself
        return lambda now: reduce(lambda shown, error: shown + error(now), self._clock_errors[vehicle], now)

    def disturbs_samples(self, vehicle: int) -> bool:
        """Return True if a fault acts on samples of the vehicle or on those it relays, now or at another time."""
        return any(disturbed == vehicle for _, disturbed in self._samples)

    def own_sample(self, vehicle: int, sample: Measurement) -> Measurement | None:
        """Return what the autopilot gets of the vehicle's own measurement; None: nothing."""
        return self._through("own", vehicle, sample.time, sample)

    def reported_sample(self, vehicle: int, sample: Measurement | None) -> ReportedState:
        """Return what the telemetry reports of the measurement that the autopilot flies by."""
        report = ReportedState(sample, sample)
        return report if sample is None else self._through("reported", vehicle, sample.time, report)

    def payload_sample(self, vehicle: int, sample: Measurement) -> Measurement | None:
        """Return what the vehicle gets to relay of the payload unit's measurement; None: nothing."""
        return self._through("payload", vehicle, sample.time, sample)

    def range_sample(self, vehicle: int, sample: RangeSample) -> RangeSample | None:
        """Return what the vehicle gets to report of a scan; None: nothing."""
        return self._through("scan", vehicle, sample.time, sample)

    def _through(self, hook: str, vehicle: int, time: float, sample: _Sample) -> _Sample:
        """Return what the methods ``hook`` of the faults leave of a sample of ``time`` (s)."""
        for impairment in self._samples.get((hook, vehicle), ()):
            moment = impairment.fault.schedule.at(time)
            if moment is not None and sample is not None:
                before, sample = sample, getattr(impairment, hook)(vehicle, sample, moment)
                impairment.fault.seen += 1
                impairment.fault.disturbed += sample is not before
        return sample

    # Datagrams

    def to_vehicle(self, vehicle: int, arriving: Sequence[Datagram], now: float) -> Sequence[Datagram]:
        """Return the datagrams that reach the vehicle now, of those ``arriving`` and of earlier ones."""
        for impairment in self._arriving.get(vehicle, ()):
            arriving = impairment.pass_on(arriving, now)
        return arriving

    def from_vehicle(self, vehicle: int, leaving: Sequence[Datagram], now: float) -> Sequence[Datagram]:
        """Return the datagrams that go on to the ground now, of those ``leaving`` and of earlier ones."""
        for impairment in self._leaving.get(vehicle, ()):
            leaving = impairment.pass_on(leaving, now)
        return leaving

    def next_timer(self) -> float | None:
        """Return when the next delayed datagram is due."""
        directions = (*self._arriving.values(), *self._leaving.values())
        timers = (impairment.next_timer() for direction in directions for impairment in direction)
        return min((timer for timer in timers if timer is not None), default=None)
