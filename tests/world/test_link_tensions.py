"""Tensions of the links: by statics at rest, and by Newton's law of the payload in motion."""

import math
from dataclasses import replace

import numpy as np
import pytest
from mission_files import MISSIONS
from nonlinear_motion import hover_state
from paper_system import system
from world_runs import place, unequal

from gcs.config import read_system
from idc_controller.rotations import rotation_from_quaternion
from vehicle_sim.world.world import World

L_PAYLOAD = read_system(MISSIONS / "l_payload.toml").parameters()
TEAMS = pytest.mark.parametrize("parameters", [system(4), unequal(), L_PAYLOAD], ids=["4", "unequal", "L"])


def high(parameters):
    """Hover far from the ground."""
    return replace(hover_state(parameters), r_0=np.array([0.0, 0.0, -20.0]))


def pulls(parameters, states, tensions):
    """Forces of the links on the payload (N, 3), NED."""
    payload, uavs = states[0], states[1:]
    attachments = payload[:3] + parameters.p @ rotation_from_quaternion(payload[3:7]).T
    towards = uavs[:, :3] - attachments
    return np.array(tensions)[:, None] * towards / np.linalg.norm(towards, axis=1, keepdims=True)


@TEAMS
def test_tensions_in_hover_carry_the_payload(parameters):
    with World(parameters) as world:
        place(world, high(parameters))
        for _ in range(50):
            world.step(parameters.hover_thrust.tolist(), [(0.0, 0.0, 0.0)] * parameters.number_of_uavs)
        tensions = world.link_tensions()
        weight = parameters.m_0 * parameters.g
        assert pulls(parameters, world.states(), tensions).sum(axis=0) == pytest.approx([0.0, 0.0, -weight], abs=1e-3)
        assert tensions == pytest.approx(weight * parameters.payload_share, abs=1e-3)


@TEAMS
@pytest.mark.parametrize("wind", [False, True], ids=["still", "wind"])
def test_tensions_in_motion_accelerate_the_payload(parameters, wind):
    n, rng, step = parameters.number_of_uavs, np.random.default_rng(4), 0.001
    rates, torques = rng.uniform(2.0, 6.0, n), 0.01 * rng.standard_normal((n, 3))
    on_payload, on_uavs = (1.0, -2.0, 0.5), rng.standard_normal((n, 3)).tolist()
    velocities, forces = [], []
    with World(parameters, round(1.0 / step)) as world:
        place(world, high(parameters))
        for k in range(600):
            t = k / world.physics_hz
            thrusts = parameters.hover_thrust * (1.02 + 0.1 * np.sin(rates * t))
            pushes = (on_payload, on_uavs) if wind else ()
            world.step(thrusts.tolist(), (torques * math.cos(8.0 * t)).tolist(), *pushes)
            velocities.append(world.states()[0, 7:10])
            force = pulls(parameters, world.states(), world.link_tensions()).sum(axis=0)
            forces.append(force + np.array(on_payload) * wind + [0.0, 0.0, parameters.m_0 * parameters.g])
    needed = parameters.m_0 * np.gradient(np.array(velocities), step, axis=0)
    change = np.linalg.norm(np.gradient(needed, axis=0), axis=1)
    assert np.abs(needed).max() > 2.0
    # They are those of the step before: off by as much as changes in one. The first steps start without velocities.
    off = np.linalg.norm(np.array(forces) - needed, axis=1)
    assert np.all(off[10:-2] < 2.0 * change[10:-2] + 0.01)


def test_tension_is_not_known_while_cradle_holds_or_something_touches():
    parameters = system(4)
    with World(parameters) as world:
        level = [(0.0, 0.0, 0.0)] * 4
        lift = parameters.hover_thrust[0]
        world.step([0.1 * lift] * 4, level)
        assert np.isnan(world.link_tensions()).all()
        world.step([0.9 * lift, 0.1 * lift, 0.9 * lift, 0.9 * lift], level)
        assert np.isnan(world.link_tensions()).tolist() == [False, True, False, False]
