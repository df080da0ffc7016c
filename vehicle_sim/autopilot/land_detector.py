"""Detection of take-off and touchdown, and the hover thrust, from a vehicle's own motion and thrust."""

import math

from gcs.config.vehicle_settings import LandDetectorSettings
from vehicle_sim.world.sensors import Measurement


class LandDetector:
    """Landed state: on the ground until it rises, in the air until it neither moves vertically nor carries its payload.

    ``in_air``; ``hover_thrust`` (N): the vertical thrust it flew with, low-passed, None before the first flight.
    """

    def __init__(self, weight: float, thrust_max: float, settings: LandDetectorSettings) -> None:
        """``weight`` of the vehicle alone and its largest thrust (N)."""
        self._settings = settings
        self._weight = weight
        self._thrust_max = thrust_max
        self._altitude: float | None = None
        self._velocity = 0.0
        self._ground: float | None = None
        self._last_time = 0.0
        self._light_since = math.inf
        self._touching_since = math.inf
        self.in_air = False
        self.hover_thrust: float | None = None

    @property
    def touching(self) -> bool:
        """Return True if something keeps a vehicle that is commanded to sink from sinking."""
        return self._touching_since < self._last_time

    @property
    def touched_down(self) -> bool:
        """Return True if :attr:`touching` has lasted."""
        return self._last_time - self._touching_since >= self._settings.time

    def start(self) -> None:
        """Take the vehicle to be on the ground here: armed, or disarmed."""
        self._ground = self._altitude
        self.in_air = False
        self._light_since = self._touching_since = math.inf

    def lift(self, thrust: float) -> None:
        """Take the vehicle to fly: it is upright on its link only by its ``thrust`` (N), also before it rises."""
        self.in_air = True
        self.hover_thrust = min(max(thrust, self._weight), self._thrust_max)

    def update(self, measured: Measurement, thrust: float, now: float, learn: bool) -> None:
        """Take one step of the onboard loop. ``thrust`` commanded (N); ``learn`` the hover thrust from it."""
        step = now - self._last_time
        self._last_time = now
        z, v_z = measured.position[2], measured.velocity[2]
        if self._altitude is None:
            self._altitude = z
            return
        self._altitude += (z - self._altitude) * step / (self._settings.altitude_filter + step)
        self._velocity += (v_z - self._velocity) * step / (self._settings.velocity_filter + step)
        _, x, y, _ = measured.attitude
        lift = thrust * (1.0 - 2.0 * (x * x + y * y))
        lift = min(max(lift, self._weight), self._thrust_max)

        if not self.in_air:
            if self._ground is not None and self._ground - self._altitude > self._settings.lifted:
                self.in_air = True
                self.hover_thrust = lift
            return
        if self.hover_thrust is None or learn:
            hover = lift if self.hover_thrust is None else self.hover_thrust
            self.hover_thrust = hover + (lift - hover) * step / (self._settings.hover_filter + step)
        hover = self.hover_thrust or lift
        slow = abs(self._velocity) < self._settings.vertical_speed_max
        if not slow or thrust > self._weight + self._settings.unloaded_share * (hover - self._weight):
            self._light_since = now
        if self._velocity > self._settings.touchdown_sinking or thrust > self._settings.touchdown_thrust * hover:
            self._touching_since = now
        self._light_since = min(self._light_since, now)
        self._touching_since = min(self._touching_since, now)
        if now - self._light_since >= self._settings.time:
            self.start()
