"""Measurement model: stacked observations, and vehicles in an estimated state."""

import numpy as np
import pytest
from estimator_scene import LAYOUT, MODEL, REFERENCE
from paper_system import system
from quaternions import quaternion_product

from idc_controller.estimation.estimator import Estimator
from idc_controller.estimation.measurement_model import MeasurementModel
from idc_controller.estimation.measurements import PAYLOAD, Attitude, MeasurementNoise, Position
from idc_controller.estimation.settings import MeasurementModelSettings
from idc_controller.estimation.vehicle_kernels import vehicle_states
from idc_controller.model.linear import StateLayout
from idc_controller.rotations import quaternion_from_euler, rotation_from_quaternion
from idc_controller.rotations_float import attitude_of_direction

pytestmark = pytest.mark.numerics


def test_stacked_observations_know_the_rows_of_the_payload_unit_and_of_each_height():
    model = MeasurementModel(MODEL, MeasurementNoise(), MeasurementModelSettings())
    keys = ((2, Position), (PAYLOAD, Attitude), (1, Attitude), (PAYLOAD, Position), (0, Position))
    observation = model.observation(keys)
    stack = observation.stack
    assert stack.sizes.tolist() == [6, 6, 4, 6, 6]
    assert np.flatnonzero(stack.of_payload).tolist() == [*range(6, 12), *range(16, 22)]
    assert (observation.uavs.tolist(), observation.heights.tolist()) == ([2, 0], [2, 24])


def test_estimated_vehicles_match_measurement_model():
    rng = np.random.default_rng(3)
    moved = REFERENCE.at(np.zeros(1)).x[0] + 0.01 * rng.standard_normal(LAYOUT.size)
    flat = REFERENCE.at(np.zeros(1))
    model = Estimator(MODEL).measurement_model
    vehicles = model.vehicles(0.0, moved)
    for measurement in (vehicles.sample(i, kind) for i in range(len(vehicles.values)) for kind in (Position, Attitude)):
        observation = model.observation(((measurement.source, type(measurement)),))
        expected = observation.rows.dense(LAYOUT.size) @ (moved - flat.x[0])
        samples, n = observation.samples([measurement]), LAYOUT.size
        innovation = model.innovation(observation, samples, flat, 0, np.zeros(n), np.eye(n))
        assert innovation.residual == pytest.approx(expected, abs=2e-3)


def vehicle_states_in_arrays(x, layout, p, l):
    """Position, velocity, quaternion and body rates (N, 13): the same as the kernel, in arrays over all UAVs."""

    def pairs(values):
        return values.reshape(-1, 2)

    def third(lateral):
        return np.sqrt(np.maximum(1.0 - (lateral**2).sum(axis=1), 0.01))

    attached = p @ rotation_from_quaternion(quaternion_from_euler(*x[layout.Theta])).T
    s, s_dot, n, n_dot = (pairs(x[part]) for part in (layout.s, layout.s_dot, layout.n, layout.n_dot))
    position = x[layout.r_0] + attached - l[:, None] * np.column_stack([s, third(s)])
    sinking = -(s * s_dot).sum(axis=1) / third(s)
    swinging = l[:, None] * np.column_stack([s_dot, sinking])
    velocity = x[layout.v_0] + np.cross(x[layout.omega], attached) - swinging
    roll, pitch = np.arcsin(n[:, 1]), np.arctan2(-n[:, 0], third(n))
    (a, b), (c, d) = (np.cos([roll / 2, pitch / 2]), np.sin([roll / 2, pitch / 2]))
    about_x = n_dot[:, 1] / np.cos(roll)
    about_y = (np.sin(pitch) * np.sin(roll) * about_x - n_dot[:, 0]) / np.cos(pitch)
    turn = np.column_stack([a * b, c * b, a * d, -c * d])
    return np.column_stack([position, velocity, turn, about_x, about_y, -np.tan(roll) * about_y])


@pytest.mark.parametrize("number_of_uavs", [3, 4, 8])
def test_estimated_vehicles_are_those_of_the_arithmetic_in_arrays(number_of_uavs):
    rng, parameters, layout = np.random.default_rng(8), system(number_of_uavs), StateLayout(number_of_uavs)
    for _ in range(50):
        x = rng.uniform(-0.6, 0.6, layout.size)
        links = x[layout.s.start : layout.s_dot.stop]
        found = vehicle_states(x[:12], links, x[layout.n], x[layout.n_dot], parameters.p, parameters.l)
        expected = vehicle_states_in_arrays(x, layout, parameters.p, parameters.l)
        np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-14)


@pytest.mark.parametrize("tilt", [(0.4, 0.3), (-0.3, 0.4), (0.0, -0.5)])
def test_estimated_vehicles_head_north_at_any_tilt(tilt):
    """As commanded: their detections are placed by it."""
    model, step = Estimator(MODEL).measurement_model, 1e-5
    n, n_dot = np.tile(tilt, LAYOUT.number_of_uavs), np.tile([0.7, -0.4], LAYOUT.number_of_uavs)
    x = REFERENCE.at(np.zeros(1)).x[0]
    x[LAYOUT.n_dot] = n_dot
    attitudes = []
    for time in (0.0, step):
        x[LAYOUT.n] = n + time * n_dot
        attitudes.append(model.vehicles(time, x).sample(0, Attitude))
    now, then = attitudes
    direction = [*tilt, -np.sqrt(1.0 - np.square(tilt).sum())]
    assert now.pose == pytest.approx(attitude_of_direction(direction), abs=1e-12)
    turned = quaternion_product(now.pose * [1.0, -1.0, -1.0, -1.0], then.pose)
    assert 2.0 * turned[1:] / step == pytest.approx(now.motion, abs=1e-4)
