"""Helpers shared by the tests of the PyBullet world."""

import math
from dataclasses import replace

import numpy as np
import pybullet
from paper_system import system
from quaternions import quaternion_product

from gcs.config.tables import WorldConfig
from idc_controller.model.nonlinear import accelerations
from idc_controller.rotations import rotation_from_quaternion
from idc_controller.rotations_float import into_body
from vehicle_sim.world.ground import ContactDetector
from vehicle_sim.world.world_state import flipped, quaternion_to_engine

STANDING_ON_PAD = -0.30
STANDING_ON_GROUND = -0.25


def unequal():
    """Three different UAVs, links and attachment points, unequal moments of inertia."""
    return replace(
        system(3), m=np.array([0.7, 0.9, 0.6]), l=np.array([3.2, 2.8, 3.0]), J_0=np.diag([0.2, 0.35, 0.5]),
        p=np.array([[0.5, 0.1, -0.25], [-0.4, 0.45, -0.2], [-0.3, -0.6, -0.25]]),
        J=np.array([np.diag(d) for d in ([0.01, 0.012, 0.02], [0.01, 0.01, 0.01], [0.015, 0.01, 0.02])]),
    )  # fmt: skip


def uav_array(state, field):
    return np.array([getattr(uav, field) for uav in state.uavs])


def angle_between(a, b):
    """Angle of the rotation between two w-first quaternions (deg)."""
    difference = quaternion_product(np.multiply(a, [1, -1, -1, -1]), b)
    return np.degrees(2 * np.arctan2(np.linalg.norm(difference[1:]), abs(difference[0])))


def run(world, seconds, thrusts, torques=None):
    torques = torques or [(0.0, 0.0, 0.0)] * world.parameters.number_of_uavs
    for _ in range(round(seconds * world.physics_hz)):
        world.step(thrusts, torques)
    return world.state()


def closest_distance(world, obstacle, within=100.0):
    """Distance (m) from an obstacle's surface to payload, links and discs; negative: overlap; inf: not within."""
    points = pybullet.getClosestPoints(
        world._system.body, world.obstacles._body(obstacle).handle, within, physicsClientId=world._client
    )
    return min((point[8] for point in points), default=math.inf)


def half_a_step_earlier(parameters, state, inputs, step):
    """Return ``state`` with the velocities that follow from its poses and generalised velocities of half a step ago.

    ``step`` in s. The generalised velocities are the payload's in the world and the joints' in the child's frame: by
    how much the parts' velocities change while those are constant is not taken back.
    """
    half, R_0, R = 0.5 * step, state.R_0, rotation_from_quaternion(state.quaternion)
    second = accelerations(parameters, state, inputs)
    payload, links = R_0 @ state.omega_0, state.Omega @ R_0.T
    products = np.cross(payload, links) + np.cross(links, np.einsum("ijk,ik->ij", R, state.omega))
    return replace(
        state, r_0_dot=state.r_0_dot - half * second.r_0_ddot, omega_0=state.omega_0 - half * second.omega_0_dot,
        Omega=state.Omega - half * second.Omega_dot,
        omega=state.omega - half * (second.omega_dot - np.einsum("ikj,ik->ij", R, products)),
    )  # fmt: skip


def place(world, state, inputs=None):
    """Put the system into ``state``, cradles open: to begin in flight.

    The engine begins with generalised velocities of half a step earlier. They follow from those of ``state`` and from
    the accelerations under ``inputs``, which are to act in the first step; without them nothing accelerates.
    """
    if inputs is not None:
        state = half_a_step_earlier(world.parameters, state, inputs, 1.0 / world.physics_hz)
    client, system = world._client, world._system
    R_0 = state.R_0
    payload_quaternion = quaternion_to_engine(state.quaternion_0.tolist())
    pybullet.resetBasePositionAndOrientation(
        system.body, flipped(state.r_0.tolist()),
        _product(payload_quaternion, _conjugate(system.payload_in_axes)), physicsClientId=client,
    )  # fmt: skip
    pybullet.resetBaseVelocity(
        system.body, flipped(state.r_0_dot.tolist()), flipped((R_0 @ state.omega_0).tolist()),
        physicsClientId=client,
    )  # fmt: skip
    for i in range(world.parameters.number_of_uavs):
        world._cradles.release(i)
        x, y, z = flipped((-state.q[i]).tolist())
        # The shortest turn from straight up to the link's direction; none is unique for straight down.
        turn = np.array([-y, x, 0.0, 1.0 + z]) if z > -1.0 + 1e-12 else np.array([1.0, 0.0, 0.0, 0.0])
        link_in_payload = (turn / np.linalg.norm(turn)).tolist()
        link_quaternion = _product(payload_quaternion, link_in_payload)
        link_rates = state.Omega[i] - state.omega_0
        uav_quaternion = quaternion_to_engine(state.quaternion[i].tolist())
        uav_rates = rotation_from_quaternion(state.quaternion[i]) @ state.omega[i] - R_0 @ state.Omega[i]
        # A spherical joint's rates are those of the child against the parent, in the child's frame.
        pybullet.resetJointStateMultiDof(
            system.body, system.links[i], link_in_payload,
            _rotate_back(link_in_payload, flipped(link_rates.tolist())), physicsClientId=client,
        )  # fmt: skip
        pybullet.resetJointStateMultiDof(
            system.body, system.uavs[i], _product(_conjugate(link_quaternion), uav_quaternion),
            _rotate_back(uav_quaternion, flipped(uav_rates.tolist())), physicsClientId=client,
        )  # fmt: skip
    world._readings.update()
    world._readings.restart()
    world._contacts = ContactDetector(
        world.parameters, WorldConfig(), system, world._ground, world.obstacles, world._readings
    )


def _product(a, b):
    """Product of two x-first quaternions."""
    x, y, z, w = quaternion_product(np.roll(a, 1), np.roll(b, 1))[[1, 2, 3, 0]].tolist()
    return [x, y, z, w]


def _conjugate(q):
    return [-q[0], -q[1], -q[2], q[3]]


def _rotate_back(q, v):
    """``v`` in the frame of the x-first quaternion ``q``."""
    return list(into_body((q[3], q[0], q[1], q[2]), tuple(v)))
