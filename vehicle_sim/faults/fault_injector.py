"""The faults of a flight: every sample and datagram goes through them in the mission's order."""

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from gcs.config import SystemConfig
from gcs.mission.model import Fault
from gcs.record.faults import FAULTS_FILE
from gcs.record.incomplete import IncompleteRecords
from gcs.record.run_folder import UnwritableFile, write_json
from vehicle_sim.faults import link, sensors, timing, values  # noqa: F401 -- each has impairments of its kinds
from vehicle_sim.faults.active import ActiveFault
from vehicle_sim.faults.disturbances import Datagram, Disturbances, Forces
from vehicle_sim.faults.impairment import OWN, PAYLOAD, REPORTED, SCAN, Impairment, LinkImpairment, SampleImpairment
from vehicle_sim.faults.world import WorldFaults
from vehicle_sim.world.range_sensor import RangeSample
from vehicle_sim.world.sensors import Measurement, ReportedState
from vehicle_sim.world.world import World

_TO_VEHICLE, _FROM_VEHICLE = 1, 2
_Sample = TypeVar("_Sample")


class FaultInjector(Disturbances):
    """Faults of one flight, each active from its start (s after the first vehicle lifts off) on.

    They act between the vehicles and their sensors, between the vehicles and the wire, and on the world.

    Equal seeds and faults disturb equal samples and datagrams equally; the random numbers of each fault, vehicle and
    direction are its own, so that one fault more or less does not change what the others do.
    """

    def __init__(self, faults: Sequence[Fault] = (), seed: int = 1, system: SystemConfig = SystemConfig()) -> None:
        """Raises :class:`gcs.errors.UnusableInput` for a fault that no mission could name."""
        team = system.team.vehicles
        self.faults = tuple(ActiveFault.of(i, fault, seed, team) for i, fault in enumerate(faults, start=1))
        self._arriving: dict[int, list[LinkImpairment]] = {}
        self._leaving: dict[int, list[LinkImpairment]] = {}
        self._samples: dict[tuple[str, int], list[SampleImpairment]] = {}
        self._clocks: dict[int, list[ActiveFault]] = {}
        for fault in self.faults:
            kind = type(fault.settings)
            if kind in timing.CLOCKS:
                for vehicle in fault.vehicles:
                    self._clocks.setdefault(vehicle, []).append(fault)
                continue
            impairment = next((cls for of, cls in Impairment.of_kind.items() if issubclass(kind, of)), None)
            if impairment is not None and issubclass(impairment, LinkImpairment):
                self._impair_link(fault, impairment)
            elif impairment is not None and issubclass(impairment, SampleImpairment):
                for vehicle, of_vehicle in impairment.of_vehicles(fault, system).items():
                    for hook in of_vehicle.acts_on:
                        self._samples.setdefault((hook, vehicle), []).append(of_vehicle)
        world = [fault for fault in self.faults if fault.kind.family == "world"]
        self.any_of_world = bool(world)
        self._world = WorldFaults(world, system.world.air)
        directions = (*self._arriving.values(), *self._leaving.values())
        self._link_impairments = [impairment for direction in directions for impairment in direction]

    def _impair_link(self, fault: ActiveFault, impairment: type[LinkImpairment]) -> None:
        direction = impairment.direction or fault.direction
        for vehicle in fault.vehicles:
            if direction in ("command", "both"):
                self._arriving.setdefault(vehicle, []).append(impairment(fault, fault.generator(vehicle, _TO_VEHICLE)))
            if direction in ("telemetry", "both"):
                self._leaving.setdefault(vehicle, []).append(impairment(fault, fault.generator(vehicle, _FROM_VEHICLE)))

    def took_off(self, time: float) -> None:
        """Start the schedules of all faults: the first vehicle has lifted off."""
        for fault in self.faults:
            fault.schedule.take_off = time

    # The world

    def disturb(self, world: World, now: float) -> Forces | None:
        """Set the load, and return the forces of the wind on payload and UAVs; None: no force."""
        return self._world.act(world, now)

    # Clocks and samples

    def clock_of(self, vehicle: int) -> Callable[[float], float]:
        """Return what the vehicle's clock shows at a time (s): without a fault of clocks the time itself."""
        return partial(self.clock, vehicle) if vehicle in self._clocks else float

    def clock(self, vehicle: int, now: float) -> float:
        """Return the time of the vehicle's clock, the base of its stamps."""
        faults = self._clocks.get(vehicle)
        if not faults:
            return now
        shown = now
        for fault in faults:
            error = timing.clock_error(fault, now)
            fault.seen += 1
            fault.disturbed += error != 0.0
            shown += error
        return shown

    def disturbs_samples(self, vehicle: int) -> bool:
        """Return True if a fault acts on samples of the vehicle or on those it relays, now or at another time."""
        return any(disturbed == vehicle for _, disturbed in self._samples)

    def own_sample(self, vehicle: int, sample: Measurement) -> Measurement | None:
        """Return what the autopilot gets of the vehicle's own measurement; None: nothing."""
        return self._through(OWN, vehicle, sample.time, sample)

    def reported_sample(self, vehicle: int, sample: Measurement | None) -> ReportedState:
        """Return what the telemetry reports of the measurement that the autopilot flies by."""
        report = ReportedState(sample, sample)
        return report if sample is None else self._through(REPORTED, vehicle, sample.time, report)

    def payload_sample(self, vehicle: int, sample: Measurement) -> Measurement | None:
        """Return what the vehicle gets to relay of the payload unit's measurement; None: nothing."""
        return self._through(PAYLOAD, vehicle, sample.time, sample)

    def range_sample(self, vehicle: int, sample: RangeSample) -> RangeSample | None:
        """Return what the vehicle gets to report of a scan; None: nothing."""
        return self._through(SCAN, vehicle, sample.time, sample)

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
        due = [timer for impairment in self._link_impairments if (timer := impairment.next_timer()) is not None]
        return min(due, default=None)


_LISTED = 1000  # occurrences that are listed


def record_faults(folder: Path, injector: FaultInjector, end: float, incomplete: IncompleteRecords) -> None:
    """Write the file; ``end`` of the flight in s. It is added to what is ``incomplete`` if it cannot be written."""
    try:
        write_json(folder / FAULTS_FILE, faults_record(injector, end))
    except UnwritableFile as error:
        incomplete.add(folder / FAULTS_FILE, error.cause)


def faults_record(injector: FaultInjector, end: float) -> dict[str, Any]:
    """Return the content of the file."""
    take_off = injector.faults[0].schedule.take_off if injector.faults else None
    return {
        "take_off_s": take_off,
        "end_s": end,
        "faults": [
            {
                "number": fault.number,
                "kind": fault.fault.kind,
                "line": fault.fault.line,
                "start": fault.fault.start,
                "vehicles": list(fault.vehicles) if fault.kind.of_vehicles else None,
                "direction": fault.direction,
                "occurrences": (happened := fault.schedule.occurrences(end, _LISTED))[0],
                "activations": happened[1],
                "seen": fault.seen,
                "disturbed": fault.disturbed,
            }
            for fault in injector.faults
        ],
    }
