"""The place of the next landing: whether the obstacle map has it free, and for how long the payload waits above it."""

import math

import numpy as np

from gcs.flight.mission_trajectory import MissionTrajectory
from gcs.mission.model import Limits, Mission
from idc_controller.arrays import Array
from idc_controller.geometry.formation import Formation
from idc_controller.geometry.obstacles import ObstacleSource
from idc_controller.guidance.progress import Guidance
from idc_controller.parameters import SystemParameters
from idc_controller.safety.separation import Obstruction, obstruction

_SPACING = 0.3
"""m between the heights at which the formation is looked at on its way down, less than its own height."""


class LandingPlace:
    """Looks at the way down to the landing place, and measures the wait. Times are the team's (s), places NED (m)."""

    def __init__(self, mission: Mission, parameters: SystemParameters, obstacles: ObstacleSource) -> None:
        """``obstacles``: the obstacle map."""
        system = mission.system
        self._formation, self._obstacles, self._sensor = Formation(parameters), obstacles, system.range_sensor
        self._settings = system.flight.takeoff_landing
        # Nearer to what is there, the safety filter's deflection would make it miss the place.
        self._within = max(system.avoidance.margin - (mission.limits or Limits()).arrival, 0.0)
        self._ground = -parameters.payload.below
        self._looked = -math.inf
        self._free_since = math.inf
        self.taken: Obstruction | None = None
        """What was found there last; None: nothing."""
        self.waiting_since = math.inf
        """Since when the payload waits above it, in a moment maybe; inf: it is not to."""

    @property
    def is_free(self) -> bool:
        """True if it has been free for some time, as often as it was looked at."""
        return self._looked - self._free_since >= self._settings.landing_clear_time

    @property
    def is_waited_for(self) -> bool:
        """True while the payload is not to descend."""
        return self.waiting_since < math.inf

    def waited(self, time: float) -> float:
        """Return for how long (s) the payload has been waiting at ``time``."""
        return max(time - self.waiting_since, 0.0)

    def watch(self, time: float, flown: MissionTrajectory, guidance: Guidance) -> None:
        """Have the payload wait before a landing place that is taken, and land once it is free; once a control step."""
        progress = guidance.progress(time)
        if self.is_waited_for:
            if self.look(time, flown.above) and self.is_free and flown.is_at_rest(progress):
                self.waiting_since = math.inf
                flown.resume_landing(progress)
                guidance.restart(time, progress)
        elif flown.landing_from - self._settings.landing_look_ahead < progress < flown.slow_from:
            followed, along = guidance.stopping_trajectory(time, flown.trajectory)
            is_descending = progress >= flown.landing_from
            if followed is not flown.trajectory and not is_descending:
                return  # on its way round something else
            here = flown.trajectory.position(progress) if is_descending else flown.above
            if self.look(time, here) and self.taken is not None:
                self.waiting_since = time + max(flown.landing_from - progress, 0.0)
                flown.wait(followed, along, self.stand_off(-flown.above[2]))
                guidance.restart(time, along)

    def stand_off(self, height: float) -> float:
        """Return the level distance (m) from which vehicles see all of it, by the lower end of their field of view.

        Straight above it they would not see it become free. ``height``: of the payload above the ground (m).
        """
        elevation, offsets = math.radians(self._sensor.elevation_min_deg), self._formation.hover_offsets
        reach = float(np.hypot(*offsets[:, :2].T).max())
        height -= float(offsets[:, 2].min())
        seen = 2.0 * reach + self._formation.disc_radius + height / max(math.tan(-elevation), 1e-3)
        return min(seen, 0.5 * self._sensor.range)

    def look(self, time: float, above: Array) -> bool:
        """Look at the way down from ``above`` (3,), if it is time to; return whether it was."""
        if time - self._looked < self._settings.landing_look_interval:
            return False
        number = 2 + int(max(self._ground - above[2], 0.0) / _SPACING)
        places = np.linspace([above[0], above[1], self._ground], above, number)
        found = (obstruction(self._formation, self._obstacles, time, place, self._within) for place in places)
        self._looked, self.taken = time, next((each for each in found if each is not None), None)
        self._free_since = min(self._free_since, time) if self.taken is None else math.inf
        return True
