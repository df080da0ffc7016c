"""Faults of the sensors."""

from __future__ import annotations

import math

from gcs.faults import sensors as kinds
from vehicle_sim.faults.active import ActiveFault
from vehicle_sim.faults.samples import OWN, PAYLOAD, SCAN, TOLD, SampleStage
from vehicle_sim.faults.schedule import Moment
from vehicle_sim.world.range_sensor import RangeSample
from vehicle_sim.world.sensors import Measurement, Told


class _Lost(SampleStage):
    """Something that the vehicle does not tell, and perhaps does not know itself."""

    def __init__(self, fault: ActiveFault) -> None:
        super().__init__(fault)
        self.acts_on = frozenset({OWN, TOLD}) if fault.settings.onboard else frozenset({TOLD})
        self._kept: Measurement | None = None
        self._occurrence = -1

    def last(self, sample: Measurement, moment: Moment) -> Measurement:
        """The sample at which it was lost."""
        if self._kept is None or moment.occurrence != self._occurrence:
            self._occurrence, self._kept = moment.occurrence, sample
        return self._kept


class PositionLost(_Lost):
    """Neither position nor velocity."""

    def own(self, vehicle: int, sample: Measurement, moment: Moment) -> Measurement:
        """The last that was known."""
        last = self.last(sample, moment)
        return sample._replace(position=last.position, velocity=last.velocity)

    def told(self, vehicle: int, told: Told, moment: Moment) -> Told:
        """Not told."""
        return told._replace(position=None)


class AttitudeLost(_Lost):
    """No attitude."""

    def own(self, vehicle: int, sample: Measurement, moment: Moment) -> Measurement:
        """The last that was known."""
        return sample._replace(attitude=self.last(sample, moment).attitude)

    def told(self, vehicle: int, told: Told, moment: Moment) -> Told:
        """Not told."""
        return told._replace(attitude=None)


class RatesLost(_Lost):
    """No rates."""

    def own(self, vehicle: int, sample: Measurement, moment: Moment) -> Measurement:
        """The last that were known."""
        return sample._replace(rates=self.last(sample, moment).rates)

    def told(self, vehicle: int, told: Told, moment: Moment) -> Told:
        """Told as not known."""
        attitude = told.attitude
        return told if attitude is None else told._replace(attitude=attitude._replace(rates=(math.nan,) * 3))


class PositionGlitch(SampleStage):
    """Jumps away and back."""

    acts_on = frozenset({OWN})

    def __init__(self, fault: ActiveFault, vehicle: int) -> None:
        super().__init__(fault)
        self._generator = fault.generator(vehicle)
        self._occurrence = -1
        self._next = 0.0
        self._offset = (0.0, 0.0)

    def own(self, vehicle: int, sample: Measurement, moment: Moment) -> Measurement:
        """Where it is, or somewhere else."""
        settings: kinds.PositionGlitch = self.fault.settings
        if moment.occurrence != self._occurrence:
            self._occurrence = moment.occurrence
            self._plan(0.0)
        while moment.elapsed >= self._next + settings.hold:
            self._plan(self._next + settings.hold)
        if moment.elapsed < self._next:
            return sample
        x, y, z = sample.position
        return sample._replace(position=(x + self._offset[0], y + self._offset[1], z))

    def _plan(self, after: float) -> None:
        settings: kinds.PositionGlitch = self.fault.settings
        self._next = after + float(self._generator.standard_exponential()) / settings.rate
        heading = math.tau * self._generator.random()
        self._offset = settings.size * math.cos(heading), settings.size * math.sin(heading)


class PositionDrift(SampleStage):
    """Drifts away."""

    acts_on = frozenset({OWN})

    def own(self, vehicle: int, sample: Measurement, moment: Moment) -> Measurement:
        """Further and further off."""
        t = moment.elapsed
        x, y, z = sample.position
        a, b, c = self.fault.settings.velocity
        return sample._replace(position=(x + a * t, y + b * t, z + c * t))


class PayloadUnitLost(SampleStage):
    """Nothing to relay."""

    acts_on = frozenset({PAYLOAD})

    def payload(self, vehicle: int, sample: Measurement, moment: Moment) -> None:
        """Nothing."""


class ObstacleSensingLost(SampleStage):
    """Nothing is seen."""

    acts_on = frozenset({SCAN})

    def scan(self, vehicle: int, sample: RangeSample, moment: Moment) -> RangeSample:
        """An empty scan of a sensor that does not work: with none at all, the last one would stay."""
        return sample._replace(detections=(), works=False)


def sensor_stage(fault: ActiveFault, vehicle: int) -> SampleStage:
    """The stage of a fault of the sensors on a vehicle."""
    match fault.settings:
        case kinds.PositionLost():
            return PositionLost(fault)
        case kinds.AttitudeLost():
            return AttitudeLost(fault)
        case kinds.RatesLost():
            return RatesLost(fault)
        case kinds.PositionGlitch():
            return PositionGlitch(fault, vehicle)
        case kinds.PositionDrift():
            return PositionDrift(fault)
        case kinds.PayloadUnitLost():
            return PayloadUnitLost(fault)
        case kinds.ObstacleSensingLost():
            return ObstacleSensingLost(fault)
    raise AssertionError(f"no stage for {fault.fault.kind}")
