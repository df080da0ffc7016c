"""The faults of a flight: every sample and datagram goes through them in the mission's order."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from gcs.config import SystemConfig
from gcs.errors import UnusableInput
from gcs.mission.model import Fault, Mission
from gcs.record.faults import FAULTS_FILE
from gcs.record.incomplete import IncompleteRecords
from gcs.record.run_folder import UnwritableFile, write_json
from vehicle_sim.faults import link, sensors, timing, values  # noqa: F401 -- each has impairments of its kinds
from vehicle_sim.faults.active import ActiveFault
from vehicle_sim.faults.disturbances import Disturbances
from vehicle_sim.faults.impairment import Impairment, LinkImpairment, SampleImpairment
from vehicle_sim.faults.phases import PhaseObserver
from vehicle_sim.faults.world import WorldFaults

_TO_VEHICLE, _FROM_VEHICLE = 1, 2


class FaultInjector(Disturbances):
    """Faults of one flight, each active from its start (s after the first vehicle lifts off, or after a phase) on.

    They act between the vehicles and their sensors, between the vehicles and the wire, and on the world.

    Equal seeds and faults disturb equal samples and datagrams equally; the random numbers of each fault, vehicle and
    direction are its own, so that one fault more or less does not change what the others do.
    """

    def __init__(
        self,
        faults: Sequence[Fault] = (),
        seed: int = 1,
        system: SystemConfig = SystemConfig(),
        mission: Mission | None = None,
    ) -> None:
        """``mission``: that which is flown, needed by faults that start in a phase of it.

        Raises :class:`gcs.errors.UnusableInput` for a fault that no mission could name.
        """
        super().__init__()
        if phases := {key for fault in faults if (key := fault.start_key) is not None}:
            if mission is None:
                raise UnusableInput("faults that start in a phase need the mission that is flown")
            self.phases = PhaseObserver(mission, phases)
        team = system.team.vehicles
        self.faults = tuple(ActiveFault.of(i, fault, seed, team) for i, fault in enumerate(faults, start=1))
        for fault in self.faults:
            kind = type(fault.settings)
            if kind in timing.CLOCKS:
                for vehicle in fault.vehicles:
                    self._clock_errors.setdefault(vehicle, []).append(partial(timing.clock_error, fault))
                continue
            impairment = next((cls for of, cls in Impairment.of_kind.items() if issubclass(kind, of)), None)
            if impairment is not None and issubclass(impairment, LinkImpairment):
                self._impair_link(fault, impairment)
            elif impairment is not None and issubclass(impairment, SampleImpairment):
                for vehicle, of_vehicle in impairment.of_vehicles(fault, system).items():
                    for hook in of_vehicle.acts_on:
                        self._samples.setdefault((hook, vehicle), []).append(of_vehicle)
        if world := [fault for fault in self.faults if fault.kind.family == "world"]:
            self.of_world = WorldFaults(world, system.world.air)

    def _impair_link(self, fault: ActiveFault, impairment: type[LinkImpairment]) -> None:
        direction = impairment.direction or fault.direction
        for vehicle in fault.vehicles:
            if direction in ("command", "both"):
                self._arriving.setdefault(vehicle, []).append(impairment(fault, fault.generator(vehicle, _TO_VEHICLE)))
            if direction in ("telemetry", "both"):
                self._leaving.setdefault(vehicle, []).append(impairment(fault, fault.generator(vehicle, _FROM_VEHICLE)))


_LISTED = 1000  # occurrences that are listed


def record_faults(folder: Path, injector: FaultInjector, end: float, incomplete: IncompleteRecords) -> None:
    """Write the file; ``end`` of the flight in s. It is added to what is ``incomplete`` if it cannot be written."""
    try:
        write_json(folder / FAULTS_FILE, faults_record(injector, end))
    except UnwritableFile as error:
        incomplete.add(folder / FAULTS_FILE, error.cause)


def faults_record(injector: FaultInjector, end: float) -> dict[str, Any]:
    """Return the content of the file."""
    take_off = injector.take_off
    return {
        "take_off_s": take_off,
        "end_s": end,
        "phases_s": injector.phases.entered if injector.phases is not None else {},
        "faults": [
            {
                "number": fault.number,
                "kind": fault.fault.kind,
                "line": fault.fault.line,
                "start": fault.schedule.start,
                "start_phase": fault.fault.start_key,
                "vehicles": list(fault.vehicles) if fault.kind.of_vehicles else None,
                "direction": fault.direction,
                "occurrences": (happened := fault.schedule.occurrences(end, _LISTED))[0],
                "activations": [_since(take_off or 0.0, fault, *times) for times in happened[1]],
                "seen": fault.seen,
                "disturbed": fault.disturbed,
            }
            for fault in injector.faults
        ],
    }


def _since(take_off: float, fault: ActiveFault, begin: float, end: float | None) -> tuple[float, float | None]:
    """Return begin and end of an activation (s after the fault's origin) in s after ``take_off`` (s)."""
    if fault.fault.start_phase is None or fault.schedule.origin is None:
        return begin, end
    earlier = fault.schedule.origin - take_off
    return begin + earlier, None if end is None else end + earlier
