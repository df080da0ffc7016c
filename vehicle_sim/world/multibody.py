"""Payload, links and UAVs as one PyBullet multibody: payload -> spherical -> link -> spherical -> UAV.

The body frames in the engine are forward-left-up, with their origin at the centre of mass; a link's frame has its
origin at the attachment point and its z axis along the link, towards the UAV.
"""

import tempfile
from collections.abc import Sequence
from itertools import permutations
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pybullet
from scipy.spatial import ConvexHull, HalfspaceIntersection
from scipy.spatial.transform import Rotation

from gcs.config.tables import BodySettings
from idc_controller.arrays import Array
from idc_controller.parameters import PayloadHull, SystemParameters
from vehicle_sim.world.errors import UnsupportedWorld

# PyBullet exchanges at most 128 coordinates a body (MAX_DEGREE_OF_FREEDOM) and is silently wrong beyond:
# 7 for the payload's pose, a quaternion for each of the two joints of every UAV.
MAX_COORDINATES = 128
MAX_VEHICLES = (MAX_COORDINATES - 7) // 8

DISC_THICKNESS = 0.04  # m, of the UAVs' collision shape
PAYLOAD_FILE = "payload.obj"
_HULL_MARGIN = 0.001  # m, that the engine adds about a hull; unlike a box's it lies outside

# A link without mass needs some inertia, or the engine diverges; 1e-6 kg m2 across it is below any measurable effect.
# Along its axis, where no joint or force turns it, more costs nothing: it keeps contacts from spinning the link up
# without bound. Together with links that have no friction, this is what lets a toppled system come to rest; with
# either missing it flies apart. The engine's reader rejects such a pair as no rigid body's: set after loading.
_LINK_INERTIA = 1e-6
_LINK_AXIAL_INERTIA = 1e-3
_JOINT_ERROR = 0.01  # m, far more than the engine's joints give way
# The engine clips joint rates at 100 rad/s by default.
_MAX_JOINT_VELOCITY = 1e3


class Multibody(NamedTuple):
    """Handles of the loaded system: the body and the engine's indices of links and UAVs, in the UAVs' order."""

    body: int
    links: tuple[int, ...]
    uavs: tuple[int, ...]
    payload_moments: tuple[float, ...]
    """The payload's principal moments of inertia (3,) (kg m2)."""
    arm: float
    """No UAV is farther from the payload's centre of mass (m)."""
    payload_in_axes: tuple[float, float, float, float]
    """Payload frame to principal axes, x-first: the engine's attitude of the payload is that of its principal axes."""


def check_supported(parameters: SystemParameters) -> None:
    """Raise :class:`UnsupportedWorld` where the engine would compute something else than requested."""
    n = parameters.number_of_uavs
    if n > MAX_VEHICLES:
        raise UnsupportedWorld(
            f"{n} vehicles: the physics engine is wrong beyond {MAX_VEHICLES} ({MAX_COORDINATES} coordinates)"
        )
    for i, inertia in enumerate(parameters.J):
        if np.any(inertia != np.diag(np.diag(inertia))):
            raise UnsupportedWorld(f"J[{i}]: the world takes no products of inertia of a UAV")
    payload = principal_axes(parameters.J_0)[0]
    for name, moments in [("J_0", payload), *((f"J[{i}]", np.diag(J)) for i, J in enumerate(parameters.J))]:
        # A rigid body's moments of inertia obey the triangle inequality; the engine corrects others without a message.
        if 2 * moments.max() > moments.sum() * (1 + 1e-9):
            raise UnsupportedWorld(f"{name}: no rigid body has the moments of inertia {moments.tolist()}")


def principal_axes(inertia: Array) -> tuple[Array, Array]:
    """Return the principal moments (3,) of ``inertia`` (3, 3) and its axes (3, 3), columns nearest to its frame's."""
    moments, axes = np.linalg.eigh(inertia)
    order = list(max(permutations(range(3)), key=lambda columns: np.abs(axes[np.arange(3), list(columns)]).sum()))
    axes = axes[:, order] * np.where(np.diag(axes[:, order]) < 0.0, -1.0, 1.0)
    if np.linalg.det(axes) < 0.0:
        axes[:, np.argmin(np.diag(axes))] *= -1.0
    return moments[order], axes


def _payload_axes(parameters: SystemParameters) -> tuple[Array, Rotation]:
    """Return the payload's principal moments, and the rotation from its principal axes to forward-left-up."""
    up = np.diag([1.0, -1.0, -1.0])
    moments, axes = principal_axes(up @ parameters.J_0 @ up)
    return moments, Rotation.from_matrix(axes)


def urdf_text(parameters: SystemParameters, link_radius: float) -> str:
    """Return the system as URDF. Attachment points off the payload's hull are on outriggers without mass or shape."""
    moments, axes = _payload_axes(parameters)
    edges = parameters.payload.box_edges
    if edges is None:
        shape = f'<mesh filename="{PAYLOAD_FILE}"/>'
    else:
        shape = f'<box size="{" ".join(map(repr, edges.tolist()))}"/>'
    parts = [
        '<?xml version="1.0"?>',
        '<robot name="cooplift">',
        _link("payload", parameters.m_0, moments, shape, axes=axes.as_euler("xyz").tolist()),
    ]
    for i, (p_i, l_i, m_i, J_i) in enumerate(
        zip(parameters.p, parameters.l, parameters.m, parameters.J, strict=True), start=1
    ):
        rod = f'<cylinder radius="{link_radius!r}" length="{float(l_i)!r}"/>'
        disc = f'<cylinder radius="{parameters.disc_radius!r}" length="{DISC_THICKNESS}"/>'
        attachment = (p_i[0], -p_i[1], -p_i[2])
        parts += [
            _joint(f"payload_link{i}", "payload", f"link{i}", attachment),
            _link(f"link{i}", 0.0, np.full(3, _LINK_INERTIA), rod, shape_z=l_i / 2),
            _joint(f"link{i}_uav{i}", f"link{i}", f"uav{i}", (0.0, 0.0, l_i)),
            _link(f"uav{i}", m_i, np.diag(J_i), disc),
        ]
    # The engine's reader cuts off long lines, hence one element a line.
    return "\n".join([*parts, "</robot>", ""])


def load_multibody(
    client: int, parameters: SystemParameters, position: tuple[float, float, float], settings: BodySettings
) -> Multibody:
    """Put the system into the world of physics client ``client``: level, links upright, ``position`` z-up (m).

    Nothing brakes it: joint motors off, no damping. Raises :class:`UnsupportedWorld`.
    """
    check_supported(parameters)
    flags = (
        pybullet.URDF_USE_INERTIA_FROM_FILE
        | pybullet.URDF_USE_IMPLICIT_CYLINDER  # round, not a prism of 32 sides
        | pybullet.URDF_USE_SELF_COLLISION
        | pybullet.URDF_USE_SELF_COLLISION_EXCLUDE_PARENT
    )
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / PAYLOAD_FILE).write_text(_payload_text(parameters.payload))
        path = Path(folder) / "system.urdf"
        path.write_text(urdf_text(parameters, settings.link_radius))
        body = pybullet.loadURDF(str(path), basePosition=position, flags=flags, physicsClientId=client)
    index = {}
    for joint in range(pybullet.getNumJoints(body, physicsClientId=client)):
        index[pybullet.getJointInfo(body, joint, physicsClientId=client)[12].decode()] = joint
        # Spherical joints start with a motor that holds them at zero.
        pybullet.setJointMotorControlMultiDof(
            body, joint, pybullet.POSITION_CONTROL, targetPosition=[0.0, 0.0, 0.0, 1.0], targetVelocity=[0.0] * 3,
            positionGain=0.0, velocityGain=0.0, force=[0.0] * 3, physicsClientId=client,
        )  # fmt: skip
    numbers = range(1, parameters.number_of_uavs + 1)
    links = tuple(index[f"link{i}"] for i in numbers)
    # Settings of the whole body. Given together with a link's own settings, they would send those to the base.
    pybullet.changeDynamics(
        body, -1, linearDamping=0.0, angularDamping=0.0, maxJointVelocity=_MAX_JOINT_VELOCITY, physicsClientId=client
    )
    for part in range(-1, len(index)):
        pybullet.changeDynamics(
            body, part, jointDamping=0.0, restitution=0.0,
            lateralFriction=0.0 if part in links else settings.friction, physicsClientId=client,
        )  # fmt: skip
        if part in links:
            pybullet.changeDynamics(
                body, part, localInertiaDiagonal=(_LINK_INERTIA, _LINK_INERTIA, _LINK_AXIAL_INERTIA),
                physicsClientId=client,
            )  # fmt: skip
    moments, axes = _payload_axes(parameters)
    uavs = tuple(index[f"uav{i}"] for i in numbers)
    arm = float(np.max(np.linalg.norm(parameters.p, axis=1) + parameters.l)) + _JOINT_ERROR
    return Multibody(body, links, uavs, tuple(moments.tolist()), arm, tuple(axes.inv().as_quat().tolist()))


def _payload_text(payload: PayloadHull) -> str:
    """Return the hull less the engine's margin as OBJ: vertices, and the faces that its reader needs."""
    faces = ConvexHull(payload.vertices * (1.0, -1.0, -1.0)).equations
    faces[:, 3] = np.minimum(faces[:, 3] + _HULL_MARGIN, 0.5 * faces[:, 3])
    vertices = np.unique(HalfspaceIntersection(faces, np.zeros(3)).intersections.round(9), axis=0)
    hull = ConvexHull(vertices)
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in hull.simplices.tolist()]
    return "\n".join([*lines, ""])


def _link(
    name: str, mass: float, inertia: Array, shape: str, shape_z: float = 0.0, axes: Sequence[float] = (0.0, 0.0, 0.0)
) -> str:
    ixx, iyy, izz = (float(value) for value in inertia)
    geometry = f'<origin xyz="0 0 {float(shape_z)!r}"/>\n<geometry>\n{shape}\n</geometry>'
    return "\n".join(
        [
            f'<link name="{name}">',
            "<inertial>",
            f'<origin rpy="{" ".join(map(repr, axes))}"/>',
            f'<mass value="{float(mass)!r}"/>',
            f'<inertia ixx="{ixx!r}" ixy="0" ixz="0" iyy="{iyy!r}" iyz="0" izz="{izz!r}"/>',
            "</inertial>",
            f"<visual>\n{geometry}\n</visual>",
            f"<collision>\n{geometry}\n</collision>",
            "</link>",
        ]
    )


def _joint(name: str, parent: str, child: str, origin: tuple[float, float, float]) -> str:
    x, y, z = (float(value) for value in origin)
    return "\n".join(
        [
            f'<joint name="{name}" type="spherical">',
            f'<parent link="{parent}"/>',
            f'<child link="{child}"/>',
            f'<origin xyz="{x!r} {y!r} {z!r}"/>',
            '<axis xyz="1 0 0"/>',  # no meaning here, but the reader complains without it
            "</joint>",
        ]
    )
