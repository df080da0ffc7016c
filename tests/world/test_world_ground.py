"""The ground of the PyBullet world, its pad and its cradles."""

import math
from dataclasses import replace

import numpy as np
import pybullet
import pytest
from nonlinear_motion import hover_state, uav_positions
from paper_system import system
from world_runs import STANDING_ON_GROUND, STANDING_ON_PAD, angle_between, place, run, uav_array, unequal

from gcs.config.tables import WorldConfig
from vehicle_sim.world.world import World


@pytest.mark.parametrize("parameters", [system(3), system(4), system(8), unequal()], ids=["3", "4", "8", "unequal"])
def test_system_on_the_pad_does_not_move(parameters):
    with World(parameters) as world:
        before = world.state()
        after = run(world, 2.0, [0.0] * parameters.number_of_uavs)
        assert after.time == pytest.approx(2.0)
        assert after.payload_position_in_world == pytest.approx((0, 0, STANDING_ON_PAD), abs=1e-4)
        assert angle_between(before.payload_quaternion, after.payload_quaternion) < 0.01
        np.testing.assert_allclose(
            uav_array(after, "position_in_world"), uav_array(before, "position_in_world"), atol=1e-4
        )
        assert np.abs(uav_array(after, "velocity_in_world")).max() < 1e-3
        assert uav_array(after, "cradled").all()
        assert world.touching_ground()
        assert world.contacts().pairs == 0


def test_at_the_start_links_are_upright_on_the_attachment_points():
    parameters = system(4)
    with World(parameters) as world:
        expected = uav_positions(parameters, hover_state(parameters, (0, 0, STANDING_ON_PAD)))
        np.testing.assert_allclose(uav_array(world.state(), "position_in_world"), expected, atol=1e-12)


def test_each_cradle_releases_when_thrust_exceeds_weight_of_its_uav():
    parameters = system(4)
    weight = float(parameters.m[0] * parameters.g)
    with World(parameters) as world:
        state = run(world, 0.5, [0.0, 0.5 * weight, 0.99 * weight, 1.2 * weight])
        assert uav_array(state, "cradled").tolist() == [True, True, True, False]
        state = run(world, 1.0, [1.2 * weight] * 4)
        assert not uav_array(state, "cradled").any()
        assert world.touching_ground()  # the UAVs carry themselves, not the payload
        assert state.payload_position_in_world[2] == pytest.approx(STANDING_ON_PAD, abs=1e-3)
        # Links stay upright on the pull of their UAVs.
        np.testing.assert_allclose(uav_array(state, "position_in_world")[:, :2], parameters.p[:, :2], atol=0.01)


def test_world_leaves_no_engine_behind():
    with World(system(3)) as world:
        engine = world._client
        assert pybullet.isConnected(engine)
    assert not pybullet.isConnected(engine)
    world.close()  # once more does nothing


def land(world, offset=0.0):
    """Set the system down from 0.1 m above its stand at ``offset`` m north, sinking at 0.2 m/s; then motors off."""
    parameters = world.parameters
    height = STANDING_ON_PAD if offset == 0.0 else STANDING_ON_GROUND
    start = hover_state(parameters, (offset, 0.0, height - 0.1))
    place(world, replace(start, r_0_dot=np.array([0.0, 0.0, 0.2])))
    hover = parameters.hover_thrust.tolist()
    assert not uav_array(world.state(), "cradled").any()
    while not world.touching_ground():
        assert world.time < 2.0
        world.step(hover, [(0.0, 0.0, 0.0)] * 4)
    for factor in np.linspace(1.0, 0.0, 1000):
        world.step([factor * f for f in hover], [(0.0, 0.0, 0.0)] * 4)
    return run(world, 2.0, [0.0] * 4)


def test_landed_uavs_are_held_by_cradles_and_take_off_again():
    parameters = system(4)
    with World(parameters) as world:
        state = land(world)
        assert uav_array(state, "cradled").all()
        assert state.payload_position_in_world == pytest.approx((0, 0, STANDING_ON_PAD), abs=2e-3)
        expected = uav_positions(parameters, hover_state(parameters, (0, 0, STANDING_ON_PAD)))
        np.testing.assert_allclose(uav_array(state, "position_in_world"), expected, atol=0.03)
        assert np.abs(uav_array(state, "velocity_in_world")).max() < 1e-3
        assert world.contacts().pairs == 0
        state = run(world, 1.0, (1.03 * parameters.hover_thrust).tolist())
        assert not uav_array(state, "cradled").any()
        assert state.payload_position_in_world[2] < STANDING_ON_PAD - 0.05
        assert not world.touching_ground()


def test_payload_landed_beside_the_pad_rests_on_the_ground():
    with World(system(4)) as world:
        state = land(world, offset=5.0)
        assert state.payload_position_in_world == pytest.approx((5.0, 0, STANDING_ON_GROUND), abs=2e-3)
        assert uav_array(state, "cradled").all()
        assert world.touching_ground()
        assert world.contacts().pairs == 0


def test_payload_that_drifts_against_the_pad_as_it_lands_beside_it_collides_with_nothing():
    parameters = system(4)
    with World(parameters) as world:
        beside = 0.5 + WorldConfig().pad.margin + 0.5
        start = hover_state(parameters, (beside + 0.02, 0.0, STANDING_ON_GROUND - 0.03))
        place(world, replace(start, r_0_dot=np.array([-0.3, 0.0, 0.2])))
        seen = []
        for _ in range(world.physics_hz):
            world.step((0.5 * parameters.hover_thrust).tolist(), [(0.0, 0.0, 0.0)] * 4)
            seen.append(world.contacts())
        # The side of the payload is at the pad.
        assert world.state().payload_position_in_world[0] == pytest.approx(beside, abs=0.01)
        assert seen[-1].standing
        assert not any(contacts.pairs for contacts in seen)


def test_payload_below_leaning_links_stays_where_it_was_set_down():
    """The engine, left to itself, doubles its motion every 1.6 s there."""
    parameters, lean = system(4), np.radians([8.0, 10.0, 6.0, 9.0])
    q = np.column_stack([0.95 * np.sin(lean), np.full(4, -0.3 * math.sin(lean[0])), np.zeros(4)])
    q[:, 2] = np.sqrt(1.0 - np.square(q).sum(axis=1))
    with World(parameters) as world:
        place(world, replace(hover_state(parameters, (5.0, 0.0, STANDING_ON_GROUND - 0.001)), q=q))
        run(world, 0.5, (0.98 * parameters.m * parameters.g).tolist())
        before = run(world, 0.5, [0.0] * 4)
        after = run(world, 15.0, [0.0] * 4)
        assert world.all_cradled and world.touching_ground()
        assert after.payload_position_in_world == pytest.approx(before.payload_position_in_world, abs=1e-6)
        assert math.hypot(*after.payload_velocity_in_world) < 1e-6
        # It is free with the first UAV.
        assert world.contacts().pairs == 0
        state = run(world, 1.0, (1.1 * parameters.hover_thrust).tolist())
        assert state.payload_position_in_world[2] < STANDING_ON_GROUND - 0.05


def test_last_cradle_releases_though_the_others_have_lifted_the_payload():
    with World(system()) as world:
        p = world.parameters
        lifting = [1.3 * float(p.m_T) * p.g / 3.0] * 3
        while world.state().payload_position_in_world[2] > -0.9:
            assert world.time < 2.0
            state = run(world, 0.05, [*lifting, 0.0])
        assert uav_array(state, "cradled").tolist() == [False, False, False, True]
        state = run(world, 0.01, [*lifting, 1.2 * float(p.m[3]) * p.g])
        assert not uav_array(state, "cradled").any()


def test_wind_does_not_move_uavs_in_cradles():
    with World(system()) as world:
        for _ in range(500):
            world.step([0.0] * 4, [(0.0, 0.0, 0.0)] * 4, (20.0, 0.0, 0.0), [(1.0, 0.0, 0.0)] * 4)
        assert np.linalg.norm(world.state().payload_position_in_world[:2]) < 1e-3
        for _ in range(100):  # one that is free is blown at
            world.step([8.0, 0.0, 0.0, 0.0], [(0.0, 0.0, 0.0)] * 4, None, [(0.0, 5.0, 0.0)] * 4)
        assert world.state().uavs[0].velocity_in_world[1] > 0.1


def test_cradles_stay_open_in_the_air():
    with World(system(4)) as world:
        place(world, hover_state(system(4), (0, 0, -1.5)))
        state = run(world, 0.05, [0.0] * 4)
        assert not uav_array(state, "cradled").any()
        assert state.payload_velocity_in_world[2] == pytest.approx(9.81 * 0.051, rel=1e-6)
