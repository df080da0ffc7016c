"""What touches what after each step, asked of the engine only where something may touch."""

import math

import numpy as np

from gcs.config.tables import WorldConfig
from idc_controller.parameters import SystemParameters
from vehicle_sim.world.broad_phase_kernels import time_apart
from vehicle_sim.world.ground import NO_CONTACTS, Contacts, Ground
from vehicle_sim.world.multibody import DISC_THICKNESS, Multibody
from vehicle_sim.world.obstacle_bodies import ObstacleBodies
from vehicle_sim.world.readings import Readings

# The engine's contacts begin at 0.02 m, and its shapes are up to 0.001 m larger.
_MARGIN = 0.05  # m
_OBSTACLES_MAY_TRAVEL = 0.1  # m, until the broad phase looks again
_STEPS_BETWEEN_LOOKS = 10  # at least: a look costs as much as three queries of the engine


class ContactDetector:
    """The contacts of one world. The broad phase says for how long there can be none."""

    def __init__(
        self,
        parameters: SystemParameters,
        settings: WorldConfig,
        system: Multibody,
        ground: Ground,
        obstacles: ObstacleBodies,
        readings: Readings,
    ) -> None:
        self._system = system
        self._ground = ground
        self._obstacles = obstacles
        self._readings = readings
        self._attachments = np.array(parameters.p, dtype=float, order="C")
        radius = max(math.hypot(parameters.disc_radius, 0.5 * DISC_THICKNESS), settings.bodies.link_radius)
        self._sizes = np.array(
            [settings.pad.thickness, parameters.payload.reach, radius, _MARGIN, _OBSTACLES_MAY_TRAVEL]
        )
        self._found: tuple[int, Contacts] = -1, NO_CONTACTS
        self._apart_until, self._travel_limit, self._next_look = -1, 0.0, 0

    def after(self, steps: int, physics_hz: int) -> Contacts:
        """Return what touches after so many steps, computed once a step."""
        if steps <= self._apart_until and self._obstacles.travelled <= self._travel_limit:
            return NO_CONTACTS
        if self._found[0] != steps:
            found = self._ground.contacts(self._system, self._readings.payload)
            self._found = steps, found
            if found is NO_CONTACTS and steps >= self._next_look:
                self._look(steps, physics_hz)
        return self._found[1]

    def _look(self, steps: int, physics_hz: int) -> None:
        bodies = self._obstacles.ray_bodies
        apart = time_apart(self._readings.states(), self._attachments, bodies.centres, bodies.bounds, self._sizes)
        self._apart_until = steps + int(apart * physics_hz)
        self._travel_limit = self._obstacles.travelled + _OBSTACLES_MAY_TRAVEL
        self._next_look = max(self._apart_until, steps + _STEPS_BETWEEN_LOOKS)
