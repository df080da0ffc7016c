"""Impairments of values: a fault changes the three numbers of one channel of one vehicle."""

import math
from collections.abc import Mapping
from typing import Any, Self

import numpy as np

from gcs.config import SystemConfig
from gcs.faults import values as kinds
from idc_controller.rotations_float import Vector, quaternion_of, rotation_vector
from vehicle_sim.faults.active import WORLD, ActiveFault, Moment
from vehicle_sim.faults.impairment import OWN, PAYLOAD, REPORTED, SCAN, GilbertElliottProcess, SampleImpairment
from vehicle_sim.world.range_sensor import RangeSample
from vehicle_sim.world.sensors import Measurement, ReportedState

LARGEST = 1e30  # finite values stay below, so that they fit a 32-bit float whatever faults are combined
_AXES = {"x": 0, "y": 1, "z": 2}


class ValueEffect:
    """The change of the axes of one channel."""

    def __init__(self, settings: kinds.ValueFault, generator: np.random.Generator, sigma: float) -> None:
        """``sigma``: the channel's own noise, standard deviation."""
        self._settings = settings
        self._generator = generator
        self._sigma = sigma
        self._axes = sorted(_AXES[axis] for axis in set(settings.axes))
        self._kept: dict[int, Vector] = {}
        self._occurrence = -1
        self._process: GilbertElliottProcess | None = None

    def __call__(self, value: Vector, moment: Moment, point: int = 0) -> Vector:
        """Return the disturbed value; ``point`` is its number in a sample of several."""
        if moment.occurrence != self._occurrence:
            self._occurrence = moment.occurrence
            self._kept = {}
        wrong = self._disturbed(value, moment, point)
        result = list(value)
        for axis in self._axes:
            x = wrong[axis]
            result[axis] = x if not abs(x) > LARGEST or math.isinf(x) else math.copysign(LARGEST, x)
        return result[0], result[1], result[2]

    def _disturbed(self, value: Vector, moment: Moment, point: int) -> Vector:
        x, y, z = value
        generator = self._generator
        match self._settings:
            case kinds.Bias(amount=a):
                return x + a, y + a, z + a
            case kinds.Drift(rate=rate):
                a = rate * moment.elapsed
                return x + a, y + a, z + a
            case kinds.Scale(factor=k):
                return k * x, k * y, k * z
            case kinds.Stuck():
                return self._kept.setdefault(point, value)
            case kinds.Spikes(probability=probability, amount=a):
                if generator.random() >= probability:
                    return value
                i, j, k = (a if up else -a for up in generator.random(3) < 0.5)
                return x + i, y + j, z + k
            case kinds.NotANumber(value=name, probability=probability):
                if generator.random() >= probability:
                    return value
                return (float(name),) * 3
            case kinds.Quantisation(step=step):
                x, y, z = (step * round(v / step) if math.isfinite(v) else v for v in value)
                return x, y, z
            case kinds.FlippedSign():
                return -x, -y, -z
            case kinds.SwappedFrame():
                return y, x, -z
            case kinds.Noise(factor=k):
                a, b, c = (self._sigma * math.sqrt(k * k - 1.0) * generator.standard_normal(3)).tolist()
                return x + a, y + b, z + c
            case kinds.Intermittent(good=good, stuck=stuck):
                if self._process is None:
                    self._process = GilbertElliottProcess(generator, good, stuck)
                if not self._process.is_bad(moment):
                    self._kept[point] = value
                return self._kept.setdefault(point, value)
        raise AssertionError(f"no effect for {type(self._settings).__name__}")


class ValueImpairment(SampleImpairment, of=kinds.ValueFault):
    """A fault of the values of one channel."""

    def __init__(self, fault: ActiveFault, vehicle: int, system: SystemConfig) -> None:
        """``vehicle`` WORLD: the payload's own unit, the same for all that relay it."""
        super().__init__(fault, vehicle, system)
        settings: kinds.ValueFault = fault.settings
        self._channel = settings.channel.removeprefix("payload_")
        if settings.channel == "obstacles":
            self.acts_on = frozenset({SCAN})
        elif settings.channel.startswith("payload_"):
            self.acts_on = frozenset({PAYLOAD})
        else:
            self.acts_on = frozenset({OWN if settings.at_source else REPORTED})
        self._effect = ValueEffect(settings, fault.generator(vehicle), noise_of(settings.channel, system))
        self._last: tuple[Measurement, Measurement] | None = None

    @classmethod
    def of_vehicles(cls, fault: ActiveFault, system: SystemConfig) -> Mapping[int, Self]:
        """Return the impairment of each vehicle; at the source of the payload's data, one for all of them."""
        settings: kinds.ValueFault = fault.settings
        if settings.at_source and settings.channel.startswith("payload_"):
            return dict.fromkeys(fault.vehicles, cls(fault, WORLD, system))
        return super().of_vehicles(fault, system)

    def own(self, vehicle: int, sample: Measurement, moment: Moment) -> Measurement:
        """Return the disturbed measurement."""
        return self._changed(sample, moment)

    def reported(self, vehicle: int, report: ReportedState, moment: Moment) -> ReportedState:
        """Return the report, disturbed in the message that carries the channel."""
        part = "position" if self._channel in ("position", "velocity") else "attitude"
        before = getattr(report, part)
        after = None if before is None else self._changed(before, moment)
        return report if after is before else report._replace(**{part: after})

    def payload(self, vehicle: int, sample: Measurement, moment: Moment) -> Measurement:
        """Return the disturbed sample; the same for all relays of it, if the fault is in the unit."""
        if self._last is None or self._last[0] is not sample:
            self._last = sample, self._changed(sample, moment)
        return self._last[1]

    def scan(self, vehicle: int, sample: RangeSample, moment: Moment) -> RangeSample:
        """Return the scan with every point disturbed by itself."""
        disturbed = [self._effect((x, y, z), moment, i) for i, (x, y, z) in enumerate(sample.points.tolist())]
        points = np.array(disturbed).reshape(-1, 3)
        unchanged = np.array_equal(points, sample.points, equal_nan=True)
        return sample if unchanged else sample._replace(points=points)

    def _changed(self, sample: Measurement, moment: Moment) -> Measurement:
        if self._channel == "attitude":
            value: Any = quaternion_of(self._effect(rotation_vector(sample.attitude), moment))
        else:
            value = self._effect(getattr(sample, self._channel), moment)
        changed = sample._replace(**{self._channel: value})
        return sample if changed == sample else changed


class SwappedVehicles(SampleImpairment, of=kinds.SwappedVehicles):
    """Two vehicles that report each other's data; one object for both."""

    def __init__(self, fault: ActiveFault, vehicle: int, system: SystemConfig) -> None:
        super().__init__(fault, vehicle, system)
        self._other = {vehicle: fault.settings.other, fault.settings.other: vehicle}
        self._latest: dict[int, ReportedState] = {}

    @classmethod
    def of_vehicles(cls, fault: ActiveFault, system: SystemConfig) -> Mapping[int, Self]:
        """Return the one impairment for both vehicles."""
        vehicle = fault.vehicles[0]
        return dict.fromkeys((vehicle, fault.settings.other), cls(fault, vehicle, system))

    def reported(self, vehicle: int, report: ReportedState, moment: Moment) -> ReportedState:
        """Return the other vehicle's report."""
        self._latest[vehicle] = report
        return self._latest.get(self._other[vehicle], report)


def noise_of(channel: str, system: SystemConfig) -> float:
    """Return the standard deviation of a channel's own noise, in its unit."""
    sensors = system.sensors
    return {
        "position": sensors.position, "payload_position": sensors.position,
        "attitude": math.radians(sensors.attitude_deg), "payload_attitude": math.radians(sensors.attitude_deg),
        "velocity": sensors.uav_velocity, "payload_velocity": sensors.payload_velocity,
        "rates": sensors.uav_rates, "payload_rates": sensors.payload_rates,
        "obstacles": system.range_sensor.noise,
    }[channel]  # fmt: skip
