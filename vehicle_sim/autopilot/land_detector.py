"""Whether a vehicle stands or flies, and what thrust keeps it up: learned from its own motion and thrust."""

from __future__ import annotations

import math

from vehicle_sim.world.sensors import Measurement

LIFTED = 0.15  # m above where it was armed
STILL = 0.1  # m/s, vertical
STILL_TIME = 0.5  # s
TOUCHED_THRUST = 0.85  # of the hover thrust: the ground carries the rest
TOUCHED_SINKING = 0.25  # m/s, half of a descent: over a payload that stands a vehicle may still sink aside
VELOCITY_FILTER = 0.2  # s
ALTITUDE_FILTER = 0.1  # s
HOVER_FILTER = 2.0  # s


class LandDetector:
    """On the ground until it rises; in the air until it neither moves vertically nor carries its payload.

    ``in_air``; ``hover_thrust`` (N): the vertical thrust it flew with, low-passed, None before the first flight.
    """

    def __init__(self, weight: float, thrust_max: float) -> None:
        """``weight`` of the vehicle alone and its largest thrust (N)."""
        self._weight = weight
        self._thrust_max = thrust_max
        self._altitude: float | None = None
        self._velocity = 0.0
        self._ground: float | None = None
        self._last_time = 0.0
        self._light_since = math.inf
        self._touching_since = math.inf
        self.in_air = False
        self.touching = False
        self.touched_down = False
        self.hover_thrust: float | None = None

    def start(self) -> None:
        """The vehicle stands here: armed, or disarmed."""
        self._ground = self._altitude
        self.in_air = self.touching = self.touched_down = False
        self._light_since = self._touching_since = math.inf

    def lift(self, thrust: float) -> None:
        """It stands upright on its link only by its ``thrust`` (N): that is flying, also before it rises."""
        self.in_air = True
        self.hover_thrust = min(max(thrust, self._weight), self._thrust_max)

    def update(self, measured: Measurement, thrust: float, now: float, learn: bool) -> None:
        """One step of the onboard loop. ``thrust`` commanded (N); ``learn`` the hover thrust from it.

        ``touching`` says, for a vehicle that is commanded to sink, that something keeps it from that;
        ``touched_down`` that this has lasted.
        """
        step = now - self._last_time
        self._last_time = now
        z, v_z = measured.position[2], measured.velocity[2]
        if self._altitude is None:
            self._altitude = z
            return
        self._altitude += (z - self._altitude) * step / (ALTITUDE_FILTER + step)
        self._velocity += (v_z - self._velocity) * step / (VELOCITY_FILTER + step)
        _, x, y, _ = measured.attitude
        lift = thrust * (1.0 - 2.0 * (x * x + y * y))
        lift = min(max(lift, self._weight), self._thrust_max)

        if not self.in_air:
            if self._ground is not None and self._ground - self._altitude > LIFTED:
                self.in_air = True
                self.hover_thrust = lift
            return
        if self.hover_thrust is None or learn:
            hover = lift if self.hover_thrust is None else self.hover_thrust
            self.hover_thrust = hover + (lift - hover) * step / (HOVER_FILTER + step)
        hover = self.hover_thrust or lift
        still = abs(self._velocity) < STILL
        if not still or thrust > 0.5 * (self._weight + hover):
            self._light_since = now
        if self._velocity > TOUCHED_SINKING or thrust > TOUCHED_THRUST * hover:
            self._touching_since = now
        self._light_since = min(self._light_since, now)
        self._touching_since = min(self._touching_since, now)
        self.touching = self._touching_since < now
        self.touched_down = now - self._touching_since >= STILL_TIME
        if now - self._light_since >= STILL_TIME:
            self.start()
