"""One fault on the samples of one vehicle: what it measures, what it tells, what it relays, what it sees."""

from __future__ import annotations

from gcs.config import SystemConfig
from gcs.faults import values as kinds
from vehicle_sim.faults.active import WORLD, ActiveFault
from vehicle_sim.faults.schedule import Moment
from vehicle_sim.faults.timing import stamp_age
from vehicle_sim.faults.values import ValueEffect, change, noise_of
from vehicle_sim.world.range_sensor import RangeSample
from vehicle_sim.world.sensors import Measurement, Told

OWN, TOLD, PAYLOAD, SCAN = "own", "told", "payload", "scan"


class SampleStage:
    """Changes nothing, which is to return what it gets. ``acts_on``: which of the four methods do something."""

    acts_on: frozenset[str] = frozenset()

    def __init__(self, fault: ActiveFault) -> None:
        self.fault = fault

    def own(self, vehicle: int, sample: Measurement, moment: Moment) -> Measurement | None:
        """What the vehicle's autopilot gets."""
        return sample

    def told(self, vehicle: int, told: Told, moment: Moment) -> Told:
        """What the vehicle tells of itself."""
        return told

    def payload(self, vehicle: int, sample: Measurement, moment: Moment) -> Measurement | None:
        """What the vehicle relays of the payload's navigation unit."""
        return sample

    def scan(self, vehicle: int, sample: RangeSample, moment: Moment) -> RangeSample:
        """What the vehicle sees."""
        return sample


class ValueStage(SampleStage):
    """A fault of values."""

    def __init__(self, fault: ActiveFault, vehicle: int, system: SystemConfig) -> None:
        """``vehicle`` WORLD: the payload's own unit, the same for all who relay it."""
        super().__init__(fault)
        settings: kinds.ValueFault = fault.settings
        self._channel = settings.channel.removeprefix("payload_")
        if settings.channel == "obstacles":
            self.acts_on = frozenset({SCAN})
        elif settings.channel.startswith("payload_"):
            self.acts_on = frozenset({PAYLOAD})
        else:
            self.acts_on = frozenset({OWN if settings.at_source else TOLD})
        self._effect = ValueEffect(settings, fault.generator(vehicle), noise_of(settings.channel, system))
        self._last: tuple[Measurement, Measurement] | None = None

    def own(self, vehicle: int, sample: Measurement, moment: Moment) -> Measurement:
        """Disturbed."""
        return self._changed(sample, moment)

    def told(self, vehicle: int, told: Told, moment: Moment) -> Told:
        """Disturbed where it is told."""
        if self._channel in ("position", "velocity"):
            before = told.position
            after = None if before is None else self._changed(before, moment)
            return told if after is before else told._replace(position=after)
        before = told.attitude
        after = None if before is None else self._changed(before, moment)
        return told if after is before else told._replace(attitude=after)

    def payload(self, vehicle: int, sample: Measurement, moment: Moment) -> Measurement:
        """Disturbed; the same for all relays of one sample, if the fault is in the unit."""
        if self._last is None or self._last[0] is not sample:
            self._last = sample, self._changed(sample, moment)
        return self._last[1]

    def scan(self, vehicle: int, sample: RangeSample, moment: Moment) -> RangeSample:
        """Disturbed, every point by itself."""
        detections = tuple(
            detection._replace(position_in_body=self._effect(detection.position_in_body, moment, i))
            for i, detection in enumerate(sample.detections)
        )
        return sample if detections == sample.detections else sample._replace(detections=detections)

    def _changed(self, sample: Measurement, moment: Moment) -> Measurement:
        changed = change(sample, self._channel, self._effect, moment)
        return sample if changed == sample else changed


class SwappedVehicles(SampleStage):
    """Two vehicles tell each other's data; one object for both."""

    acts_on = frozenset({TOLD})

    def __init__(self, fault: ActiveFault) -> None:
        super().__init__(fault)
        self._pair = (fault.vehicles[0], int(fault.settings.other))
        self._latest: dict[int, Told] = {}

    @property
    def vehicles(self) -> tuple[int, int]:
        """Both of them."""
        return self._pair

    def told(self, vehicle: int, told: Told, moment: Moment) -> Told:
        """The other one's."""
        self._latest[vehicle] = told
        one, two = self._pair
        return self._latest.get(two if vehicle == one else one, told)


class StaleStamps(SampleStage):
    """Stamps of an earlier time on all that is told."""

    acts_on = frozenset({TOLD, PAYLOAD, SCAN})

    def told(self, vehicle: int, told: Told, moment: Moment) -> Told:
        """With earlier stamps."""
        attitude, position = told
        old_attitude = None if attitude is None else self._old(attitude)
        return Told(
            old_attitude,
            old_attitude if position is attitude else None if position is None else self._old(position),
        )

    def payload(self, vehicle: int, sample: Measurement, moment: Moment) -> Measurement:
        """With an earlier stamp."""
        return self._old(sample)

    def scan(self, vehicle: int, sample: RangeSample, moment: Moment) -> RangeSample:
        """With an earlier stamp."""
        return sample._replace(time=max(sample.time - stamp_age(self.fault, sample.time), 0.0))

    def _old(self, sample: Measurement) -> Measurement:
        # By the schedule at the sample's own time: it may be told for the second time.
        return sample._replace(time=max(sample.time - stamp_age(self.fault, sample.time), 0.0))


def value_stages(fault: ActiveFault, system: SystemConfig) -> dict[int, SampleStage]:
    """The stage of every vehicle that a fault of values disturbs."""
    if isinstance(fault.settings, kinds.SwappedVehicles):
        pair = SwappedVehicles(fault)
        return dict.fromkeys(pair.vehicles, pair)
    settings: kinds.ValueFault = fault.settings
    if settings.at_source and settings.channel.startswith("payload_"):
        return dict.fromkeys(fault.vehicles, ValueStage(fault, WORLD, system))
    return {vehicle: ValueStage(fault, vehicle, system) for vehicle in fault.vehicles}
