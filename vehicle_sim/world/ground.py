"""Ground and pad, and what touches what."""

from typing import NamedTuple

import numpy as np
import pybullet

from gcs.config.tables import PadSettings
from idc_controller.payload_hull import PayloadHull
from idc_controller.rotations_float import into_body
from vehicle_sim.world.multibody import Multibody
from vehicle_sim.world.world_state import flipped, product, quaternion_from_engine

# Contact points closer than this (m) to the plane of the payload's lower face are the payload standing.
_STANDING_DEPTH = 0.02

Pose = tuple[tuple[float, float, float], tuple[float, float, float, float]]
"""Position and x-first quaternion in the engine's frame."""


class Contacts(NamedTuple):
    """``pairs``: number of pairs of parts that touch; ``standing``: the payload stands on pad or ground.

    The payload standing and UAVs in their cradles do not count as pairs; a part and its neighbour on the same link
    cannot touch.
    """

    pairs: int
    standing: bool


NO_CONTACTS = Contacts(0, False)


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
        self._bodies = ground, stand
        self._lower_face = payload.below - _STANDING_DEPTH
        self.standing_height = pad.thickness + payload.reach + 0.05

    def is_near(self, payload: Pose) -> bool:
        """Return True for a payload low enough to stand on pad or ground."""
        return payload[0][2] <= self.standing_height

    def contacts(self, system: Multibody, payload: Pose) -> Contacts:
        """Return the contacts of the last step; ``payload`` is the pose of its principal axes."""
        points = pybullet.getContactPoints(physicsClientId=self._client)
        if not points:
            return NO_CONTACTS
        payload = payload[0], product(payload[1], system.payload_in_axes)
        pairs: set[tuple[int, int, int, int]] = set()
        standing = False
        for _, body_a, body_b, link_a, link_b, on_a, on_b, _, distance, force, *_ in points:
            if distance > 0.0 and force <= 0.0:
                continue
            if body_b == system.body and body_a != body_b:
                body_a, body_b, link_a, link_b, on_a, on_b = body_b, body_a, link_b, link_a, on_b, on_a
            if link_a == -1 and body_b in self._bodies and self._is_in_lower_face(payload, on_a):
                standing = True
            else:
                pairs.add((body_a, link_a, body_b, link_b))
        return Contacts(len(pairs), standing)

    def _is_in_lower_face(self, payload: Pose, point: tuple[float, float, float]) -> bool:
        """Return True for a ``point`` (engine's frame) in the payload's lower face."""
        position, quaternion = payload
        offset = flipped((point[0] - position[0], point[1] - position[1], point[2] - position[2]))
        down = into_body(quaternion_from_engine(quaternion), offset)[2]
        return down > self._lower_face
