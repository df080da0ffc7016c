"""Detection of take-off and touchdown, and the hover thrust, from a vehicle's own motion and thrust."""

import math

from vehicle_sim.autopilot.onboard_arrays import OnboardArrays
from vehicle_sim.autopilot.onboard_kernels import (
    ALTITUDE,
    GROUND,
    HOVER_THRUST,
    IN_AIR,
    LAST_TIME,
    LIGHT_SINCE,
    THRUST_MAX,
    TIME,
    TOUCHING_SINCE,
    WEIGHT,
)


class LandDetector:
    """Landed state: on the ground until it rises, in the air until it neither moves vertically nor carries its payload.

    It takes its steps with those of the whole team, in :func:`.onboard_kernels.detect_landings`.
    """

    def __init__(self, arrays: OnboardArrays) -> None:
        """``arrays`` of one vehicle."""
        self._found, self._detector = arrays.landings[0], arrays.detectors[0]

    @property
    def in_air(self) -> bool:
        """Return True from take-off to touchdown."""
        return bool(self._found.item(IN_AIR))

    @property
    def last_time(self) -> float:
        """Time of the last step (s); zero before the first estimate."""
        return float(self._found[LAST_TIME])

    @property
    def hover_thrust(self) -> float | None:
        """The vertical thrust that it flew with (N), low-passed; None before the first flight."""
        thrust = float(self._found[HOVER_THRUST])
        return None if math.isnan(thrust) else thrust

    @property
    def touching(self) -> bool:
        """Return True if something keeps a vehicle that is commanded to sink from sinking."""
        return bool(self._found[TOUCHING_SINCE] < self._found[LAST_TIME])

    @property
    def touched_down(self) -> bool:
        """Return True if :attr:`touching` has lasted."""
        return bool(self._found[LAST_TIME] - self._found[TOUCHING_SINCE] >= self._detector[TIME])

    def start(self) -> None:
        """Take the vehicle to be on the ground here: armed, or disarmed."""
        self._found[GROUND] = self._found[ALTITUDE]
        self._found[IN_AIR] = 0.0
        self._found[[LIGHT_SINCE, TOUCHING_SINCE]] = math.inf

    def lift(self, thrust: float) -> None:
        """Take the vehicle to fly: it is upright on its link only by its ``thrust`` (N), also before it rises."""
        self._found[IN_AIR] = 1.0
        self._found[HOVER_THRUST] = min(max(thrust, self._detector[WEIGHT]), self._detector[THRUST_MAX])
