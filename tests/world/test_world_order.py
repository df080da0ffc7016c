"""The world at the flown rate is of second order: large motions against an exact integration of the dynamics.

The integration (:mod:`nonlinear_motion`) shares no code with the world; at its step of 5 ms it is exact to 0.05 mm.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from mission_files import MISSIONS
from nonlinear_motion import hover_state, rk4_step, uav_positions, uav_velocities
from paper_system import system
from world_runs import half_a_step_earlier, place, uav_array, unequal

from gcs.config import read_system
from idc_controller.model.nonlinear import Inputs, thrust_forces
from idc_controller.rotations import quaternion_from_euler
from vehicle_sim.world.multibody import MAX_VEHICLES
from vehicle_sim.world.rotors import RotorGeometry, Rotors
from vehicle_sim.world.world import World

HZ = 500
L_PAYLOAD = read_system(MISSIONS / "l_payload.toml").parameters()


def large_motion(parameters, seed):
    """A spin of 1.5 rad/s that spreads the links, payload and UAVs turning about all axes, links swinging."""
    n, rng = parameters.number_of_uavs, np.random.default_rng(seed)
    room = min(1.0, (4 / n) ** 1.5)  # many UAVs would meet
    tilt = 0.6 + room * rng.uniform(-0.15, 0.15, n)
    outwards = parameters.p[:, :2] / np.linalg.norm(parameters.p[:, :2], axis=1, keepdims=True)
    q = np.column_stack([-np.sin(tilt)[:, None] * outwards, np.cos(tilt)])
    attitudes = np.array([quaternion_from_euler(*rng.uniform(-0.8, 0.8, 3)) for _ in range(n + 1)])
    spin = np.array([0.0, 0.0, rng.choice([-1.5, 1.5])])
    omega_0 = spin + 0.4 * room * rng.normal(size=3)
    Omega = spin + 0.25 * room * rng.normal(size=(n, 3))
    return replace(
        hover_state(parameters, (1.0, 2.0, -1500.0)), r_0_dot=rng.normal(size=3), quaternion_0=attitudes[0],
        omega_0=omega_0, q=q, Omega=Omega - np.sum(q * Omega, axis=1, keepdims=True) * q, quaternion=attitudes[1:],
        omega=3.0 * rng.normal(size=(n, 3)),
    )  # fmt: skip


def free(parameters):
    """No inputs but gravity."""
    n = parameters.number_of_uavs
    return Inputs(F=np.zeros((n, 3)), tau=np.zeros((n, 3)))


def free_states(parameters, start, hz, seconds):
    """States of the world every 0.1 s of free motion."""
    n = parameters.number_of_uavs
    with World(parameters, physics_hz=hz) as world:
        place(world, start, free(parameters))
        for _ in range(round(10 * seconds)):
            for _ in range(round(0.1 * hz)):
                world.step([0.0] * n, [(0.0, 0.0, 0.0)] * n)
                assert world.contacts().pairs == 0
            yield world.state()


def errors(parameters, found, exact):
    """Errors of the payload's place and velocity and rates, and the largest of the UAVs' (mm, mm/s, mrad/s)."""
    differences = (
        found.payload_position_in_world - exact.r_0,
        found.payload_velocity_in_world - exact.r_0_dot,
        found.payload_rates_in_payload - exact.omega_0,
        uav_array(found, "position_in_world") - uav_positions(parameters, exact),
        uav_array(found, "velocity_in_world") - uav_velocities(parameters, exact),
        uav_array(found, "rates_in_body") - exact.omega,
    )
    return [1000.0 * np.linalg.norm(difference, axis=-1).max() for difference in differences]


@pytest.mark.parametrize(
    ("parameters", "seed"),
    [
        (system(4), 1),
        (L_PAYLOAD, 0),
        *(
            pytest.param(*case, marks=pytest.mark.long)
            for case in [(system(3), 0), (system(4), 6), (system(6), 10), (system(8), 0), (unequal(), 5)]
        ),
        pytest.param(system(MAX_VEHICLES), 4, marks=pytest.mark.long),
    ],
    ids=["4", "L", "3", "4 again", "6", "8", "unequal", "most"],
)
def test_free_motion_agrees_with_an_exact_integration(parameters, seed):
    start = exact = large_motion(parameters, seed)
    worlds = free_states(parameters, start, HZ, 5.0), free_states(parameters, start, 2 * HZ, 5.0)
    all_errors = []
    for whole, half in zip(*worlds, strict=True):
        for _ in range(20):
            exact = rk4_step(parameters, exact, free(parameters), 0.005)
        all_errors.append([errors(parameters, found, exact) for found in (whole, half)])
    payload, _, _, uavs, _, _ = np.max(all_errors, axis=0)[0]
    # Of first order: 4 to 125 mm and 60 to 350 mm.
    assert payload < 2.0 and uavs < 5.0
    # Velocities belong to the time of the poses from the beginning. Half a step older ones are 6 to 13 off.
    assert np.take(all_errors[0][0], [1, 2, 4, 5]).max() < 0.2
    whole, half = np.linalg.norm(all_errors, axis=0)
    assert np.min(whole / half) > 3.5


def test_changed_payload_mass_changes_its_moments_of_inertia_too():
    exact = large_motion(L_PAYLOAD, 0)
    now = L_PAYLOAD.with_payload_mass(2.4 * L_PAYLOAD.m_0)
    with World(L_PAYLOAD, physics_hz=HZ) as world:
        world.set_payload_mass(now.m_0)
        place(world, half_a_step_earlier(now, exact, free(now), 1.0 / HZ))
        for _ in range(2 * HZ):
            world.step([0.0] * 4, [(0.0, 0.0, 0.0)] * 4)
        found = world.state()
    for _ in range(400):
        exact = rk4_step(now, exact, free(now), 0.005)
    # With the moments of the old mass in the correction: 0.66.
    assert max(errors(now, found, exact)) < 0.2


GEOMETRY = RotorGeometry(thrust_max=30.0, rotor_speed_max=1000.0, arm_length=0.17, torque_to_thrust=0.016)
LAG = 0.05  # s, of the motors
HELD = 0.004  # s, that a command is held


def rotor_commands(parameters, k):
    """Rotor speeds (N, 4) (rad/s) that carry the system up and down and turn the UAVs a little to and fro."""
    n, t = parameters.number_of_uavs, k * HELD
    hover = np.sqrt(parameters.hover_thrust / (4.0 * GEOMETRY.k_f))
    shares = 1.0 + 0.15 * np.sin(5.0 * t + 0.05 * np.arange(n))[:, None]
    return hover[:, None] * (shares + 0.001 * np.sin(8.0 * t + np.arange(4.0 * n).reshape(n, 4)))


def wrenches(speeds):
    """Thrusts (N,) and torques (N, 3) of rotors at PX4's places, front right, rear left, front left, rear right."""
    forces, arm = GEOMETRY.k_f * speeds**2, GEOMETRY.arm_length / math.sqrt(2.0)
    places = arm * np.array([[1, 1, 0], [-1, -1, 0], [1, -1, 0], [-1, 1, 0]])
    torques = np.cross(places, forces[:, :, None] * np.array([0.0, 0.0, -1.0])).sum(axis=1)
    torques[:, 2] += GEOMETRY.torque_to_thrust * (forces @ [1.0, 1.0, -1.0, -1.0])
    return forces.sum(axis=1), torques


def under(speeds):
    """Inputs of rotors at these speeds."""

    def law(_, state):
        thrusts, torques = wrenches(speeds)
        return Inputs(F=thrust_forces(state.quaternion, thrusts), tau=torques)

    return law


def carried(parameters, hz, seconds):
    """States of the world every 0.1 s, flown by rotors that follow their commands."""
    n, steps = parameters.number_of_uavs, round(HELD * hz)
    rotors = Rotors([GEOMETRY] * n, [LAG] * n, 1.0 / hz, steps)
    rotors.speeds[:] = begun = rotor_commands(parameters, 0)
    start = hover_state(parameters, (0.0, 0.0, -50.0))
    with World(parameters, physics_hz=hz) as world:
        place(world, start, under(begun)(0.0, start))
        for k in range(round(seconds / HELD)):
            for thrusts, torques in zip(*rotors.advance(rotor_commands(parameters, k)), strict=True):
                world.step(thrusts, torques)
            if (k + 1) % 25 == 0:
                yield world.state()


def test_thrust_that_changes_acts_when_the_rotors_have_it():
    parameters = system(4)
    exact, speeds = hover_state(parameters, (0.0, 0.0, -50.0)), rotor_commands(parameters, 0)
    worlds = carried(parameters, HZ, 3.0), carried(parameters, 2 * HZ, 3.0)
    all_errors, heights = [], []
    for j, found in enumerate(zip(*worlds, strict=True)):
        for k in range(25 * j, 25 * j + 25):
            command, begun = rotor_commands(parameters, k), speeds

            def law(t, state, command=command, begun=begun):
                return under(command + (begun - command) * math.exp(-t / LAG))(t, state)

            exact = rk4_step(parameters, exact, law, HELD)
            speeds = command + (begun - command) * math.exp(-HELD / LAG)
        all_errors.append([errors(parameters, state, exact) for state in found])
        heights.append(exact.r_0[2])
    assert np.ptp(heights) > 0.3
    # A thrust that acts half a step early is 1 mm and 3 mm/s.
    assert np.max(all_errors, axis=0)[0].max() < 0.2
    whole, half = np.linalg.norm(all_errors, axis=0)
    assert whole / half == pytest.approx(4.0, rel=0.2)
