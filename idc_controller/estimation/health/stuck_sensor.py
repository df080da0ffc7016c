"""Detection of stuck sensors: a value with noise never repeats to the digit."""

from dataclasses import dataclass

from idc_controller.estimation.measurements import PAYLOAD, Attitude, Channel, Measurement, MeasurementNoise, SensorKey
from idc_controller.estimation.settings import StuckSensorSettings


@dataclass(slots=True)
class _Last:
    time: float
    pose: list[float]
    motion: list[float]
    repeats: tuple[int, int] = (0, 0)
    """Of the pose and of the motion."""
    stuck: tuple[bool, bool] = (False, False)
    """Whether the pose, and whether the motion, is stuck."""


class StuckSensors:
    """Counts repeated values of every channel that has noise."""

    def __init__(self, noise: MeasurementNoise, settings: StuckSensorSettings = StuckSensorSettings()) -> None:
        self._noise, self._settings = noise, settings
        self._last: dict[SensorKey, _Last] = {}

    def check(self, measurement: Measurement, pose: list[float], motion: list[float]) -> tuple[bool, bool]:
        """Take a measurement, by its numbers, and return whether its pose, and whether its motion, is stuck."""
        time, key = measurement.time, (measurement.source, type(measurement))
        last = self._last.get(key)
        if last is None:
            self._last[key] = _Last(time, pose, motion)
            return False, False
        if time <= last.time + (self._settings.relay_interval if measurement.source == PAYLOAD else 0.0):
            return last.stuck
        same_pose, same_motion = pose == last.pose, motion == last.motion
        if same_pose or same_motion:
            of_pose, of_motion = last.repeats
            last.repeats = of_pose + 1 if same_pose else 0, of_motion + 1 if same_motion else 0
            last.stuck = self._stuck_parts(key, last.repeats)
        else:
            last.repeats, last.stuck = (0, 0), (False, False)
        last.time, last.pose, last.motion = time, pose, motion
        return last.stuck

    def channels(self) -> list[Channel]:
        """Return the channels that are stuck now."""
        return [
            Channel(source, kind, part)
            for (source, kind), last in self._last.items()
            if True in last.stuck
            for part, stuck in enumerate(last.stuck)
            if stuck
        ]

    def _stuck_parts(self, key: SensorKey, repeats: tuple[int, int]) -> tuple[bool, bool]:
        limit, (pose, motion), (pose_sigma, motion_sigma) = self._settings.repeats, repeats, self._sigmas(*key)
        return pose >= limit and pose_sigma > 0.0, motion >= limit and motion_sigma > 0.0

    def _sigmas(self, source: int, kind: type) -> tuple[float, float]:
        noise, of_payload = self._noise, source == PAYLOAD
        if kind is Attitude:
            return noise.attitude, noise.payload_rates if of_payload else noise.uav_rates
        return noise.position, noise.payload_velocity if of_payload else noise.uav_velocity
