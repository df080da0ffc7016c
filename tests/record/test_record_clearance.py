"""Clearance against distances that can be written down by hand."""

from __future__ import annotations

import coal
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gcs.errors import UnusableInput
from gcs.record.clearance import DEFAULT_PAYLOAD, Formation, ObstacleTrack
from idc_controller.geometry.shape import Shape
from idc_controller.geometry.shapes import Box, Capsule, Mesh, MeshHull, Pole, Sphere, Wall
from idc_controller.parameters import PayloadHull
from idc_controller.rotations import quaternion_from_euler, rotation_from_quaternion

LEVEL = np.array([1.0, 0.0, 0.0, 0.0])
# Payload at the origin, its UAVs 1 m above its upper corners.
UAVS = np.array([[x, y, -1.25] for x in (-0.5, 0.5) for y in (-0.5, 0.5)])
BOUND = 1e-6  # m


def clearance(obstacle: ObstacleTrack, rotation=LEVEL, shift=(0.0, 0.0, 0.0), uav_quaternion=LEVEL) -> float:
    """Clearance of the level formation, moved as a whole, from one obstacle."""
    R = rotation_from_quaternion(rotation)
    uavs, attitudes = (UAVS @ R.T + shift)[None], np.array([[uav_quaternion] * 4])
    return Formation(np.array([shift]), rotation[None], uavs, attitudes).clearance([obstacle])[0]


def sphere(position, radius=0.5) -> ObstacleTrack:
    return ObstacleTrack("s", Sphere(radius), np.array([position], dtype=float))


@pytest.mark.parametrize(
    ("position", "expected"),
    [
        ((0.0, 0.0, 3.0), 3.0 - 0.25 - 0.5),  # below: the box's floor
        ((0.0, 0.0, -4.0), 4.0 - 1.25 - 0.5),  # above: between the discs, where only the hull is
        ((5.0, 0.3, -1.25), 5.0 - 0.8 - 0.5),  # ahead, between the rims of two discs
        ((5.0, 0.5, -1.25), 5.0 - 0.8 - 0.5),  # ahead of one disc
        ((0.5, 4.0, -1.25), 4.0 - 0.8 - 0.5),
        ((4.5, 4.5, -1.25), 4.0 * np.sqrt(2.0) - 0.3 - 0.5),  # diagonal: the rim, not a corner
    ],
)
def test_clearance_of_sphere(position, expected) -> None:
    assert clearance(sphere(position)) == pytest.approx(expected, abs=BOUND)


@pytest.mark.parametrize("position", [(0.0, 0.0, 0.0), (0.9, 0.9, -1.25), (0.0, 0.0, -0.9)])
def test_clearance_of_overlap_is_zero(position) -> None:
    assert clearance(sphere(position)) == 0.0


def test_size_and_radius_given() -> None:
    payload = PayloadHull.box((1.0, 1.0, 2.0))
    formation = Formation(np.zeros((1, 3)), LEVEL[None], UAVS[None], np.array([[LEVEL] * 4]), payload, disc_radius=0.5)
    got = formation.clearances([sphere((0, 0, 4)), sphere((9, 0.5, -1.25))])
    assert got[0] == pytest.approx([4 - 1 - 0.5, 9 - 1.0 - 0.5], abs=BOUND)


def test_clearance_without_record_is_nan() -> None:
    track = ObstacleTrack("s", Sphere(0.5), np.array([[0.0, 0.0, 3.0], [np.nan] * 3]))
    states = [np.repeat(a[None], 2, axis=0) for a in (np.zeros(3), LEVEL, UAVS, np.array([LEVEL] * 4))]
    got = Formation(*states).clearance([track])
    assert got[0] == pytest.approx(2.25, abs=BOUND)
    assert np.isnan(got[1])


@pytest.mark.parametrize("seed", range(5))
def test_clearance_over_a_flight_is_the_least_of_all_obstacles(seed) -> None:
    rng = np.random.default_rng(seed)
    T = 400
    turns = np.linspace(0.0, 12.0, T)[:, None] * rng.uniform(0.5, 2.0, 3) + rng.uniform(0.0, 6.0, 3)
    payload = [6.0, 6.0, 2.0] * np.sin(turns)
    angles = 0.3 * np.sin(np.linspace(0.0, 9.0, T)[:, None] * rng.uniform(0.5, 3.0, 5) + rng.uniform(0.0, 6.0, 5))
    attitudes = np.array([[quaternion_from_euler(a, 0.5 * a, 2.0 * a) for a in row] for row in angles])
    uavs = payload[:, None] + UAVS + rng.normal(size=(T, 4, 3)).cumsum(axis=0) * 0.002
    obstacles = []
    for k in range(60):
        place = np.append(rng.uniform(-8.0, 8.0, 2), -3.0) + np.linspace(0.0, 1.0, T)[:, None] * (k % 3) * [2.0, 1.0, 0]
        place[rng.integers(0, T) : rng.integers(0, T)] = np.nan
        obstacles.append(ObstacleTrack("x", SHAPES[k % len(SHAPES)], place))
    payload[200] = np.nan
    formation = Formation(payload, attitudes[:, 0], uavs, attitudes[:, 1:])
    each = formation.clearances(obstacles)
    expected = np.nan_to_num(each, nan=np.inf).min(axis=1)
    assert np.isnan(each[200]).all() and np.isfinite(expected).sum() == T - 1
    expected[200] = np.nan
    np.testing.assert_allclose(formation.clearance(obstacles), expected, atol=1e-7)
    for k in (3, 399):  # each row for itself
        states = payload, attitudes[:, 0], uavs, attitudes[:, 1:]
        there = [ObstacleTrack("x", o.shape, o.position[k : k + 1]) for o in obstacles]
        alone = Formation(*(state[k : k + 1] for state in states)).clearances(there)
        np.testing.assert_allclose(alone[0], each[k], atol=1e-7)


CORNERS = ((0.4, 0.0, 0.0), (-0.3, 0.5, 0.0), (-0.3, -0.5, 0.1), (0.0, 0.0, 0.8), (0.1, 0.1, -0.6))
SHAPES = (
    Sphere(0.4),
    Pole(0.3, 12.0),
    Wall((0.3, 4.0, 6.0), 0.5),
    Capsule(0.3, 2.0, roll=0.4, pitch=-0.7, yaw=1.0),
    Box((0.5, 1.0, 2.0), roll=0.3, pitch=0.5, yaw=-1.0),
    Mesh(MeshHull("rock", CORNERS), scale=1.5, roll=0.2, pitch=0.1, yaw=2.0),
)
FINE = 100
"""Corners of the polygons in place of discs, of the reference by coal."""


def clearance_by_coal(states, shape: Shape, position) -> float:
    """Reference: the hull built of points, discs as polygons through the rim, and the distance by coal."""
    payload, quaternion, uavs, uav_quaternions = states
    angle = np.linspace(0.0, 2.0 * np.pi, FINE, endpoint=False)
    rim = 0.3 * np.column_stack([np.cos(angle), np.sin(angle), np.zeros(FINE)])
    points = [DEFAULT_PAYLOAD.vertices @ rotation_from_quaternion(quaternion).T]
    points += [
        uav - payload + rim @ rotation_from_quaternion(q).T for uav, q in zip(uavs, uav_quaternions, strict=True)
    ]
    vertices = coal.StdVec_Vec3s()
    vertices.extend(list(np.concatenate(points)))
    hull = coal.ConvexBase.convexHull(vertices, False, "")
    request = coal.DistanceRequest()
    request.gjk_tolerance, request.gjk_max_iterations = 1e-7, 1000
    there = coal.Transform3s(shape.rotation, position - payload)
    here, result = coal.Transform3s.Identity(), coal.DistanceResult()
    return max(coal.distance(hull, here, shape.geometry(), there, request, result), 0.0)


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape.kind)
@settings(deadline=None, derandomize=True, max_examples=60)
@given(seed=st.integers(0, 10**6), away=st.floats(0.0, 6.0))
def test_clearance_kernel_agrees_with_coal(shape, seed, away) -> None:
    rng = np.random.default_rng(seed)
    payload = rng.uniform(-50.0, 50.0, 3)
    attitudes = [quaternion_from_euler(*rng.uniform(-0.8, 0.8, 3)) for _ in range(5)]
    uavs = payload + UAVS + rng.uniform(-0.3, 0.3, UAVS.shape)
    direction = rng.normal(size=3)
    position = payload + away * direction / np.linalg.norm(direction)
    states = (payload, attitudes[0], uavs, np.array(attitudes[1:]))
    track = ObstacleTrack("x", shape, position[None])
    got = Formation(*(np.asarray(state)[None] for state in states)).clearance([track])[0]
    # The polygons lie within the discs.
    assert -1e-5 <= clearance_by_coal(states, shape, position) - got <= 0.3 * (1.0 - np.cos(np.pi / FINE)) + 1e-5


@pytest.mark.parametrize(
    ("shape", "reason"),
    [
        (Sphere(0.0), "radius must be positive"),
        (Pole(1.0, 0.0), "height must be positive"),
        (Wall((1.0, float("nan"), 1.0)), "size_y must be positive"),
    ],
)
def test_track_refuses_shape_without_extent(shape, reason) -> None:
    with pytest.raises(UnusableInput, match=f"obstacle x: {reason}"):
        ObstacleTrack("x", shape, np.zeros((1, 3)))
