"""Position and velocity of a free vehicle whose position is no longer measured."""

import math

from gcs.config.vehicle_settings import FreeFlightSettings
from idc_controller.rotations_float import Vector
from vehicle_sim.autopilot.inertial import accelerated
from vehicle_sim.autopilot.onboard_arrays import OnboardArrays
from vehicle_sim.world.sensors import Measurement

_NOWHERE = [math.nan] * 3


class DeadReckoning:
    """Integrates the specific force from the last position on, while the estimate repeats that position.

    ``is_lost``: the position has repeated itself for a while, though the vehicle turns and has moved meanwhile. In a
    world without noise a vehicle that hovers repeats it, too.
    """

    def __init__(self, arrays: OnboardArrays, g: float, settings: FreeFlightSettings) -> None:
        """``arrays`` of one vehicle; ``g`` in m/s2."""
        self._row, self._g, self._settings = arrays.estimates[0], g, settings
        self.restart()

    def restart(self) -> None:
        """Take the position to be measured."""
        self.is_lost = False
        self._place, self._attitude = _NOWHERE, [math.nan] * 4
        self._measured_velocity = _NOWHERE
        self._position: Vector = (math.nan,) * 3
        self._velocity: Vector = (math.nan,) * 3
        self._since = self._turned_at = self._now = -math.inf

    def advance(self, force: Vector, *, is_clipped: bool, now: float) -> None:
        """Take the specific force (body frame, m/s2) of the time up to ``now`` (s), at every step of the onboard loop.

        One that exceeds the accelerometer's range is the impact on the ground: the vehicle is then at rest.
        """
        row = self._row.tolist()
        place, attitude, velocity = row[:3], row[3:7], row[7:10]
        step, self._now = now - self._now, now
        if attitude != self._attitude:
            self._attitude, self._turned_at = attitude, now
        if place != self._place:
            self._place, self._measured_velocity, self._since = place, velocity, now
            self._position, self._velocity = (place[0], place[1], place[2]), (velocity[0], velocity[1], velocity[2])
            self.is_lost = False
            return
        if velocity != self._measured_velocity:  # that is measured still
            self._velocity = velocity[0], velocity[1], velocity[2]
        elif is_clipped:
            self._velocity = 0.0, 0.0, 0.0
        else:
            self._velocity = accelerated(self._velocity, attitude, force, self._g, step)
        x, y, z = self._position
        v_x, v_y, v_z = self._velocity
        self._position = x + v_x * step, y + v_y * step, z + v_z * step
        settings = self._settings
        self.is_lost = self.is_lost or (
            now - self._since > settings.position_timeout
            and now - self._turned_at < settings.position_timeout
            and math.dist(self._position, place) > settings.position_motion
        )

    def corrected(self, estimate: Measurement) -> Measurement:
        """Return the ``estimate`` with the position and velocity that follow from the specific force, if it is lost."""
        return estimate._replace(position=self._position, velocity=self._velocity) if self.is_lost else estimate
