"""Cradles: what holds a UAV on top of its link while its own thrust does not."""

import math
from collections.abc import Sequence

import pybullet

from gcs.config.tables import CradleSettings
from vehicle_sim.world.readings import Uavs

# Upper bound of what a cradle bears (N): far above any load of this size of system.
_MAX_FORCE = 1e4


class Cradles:
    """One fixed constraint to the world for every UAV that is held.

    A cradle opens when the upward part of the thrust exceeds the UAV's weight by a factor (the pull on the link is what
    keeps it upright) and closes again below the weight itself; the gap between the two prevents chatter.
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
        self.number_held = 0

    def held(self, i: int) -> bool:
        """Return True if UAV ``i`` (from 0) is held."""
        return self._constraints[i] is not None

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
            elif upward < self._weights[i] and math.sqrt(v_x * v_x + v_y * v_y + v_z * v_z) < self._latch_speed:
                due.append(i)
        return due

    def latch(self, i: int, position: Sequence[float], quaternion: Sequence[float]) -> None:
        """Hold UAV ``i`` at a pose, in the engine's frame and order."""
        if self._constraints[i] is not None:
            return
        constraint = pybullet.createConstraint(
            self._body, self._links[i], -1, -1, pybullet.JOINT_FIXED, [0.0] * 3, [0.0] * 3, position,
            [0.0, 0.0, 0.0, 1.0], quaternion, physicsClientId=self._client,
        )  # fmt: skip
        pybullet.changeConstraint(constraint, maxForce=_MAX_FORCE, physicsClientId=self._client)
        self._constraints[i] = constraint
        self.number_held += 1

    def release(self, i: int) -> None:
        """Release UAV ``i``."""
        constraint = self._constraints[i]
        if constraint is not None:
            pybullet.removeConstraint(constraint, physicsClientId=self._client)
            self._constraints[i] = None
            self.number_held -= 1
