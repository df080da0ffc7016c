"""The passage of a flight with faults: every sample and datagram goes through them in the mission's order."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from gcs.config import SystemConfig
from gcs.faults import timing as timing_kinds
from gcs.mission import Fault
from vehicle_sim.faults import link, timing
from vehicle_sim.faults.active import ActiveFault
from vehicle_sim.faults.impairment import Stage
from vehicle_sim.faults.interface import Datagram, Forces, Passage
from vehicle_sim.faults.samples import OWN, PAYLOAD, SCAN, TOLD, SampleStage, StaleStamps, value_stages
from vehicle_sim.faults.sensors import sensor_stage
from vehicle_sim.faults.world import WorldFaults
from vehicle_sim.world.range_sensor import RangeSample
from vehicle_sim.world.sensors import Measurement, Told
from vehicle_sim.world.world import World

_TO_VEHICLE, _FROM_VEHICLE = 1, 2
_STAGES = {**link.STAGES, **timing.STAGES}


class FaultPassage(Passage):
    """Faults of one flight, each there from its start (s after the first vehicle lifts off) on.

    Equal seeds and faults disturb equal samples and datagrams equally; the random numbers of each fault, vehicle and
    direction are its own, so that one fault more or less does not change what the others do.
    """

    def __init__(self, faults: Sequence[Fault], seed: int, system: SystemConfig) -> None:
        """Raises :class:`gcs.errors.UnusableInput` for a fault that no mission could name."""
        team = system.team.vehicles
        self.faults = tuple(ActiveFault.of(i, fault, seed, team) for i, fault in enumerate(faults, start=1))
        self._arriving: dict[int, list[Stage]] = {}
        self._leaving: dict[int, list[Stage]] = {}
        self._samples: dict[tuple[str, int], list[SampleStage]] = {}
        self._clocks: dict[int, list[ActiveFault]] = {}
        for fault in self.faults:
            if isinstance(fault.settings, timing.CLOCKS):
                for vehicle in fault.vehicles:
                    self._clocks.setdefault(vehicle, []).append(fault)
            elif stage := _STAGES.get(type(fault.settings)):
                self._add_stages(fault, stage)
            elif fault.kind.family != "world":
                for vehicle, each in _sample_stages(fault, system):
                    for hook in each.acts_on:
                        self._samples.setdefault((hook, vehicle), []).append(each)
        world = [fault for fault in self.faults if fault.kind.family == "world"]
        self._world = WorldFaults(world) if world else None
        ways = (*self._arriving.values(), *self._leaving.values())
        self._all_stages = [stage for way in ways for stage in way]

    def _add_stages(self, fault: ActiveFault, stage: type[Stage]) -> None:
        hangs = isinstance(fault.settings, timing_kinds.GroundHang)
        direction = "command" if hangs else fault.direction
        for vehicle in fault.vehicles:
            if direction in ("command", "both"):
                self._arriving.setdefault(vehicle, []).append(stage(fault, fault.generator(vehicle, _TO_VEHICLE)))
            if direction in ("telemetry", "both"):
                self._leaving.setdefault(vehicle, []).append(stage(fault, fault.generator(vehicle, _FROM_VEHICLE)))

    def took_off(self, time: float) -> None:
        """All times of faults count from here."""
        for fault in self.faults:
            fault.schedule.take_off = time

    # The world

    def disturb(self, world: World, now: float) -> Forces | None:
        """Wind and load."""
        return None if self._world is None else self._world.act(world, now)

    # Clocks and samples

    def clock(self, vehicle: int, now: float) -> float:
        """With what the clock is ahead."""
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

    def own_sample(self, vehicle: int, sample: Measurement) -> Measurement | None:
        """What the vehicle itself measures."""
        return self._through(OWN, vehicle, sample.time, sample)

    def told(self, vehicle: int, sample: Measurement | None) -> Told:
        """What the vehicle tells."""
        told = Told(sample, sample)
        return told if sample is None else self._through(TOLD, vehicle, sample.time, told)

    def payload_sample(self, vehicle: int, sample: Measurement) -> Measurement | None:
        """What the vehicle relays."""
        return self._through(PAYLOAD, vehicle, sample.time, sample)

    def range_sample(self, vehicle: int, sample: RangeSample) -> RangeSample | None:
        """What the vehicle sees."""
        return self._through(SCAN, vehicle, sample.time, sample)

    def _through(self, hook: str, vehicle: int, time: float, sample: Any) -> Any:
        """What the faults at a hook, which is a method of theirs, leave of a sample of ``time`` (s); None: nothing."""
        for stage in self._samples.get((hook, vehicle), ()):
            moment = stage.fault.schedule.at(time)
            if moment is not None and sample is not None:
                before, sample = sample, getattr(stage, hook)(vehicle, sample, moment)
                stage.fault.seen += 1
                stage.fault.disturbed += sample is not before
        return sample

    # Datagrams

    def to_vehicle(self, vehicle: int, arriving: Sequence[Datagram], now: float) -> Sequence[Datagram]:
        """Through all faults of the way from the ground."""
        for stage in self._arriving.get(vehicle, ()):
            arriving = stage.pass_on(arriving, now)
        return arriving

    def from_vehicle(self, vehicle: int, leaving: Sequence[Datagram], now: float) -> Sequence[Datagram]:
        """Through all faults of the way to the ground."""
        for stage in self._leaving.get(vehicle, ()):
            leaving = stage.pass_on(leaving, now)
        return leaving

    def next_timer(self) -> float | None:
        """When the next datagram that is held back is due."""
        due = [timer for stage in self._all_stages if (timer := stage.next_timer()) is not None]
        return min(due, default=None)


def _sample_stages(fault: ActiveFault, system: SystemConfig) -> Iterable[tuple[int, SampleStage]]:
    if fault.kind.family == "values":
        yield from value_stages(fault, system).items()
    elif isinstance(fault.settings, timing_kinds.StaleStamps):
        yield from ((vehicle, StaleStamps(fault)) for vehicle in fault.vehicles)
    else:
        yield from ((vehicle, sensor_stage(fault, vehicle)) for vehicle in fault.vehicles)
