"""The broad phase against the engine: where it excludes contacts there are none."""

import math

import numpy as np
import pytest
from nonlinear_motion import hover_state
from paper_system import system
from world_runs import place

from idc_controller.geometry.shapes import Sphere
from vehicle_sim.world import broad_phase_kernels
from vehicle_sim.world.broad_phase_kernels import time_apart
from vehicle_sim.world.world import World

SIZES = np.array([0.05, 0.75, 0.301, 0.05, 0.1])
NO_OBSTACLES = np.empty((0, 3)), np.empty((0, 3))
NO_TORQUES = [(0.0, 0.0, 0.0)] * 4


def formation(height=10.0, speed=0.0):
    """States of a level payload with four upright links, all moving north; and the attachments."""
    attachments = np.array([[0.5, 0.5, -0.25], [0.5, -0.5, -0.25], [-0.5, -0.5, -0.25], [-0.5, 0.5, -0.25]])
    states = np.zeros((5, 13))
    states[1:, :3] = attachments - [0.0, 0.0, 3.2]
    states[:, 2] -= height
    states[:, 3], states[:, 7] = 1.0, speed
    return states, attachments


def time_for(room, speed=0.0):
    """Time in which two parts that approach each other, accelerating as none does, close ``room`` (m)."""
    times = np.linspace(0.0, 1.0, 1_000_001)
    closed = 2.0 * speed * times + broad_phase_kernels.ACCELERATION_MAX * times**2
    return times[np.searchsorted(closed, room) - 1]


@pytest.mark.parametrize("speed", [0.0, 3.0])
def test_time_apart_follows_from_least_gap_and_greatest_speed(speed):
    states, attachments = formation(speed=speed)
    room = 1.0 - 2 * 0.301 - 0.05  # between neighbouring discs
    assert time_apart(states, attachments, *NO_OBSTACLES, SIZES) == pytest.approx(time_for(room, speed), abs=2e-6)


def test_no_time_apart_near_the_ground_and_with_discs_close_to_each_other():
    states, attachments = formation(height=0.84)
    assert time_apart(states, attachments, *NO_OBSTACLES, SIZES) == 0.0
    states, attachments = formation(height=0.86)
    assert time_apart(states, attachments, *NO_OBSTACLES, SIZES) > 0.0
    states[1, :3] = states[2, :3] + [0.0, 0.65, 0.0]
    assert time_apart(states, attachments, *NO_OBSTACLES, SIZES) == 0.0


@pytest.mark.parametrize(
    ("centre", "gap"),
    [
        ((2.0, 0.0, -10.0), 2.0 - 0.75 - 0.5),  # from the payload
        ((2.0, 0.5, -12.0), 1.5 - 0.301 - 0.5),  # from a link
        ((0.5, 0.5, -15.0), 5.0 - 3.45 - 0.301 - 0.5),  # from a UAV, above it
    ],
)
def test_obstacles_count_by_their_balls(centre, gap):
    states, attachments = formation()
    obstacles = np.array([centre]), np.array([[0.5, math.nan, math.nan]])
    alone = time_apart(states, attachments, *NO_OBSTACLES, SIZES)
    expected = min(alone, time_for(gap - 0.05 - 0.1))
    assert time_apart(states, attachments, *obstacles, SIZES) == pytest.approx(expected, abs=2e-6)
    near = np.array([centre]), np.array([[0.5 + gap, math.nan, math.nan]])
    assert time_apart(states, attachments, *near, SIZES) == 0.0


@pytest.mark.parametrize("seed", range(4))
def test_contacts_are_those_of_the_engine_in_a_fall_among_moving_obstacles(seed):
    """UAVs that tumble with a payload onto the ground, while a sphere flies through them."""
    random = np.random.default_rng(seed)
    parameters = system(4)
    with World(parameters) as world:
        place(world, hover_state(parameters, (0.0, 0.0, -2.0)))
        world.obstacles.add("ball", Sphere(0.3), (4.0, 0.5, -4.0))
        lift = 0.97 * parameters.hover_thrust
        excluded, pairs = 0, 0
        for k in range(1200):
            world.obstacles.move("ball", (4.0 - 0.008 * k, 0.5, -4.0))
            pushes = 2.0 * random.normal(size=(4, 3)) * (k > 200)
            world.step(lift.tolist(), NO_TORQUES, uav_forces=pushes.tolist())
            found = world.contacts()
            assert found == world._ground.contacts(world._system, world._readings.payload)
            excluded += world.steps <= world._contacts._apart_until
            pairs = max(pairs, found.pairs)
        assert excluded > 50
        assert pairs >= 1


@pytest.mark.parametrize("north", [0.0, 1.0, -2.0])
def test_distance_of_parallel_links_is_that_across_them(north):
    """All UAVs ahead of the payload or behind it, as when it accelerates: the links lean, side by side."""
    states, attachments = formation()
    states[1:, 0] += north
    link = np.array([north, 0.0, -3.2])
    across = 1.0 - (link[0] / np.linalg.norm(link)) ** 2  # of two links, one behind the other
    room = math.sqrt(across) - 2 * 0.301 - 0.05
    assert time_apart(states, attachments, *NO_OBSTACLES, SIZES) == pytest.approx(time_for(room), abs=2e-6)
