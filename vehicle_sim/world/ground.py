"""Ground and pad, and what touches what."""

from typing import NamedTuple

import numpy as np
import pybullet

from gcs.config.tables import PadSettings
from idc_controller.parameters import PayloadHull
from vehicle_sim.world.multibody import Multibody
from vehicle_sim.world.world_state import flipped, product, upward_axis

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
        self._bodies = ground, stand
        self._lower_face = payload.below - _STANDING_DEPTH  # m below the centre
        self.standing_height = pad.thickness + payload.reach + 0.05

    def is_near(self, payload: Pose) -> bool:
        """Return True for a payload low enough to stand on pad or ground."""
        return payload[0][2] <= self.standing_height

    def contacts(self, system: Multibody, payload: Pose) -> Contacts:
        """Return the contacts of the last step; ``payload`` is the pose of its principal axes."""
        points = pybullet.getContactPoints(physicsClientId=self._client)
        if not points:
            return NO_CONTACTS
        body, grounds = system.body, self._bodies
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
            is_of_payload = link_a == -1 and body_b in grounds
            if is_of_payload and up_x * on_a[0] + up_y * on_a[1] + up_z * on_a[2] < lower_face:
                standing = True
            else:
                pairs.add((body_a, link_a, body_b, link_b))
        if not pairs:
            return _STANDING if standing else NO_CONTACTS
        return Contacts(len(pairs), standing)
