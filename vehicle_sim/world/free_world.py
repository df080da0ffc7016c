"""The world without a payload: each UAV a body of its own, with ground and obstacles.

All that crosses this boundary is SI, north-east-down, forward-right-down, quaternions w first.
"""

import math
from collections.abc import Sequence

import numpy as np
import pybullet

from gcs.config.tables import UavConfig, WorldConfig
from idc_controller.arrays import Array
from idc_controller.rotations_float import Vector, into_body
from vehicle_sim.world.engine import EngineWorld
from vehicle_sim.world.errors import UnsupportedWorld
from vehicle_sim.world.ground import NO_CONTACTS, Contacts
from vehicle_sim.world.multibody import DISC_THICKNESS
from vehicle_sim.world.obstacle_bodies import ObstacleBodies
from vehicle_sim.world.sensors import ACCELEROMETER_RANGE
from vehicle_sim.world.state_kernels import STATE_COLUMNS
from vehicle_sim.world.world_state import FreeState, UavState, flipped, quaternion_from_engine, upward_axis

SPACING = 2.0
"""m between the places of neighbours: vehicle 1 stands at the origin, the others east of it."""

_ORIGIN = (0.0, 0.0, 0.0)
_LIFTED = 0.05  # m above the ground: it has taken off
_UPRIGHT = 0.5  # of the upward axis: it stands, and has not turned over


class FreeWorld(EngineWorld):
    """One simulated world of free UAVs, with the interface of :class:`~.world.World` as far as a swarm uses it.

    At the start they stand on the ground in a row, :data:`SPACING` apart, with yaw 0. Equal calls give equal results to
    the last bit on one machine. Raises :class:`UnsupportedWorld` for a UAV that the engine would compute wrongly.
    """

    def __init__(
        self,
        uav: UavConfig,
        vehicles: int,
        physics_hz: int = 500,
        gui: bool = False,
        settings: WorldConfig = WorldConfig(),
        g: float = 9.81,
    ) -> None:
        if 2.0 * max(uav.inertia) > sum(uav.inertia) * (1.0 + 1e-9):
            raise UnsupportedWorld(f"uav.inertia: no rigid body has the moments of inertia {list(uav.inertia)}")
        super().__init__(physics_hz, g, gui)
        self.g = g
        self._rest = settings.rest
        client = self._client
        try:
            plane = pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=client)
            self._ground = pybullet.createMultiBody(0.0, plane, useMaximalCoordinates=1, physicsClientId=client)
            disc = pybullet.createCollisionShape(
                pybullet.GEOM_CYLINDER, radius=uav.disc_radius, height=DISC_THICKNESS, physicsClientId=client
            )
            self._bodies = [self._add(uav, disc, i, settings.bodies.friction) for i in range(vehicles)]
            self.obstacles = ObstacleBodies(client)
        except BaseException:
            self.close()
            raise
        self.any_lifted = False
        """A vehicle has left the ground."""
        self._thrusts = (0.0,) * vehicles
        self._contacts = NO_CONTACTS
        self._states, self._changes = np.zeros((vehicles, STATE_COLUMNS)), np.zeros((vehicles, 3))
        self._velocities, self._felt_velocities = np.zeros((vehicles, 3)), np.zeros((vehicles, 3))
        self._felt_at = 0
        self._read()

    def _add(self, uav: UavConfig, shape: int, index: int, friction: float) -> int:
        place = flipped((0.0, index * SPACING, -DISC_THICKNESS / 2))
        client = self._client
        body: int = pybullet.createMultiBody(uav.mass, shape, basePosition=place, physicsClientId=client)
        pybullet.changeDynamics(
            body, -1, linearDamping=0.0, angularDamping=0.0, restitution=0.0, lateralFriction=friction,
            physicsClientId=client,
        )  # fmt: skip
        pybullet.changeDynamics(body, -1, localInertiaDiagonal=uav.inertia, physicsClientId=client)
        return body

    @property
    def at_rest(self) -> bool:
        """Return True if the rotors have run down and nothing moves any more."""
        if max(self._thrusts) > self._rest.thrust:
            return False
        return all(math.hypot(*row[7:10]) < self._rest.speed for row in self._states.tolist())

    def step(
        self,
        thrusts: Sequence[float],
        torques: Sequence[Sequence[float]],
        payload_force: Sequence[float] | None = None,
        uav_forces: Sequence[Sequence[float]] | None = None,
    ) -> None:
        """Advance by one physics step, everything held over it; arguments as those of :meth:`.World.step`.

        There is no payload on which ``payload_force`` could act.
        """
        client, bodies = self._client, self._bodies
        for body, thrust, (x, y, z) in zip(bodies, thrusts, torques, strict=True):
            pybullet.applyExternalForce(body, -1, (0.0, 0.0, thrust), _ORIGIN, pybullet.LINK_FRAME, client)
            pybullet.applyExternalTorque(body, -1, (x, -y, -z), pybullet.LINK_FRAME, client)
        if uav_forces is not None:
            for body, force in zip(bodies, uav_forces, strict=True):
                place = pybullet.getBasePositionAndOrientation(body, client)[0]
                pybullet.applyExternalForce(body, -1, flipped(force), place, pybullet.WORLD_FRAME, client)
        pybullet.stepSimulation(client)
        self.steps += 1
        self._thrusts = tuple(thrusts)
        self._read()

    def states(self) -> Array:
        """Return the true states of the UAVs after the last step, (N, 13) as in :mod:`.state_kernels`."""
        return self._states

    @property
    def thrusts(self) -> tuple[float, ...]:
        """The UAVs' thrusts of the last step (N)."""
        return self._thrusts

    def state(self, states: Array | None = None) -> FreeState:
        """Return the true state after the last step; ``states`` as :meth:`states` gave them after it."""
        uavs = []
        for row, thrust in zip((self._states if states is None else states).tolist(), self._thrusts, strict=True):
            x, y, z, q_w, q_x, q_y, q_z, v_x, v_y, v_z, p, q, r = row
            uavs.append(UavState((x, y, z), (q_w, q_x, q_y, q_z), (v_x, v_y, v_z), (p, q, r), thrust, False))
        return FreeState(self.time, tuple(uavs))

    def contacts(self) -> Contacts:
        """Return what touches after the last step. A UAV that stands upright on the ground does not count as a pair."""
        return self._contacts

    def specific_forces(self) -> list[Vector]:
        """Return what the accelerometers measured since the last call (N), in the bodies' frames (m/s2), no noise."""
        rate = self.physics_hz / max(self.steps - self._felt_at, 1)
        changes = ((self._velocities - self._felt_velocities) * rate).tolist()
        self._felt_at, self._felt_velocities = self.steps, self._velocities
        attitudes = self._states[:, 3:7].tolist()
        return [
            into_body((w, q_x, q_y, q_z), (x, y, z - self.g))
            for (w, q_x, q_y, q_z), (x, y, z) in zip(attitudes, changes, strict=True)
        ]

    def clipped(self) -> Sequence[int]:
        """Return whose accelerometer exceeded its range in the last step, 1 .. N: without contact nobody's."""
        if self._contacts is NO_CONTACTS:
            return ()
        rate, g = self.physics_hz, self.g
        changes = enumerate(self._changes.tolist(), start=1)
        return [i for i, (x, y, z) in changes if math.hypot(x * rate, y * rate, z * rate - g) > ACCELEROMETER_RANGE]

    def _read(self) -> None:
        """Read the state after a step.

        The engine is a leapfrog: its velocities are half a step older than its poses, and are brought forward by half
        of their last change while nothing touches.
        """
        client = self._client
        self._contacts = self._touching()
        lead = 0.5 if self.steps and self._contacts is NO_CONTACTS else 0.0
        states, velocities = np.empty_like(self._states), []
        for i, body in enumerate(self._bodies):
            place, turn = pybullet.getBasePositionAndOrientation(body, client)
            velocity, spin = (flipped(v) for v in pybullet.getBaseVelocity(body, client))
            attitude = quaternion_from_engine(turn)
            states[i] = *flipped(place), *attitude, *velocity, *into_body(attitude, spin)
            velocities.append(velocity)
            self.any_lifted = self.any_lifted or place[2] > DISC_THICKNESS / 2 + _LIFTED
        now = np.array(velocities)
        self._changes = now - self._velocities
        self._velocities = now
        states[:, 7:10] += lead * self._changes
        self._states = states

    def _touching(self) -> Contacts:
        pairs: set[tuple[int, int]] = set()
        standing = False
        for _, body_a, body_b, _, _, _, _, _, distance, force, *_ in pybullet.getContactPoints(
            physicsClientId=self._client
        ):
            if distance > 0.0 and force <= 0.0:
                continue
            if self._ground in (body_a, body_b) and self._stands(body_a if body_b == self._ground else body_b):
                standing = True
            else:
                pairs.add((min(body_a, body_b), max(body_a, body_b)))
        return Contacts(len(pairs), standing) if pairs or standing else NO_CONTACTS

    def _stands(self, body: int) -> bool:
        turn = pybullet.getBasePositionAndOrientation(body, self._client)[1]
        return upward_axis(turn)[2] > _UPRIGHT
