"""The undisturbed trajectory of the payload, in the time of the obstacles.

That time starts with take-off: when the first cradle releases, which is while the rotors spool up and so before the
trajectory begins.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcs.config.flight_settings import TakeoffLandingSettings
from gcs.flight.mission_trajectory import MissionTrajectory
from gcs.mission.model import RESTING_ALTITUDE, Mission
from idc_controller.parameters import SystemParameters

Array = NDArray[np.float64]

PAD_OFFSET = 0.003
"""m: what navigation noise leaves between the pad and home. A figure eight begins with that distance, at rest at both
ends, which takes seconds however short it is."""
LAG = 0.138
"""s from a set-point of the ground to the thrust in the world: a control step, the hold of a step, the motors' lag."""
SAMPLE = 0.02
LONGEST = 3600.0


def trajectory_start(parameters: SystemParameters, settings: TakeoffLandingSettings) -> float:
    """Return the time of the obstacles at which the trajectory begins (s)."""
    own_weight = parameters.m * parameters.g / parameters.hover_thrust
    spool_up = settings.spool_up_time
    release = spool_up * float(own_weight.min()) + LAG
    return spool_up - release


class Schedule:
    """The undisturbed flight of ``mission``; times are the obstacles' (s)."""

    def __init__(self, mission: Mission) -> None:
        """Raises :class:`ValueError` for a mission that lasts longer than an hour."""
        pad = np.array([PAD_OFFSET, -PAD_OFFSET, -RESTING_ALTITUDE])
        self._trajectory = MissionTrajectory(mission, pad, 0.0)
        self.start = trajectory_start(mission.system.parameters(), mission.system.flight.takeoff_landing)
        """When the climb begins."""
        count = 4096
        while True:  # the end of a lazy trajectory is known only after a sample beyond it
            elapsed: Array = SAMPLE * np.arange(count, dtype=np.float64)
            positions = self._trajectory.trajectory.derivatives(elapsed, 0)[0]
            if elapsed[-1] > self._trajectory.landing_from:
                break
            if elapsed[-1] > LONGEST:
                raise ValueError(f"the mission lasts longer than {LONGEST:g} s")
            count *= 2
        self.landing = self.start + self._trajectory.landing_from
        """When the final descent begins."""
        until = elapsed <= self._trajectory.landing_from
        self.times: Array = self.start + elapsed[until]
        self.positions: Array = positions[until]
        """Where the payload is at ``times`` (K, 3), from the pad to the place above the landing."""
        self.goal: Array = np.array(self._trajectory.trajectory.position(self._trajectory.landing_from))

    def position(self, times: Array) -> Array:
        """Return the position of the payload (K, 3), NED (m)."""
        return np.asarray(self._trajectory.trajectory.derivatives(np.maximum(times - self.start, 0.0), 0)[0])

    def velocity(self, times: Array) -> Array:
        """Return its velocity (K, 3) (m/s)."""
        return np.asarray(self._trajectory.trajectory.derivatives(np.maximum(times - self.start, 0.0), 1)[1])


def arrival(times: Array, positions: Array, goal: Array, within: float) -> float | None:
    """Return when the payload comes within ``within`` (m, horizontally) of the goal for good; None: never.

    ``times`` (K,) (s), ``positions`` (K, 3).
    """
    if len(times) == 0:
        return None
    away = np.flatnonzero(np.linalg.norm(positions[:, :2] - goal[:2], axis=1) > within)
    if len(away) == 0:
        return float(times[0])
    return float(times[away[-1] + 1]) if away[-1] + 1 < len(times) else None
