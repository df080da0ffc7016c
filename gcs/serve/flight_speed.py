"""The speed of a team that is flown by orders: which is wanted, and whether what is planned can be flown with it."""

from __future__ import annotations

import math
from typing import NamedTuple

from gcs.mission.model import Lissajous, Mission
from gcs.mission.route import Route
from gcs.mission.steps import Speed


class LegSpeeds(NamedTuple):
    """Speeds of legs (m/s)."""

    planned: float
    """Where their mission names none; inf: of a curve, which has its own."""
    fastest: float
    """That none of them exceeds; beside a curve those that lead to it and back."""

    @classmethod
    def of(cls, reference: Route | Lissajous, cruise: float) -> LegSpeeds:
        """Return the speeds of what a mission flies; ``cruise``: beside a curve (m/s)."""
        return cls(reference.speed, reference.fastest) if isinstance(reference, Route) else cls(math.inf, cruise)


class FlightSpeed:
    """Speeds in m/s. A slower one limits the progress along what is planned, a faster one takes new legs."""

    def __init__(self) -> None:
        self.ordered: float | None = None
        """Speed that was ordered in place of the mission's; None: none."""
        self.legs = LegSpeeds(0.0, 0.0)
        """Of the legs that are flown."""
        self._flown = 0.0
        """What they are flown with where their mission names none."""

    def cruise(self, world: Mission) -> float:
        """Return the speed of what is flown without a mission."""
        return world.system.motion.speed if self.ordered is None else self.ordered

    def of_mission(self, mission: Mission) -> float:
        """Return the speed wanted of a mission where that names none; inf: its own."""
        planned = LegSpeeds.of(mission.reference, mission.system.motion.speed).planned
        return planned if self.ordered is None else self.ordered

    def plan(self, legs: LegSpeeds, wanted: float) -> float:
        """Return the speed that none of ``legs`` is to exceed, which are planned to have the speed ``wanted``."""
        slower = wanted < legs.planned < math.inf
        self.legs, self._flown = legs, wanted if slower else legs.planned
        return wanted if slower else legs.fastest

    def limit(self, wanted: float) -> float:
        """Return the limit that what is planned is flown with to have the speed ``wanted``; inf: none."""
        return wanted if wanted < self._flown else math.inf

    def needs_new_legs(self, mission: Mission) -> bool:
        """Return whether a limit of what is planned of a ``mission`` does not give the speed that is wanted of it."""
        route = mission.reference
        if not isinstance(route, Route):
            return False
        names_speeds = any(isinstance(step, Speed) for step in route.steps)
        return self.of_mission(mission) > self._flown or (self.ordered is None and names_speeds)
