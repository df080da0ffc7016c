"""The PyBullet world against the constrained dynamics."""

from dataclasses import replace

import numpy as np
import pytest
from mission_files import MISSIONS
from nonlinear_motion import hover_state, rk4_step, uav_positions, uav_velocities
from paper_system import system
from world_runs import angle_between, half_a_step_earlier, place, run, uav_array

from gcs.config import read_system
from idc_controller.model.nonlinear import Inputs, thrust_forces
from idc_controller.rotations import quaternion_from_euler
from vehicle_sim.world.errors import UnsupportedWorld
from vehicle_sim.world.multibody import MAX_VEHICLES
from vehicle_sim.world.world import World

L_PAYLOAD = read_system(MISSIONS / "l_payload.toml").parameters()


def random_state(n, seed):
    rng = np.random.default_rng(seed)
    q = rng.normal(size=(n, 3))
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    Omega = np.cross(q, rng.normal(size=(n, 3)))
    quaternions = np.array([quaternion_from_euler(*rng.uniform(-1.5, 1.5, 3)) for _ in range(n + 1)])
    return replace(
        hover_state(system(n)), r_0=np.array([1.0, 2.0, -20.0]), r_0_dot=rng.normal(size=3),
        quaternion_0=quaternions[0], omega_0=rng.normal(size=3), q=q, Omega=Omega, quaternion=quaternions[1:],
        omega=rng.normal(size=(n, 3)),
    )  # fmt: skip


@pytest.mark.parametrize("n", [3, 4, 8, MAX_VEHICLES])
def test_any_state_is_set_read_and_propagated_exactly(n):
    parameters, state = system(n), random_state(n, n)
    rng = np.random.default_rng(100 + n)
    f, tau, F, F_0 = rng.uniform(5, 10, n), rng.normal(size=(n, 3)), rng.normal(size=(n, 3)), rng.normal(size=3)
    inputs = Inputs(F=F + thrust_forces(state.quaternion, f), tau=tau, F_0=F_0)
    hz = 100_000
    begun = half_a_step_earlier(parameters, state, inputs, 1.0 / hz)
    with World(parameters, physics_hz=hz) as world:
        place(world, state, inputs)
        now = world.state()
        np.testing.assert_allclose(now.payload_position_in_world, state.r_0, atol=1e-12)
        np.testing.assert_allclose(now.payload_velocity_in_world, begun.r_0_dot, atol=1e-12)
        np.testing.assert_allclose(now.payload_rates_in_payload, begun.omega_0, atol=1e-12)
        np.testing.assert_allclose(uav_array(now, "position_in_world"), uav_positions(parameters, state), atol=1e-12)
        np.testing.assert_allclose(uav_array(now, "velocity_in_world"), uav_velocities(parameters, begun), atol=1e-12)
        np.testing.assert_allclose(uav_array(now, "rates_in_body"), begun.omega, atol=1e-12)
        for measured, given in zip(uav_array(now, "quaternion"), state.quaternion, strict=True):
            assert angle_between(measured, given) < 1e-5
        world.step(f.tolist(), tau.tolist(), F_0.tolist(), F.tolist())
        after = world.state()
    expected = rk4_step(parameters, state, inputs, 1.0 / hz)
    tolerance = 0.01 / hz  # of velocities: 0.01 m/s2 of accelerations of some 10 m/s2
    np.testing.assert_allclose(after.payload_velocity_in_world, expected.r_0_dot, atol=tolerance)
    np.testing.assert_allclose(after.payload_rates_in_payload, expected.omega_0, atol=tolerance)
    np.testing.assert_allclose(
        uav_array(after, "velocity_in_world"), uav_velocities(parameters, expected), atol=tolerance
    )
    np.testing.assert_allclose(uav_array(after, "rates_in_body"), expected.omega, atol=10 * tolerance)
    assert uav_array(after, "thrust").tolist() == f.tolist()


def test_parameters_that_engine_cannot_simulate_are_refused():
    assert MAX_VEHICLES >= 8
    with pytest.raises(UnsupportedWorld, match=f"{MAX_VEHICLES + 1} vehicles"):
        World(system(MAX_VEHICLES + 1))
    oblique = np.tile(np.diag([0.01, 0.01, 0.01]), (4, 1, 1))
    oblique[2, 0, 1] = oblique[2, 1, 0] = 0.001
    with pytest.raises(UnsupportedWorld, match=r"J\[2\]"):
        World(replace(system(), J=oblique))
    with pytest.raises(UnsupportedWorld, match="J_0"):
        World(replace(system(), J_0=np.diag([0.1, 0.1, 0.55])))


def test_free_body_keeps_velocity_and_angular_rates():
    """No damping, no joint motor, no limit: without forces nothing changes but by gravity."""
    parameters = system(4)
    spin = np.array([0.0, 0.0, 150.0])
    hover = hover_state(parameters, (0, 0, -500.0))
    start = replace(hover, r_0_dot=np.array([150.0, 0, 0]), omega=np.tile(spin, (4, 1)))
    with World(parameters) as world:
        place(world, start, Inputs(F=np.zeros((4, 3)), tau=np.zeros((4, 3))))
        state = run(world, 0.5, [0.0] * 4)
        assert state.payload_velocity_in_world == pytest.approx((150.0, 0.0, 9.81 * 0.5), abs=1e-6)
        np.testing.assert_allclose(uav_array(state, "rates_in_body"), np.tile(spin, (4, 1)), atol=1e-6)
