"""The physics engine of one world: opened, stepped at one rate, closed."""

from typing import Self

import pybullet

from vehicle_sim.world.errors import SimulationError


class EngineWorld:
    """What every simulated world has of the engine: a client of its own, gravity, and its steps.

    ``physics_hz`` steps a second, ``steps`` so far. A context manager. Several worlds may live in one process.
    """

    def __init__(self, physics_hz: int, g: float, gui: bool) -> None:
        """``g`` in m/s2; ``gui`` with the engine's window. Raises :class:`SimulationError`."""
        if physics_hz <= 0:
            raise SimulationError(f"physics_hz must be positive, got {physics_hz}")
        self.physics_hz = physics_hz
        self.steps = 0
        self._client = client = pybullet.connect(pybullet.GUI if gui else pybullet.DIRECT)
        if client < 0:
            raise SimulationError("the physics engine does not start" + (" (is there a display?)" if gui else ""))
        pybullet.setGravity(0.0, 0.0, -g, physicsClientId=client)
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=1.0 / physics_hz, numSubSteps=0, deterministicOverlappingPairs=1, physicsClientId=client
        )

    @property
    def time(self) -> float:
        """Seconds since the world was made."""
        return self.steps / self.physics_hz

    def close(self) -> None:
        """End the world; harmless when it has ended."""
        if self._client >= 0:
            pybullet.disconnect(self._client)
            self._client = -1

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
