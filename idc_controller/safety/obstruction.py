"""The obstacle that is nearest to the formation at rest at a place, exactly."""

from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.formation import Formation
from idc_controller.geometry.obstacles import ObstacleSource
from idc_controller.safety.separation import PredictedObstacles, separations


class Obstruction(NamedTuple):
    """An obstacle, and its distance (m) from the hull as it is known; negative: it reaches into it."""

    name: str
    distance: float

    def lacking(self, keep: float) -> str:
        """Return in words how much nearer it is than ``keep`` (m)."""
        if self.distance <= 0.0:
            missing = f", {keep - self.distance:.2f} m are missing" if keep > 0.0 else ""
            return f"{self.name} reaches {-self.distance:.2f} m into the formation there{missing}"
        missing = f"{self.distance:.2f} m from the formation there, {keep - self.distance:.2f} m are missing"
        return f"{self.name} is {missing}"


def obstruction(
    formation: Formation, obstacles: ObstacleSource, time: float, place: Array, within: float
) -> Obstruction | None:
    """Return what is nearer than ``within`` (m) to a ``formation`` at rest at ``place`` (3,) at ``time`` (s)."""
    predicted = PredictedObstacles(obstacles.predict(np.array([time])))
    near = separations(formation, place.reshape(1, 3), np.zeros((1, 3)), predicted, within)
    found = [Obstruction(each.obstacle.name, float(each.distance[0])) for each in near]
    return min((each for each in found if each.distance < within), key=lambda each: each.distance, default=None)
