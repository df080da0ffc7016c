"""What the tests of the PyBullet world share."""

from dataclasses import replace

import numpy as np
from paper_system import system

from idc_controller.rotations import quaternion_product, rotation_from_quaternion

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


def link_lengths(parameters, state):
    R_0 = rotation_from_quaternion(state.payload_quaternion)
    attachments = state.payload_position_in_world + parameters.p @ R_0.T
    return np.linalg.norm(uav_array(state, "position_in_world") - attachments, axis=1)


def run(world, seconds, thrusts, torques=None):
    torques = torques or [(0.0, 0.0, 0.0)] * world.number_of_uavs
    for _ in range(round(seconds * world.physics_hz)):
        world.step(thrusts, torques)
    return world.state()
