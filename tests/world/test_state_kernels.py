"""The kernels of the true state and of the sensors agree with plain Python."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from idc_controller.rotations_float import into_body
from vehicle_sim.world.rotor_kernels import advance_rotors
from vehicle_sim.world.state_kernels import (
    LOAD_COLUMNS,
    MEMORY_COLUMNS,
    PART_COLUMNS,
    STATE_COLUMNS,
    measure,
    states_from_engine,
)
from vehicle_sim.world.world_state import flipped, product, quaternion_from_engine, upward_axis

RNG = np.random.default_rng(7)


def quaternions(count):
    return Rotation.random(count, random_state=3).as_quat()


def test_states_are_the_readings_in_the_projects_frames():
    readings, parts, memory = RNG.normal(size=(5, 13)), RNG.random((5, PART_COLUMNS)), np.zeros((5, MEMORY_COLUMNS))
    readings[:, 3:7] = quaternions(5)
    payload_in_axes = quaternions(6)[5]
    states, loads = np.empty((5, STATE_COLUMNS)), np.empty((5, LOAD_COLUMNS))
    states_from_engine(readings, parts, payload_in_axes, 0.002, 0, memory, states, loads)
    for i, now in enumerate(readings.tolist()):
        attitude = quaternion_from_engine(product(now[3:7], payload_in_axes.tolist()) if i == 0 else now[3:7])
        rates = into_body(attitude, flipped(now[10:]))
        assert states[i].tolist() == [*flipped(now[:3]), *attitude, *flipped(now[7:10]), *rates]


def test_samples_are_states_turned_and_shifted_by_the_normals():
    states, normals, sigmas = RNG.normal(size=(5, 13)), RNG.normal(size=(5, 12)), 0.1 * RNG.random((5, 4))
    states[:, 3:7] = quaternions(5)
    samples = np.empty((5, 13))
    measure(states, sigmas, normals, samples)
    for state, sample, (position, attitude, velocity, rates), n in zip(states, samples, sigmas, normals, strict=True):
        turned = Rotation.from_quat(state[[4, 5, 6, 3]]) * Rotation.from_quat([*(0.5 * attitude * n[:3]), 1.0])
        assert turned.approx_equal(Rotation.from_quat(sample[[4, 5, 6, 3]]), 1e-12)
        assert np.linalg.norm(sample[3:7]) == pytest.approx(1.0)
        assert sample[10:] == pytest.approx(state[10:] + rates * n[3:6], abs=1e-15)
        assert sample[:3] == pytest.approx(state[:3] + position * n[6:9], abs=1e-15)
        assert sample[7:10] == pytest.approx(state[7:10] + velocity * n[9:], abs=1e-15)


def test_rotors_of_a_team_advance_as_each_alone():
    motors = RNG.uniform(0.1, 1.0, (3, 5))
    motors[:, 4] = 800.0
    commands, speeds = RNG.uniform(0.0, 1000.0, (3, 4)), RNG.uniform(0.0, 1000.0, (3, 4))
    begun, thrusts, torques = speeds.copy(), np.empty((1, 3)), np.empty((1, 3, 3))
    advance_rotors(motors, commands, speeds, thrusts, torques)
    (thrusts,), (torques,) = thrusts, torques
    for i, (decay, k_f, lever, per_thrust, top) in enumerate(motors.tolist()):
        c = np.minimum(commands[i], top)
        f = k_f * begun[i] ** 2
        assert speeds[i] == pytest.approx(c + (begun[i] - c) * decay)
        assert thrusts[i] == pytest.approx(math.fsum(f))
        roll, pitch, yaw = lever * (f @ [-1, 1, 1, -1]), lever * (f @ [1, -1, 1, -1]), per_thrust * (f @ [1, 1, -1, -1])
        assert torques[i] == pytest.approx([roll, pitch, yaw])


def test_rotors_advance_by_several_steps_as_by_each_alone():
    motors, commands = RNG.uniform(0.1, 1.0, (3, 5)), RNG.uniform(0.0, 1000.0, (3, 4))
    begun = RNG.uniform(0.0, 1000.0, (3, 4))
    speeds, thrusts, torques = begun.copy(), np.empty((5, 3)), np.empty((5, 3, 3))
    advance_rotors(motors, commands, speeds, thrusts, torques)
    for thrust, torque in zip(thrusts, torques, strict=True):
        alone = np.empty((1, 3)), np.empty((1, 3, 3))
        advance_rotors(motors, commands, begun, *alone)
        assert np.array_equal(alone[0][0], thrust)
        assert np.array_equal(alone[1][0], torque)
    assert np.array_equal(speeds, begun)


def test_upward_axis_is_opposite_to_third_axis_of_body():
    for attitude, offset in zip(quaternions(100).tolist(), RNG.normal(size=(100, 3)).tolist(), strict=True):
        down = into_body(quaternion_from_engine(attitude), flipped(offset))[2]
        assert np.dot(upward_axis(attitude), offset) == pytest.approx(-down, abs=1e-12)
