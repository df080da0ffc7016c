"""Contacts and obstacles in the PyBullet world."""

import math
from dataclasses import replace

import numpy as np
import pytest
from nonlinear_motion import hover_state, uav_positions
from paper_system import system
from world_runs import closest_distance, place, uav_array

from idc_controller.geometry.shapes import Pole, Sphere, Wall
from vehicle_sim.world.errors import SimulationError
from vehicle_sim.world.ground import Ground
from vehicle_sim.world.world import World


def test_uav_driven_into_a_sphere_counts_as_contact():
    parameters = system(4)
    with World(parameters) as world:
        place(world, hover_state(parameters, (0, 0, -10.0)))
        front_right = uav_positions(parameters, hover_state(parameters, (0, 0, -10.0)))[0]
        world.obstacles.add("ball", Sphere(0.5), front_right + np.array([1.0, 0, 0]))
        assert closest_distance(world, "ball") == pytest.approx(0.2, abs=1e-3)
        seen, clipped = [], set()
        lift = parameters.hover_thrust.tolist()
        for _ in range(1000):
            world.step(lift, [(0.0, 0.0, 0.0)] * 4, uav_forces=[(1.0, 0.0, 0.0)] * 4)
            seen.append(world.contacts().pairs)
            assert seen[-1] or not world.clipped()
            clipped |= set(world.clipped())
        assert seen[0] == 0
        assert 1 in clipped  # the accelerometer of the UAV that met it
        assert max(seen) >= 1
        assert not world.touching_ground()


@pytest.mark.parametrize("speed", [4.0, 30.0])
def test_obstacle_that_comes_near_is_noticed_however_long_the_team_was_clear(monkeypatch, speed):
    """Of a team that is clear the engine is asked seldom."""
    asked, contacts = [], Ground.contacts
    monkeypatch.setattr(Ground, "contacts", lambda *arguments: asked.append(0) or contacts(*arguments))
    parameters = system(4)
    lift, met = parameters.hover_thrust.tolist(), False
    with World(parameters) as world:
        place(world, hover_state(parameters, (0, 0, -10.0)))
        world.obstacles.add("ball", Sphere(0.5), (20.0, 0.0, -10.0))
        for _ in range(200):
            world.step(lift, [(0.0, 0.0, 0.0)] * 4)
            assert world.contacts().pairs == 0
        assert 1 <= len(asked) <= 12
        for k in range(2000):
            world.obstacles.move("ball", (3.0 - speed * k / world.physics_hz, 0.0, -10.0))
            world.step(lift, [(0.0, 0.0, 0.0)] * 4)
            distance = closest_distance(world, "ball")
            met = world.contacts().pairs > 0
            assert met or distance > 0.0, distance
            if met:
                assert distance < 0.025
                break
    assert met


def test_link_contacts_pole_and_wall_stops_payload():
    parameters = system(4)
    with World(parameters) as world:
        place(world, hover_state(parameters, (0, 0, -6.0)))
        world.obstacles.add("pole", Pole(0.05, 8.0), (0.6, 0.5, -4.0))
        assert closest_distance(world, "pole") == pytest.approx(0.04, abs=2e-3)
        world.obstacles.move("pole", (0.55, 0.5, -4.0))
        world.obstacles.add("wall", Wall((1.0, 4.0, 0.2)), (-2.5, 0, -6.0))
        # Payload to wall: 2.5 - 0.5 - 0.5; one turned by 90 degrees is 2 m long towards it, and they touch.
        assert closest_distance(world, "wall") == pytest.approx(1.5, abs=3e-3)
        world.obstacles.add("turned", Wall((1.0, 4.0, 0.2), math.pi / 2), (-2.5, 0, -6.0))
        assert closest_distance(world, "turned") == pytest.approx(0.0, abs=3e-3)
        world.obstacles.move("turned", (-40.0, 0, -6.0))
        world.obstacles.move("wall", (-20.0, 0, -6.0))
        world.step([14.0] * 4, [(0.0, 0.0, 0.0)] * 4)
        assert world.contacts().pairs == 1  # link 1 and the pole
        world.obstacles.move("pole", (0.0, 0.0, -4.0))
        world.obstacles.move("wall", (-0.99, 0, -6.0))
        place(world, hover_state(parameters, (0, 0, -6.0)))
        world.step([14.0] * 4, [(0.0, 0.0, 0.0)] * 4)
        assert world.contacts().pairs == 2  # the payload with the pole and with the wall
        assert closest_distance(world, "pole") < 0
        world.obstacles.move("pole", (50.0, 50.0, -4.0))
        assert closest_distance(world, "pole", within=10.0) == math.inf
        assert [(o.name, o.shape.kind) for o in world.obstacles.all()][:2] == [("pole", "pole"), ("wall", "wall")]
        assert world.obstacles.all()[0].position_in_world == (50.0, 50.0, -4.0)


def test_wall_yaw_turns_clockwise_seen_from_above():
    with World(system(4)) as world:
        place(world, hover_state(system(4), (0, 0, -10.0)))
        # A long wall to the north-east, lying towards the payload only when yaw is +45 degrees (north to east).
        for name, yaw in ("towards", math.pi / 4), ("across", -math.pi / 4):
            world.obstacles.add(name, Wall((4.0, 0.1, 0.4), yaw), (3.0, 3.0, -10.0))
        assert closest_distance(world, "towards") < closest_distance(world, "across") - 1.0


def test_discs_that_meet_count():
    parameters = system(4)
    with World(parameters) as world:
        hover = hover_state(parameters, (0, 0, -10.0))
        tilt = np.array([0.0, 0.21 / 3.2, 0.0])
        q = hover.q + np.array([tilt, -tilt, 0 * tilt, 0 * tilt])
        place(world, replace(hover, q=q / np.linalg.norm(q, axis=1, keepdims=True)))
        world.step([14.0] * 4, [(0.0, 0.0, 0.0)] * 4)
        assert world.contacts().pairs == 1


@pytest.mark.slow
def test_toppled_system_on_the_ground_counts():
    parameters = system(4)
    with World(parameters) as world:
        # Links on their way down when the payload reaches the ground: too fast for the cradles.
        state = hover_state(parameters, (5, 0, -0.26))
        place(world, replace(state, Omega=np.tile([0.0, 0.5, 0.0], (4, 1))))
        counts, speeds = [], []
        for _ in range(2500):
            world.step([0.0] * 4, [(0.0, 0.0, 0.0)] * 4)
            counts.append(world.contacts().pairs)
            speeds.append(np.abs(uav_array(world.state(), "velocity_in_world")).max())
        assert counts[0] == 0
        assert max(counts) >= 2  # discs or links on the ground
        # The wreck lies still instead of flying apart; free fall from 4 m ends at 9 m/s.
        assert max(speeds) < 12.0
        assert speeds[-1] < 0.5
        assert uav_array(world.state(), "position_in_world")[:, 2].min() > -0.8


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("a", Sphere(0.0), (0, 0, 0)), "radius"),
        (("a", Sphere(1.0), (0, math.nan, 0)), "finite"),
        (("a", Pole(1.0, 0.0), (0, 0, 0)), "height"),
        (("a", Wall((1, 0, 1)), (0, 0, 0)), "size_y"),
        (("a", Wall((1, 1, 1), math.inf), (0, 0, 0)), "yaw"),
        (("taken", Sphere(1.0), (0, 0, 0)), "taken"),
    ],
)
def test_invalid_obstacles_are_refused(arguments, reason):
    with World(system(4)) as world:
        world.obstacles.add("taken", Sphere(1.0), (9, 9, -9))
        with pytest.raises(SimulationError, match=reason):
            world.obstacles.add(*arguments)
        with pytest.raises(SimulationError, match="nobody"):
            world.obstacles.move("nobody", (0, 0, 0))
        with pytest.raises(SimulationError, match="nobody"):
            closest_distance(world, "nobody")
