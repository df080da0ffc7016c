"""The attitude loop, hold plans, and the noise of the sensors: the parts of an autopilot."""

import math
from dataclasses import replace

import numpy as np
import pytest
from flying import AIRFRAME, measured
from quaternions import quaternion_product
from scipy.interpolate import BPoly

from gcs.config.vehicle_settings import LandDetectorSettings
from idc_controller.rotations import quaternion_from_euler
from idc_controller.rotations_float import attitude_of_force
from idc_controller.trajectory.settings import BrakingSettings
from vehicle_sim.autopilot.hold_control import HoldPlan
from vehicle_sim.autopilot.onboard_arrays import OnboardArrays
from vehicle_sim.autopilot.onboard_kernels import control_attitudes, mixed_forces, wanted_acceleration
from vehicle_sim.world.sensors import Measurement, NavigationSensors, SensorNoise

LEVEL = (1.0, 0.0, 0.0, 0.0)


def test_small_errors_are_angles_whatever_the_signs() -> None:
    for angles in np.eye(3) * 0.01:
        target = tuple(quaternion_from_euler(*angles))
        for a, b in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
            wanted = acceleration(tuple(a * np.array(LEVEL)), tuple(b * np.array(target)))
            assert wanted == pytest.approx(angles, rel=1e-4, abs=1e-9)


def test_error_is_in_the_body_frame() -> None:
    yawed = quaternion_from_euler(0.0, 0.0, math.pi / 2)
    target = quaternion_from_euler(0.02, 0.0, math.pi / 2)
    assert acceleration(tuple(yawed), tuple(target)) == pytest.approx([0.02, 0, 0], abs=1e-4)


def test_rates_alone_are_controlled_without_an_attitude():
    # A torque of J (kd (target - rates)), of which the rotors' wrench is made.
    J = np.array([[0.02, 0.001, 0.002], [0.001, 0.03, 0.003], [0.002, 0.003, 0.04]])
    airframe = replace(AIRFRAME, inertia=tuple(map(tuple, J.tolist())), attitude_kd=2.0)
    arrays = OnboardArrays.of([AIRFRAME, airframe], LandDetectorSettings())
    arrays.estimates[1] = [*(0.0,) * 3, *LEVEL, *(0.0,) * 3, 0.1, 0.2, 0.3]
    arrays.targets[1] = [0.0, *LEVEL, 0.2, 0.25, 0.35, 14.0]
    control(arrays)
    assert arrays.accelerations[1] == pytest.approx([0.2, 0.1, 0.1])
    lever, per_thrust = airframe.rotors.lever, airframe.rotors.torque_to_thrust
    a, b, c, d = (airframe.rotors.k_f * arrays.speeds[1] ** 2).tolist()
    wrench = [a + b + c + d, lever * (b + c - a - d), lever * (a + c - b - d), per_thrust * (a + b - c - d)]
    assert wrench == pytest.approx([14.0, *(J @ [0.2, 0.1, 0.1])])
    # The other one has neither an estimate nor a thrust.
    assert not arrays.speeds[0].any() and not arrays.accelerations[0].any()


def test_attitude_loop_of_a_team_is_that_of_each():
    rng = np.random.default_rng(5)
    arrays = OnboardArrays.of([AIRFRAME] * 6, LandDetectorSettings())
    for i in range(6):
        attitude, target = (quaternion_from_euler(*rng.uniform(-0.4, 0.4, 3)).tolist() for _ in range(2))
        arrays.estimates[i] = [*rng.normal(size=3), *attitude, *rng.normal(size=3), *(0.3 * rng.normal(size=3))]
        arrays.targets[i] = [1.0, *target, *(0.3 * rng.normal(size=3)), rng.uniform(2.0, 28.0)]
    control(arrays)
    kp, kd, rotors = AIRFRAME.attitude_kp, AIRFRAME.attitude_kd, AIRFRAME.rotors
    for i, (estimate, target) in enumerate(zip(arrays.estimates, arrays.targets, strict=True)):
        turn = quaternion_product(estimate[3:7] * [1, -1, -1, -1], target[1:5])
        wanted = kp * 2.0 * np.sign(turn[0]) * turn[1:] + kd * (target[5:8] - estimate[10:13])
        assert arrays.accelerations[i] == pytest.approx(wanted)
        geometry = 1 / (4 * rotors.lever), 1 / (4 * rotors.torque_to_thrust)
        forces = mixed_forces(target[8], *(np.array(AIRFRAME.inertia) @ wanted), rotors.thrust_max / 4, *geometry)
        assert rotors.k_f * arrays.speeds[i] ** 2 == pytest.approx(np.maximum(forces, 0.0), abs=1e-12)


def control(arrays):
    control_attitudes(arrays.airframes, arrays.estimates, arrays.targets, arrays.accelerations, arrays.speeds)


def acceleration(attitude, target):
    """Angular acceleration by the attitude alone, with kp = 1."""
    return wanted_acceleration(attitude, (0.0,) * 3, target, (0.0,) * 3, 2.0, 1e-9)


def test_hold_plan_is_the_bezier_curve_of_its_control_points() -> None:
    plan = HoldPlan.to_rest(2.0, (1.0, 2.0, -5.0), (3.0, -4.0, 1.0), 0.3, BrakingSettings())
    curve = BPoly(np.array(plan.control_points)[:, None, :], [2.0, 2.0 + plan.duration])
    for t in np.linspace(2.0, 2.0 + plan.duration, 20):
        for order, state in enumerate(plan.at(t)):
            assert state == pytest.approx(curve(t, order), abs=1e-12)


def test_hold_plan_is_consistent_with_its_own_derivatives() -> None:
    plan = HoldPlan.to_rest(2.0, (1.0, 2.0, -5.0), (3.0, -4.0, 1.0), 0.3, BrakingSettings(), 7.0, 0.5)
    h = 1e-4
    for t in np.linspace(2.1, 12.0, 53):
        before, here, after = plan.at(t - h), plan.at(t), plan.at(t + h)
        slope = (np.array(after.position) - before.position) / (2 * h)
        assert here.velocity == pytest.approx(slope, abs=1e-6)
        if abs(t - 7.0) > 0.01 and abs(t - 8.0) > 0.01:
            bend = (np.array(after.velocity) - before.velocity) / (2 * h)
            assert here.acceleration == pytest.approx(bend, abs=1e-5)
    start, end = plan.at(2.0), plan.at(7.0)
    assert start.velocity == pytest.approx((3.0, -4.0, 0.0)) and start.acceleration == pytest.approx((0.0, 0.0, 0.0))
    assert end.velocity == pytest.approx((0.0, 0.0, 0.0)) and end.position[2] == pytest.approx(-5.0)
    assert max(np.linalg.norm(plan.at(t).acceleration) for t in np.linspace(2, 7, 99)) <= 2.0 + 1e-9


def test_attitude_of_force_points_body_up_along_the_force() -> None:
    for yaw in (-2.0, 0.0, 1.0):
        force = np.array([1.0, -2.0, -9.0])
        w, x, y, z = attitude_of_force(*force, yaw)
        up = -np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
        assert up == pytest.approx(force / np.linalg.norm(force))


def test_sensor_noise_has_its_sigmas_and_repeats_by_seed_and_id() -> None:
    noise = SensorNoise(position=0.02, attitude=0.003, velocity=0.05, rates=0.008)
    truth = (tuple(quaternion_from_euler(0.1, 0.2, 2.0)), (0.1, 0.2, 0.3), (1.0, 2.0, -3.0), (0.5, 0.0, -0.5))

    def samples(seed: int, sensor_id: int, count: int = 4000) -> list[Measurement]:
        sensor = NavigationSensors([noise], seed, [sensor_id])
        return [measured(sensor, 0.0, *truth) for _ in range(count)]

    some = samples(1, 2)
    for field, index, sigma in (("position", 2, 0.02), ("velocity", 3, 0.05), ("rates", 1, 0.008)):
        error = np.array([getattr(s, field) for s in some]) - truth[index]
        assert error.std(axis=0) == pytest.approx([sigma] * 3, rel=0.06)
        assert np.abs(error.mean(axis=0)).max() < 4 * sigma / math.sqrt(4000)
    attitude = np.array([s.attitude for s in some])
    assert np.linalg.norm(attitude, axis=1) == pytest.approx(np.ones(4000))
    angle = 2 * np.arccos(np.clip(attitude @ np.array(truth[0]), -1, 1))
    assert math.sqrt(np.mean(angle**2) / 3) == pytest.approx(0.003, rel=0.06)
    assert samples(1, 2, 50) == some[:50]
    assert samples(2, 2, 1) != some[:1] and samples(1, 3, 1) != some[:1]
    perfect = measured(NavigationSensors([SensorNoise()], 1, [1]), 0.5, *truth)
    assert perfect.position == truth[2] and perfect.attitude == pytest.approx(truth[0], abs=1e-15)
