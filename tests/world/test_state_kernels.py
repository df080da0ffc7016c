"""The kernels of the true state and of the sensors agree with plain Python."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from idc_controller.rotations_float import into_body
from vehicle_sim.world.state_kernels import measure
from vehicle_sim.world.world_state import flipped, quaternion_from_engine, upward_axis

RNG = np.random.default_rng(7)


def quaternions(count):
    return Rotation.random(count, random_state=3).as_quat()


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


def test_upward_axis_is_opposite_to_third_axis_of_body():
    for attitude, offset in zip(quaternions(100).tolist(), RNG.normal(size=(100, 3)).tolist(), strict=True):
        down = into_body(quaternion_from_engine(attitude), flipped(offset))[2]
        assert np.dot(upward_axis(attitude), offset) == pytest.approx(-down, abs=1e-12)
