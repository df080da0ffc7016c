"""The PyBullet world repeats to the last bit, and ends once."""

import math

import pytest
from paper_system import system
from world_runs import closest_distance, run

from idc_controller.geometry.shapes import Sphere
from vehicle_sim.world.world import World


def scenario(world, look):
    """Take-off, a bump against a sphere, fall to the ground; ``look`` at the state on the way or only at the end."""
    hover = world.parameters.hover_thrust
    world.obstacles.add("ball", Sphere(0.5), (0.6, 0.5, -5.0))
    for k in range(2000):
        factor = 1.2 if k < 1000 else 0.5
        sway = 0.01 * math.sin(0.05 * k)
        world.step((factor * hover).tolist(), [(sway, -sway, 0.0)] * 4, (0.1, 0.0, 0.0))
        if look:
            world.state()
            world.contacts().pairs
            closest_distance(world, "ball")
    return world.state()


def test_world_repeats_to_the_bit_with_reads_and_parallel_worlds():
    with World(system(4)) as first:
        one = scenario(first, look=False)
    with World(system(4)) as second, World(system(3)) as other:
        run(other, 0.1, [8.0] * 3)
        assert scenario(second, look=True) == one
        assert other.time == pytest.approx(0.1)
