"""Faults of values: three numbers in, three numbers out, one object for a fault, a vehicle and a channel."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from gcs.config import SystemConfig
from gcs.faults import values as kinds
from idc_controller.rotations_float import Vector, quaternion_of, rotation_vector
from vehicle_sim.faults.impairment import OnOff
from vehicle_sim.faults.schedule import Moment
from vehicle_sim.world.sensors import Measurement

LARGEST = 1e30  # finite values are kept below, so that they can be told in 32 bits whatever faults are combined
_AXES = {"x": 0, "y": 1, "z": 2}

Change = Callable[[float, int, Moment], float]
"""A value, its axis and the moment -> the disturbed value."""


class ValueEffect:
    """Disturbs the axes of one channel."""

    def __init__(self, settings: kinds.ValueFault, generator: np.random.Generator, sigma: float) -> None:
        """``sigma``: the channel's own noise, standard deviation."""
        self._settings = settings
        self._generator = generator
        self._sigma = sigma
        self._axes = sorted(_AXES[axis] for axis in set(settings.axes))
        self._kept: dict[int, Vector] = {}
        self._occurrence = -1
        self._state: OnOff | None = None

    def __call__(self, value: Vector, moment: Moment, point: int = 0) -> Vector:
        """``point`` tells several values of one sample apart."""
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
                if self._state is None:
                    self._state = OnOff(generator, good, stuck)
                if not self._state.is_on(moment):
                    self._kept[point] = value
                return self._kept.setdefault(point, value)
        raise AssertionError(f"no effect for {type(self._settings).__name__}")


def noise_of(channel: str, system: SystemConfig) -> float:
    """Standard deviation of a channel's own noise, in its unit."""
    sensors = system.sensors
    return {
        "position": sensors.position, "payload_position": sensors.position,
        "attitude": math.radians(sensors.attitude_deg), "payload_attitude": math.radians(sensors.attitude_deg),
        "velocity": sensors.uav_velocity, "payload_velocity": sensors.payload_velocity,
        "rates": sensors.uav_rates, "payload_rates": sensors.payload_rates,
        "obstacles": system.range_sensor.noise,
    }[channel]  # fmt: skip


def change(sample: Measurement, channel: str, effect: ValueEffect, moment: Moment) -> Measurement:
    """A sample with one of position, velocity, attitude, rates disturbed."""
    match channel:
        case "position":
            return sample._replace(position=effect(sample.position, moment))
        case "velocity":
            return sample._replace(velocity=effect(sample.velocity, moment))
        case "rates":
            return sample._replace(rates=effect(sample.rates, moment))
    vector = effect(rotation_vector(sample.attitude), moment)
    return sample._replace(attitude=quaternion_of(vector))
