import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from vehicle_sim.autopilot.onboard_kernels import mixed_forces
from vehicle_sim.world.errors import SimulationError
from vehicle_sim.world.rotors import RotorGeometry, Rotors

GEOMETRY = RotorGeometry(thrust_max=30.0, rotor_speed_max=1000.0, arm_length=0.17, torque_to_thrust=0.016)
TORQUE = st.floats(-5.0, 5.0)


def forces_of(thrust, tau_x, tau_y, tau_z):
    """Rotor forces by the mixer (N)."""
    per_roll_pitch, per_yaw = 0.25 / GEOMETRY.lever, 0.25 / GEOMETRY.torque_to_thrust
    return mixed_forces(thrust, tau_x, tau_y, tau_z, GEOMETRY.thrust_max / 4.0, per_roll_pitch, per_yaw)


def wrench_of(f_1, f_2, f_3, f_4):
    """Thrust (N) and body torques (N m, FRD) of four rotor forces (N)."""
    a, c = GEOMETRY.lever, GEOMETRY.torque_to_thrust
    total = f_1 + f_2 + f_3 + f_4
    return total, a * (-f_1 + f_2 + f_3 - f_4), a * (f_1 - f_2 + f_3 - f_4), c * (f_1 + f_2 - f_3 - f_4)


def wrench_after(rotors, command):
    """Thrust and torques of one vehicle's rotors at the beginning of a step, which is taken."""
    [[thrust]], [[torques]] = rotors.advance(np.array([command], dtype=float))
    return thrust, *torques


def wrench_by_cross_products(forces: np.ndarray) -> np.ndarray:
    """Independent of the module's formulas: rotor positions and turning senses of PX4's X layout."""
    places = 0.17 / math.sqrt(2) * np.array([[1, 1, 0], [-1, -1, 0], [1, -1, 0], [-1, 1, 0]])
    pull = np.column_stack([np.zeros(4), np.zeros(4), -forces])
    torque = np.cross(places, pull).sum(axis=0)
    torque[2] += 0.016 * (forces @ [1, 1, -1, -1])  # counter-clockwise rotors push the body clockwise: +z in FRD
    return np.array([forces.sum(), *torque])


def test_rotors_have_the_wrench_of_the_x_layout() -> None:
    forces = np.array([1.0, 2.0, 3.5, 0.25])
    rotors = Rotors([GEOMETRY], [0.05], 0.002)
    rotors.speeds[:] = np.sqrt(forces / GEOMETRY.k_f)
    assert wrench_after(rotors, rotors.speeds[0]) == pytest.approx(wrench_by_cross_products(forces))
    assert wrench_of(*forces) == pytest.approx(wrench_by_cross_products(forces))


@settings(deadline=None, derandomize=True)
@given(st.floats(5.0, 25.0), st.floats(-0.2, 0.2), st.floats(-0.2, 0.2), st.floats(-0.01, 0.01))
def test_mixer_inverts_the_map_inside_the_limits(thrust: float, x: float, y: float, z: float) -> None:
    forces = forces_of(thrust, x, y, z)
    assert max(forces) <= 7.5
    assert wrench_of(*forces) == pytest.approx((thrust, x, y, z), abs=1e-9)


@settings(deadline=None, derandomize=True)
@given(st.floats(-5.0, 40.0), TORQUE, TORQUE, TORQUE)
def test_saturation_keeps_thrust_and_the_direction_of_roll_and_pitch(
    thrust: float, x: float, y: float, z: float
) -> None:
    forces = np.array(forces_of(thrust, x, y, z))
    assert np.all(forces >= -1e-9) and np.all(forces <= 7.5 + 1e-9)
    total, tau_x, tau_y, tau_z = wrench_of(*forces)
    assert total == pytest.approx(min(max(thrust, 0.0), 30.0), abs=1e-9)
    assert tau_x * y == pytest.approx(tau_y * x, abs=1e-9)
    for got, wanted in ((tau_x, x), (tau_y, y), (tau_z, z)):
        assert got * wanted >= -1e-12 and abs(got) <= abs(wanted) + 1e-9


@settings(deadline=None, derandomize=True)
@given(st.floats(0.0, 30.0), TORQUE, TORQUE, TORQUE)
def test_yaw_never_costs_roll_or_pitch_and_is_the_largest_that_fits(
    thrust: float, x: float, y: float, z: float
) -> None:
    forces = forces_of(thrust, x, y, z)
    without = wrench_of(*forces_of(thrust, x, y, 0.0))
    wrench = wrench_of(*forces)
    assert wrench[1:3] == pytest.approx(without[1:3], abs=1e-9)
    if abs(wrench[3]) < abs(z) - 1e-9:  # given up in part: then a rotor is at its limit
        assert min(min(forces), 7.5 - max(forces)) == pytest.approx(0.0, abs=1e-9)


def test_rotor_lag_is_exact_at_any_step_and_its_impulse_of_second_order() -> None:
    command = (700.0, 400.0, 900.0, 0.0)

    def motion(t: float, state: np.ndarray) -> np.ndarray:
        speeds, impulse = state[:4], wrench_of(*(GEOMETRY.k_f * state[:4] ** 2))
        return np.concatenate([(np.array(command) - speeds) / 0.05, impulse])

    exact = solve_ivp(motion, (0.0, 0.08), [600.0] * 4 + [0.0] * 4, rtol=1e-11, atol=1e-11).y[:, -1]
    errors = []
    for steps in (1, 20, 40):
        rotors = Rotors([GEOMETRY], [0.05], 0.08 / steps)
        rotors.speeds[:] = 600.0
        wrenches = [wrench_after(rotors, command) for _ in range(steps)]
        assert rotors.speeds[0] == pytest.approx(exact[:4], abs=1e-6)
        # A wrench acts from half a step before its time to half a step after it.
        wrenches.append(wrench_after(rotors, command))
        weights = np.array([0.5, *[1.0] * (steps - 1), 0.5])
        errors.append(weights @ wrenches * 0.08 / steps - exact[4:])
    assert np.abs(errors[1]).max() < 1e-3
    assert np.linalg.norm(errors[1]) / np.linalg.norm(errors[2]) == pytest.approx(4.0, rel=0.01)


def test_commands_above_largest_speed_are_clipped() -> None:
    rotors = Rotors([GEOMETRY], [0.05], 0.002)
    for _ in range(1000):
        thrust, *_ = wrench_after(rotors, (5000.0,) * 4)
    assert thrust == pytest.approx(30.0)


def test_invalid_parameters_are_refused() -> None:
    with pytest.raises(SimulationError, match="arm_length"):
        RotorGeometry(30.0, 1000.0, 0.0, 0.016)
    with pytest.raises(SimulationError, match="motor_time_constant"):
        Rotors([GEOMETRY], [0.0], 0.002)
