"""One fault on the samples of one vehicle: what it measures, reports, relays and detects."""

from collections.abc import Mapping
from typing import ClassVar, Self

from gcs.config import SystemConfig
from vehicle_sim.faults.active import ActiveFault
from vehicle_sim.faults.schedule import Moment
from vehicle_sim.world.range_sensor import RangeSample
from vehicle_sim.world.sensors import Measurement, ReportedState

OWN, REPORTED, PAYLOAD, SCAN = "own", "reported", "payload", "scan"


class SampleImpairment:
    """No change: every method returns its sample. ``acts_on`` names the methods that a kind of fault overrides."""

    of_kind: ClassVar[dict[type, type["SampleImpairment"]]] = {}
    """The impairment of each kind of fault, by the kind's parameters or their base class."""
    acts_on: frozenset[str] = frozenset()

    def __init_subclass__(cls, of: type | None = None) -> None:
        """``of``: parameters of the kind of fault, or their base class."""
        if of is not None:
            SampleImpairment.of_kind[of] = cls

    def __init__(self, fault: ActiveFault, vehicle: int, system: SystemConfig) -> None:
        self.fault = fault

    @classmethod
    def of_vehicles(cls, fault: ActiveFault, system: SystemConfig) -> Mapping[int, Self]:
        """Return the impairment of each vehicle that the fault disturbs."""
        return {vehicle: cls(fault, vehicle, system) for vehicle in fault.vehicles}

    def own(self, vehicle: int, sample: Measurement, moment: Moment) -> Measurement | None:
        """Return what the vehicle's autopilot gets."""
        return sample

    def reported(self, vehicle: int, report: ReportedState, moment: Moment) -> ReportedState:
        """Return what the vehicle reports of itself."""
        return report

    def payload(self, vehicle: int, sample: Measurement, moment: Moment) -> Measurement | None:
        """Return what the vehicle relays of the payload's navigation unit."""
        return sample

    def scan(self, vehicle: int, sample: RangeSample, moment: Moment) -> RangeSample:
        """Return what the vehicle detects."""
        return sample
