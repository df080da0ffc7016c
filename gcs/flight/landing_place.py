"""The place of the next landing: whether the obstacle map has it free, and for how long the payload waits above it."""

import math

import numpy as np

from gcs.config.flight_settings import DEFAULTS, TakeoffLandingSettings
from idc_controller.arrays import Array
from idc_controller.geometry.formation import Formation
from idc_controller.geometry.obstacles import ObstacleSource
from idc_controller.parameters import SystemParameters
from idc_controller.safety.separation import Obstruction, obstruction

_SPACING = 0.3
"""m between the heights at which the formation is looked at on its way down, less than its own height."""


class LandingPlace:
    """Looks at the way down to the landing place, and measures the wait. Times are the team's (s), places NED (m)."""

    def __init__(
        self,
        parameters: SystemParameters,
        obstacles: ObstacleSource,
        within: float,
        settings: TakeoffLandingSettings = DEFAULTS.takeoff_landing,
    ) -> None:
        """``within``: what is nearer than that (m) to the formation there takes the place."""
        self._formation, self._obstacles = Formation(parameters), obstacles
        self._within, self._settings = within, settings
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

    def stand_off(self, height: float, elevation: float) -> float:
        """Return the level distance (m) from which vehicles see all of it, by the lower end of their field of view.

        Straight above it they would not see it become free.

        ``height``: of the payload above the ground (m); ``elevation`` (rad), negative: downwards.
        """
        offsets = self._formation.hover_offsets
        reach = float(np.hypot(*offsets[:, :2].T).max())
        height -= float(offsets[:, 2].min())
        return 2.0 * reach + self._formation.disc_radius + height / max(math.tan(-elevation), 1e-3)

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
