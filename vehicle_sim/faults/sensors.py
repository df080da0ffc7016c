"""Impairments of the sensors, one class a kind of fault."""

import math

from gcs.config import SystemConfig
from gcs.faults import sensors as kinds
from vehicle_sim.faults.active import ActiveFault, Moment
from vehicle_sim.faults.impairment import OWN, REPORTED, SampleImpairment
from vehicle_sim.world.range_sensor import RangeSample
from vehicle_sim.world.sensors import Measurement, ReportedState


class _Lost(SampleImpairment):
    """Measurements that are missing from the telemetry, and stuck on board where the vehicle has lost them, too."""

    lost: tuple[str, ...]
    """Their names in a :class:`Measurement`."""

    def __init__(self, fault: ActiveFault, vehicle: int, system: SystemConfig) -> None:
        super().__init__(fault, vehicle, system)
        self.acts_on = frozenset({OWN, REPORTED}) if fault.settings.onboard else frozenset({REPORTED})
        self._last: Measurement | None = None
        self._occurrence = -1

    def own(self, vehicle: int, sample: Measurement, moment: Moment) -> Measurement:
        """Return the sample with the values at which the measurement was lost."""
        if self._last is None or moment.occurrence != self._occurrence:
            self._occurrence, self._last = moment.occurrence, sample
        return sample._replace(**{name: getattr(self._last, name) for name in self.lost})


class PositionLost(_Lost, of=kinds.PositionLost):
    """Loss of position and velocity."""

    lost = ("position", "velocity")

    def reported(self, vehicle: int, report: ReportedState, moment: Moment) -> ReportedState:
        """Return the report without it."""
        return report._replace(position=None)


class AttitudeLost(_Lost, of=kinds.AttitudeLost):
    """Loss of the attitude."""

    lost = ("attitude",)

    def reported(self, vehicle: int, report: ReportedState, moment: Moment) -> ReportedState:
        """Return the report without it."""
        return report._replace(attitude=None)


class RatesLost(_Lost, of=kinds.RatesLost):
    """Loss of the body rates."""

    lost = ("rates",)

    def reported(self, vehicle: int, report: ReportedState, moment: Moment) -> ReportedState:
        """Return the report with rates of NaN: MAVLink's unknown value."""
        attitude = report.attitude
        return report if attitude is None else report._replace(attitude=attitude._replace(rates=(math.nan,) * 3))


class PositionGlitch(SampleImpairment, of=kinds.PositionGlitch):
    """Position that jumps away and back."""

    def __init__(self, fault: ActiveFault, vehicle: int, system: SystemConfig) -> None:
        super().__init__(fault, vehicle, system)
        self._generator = fault.generator(vehicle)
        self._occurrence = -1
        self._next = 0.0
        self._offset = (0.0, 0.0)

    def own(self, vehicle: int, sample: Measurement, moment: Moment) -> Measurement:
        """Return the sample, displaced during a glitch."""
        settings: kinds.PositionGlitch = self.fault.settings
        if moment.occurrence != self._occurrence:
            self._occurrence = moment.occurrence
            self._schedule(0.0)
        while moment.elapsed >= self._next + settings.hold:
            self._schedule(self._next + settings.hold)
        if moment.elapsed < self._next:
            return sample
        x, y, z = sample.position
        return sample._replace(position=(x + self._offset[0], y + self._offset[1], z))

    def _schedule(self, after: float) -> None:
        settings: kinds.PositionGlitch = self.fault.settings
        self._next = after + float(self._generator.standard_exponential()) / settings.rate
        heading = math.tau * self._generator.random()
        self._offset = settings.size * math.cos(heading), settings.size * math.sin(heading)


class PositionDrift(SampleImpairment, of=kinds.PositionDrift):
    """Position that drifts away."""

    def own(self, vehicle: int, sample: Measurement, moment: Moment) -> Measurement:
        """Return the sample displaced by the drift."""
        t = moment.elapsed
        x, y, z = sample.position
        a, b, c = self.fault.settings.velocity
        return sample._replace(position=(x + a * t, y + b * t, z + c * t))


class PayloadUnitLost(SampleImpairment, of=kinds.PayloadUnitLost):
    """Loss of the payload's navigation unit."""

    def payload(self, vehicle: int, sample: Measurement, moment: Moment) -> None:
        """Return nothing to relay."""


class ObstacleSensingLost(SampleImpairment, of=kinds.ObstacleSensingLost):
    """Loss of the range sensor."""

    def scan(self, vehicle: int, sample: RangeSample, moment: Moment) -> RangeSample:
        """Return a scan of a failed sensor, of which nothing is sent: without any, the last one would stay in force."""
        return sample._replace(points=sample.points[:0], works=not self.fault.settings.reported, is_sent=False)
