"""Detection of take-off and touchdown, and the hover thrust, from a vehicle's own motion and thrust."""

import math

from vehicle_sim.autopilot.onboard_arrays import OnboardArrays
from vehicle_sim.autopilot.onboard_kernels import (
    ALTITUDE,
    GROUND,
    HOVER_THRUST,
    IN_AIR,
    LAST_TIME,
    LIFTED_AT,
    STANDING_SINCE,
    THRUST_MAX,
    TOUCHING_SINCE,
    WEIGHT,
)


class LandDetector:
    """Landed state: on the ground until it rises, in the air until it surely stands.

    It stands if neither velocity nor altitude moves while the thrust is below the vehicle's own weight: something under
    it carries the rest. Without a ground it comes to that in two stages, as PX4's ground contact and landed: one that
    should sink and does not is :attr:`touching`; its thrust is then lowered below its own weight, with which it sinks
    in the air. Whether it stands depends on no thrust that was learned. Away from the altitude where it was armed,
    neighbours may carry it for a while, so that it must stand longer. A position and velocity that repeat say nothing.

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
        """The thrust (N) that holds the vehicle and its share of the payload at rest; None before the first flight.

        By thrust over specific force, low-passed, as PX4's estimator of the hover thrust has it: a vehicle that is
        accelerated carries no other mass.
        """
        thrust = float(self._found[HOVER_THRUST])
        return None if math.isnan(thrust) else thrust

    @property
    def touching(self) -> bool:
        """Return True if a vehicle with less than its hover thrust has not sunk, and has not since."""
        return bool(self._found[TOUCHING_SINCE] < self._found[LAST_TIME])

    def start(self) -> None:
        """Take the vehicle to be on the ground here: armed, or disarmed."""
        self._found[GROUND] = self._found[ALTITUDE]
        self._found[IN_AIR] = 0.0
        self._found[[STANDING_SINCE, TOUCHING_SINCE]] = math.inf

    def lift(self, thrust: float) -> None:
        """Take the vehicle to fly: it is upright on its link only by its ``thrust`` (N), also before it rises."""
        self._found[IN_AIR] = 1.0
        self._found[LIFTED_AT] = self._found[LAST_TIME]
        self._found[HOVER_THRUST] = min(max(thrust, self._detector[WEIGHT]), self._detector[THRUST_MAX])
