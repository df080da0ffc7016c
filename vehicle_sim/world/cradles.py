"""Cradles: what holds a UAV on top of its link while its own thrust does not."""

from __future__ import annotations

from collections.abc import Sequence

import pybullet

# A cradle lets go when the thrust's upward part exceeds the UAV's weight by this factor (the pull on the link is what
# keeps it upright) and takes hold again below the weight itself; the gap between the two prevents chatter.
RELEASE_FACTOR = 1.05
# A UAV faster than this (m/s) is not caught.
LATCH_SPEED = 0.3
# Upper bound of what a cradle bears (N): far above any load of this size of system.
_MAX_FORCE = 1e4


class Cradles:
    """One fixed constraint to the world for every UAV that is held.

    ``links`` are the engine's indices of the UAVs in ``body``, ``weights`` theirs (N). All are free at first.
    """

    def __init__(self, client: int, body: int, links: Sequence[int], weights: Sequence[float]) -> None:
        self._client = client
        self._body = body
        self._links = tuple(links)
        self._weights = tuple(weights)
        self._constraints: list[int | None] = [None] * len(self._links)
        self.number_held = 0

    def held(self, i: int) -> bool:
        """Whether UAV ``i`` (from 0) is held."""
        return self._constraints[i] is not None

    def wants_release(self, i: int, upward_thrust: float) -> bool:
        """Whether UAV ``i`` is held and lifts (``upward_thrust`` in N) more than its own weight."""
        return self._constraints[i] is not None and upward_thrust > RELEASE_FACTOR * self._weights[i]

    def wants_latch(self, i: int, upward_thrust: float, speed: float) -> bool:
        """Whether UAV ``i`` is free, slow (m/s) and lifts less than its own weight."""
        return self._constraints[i] is None and upward_thrust < self._weights[i] and speed < LATCH_SPEED

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
