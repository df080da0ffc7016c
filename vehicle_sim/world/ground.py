"""Ground and pad, the cradles in which UAVs are held at first, and what touches what."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pybullet

from gcs.config.tables import CradleSettings, PadSettings, WorldConfig
from idc_controller.parameters import PayloadHull, SystemParameters
from vehicle_sim.world.broad_phase_kernels import time_apart
from vehicle_sim.world.multibody import DISC_THICKNESS, Multibody
from vehicle_sim.world.obstacle_bodies import ObstacleBodies
from vehicle_sim.world.readings import Pose, Readings, Uavs
from vehicle_sim.world.world_state import flipped, product, upward_axis

# Contact points closer than this (m) to the plane of the payload's lower face are the payload standing.
_STANDING_DEPTH = 0.02


class Contacts(NamedTuple):
    """``pairs``: number of pairs of parts that touch; ``standing``: the payload stands on pad or ground.

    The payload standing, or at the pad with any of its faces, and UAVs in their cradles do not count as pairs; a part
    and its neighbour on the same link cannot touch.
    """

    pairs: int
    standing: bool


NO_CONTACTS, _STANDING = Contacts(0, False), Contacts(0, True)


class Ground:
    """Ground and pad in one physics client.

    Above ``standing_height`` (m) of its centre the payload cannot stand on anything, whatever its attitude.
    """

    def __init__(self, client: int, payload: PayloadHull, pad: PadSettings) -> None:
        # Rigid bodies: the engine spends more at each step on bases without links.
        plane = pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=client)
        ground = pybullet.createMultiBody(0.0, plane, useMaximalCoordinates=1, physicsClientId=client)
        x, y, _ = (np.ptp(payload.bounds, axis=0) / 2.0).tolist()
        half_extents = [x + pad.margin, y + pad.margin, pad.thickness / 2]
        north, east, _ = payload.bounds.mean(axis=0).tolist()
        box = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=half_extents, physicsClientId=client)
        middle = flipped((north, east, -pad.thickness / 2))
        stand = pybullet.createMultiBody(
            0.0, box, basePosition=middle, useMaximalCoordinates=1, physicsClientId=client
        )  # fmt: skip
        self._client = client
        self._ground, self._pad = ground, stand
        self._lower_face = payload.below - _STANDING_DEPTH  # m below the centre
        self.standing_height = pad.thickness + payload.reach + 0.05

    def contacts(self, system: Multibody, payload: Pose) -> Contacts:
        """Return the contacts of the last step; ``payload`` is the pose of its principal axes."""
        points = pybullet.getContactPoints(physicsClientId=self._client)
        if not points:
            return NO_CONTACTS
        body, ground, pad = system.body, self._ground, self._pad
        (x, y, z), attitude = payload
        up_x, up_y, up_z = upward_axis(product(attitude, system.payload_in_axes))
        lower_face = up_x * x + up_y * y + up_z * z - self._lower_face
        pairs: set[tuple[int, int, int, int]] = set()
        standing = False
        for _, body_a, body_b, link_a, link_b, on_a, on_b, _, distance, force, _, _, _, _ in points:
            if distance > 0.0 and force <= 0.0:
                continue
            if body_b == body and body_a != body_b:
                body_a, body_b, link_a, link_b, on_a = body_b, body_a, link_b, link_a, on_b
            of_payload, at_pad = link_a == -1, body_b == pad
            below = up_x * on_a[0] + up_y * on_a[1] + up_z * on_a[2] < lower_face
            if of_payload and below and (at_pad or body_b == ground):
                standing = True
            elif not (of_payload and at_pad):
                pairs.add((body_a, link_a, body_b, link_b))
        if not pairs:
            return _STANDING if standing else NO_CONTACTS
        return Contacts(len(pairs), standing)


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
        apart = time_apart(self._readings.states, self._attachments, bodies.centres, bodies.bounds, self._sizes)
        self._apart_until = steps + int(apart * physics_hz)
        self._travel_limit = self._obstacles.travelled + _OBSTACLES_MAY_TRAVEL
        self._next_look = max(self._apart_until, steps + _STEPS_BETWEEN_LOOKS)


# Upper bound of what a cradle bears (N): far above any load of this size of system.
_MAX_FORCE = 1e4


class Cradles:
    """One fixed constraint to the world for every UAV that is held, and for the payload that stands below them.

    A cradle opens when the upward part of the thrust exceeds the UAV's weight by a factor (the pull on the link is what
    keeps it upright) and closes again below the weight itself; the gap between the two prevents chatter. Between links
    whose UAVs are all held the engine lets a payload hang and stand at once, and leaning links would swing it up.
    """

    def __init__(
        self, client: int, body: int, links: Sequence[int], weights: Sequence[float], settings: CradleSettings
    ) -> None:
        """All UAVs are free at first; ``links`` are the engine's indices of them in ``body``, ``weights`` in N."""
        self._client = client
        self._body = body
        self._links = tuple(links)
        self._weights = tuple(weights)
        self._release_thrusts = [settings.release_factor * weight for weight in weights]
        self._latch_speed = settings.latch_speed
        self._constraints: list[int | None] = [None] * len(self._links)
        self._payload: int | None = None
        self.number_held = 0

    def held(self, i: int) -> bool:
        """Return True if UAV ``i`` (from 0) is held."""
        return self._constraints[i] is not None

    @property
    def all_held(self) -> bool:
        """True if every UAV is held."""
        return self.number_held == len(self._links)

    @property
    def payload_held(self) -> bool:
        """True if the payload is held, too."""
        return self._payload is not None

    def due(self, thrusts: Sequence[float], uavs: Uavs) -> list[int]:
        """Return the UAVs (from 0) to be released: held, lifting more than their weight; or latched: free, slow, less.

        ``thrusts`` in N, ``uavs`` as the engine gives them.
        """
        due = []
        for i, (_, (x, y, _, _), _, _, _, _, (v_x, v_y, v_z), _) in enumerate(uavs):
            upward = thrusts[i] * (1.0 - 2.0 * (x * x + y * y))
            if self._constraints[i] is not None:
                if upward > self._release_thrusts[i]:
                    due.append(i)
            elif upward < self._weights[i] and self.catches(math.sqrt(v_x * v_x + v_y * v_y + v_z * v_z)):
                due.append(i)
        return due

    def catches(self, speed: float) -> bool:
        """Return whether what moves with ``speed`` (m/s) can be held."""
        return speed < self._latch_speed

    def latch(self, i: int, position: Sequence[float], quaternion: Sequence[float]) -> None:
        """Hold UAV ``i`` at a pose, in the engine's frame and order."""
        if self._constraints[i] is None:
            self._constraints[i] = self._fixed(self._links[i], position, quaternion)
            self.number_held += 1

    def latch_payload(self, position: Sequence[float], quaternion: Sequence[float]) -> None:
        """Hold the payload at a pose of its principal axes, until the first UAV is released."""
        if self._payload is None:
            self._payload = self._fixed(-1, position, quaternion)

    def release(self, i: int) -> None:
        """Release UAV ``i``, and the payload."""
        constraint = self._constraints[i]
        if constraint is not None:
            self._remove(constraint)
            self._constraints[i] = None
            self.number_held -= 1
        if self._payload is not None:
            self._remove(self._payload)
            self._payload = None

    def _fixed(self, link: int, position: Sequence[float], quaternion: Sequence[float]) -> int:
        constraint: int = pybullet.createConstraint(
            self._body, link, -1, -1, pybullet.JOINT_FIXED, [0.0] * 3, [0.0] * 3, position,
            [0.0, 0.0, 0.0, 1.0], quaternion, physicsClientId=self._client,
        )  # fmt: skip
        pybullet.changeConstraint(constraint, maxForce=_MAX_FORCE, physicsClientId=self._client)
        return constraint

    def _remove(self, constraint: int) -> None:
        pybullet.removeConstraint(constraint, physicsClientId=self._client)
