"""The undisturbed trajectory of the payload, in the time of the obstacles.

That time starts when the first cradle releases, while the rotors spool up, and so before the trajectory begins.
"""

import numpy as np

from gcs.flight.mission_trajectory import MissionTrajectory
from gcs.mission.model import Mission
from idc_controller.arrays import Array

PAD_OFFSET = 0.003
"""Offset (m) of home from the pad by navigation noise. A figure eight begins with that distance, at rest at both ends,
which takes seconds however short it is."""
LAG = 0.138
"""Time (s) from a set-point of the ground to the thrust in the world: control step, hold of a step, motor lag."""
SAMPLE = 0.02
LONGEST = 3600.0


class Schedule:
    """The undisturbed flight of ``mission``; times are the obstacles' (s)."""

    def __init__(self, mission: Mission) -> None:
        """Raises :class:`ValueError` for a mission that lasts longer than an hour."""
        pad = np.array([PAD_OFFSET, -PAD_OFFSET, -mission.system.resting_altitude])
        mission_trajectory = MissionTrajectory(mission, pad, 0.0)
        parameters, spool_up = mission.system.parameters(), mission.system.flight.takeoff_landing.spool_up_time
        own_weight = parameters.m * parameters.g / parameters.hover_thrust
        release = spool_up * float(own_weight.min()) + LAG
        self.start = spool_up - release
        """Time at which the climb begins."""
        count = 4096
        while True:  # the end of a lazy trajectory is known only after a sample beyond it
            elapsed: Array = SAMPLE * np.arange(count, dtype=np.float64)
            positions = mission_trajectory.trajectory.derivatives(elapsed, 0)[0]
            if elapsed[-1] > mission_trajectory.landing_from:
                break
            if elapsed[-1] > LONGEST:
                raise ValueError(f"the mission lasts longer than {LONGEST:g} s")
            count *= 2
        self.landing = self.start + mission_trajectory.landing_from
        """Time at which the final descent begins."""
        until = elapsed <= mission_trajectory.landing_from
        self.times: Array = self.start + elapsed[until]
        self.positions: Array = positions[until]
        """Payload positions at ``times`` (K, 3), from the pad to the place above the landing."""
        self.goal: Array = np.array(mission_trajectory.trajectory.position(mission_trajectory.landing_from))


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
