"""The payload on the ground, by the telemetry of its unit: what the feet of the links do."""

import numpy as np

from idc_controller.arrays import Array
from idc_controller.estimation.measurements import Attitude, Measurement
from idc_controller.estimation.settings import GroundedLinksSettings
from idc_controller.rotations import quaternion_from_euler, rotation_from_quaternion


class GroundedPayload:
    """It stands, or slides."""

    def __init__(self, time: float, x: Array, arm: float, settings: GroundedLinksSettings) -> None:
        """``x``: position, velocity, Euler angles and body rates (12,) at ``time`` (s); ``arm`` of the feet (m)."""
        self._time, self._settings = time, settings
        self._speed_max, self._rate_max = settings.payload_speed_max, settings.payload_speed_max / arm
        self._position, self.velocity = x[:3].copy(), x[3:6].copy()
        self._velocity = np.clip(self.velocity, -self._speed_max, self._speed_max)
        self._rates = np.clip(x[9:12], -self._rate_max, self._rate_max)
        self._turn = rotation_from_quaternion(quaternion_from_euler(*x[6:9]))

    def add(self, measurement: Measurement) -> None:
        """Take a measurement of its unit."""
        s = self._settings
        if isinstance(measurement, Attitude):
            if measurement.has_pose and measurement.has_motion:
                self._turn = rotation_from_quaternion(measurement.pose)
                self._rates = np.clip(measurement.motion, -self._rate_max, self._rate_max)
            return
        if measurement.has_motion:
            self.velocity = measurement.motion
            self._velocity = np.clip(measurement.motion, -self._speed_max, self._speed_max)
        if measurement.has_pose and measurement.time > self._time:
            predicted = self._position + (measurement.time - self._time) * self._velocity
            off = np.clip(measurement.pose - predicted, -s.payload_step_max, s.payload_step_max)
            self._time, self._position = measurement.time, predicted + s.payload_share * off

    def positions(self, places: Array) -> Array:
        """Return the positions (K, 3) (m) of ``places`` (K, 3) in its frame."""
        return np.asarray(self._position + places @ self._turn.T)

    def velocities(self, places: Array) -> Array:
        """Return the velocities (K, 3) (m/s) of ``places`` (K, 3) in its frame."""
        return np.asarray(self._velocity + np.cross(self._rates, places) @ self._turn.T)
