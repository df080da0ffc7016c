"""The world: payload, links and UAVs in PyBullet, with ground, pad, cradles and obstacles.

All that crosses this boundary is SI, north-east-down, forward-right-down, quaternions w first.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pybullet

from idc_controller.geometry.shape import Shape
from idc_controller.model.nonlinear import SystemState
from idc_controller.parameters import SystemParameters
from idc_controller.rotations_float import Vector, into_body
from vehicle_sim.world.cradles import Cradles
from vehicle_sim.world.errors import SimulationError
from vehicle_sim.world.multibody import check_supported, load_multibody
from vehicle_sim.world.obstacle_bodies import Obstacle, ObstacleBodies
from vehicle_sim.world.world_state import UavState, WorldState, flipped, quaternion_from_engine, quaternion_to_engine

PAD_THICKNESS = 0.05  # m
PAD_MARGIN = 0.25  # m, by which the pad is larger than the payload on every side

# Contact points closer than this (m) to the plane of the payload's lower face are the payload standing.
_STANDING_DEPTH = 0.02
_ORIGIN = (0.0, 0.0, 0.0)


class World:
    """One simulated world; several may live in one process. Use it as a context manager or call :meth:`close`.

    At the start the payload stands on a pad at the origin, level, links upright, each UAV on top of its link in a
    cradle. A cradle lets go when its UAV's thrust lifts more than the UAV's own weight, and takes hold again, where
    the UAV is then, once the payload stands on pad or ground, or hangs low on the links of UAVs that are held, and the
    UAV is slow and no longer lifts its weight.

    ``physics_hz`` steps a second. Equal calls give equal results to the last bit on one machine.
    Raises :class:`~vehicle_sim.world.errors.UnsupportedWorld` for a system that the engine would compute wrongly.
    """

    def __init__(self, parameters: SystemParameters, physics_hz: int = 500, gui: bool = False) -> None:
        if physics_hz <= 0:
            raise SimulationError(f"physics_hz must be positive, got {physics_hz}")
        check_supported(parameters)
        self.parameters = parameters
        self.physics_hz = physics_hz
        self.number_of_uavs = parameters.number_of_uavs
        self._client = pybullet.connect(pybullet.GUI if gui else pybullet.DIRECT)
        if self._client < 0:
            raise SimulationError("the physics engine does not start" + (" (is there a display?)" if gui else ""))
        try:
            self._build()
        except BaseException:
            self.close()
            raise

    def _build(self) -> None:
        parameters, client = self.parameters, self._client
        pybullet.setGravity(0.0, 0.0, -parameters.g, physicsClientId=client)
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=1.0 / self.physics_hz, numSubSteps=0, deterministicOverlappingPairs=1,
            physicsClientId=client,
        )  # fmt: skip
        length, width, height = (float(edge) for edge in parameters.payload_size)
        plane = pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=client)
        self._ground = pybullet.createMultiBody(0.0, plane, physicsClientId=client)
        pad = pybullet.createCollisionShape(
            pybullet.GEOM_BOX, physicsClientId=client,
            halfExtents=[length / 2 + PAD_MARGIN, width / 2 + PAD_MARGIN, PAD_THICKNESS / 2],
        )  # fmt: skip
        self._pad = pybullet.createMultiBody(
            0.0, pad, basePosition=(0.0, 0.0, PAD_THICKNESS / 2), physicsClientId=client
        )
        self._system = load_multibody(client, parameters, (0.0, 0.0, PAD_THICKNESS + height / 2))
        self._obstacles = ObstacleBodies(client)
        weights = [float(m_i) * parameters.g for m_i in parameters.m]
        self._cradles = Cradles(client, self._system.body, self._system.uavs, weights)
        self._half_height = height / 2
        # Above this height of its centre the payload cannot stand on anything, whatever its attitude.
        self._standing_height = PAD_THICKNESS + float(np.linalg.norm(parameters.payload_size)) / 2 + 0.05
        self._steps = 0
        self._thrusts = (0.0,) * self.number_of_uavs
        self._contact_cache: tuple[int, bool] | None = None
        self._read()
        for i, uav in enumerate(self._uav_states):
            self._cradles.latch(i, uav[0], uav[1])

    @property
    def time(self) -> float:
        """Seconds since the world was made."""
        return self._steps / self.physics_hz

    def step(
        self,
        thrusts: Sequence[float],
        torques: Sequence[Sequence[float]],
        payload_force: Sequence[float] | None = None,
        uav_forces: Sequence[Sequence[float]] | None = None,
    ) -> None:
        """Advance by one physics step, everything held over it.

        ``thrusts`` N numbers (N) along -z of the UAVs; ``torques`` N triples in the UAVs' frames (N m);
        ``payload_force`` (3,) and ``uav_forces`` N triples: external forces at the centres of mass, NED (N); without
        effect while all UAVs are in their cradles. Plain floats are faster than arrays.

        The engine integrates semi-implicitly: inputs sampled at the beginning of a step give positions of second
        order at its end, with velocities that belong to half a step earlier; :meth:`state` brings those forward.
        """
        client, body, uavs = self._client, self._system.body, self._system.uavs
        apply_force, apply_torque = pybullet.applyExternalForce, pybullet.applyExternalTorque
        self._update_cradles(thrusts)
        link_frame, world_frame = pybullet.LINK_FRAME, pybullet.WORLD_FRAME
        for i, uav in enumerate(uavs):
            apply_force(body, uav, (0.0, 0.0, thrusts[i]), _ORIGIN, link_frame, client)
            x, y, z = torques[i]
            apply_torque(body, uav, (x, -y, -z), link_frame, client)
        if self._cradles.number_held == self.number_of_uavs:
            # A payload between held links hangs as much as it stands: wind would swing what the ground should hold.
            payload_force = uav_forces = None
        if uav_forces is not None:
            for uav, force, state in zip(uavs, uav_forces, self._uav_states, strict=True):
                apply_force(body, uav, flipped(force), state[0], world_frame, client)
        if payload_force is not None:
            apply_force(body, -1, flipped(payload_force), self._payload_pose[0], world_frame, client)
        pybullet.stepSimulation(client)
        self._steps += 1
        self._thrusts = tuple(thrusts)
        before = self._payload_velocity, self._uav_states
        self._read()
        self._before = before

    def set_payload_mass(self, mass: float) -> None:
        """Make the payload weigh ``mass`` (kg) from the next step on; its inertia changes in proportion."""
        parameters, client, body = self.parameters, self._client, self._system.body
        share = mass / parameters.m_0
        pybullet.changeDynamics(body, -1, mass=mass, physicsClientId=client)
        # After the mass: with that alone the engine takes the inertia of a homogeneous box.
        inertia = tuple(share * float(J) for J in np.diag(parameters.J_0))
        pybullet.changeDynamics(body, -1, localInertiaDiagonal=inertia, physicsClientId=client)

    def state(self) -> WorldState:
        """The true state after the last step: velocities, too, to second order."""
        position, quaternion = self._payload_pose
        payload_quaternion = quaternion_from_engine(quaternion)
        (velocity_before, rates_before), uavs_before = self._before
        velocity = _half_a_step_on(velocity_before, self._payload_velocity[0])
        rates = _half_a_step_on(rates_before, self._payload_velocity[1])
        held = self._cradles.held
        uavs = []
        for i, (before, link) in enumerate(zip(uavs_before, self._uav_states, strict=True)):
            attitude = quaternion_from_engine(link[1])
            uav_velocity = _half_a_step_on(before[6], link[6])
            uav_rates = _half_a_step_on(before[7], link[7])
            uavs.append(
                UavState(
                    flipped(link[0]), attitude, flipped(uav_velocity), into_body(attitude, flipped(uav_rates)),
                    self._thrusts[i], held(i),
                )
            )  # fmt: skip
        return WorldState(
            self._steps / self.physics_hz, flipped(position), payload_quaternion, flipped(velocity),
            into_body(payload_quaternion, flipped(rates)), tuple(uavs),
        )  # fmt: skip

    def contacts(self) -> int:
        """Number of pairs of parts that touch after the last step.

        The payload standing on pad or ground and UAVs in their cradles do not count; a part and its neighbour on
        the same link cannot touch.
        """
        return self._contacts_and_standing()[0]

    def touching_ground(self) -> bool:
        """Whether the payload stands on pad or ground."""
        if self._payload_pose[0][2] > self._standing_height:
            return False
        return self._contacts_and_standing()[1]

    def add_obstacle(self, name: str, shape: Shape, position_in_world: Sequence[float]) -> None:
        """Add an obstacle, its centre (3,) in NED (m). Raises :class:`SimulationError`."""
        x, y, z = (float(value) for value in position_in_world)
        self._obstacles.add(Obstacle(name, shape, (x, y, z)))

    def move_obstacle(self, name: str, position_in_world: Sequence[float]) -> None:
        """Put an obstacle elsewhere, its centre (3,) in NED (m); it counts from the next step on."""
        self._obstacles.move(name, position_in_world)

    def obstacles(self) -> tuple[Obstacle, ...]:
        """The obstacles at the current time."""
        return self._obstacles.all()

    def closest_distance(self, obstacle: str, within: float = 100.0) -> float:
        """Distance between an obstacle's surface and the nearest part of payload, links and discs (m).

        Negative: they overlap. ``inf`` if nothing is nearer than ``within`` (m).
        """
        points = pybullet.getClosestPoints(
            self._system.body, self._obstacles.body(obstacle), within, physicsClientId=self._client
        )
        return min((point[8] for point in points), default=float("inf"))

    def place(self, state: SystemState) -> None:
        """Put the system into ``state``, cradles open: to begin in flight.

        As the engine integrates, the velocities are those of half a step earlier.
        """
        client, system = self._client, self._system
        R_0 = state.R_0
        payload_quaternion = quaternion_to_engine(state.quaternion_0.tolist())
        pybullet.resetBasePositionAndOrientation(
            system.body, flipped(state.r_0.tolist()), payload_quaternion, physicsClientId=client
        )
        pybullet.resetBaseVelocity(
            system.body, flipped(state.r_0_dot.tolist()), flipped((R_0 @ state.omega_0).tolist()),
            physicsClientId=client,
        )  # fmt: skip
        for i in range(self.number_of_uavs):
            self._cradles.release(i)
            x, y, z = flipped((-state.q[i]).tolist())
            # The shortest turn from straight up to the link's direction; none is unique for straight down.
            turn = np.array([-y, x, 0.0, 1.0 + z]) if z > -1.0 + 1e-12 else np.array([1.0, 0.0, 0.0, 0.0])
            link_in_payload = (turn / np.linalg.norm(turn)).tolist()
            link_quaternion = _product(payload_quaternion, link_in_payload)
            link_rates = state.Omega[i] - state.omega_0
            uav_quaternion = quaternion_to_engine(state.quaternion[i].tolist())
            uav_rates = state.R[i] @ state.omega[i] - R_0 @ state.Omega[i]
            # A spherical joint's rates are those of the child against the parent, in the child's frame.
            pybullet.resetJointStateMultiDof(
                system.body, system.links[i], link_in_payload,
                _rotate_back(link_in_payload, flipped(link_rates.tolist())), physicsClientId=client,
            )  # fmt: skip
            pybullet.resetJointStateMultiDof(
                system.body, system.uavs[i], _product(_conjugate(link_quaternion), uav_quaternion),
                _rotate_back(uav_quaternion, flipped(uav_rates.tolist())), physicsClientId=client,
            )  # fmt: skip
        self._read()

    def close(self) -> None:
        """End the world; harmless when it has ended."""
        if self._client >= 0:
            pybullet.disconnect(self._client)
            self._client = -1

    def __enter__(self) -> World:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _read(self) -> None:
        """Fetch poses and velocities from the engine.

        Forward kinematics is requested: without it links are one step behind the payload, and so are the frames in
        which the engine takes the next forces. Hence after every step, whether anybody looks at the state or not.
        """
        body, client = self._system.body, self._client
        self._uav_states = pybullet.getLinkStates(body, self._system.uavs, 1, 1, client)
        self._payload_pose = pybullet.getBasePositionAndOrientation(body, client)
        self._payload_velocity = pybullet.getBaseVelocity(body, client)
        self._before = self._payload_velocity, self._uav_states
        self._contact_cache = None

    def _update_cradles(self, thrusts: Sequence[float]) -> None:
        cradles = self._cradles
        low = self._payload_pose[0][2] <= self._standing_height
        if not low and cradles.number_held == 0:
            return
        for i, link in enumerate(self._uav_states):
            x, y, _, _ = link[1]
            upward = thrusts[i] * (1.0 - 2.0 * (x * x + y * y))
            if cradles.wants_release(i, upward):
                cradles.release(i)
            elif low:
                a, b, c = link[6]
                # A payload that has been caught by some hangs on their links as well as it stands.
                is_supported = cradles.number_held > 0 or self.touching_ground()
                if is_supported and cradles.wants_latch(i, upward, (a * a + b * b + c * c) ** 0.5):
                    cradles.latch(i, link[0], link[1])

    def _contacts_and_standing(self) -> tuple[int, bool]:
        """Number of touching pairs, and whether the payload stands; computed once a step."""
        if self._contact_cache is None:
            pairs: set[tuple[int, int, int, int]] = set()
            standing = False
            points = pybullet.getContactPoints(physicsClientId=self._client)
            for _, body_a, body_b, link_a, link_b, on_a, on_b, _, distance, force, *_ in points:
                if distance > 0.0 and force <= 0.0:
                    continue
                if body_b == self._system.body and body_a != body_b:
                    body_a, body_b, link_a, link_b, on_a, on_b = body_b, body_a, link_b, link_a, on_b, on_a
                if link_a == -1 and body_b in (self._ground, self._pad) and self._below_payload(on_a):
                    standing = True
                else:
                    pairs.add((body_a, link_a, body_b, link_b))
            self._contact_cache = (len(pairs), standing)
        return self._contact_cache

    def _below_payload(self, point: Sequence[float]) -> bool:
        """Whether a point (engine's frame) lies in the payload's lower face."""
        position, quaternion = self._payload_pose
        offset: Vector = flipped((point[0] - position[0], point[1] - position[1], point[2] - position[2]))
        down = into_body(quaternion_from_engine(quaternion), offset)[2]
        return down > self._half_height - _STANDING_DEPTH


def _half_a_step_on(before: Sequence[float], now: Sequence[float]) -> Vector:
    """A velocity at the end of a step, from those of the middles of the last two steps."""
    x, y, z = now
    a, b, c = before
    return (x + 0.5 * (x - a), y + 0.5 * (y - b), z + 0.5 * (z - c))


def _product(a: Sequence[float], b: Sequence[float]) -> list[float]:
    """Product of two x-first quaternions."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ]


def _conjugate(q: Sequence[float]) -> list[float]:
    return [-q[0], -q[1], -q[2], q[3]]


def _rotate_back(q: Sequence[float], v: Sequence[float]) -> list[float]:
    """``v`` seen from the frame of the x-first quaternion ``q``."""
    return list(into_body((q[3], q[0], q[1], q[2]), (v[0], v[1], v[2])))
