"""Detection of stuck sensors: a value with noise never repeats to the digit."""

from dataclasses import dataclass

from idc_controller.arrays import Array
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Channel, Measurement, MeasurementNoise, SensorKey
from idc_controller.estimation.settings import StuckSensorSettings


@dataclass
class _Last:
    time: float
    parts: tuple[Array, Array]
    repeats: list[int]


class StuckSensors:
    """Counts repeated values of every channel that has noise."""

    def __init__(self, noise: MeasurementNoise, settings: StuckSensorSettings = StuckSensorSettings()) -> None:
        self._noise, self._settings = noise, settings
        self._last: dict[SensorKey, _Last] = {}

    def check(self, measurement: Measurement) -> tuple[bool, bool]:
        """Take a measurement and return whether its pose, and whether its motion, is stuck."""
        key = measurement.source, type(measurement)
        parts = measurement.pose, measurement.motion
        last = self._last.get(key)
        if last is None:
            self._last[key] = _Last(measurement.time, parts, [0, 0])
            return False, False
        relayed = self._settings.relay_interval if measurement.source == PAYLOAD else 0.0
        if measurement.time > last.time + relayed:
            for k, (now, before) in enumerate(zip(parts, last.parts, strict=True)):
                last.repeats[k] = last.repeats[k] + 1 if bool((now == before).all()) else 0
            last.time, last.parts = measurement.time, parts
        return self._stuck_parts(key, last)

    def channels(self) -> list[Channel]:
        """Return the channels that are stuck now."""
        return [
            Channel(source, kind, part)
            for (source, kind), last in self._last.items()
            for part, stuck in enumerate(self._stuck_parts((source, kind), last))
            if stuck
        ]

    def _stuck_parts(self, key: SensorKey, last: _Last) -> tuple[bool, bool]:
        pose_sigma, motion_sigma = self._sigmas(*key)
        pose, motion = last.repeats
        limit = self._settings.repeats
        return pose >= limit and pose_sigma > 0.0, motion >= limit and motion_sigma > 0.0

    def _sigmas(self, source: int, kind: type) -> tuple[float, float]:
        noise, of_payload = self._noise, source == PAYLOAD
        if kind is Attitude:
            return noise.attitude, noise.payload_rates if of_payload else noise.uav_rates
        return noise.position, noise.payload_velocity if of_payload else noise.uav_velocity
