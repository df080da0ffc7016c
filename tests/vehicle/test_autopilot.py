"""An autopilot on a body: the attitude loop, arming, modes, failsafes, landing."""

import math

import numpy as np
import pymavlink.dialects.v20.common as mavlink
import pytest
from autopilot_flight import LEVEL, Flight, autopilot, setpoint
from flying import AIRFRAME
from onboard import step_alone
from scipy.linalg import expm

from gcs.config.vehicle_settings import HoldSettings
from gcs.mavlink import px4
from idc_controller.rotations import euler_from_quaternion, quaternion_from_euler
from vehicle_sim.autopilot.setpoints import AttitudeSetpoint
from vehicle_sim.world.sensors import Measurement, SensorNoise

STANDING = Measurement(0.0, LEVEL, (0.0,) * 3, (0.0,) * 3, (0.0,) * 3)


@pytest.fixture
def flying() -> Flight:
    flight = Flight()
    flight.take_off()
    return flight


# The attitude loop


@pytest.mark.parametrize("axis", [0, 1])
def test_attitude_loop_agrees_with_linear_model_of_the_ground(axis: int) -> None:
    """tilt'' = a; T_m a' = kp (set-point - tilt) - kd tilt' - a, with commands held for 4 ms.

    Exact steps of the linear model, so that any hidden delay of the loop shows; without the hold, the plain model
    still describes it within a few percent.
    """
    size = 0.03
    kp, kd, lag = AIRFRAME.attitude_kp, AIRFRAME.attitude_kd, AIRFRAME.motor_time_constant
    A = np.array([[0, 1, 0, 0], [0, 0, 1, 0], [0, 0, -1 / lag, 1 / lag], [0, 0, 0, 0]])  # tilt, rate, a, command
    step = expm(A * 0.002)
    state = np.zeros(4)
    plain = expm(np.array([[0, 1, 0, 0], [0, 0, 1, 0], np.array([-kp, -kd, -1, kp]) / lag, [0, 0, 0, 0]]) * 0.002)
    plain_state = np.array([0.0, 0.0, 0.0, size])

    flight = Flight()
    flight.take_off(2.0)
    flight.run(flight.body.now % 0.004)
    angles = [0.0, 0.0, 0.0]
    angles[axis] = size
    flight.target = setpoint(tuple(quaternion_from_euler(*angles)), flight.hover)
    flight.pilot.follow(flight.target, flight.body.now)
    for tick in range(400):
        if tick % 2 == 0:
            state[3] = kp * (size - state[0]) - kd * state[1]
        state = step @ state
        plain_state = plain @ plain_state
        flight.run(0.002)
        tilt = euler_from_quaternion(flight.body.attitude)[axis]
        assert tilt == pytest.approx(state[0], abs=0.006 * size)
        assert tilt == pytest.approx(plain_state[0], abs=0.04 * size)
    assert tilt == pytest.approx(size, rel=0.02)


def test_large_turns_with_negative_quaternions_settle(flying: Flight) -> None:
    target = quaternion_from_euler(0.3, -0.2, 1.5)
    flying.target = setpoint(tuple(-target), flying.hover)
    flying.run(1.5)
    assert abs(flying.body.attitude @ target) > math.cos(0.005)


def test_setpoint_of_rates_only_is_followed(flying: Flight) -> None:
    flying.target = AttitudeSetpoint(None, (0.0, 0.0, 0.4), flying.hover, 0)
    flying.run(1.0)
    assert flying.body.rates == pytest.approx([0.0, 0.0, 0.4], abs=0.01)


# Arming and modes


def test_arming_is_refused_without_measurements_or_tilted_or_moving() -> None:
    pilot = autopilot()
    assert pilot.arm(0.0).result == mavlink.MAV_RESULT_TEMPORARILY_REJECTED
    assert "navigation" in pilot.arm(0.0, force=True).text
    step_alone(pilot, STANDING._replace(attitude=(math.cos(0.6), math.sin(0.6), 0.0, 0.0)), 0.0)
    assert "side" in pilot.arm(0.0).text
    step_alone(pilot, STANDING._replace(velocity=(0.0, 0.0, 3.0)), 0.004)
    assert "moves" in pilot.arm(0.004).text
    step_alone(pilot, STANDING._replace(position=(math.nan, 0.0, 0.0)), 1.0)
    assert "navigation" in pilot.arm(1.0).text
    step_alone(pilot, STANDING, 2.0)
    assert pilot.arm(2.0).result == mavlink.MAV_RESULT_ACCEPTED and pilot.armed
    assert pilot.arm(2.0).result == mavlink.MAV_RESULT_ACCEPTED


def test_rotors_are_stopped_when_armed_on_the_ground() -> None:
    pilot = autopilot()
    step_alone(pilot, STANDING, 0.0)
    pilot.arm(0.0)
    assert step_alone(pilot, STANDING, 0.004) == (0.0,) * 4
    assert pilot.landed_state == mavlink.MAV_LANDED_STATE_ON_GROUND
    assert pilot.disarm().result == mavlink.MAV_RESULT_ACCEPTED and not pilot.armed


def test_disarming_in_the_air_needs_force(flying: Flight) -> None:
    assert flying.pilot.landed_state == mavlink.MAV_LANDED_STATE_IN_AIR
    assert flying.pilot.disarm().result == mavlink.MAV_RESULT_DENIED and flying.pilot.armed
    assert flying.pilot.disarm(force=True).result == mavlink.MAV_RESULT_ACCEPTED and not flying.pilot.armed
    flying.run(0.01)
    assert flying.body.command == (0.0,) * 4


@pytest.mark.parametrize(
    "mode",
    [px4.MODE_TAKEOFF, px4.MODE_MISSION, px4.MODE_RETURN, px4.MODE_POSCTL, px4.encode_custom_mode(77), 0],
)
def test_modes_that_cannot_be_flown_are_refused_and_change_nothing(flying: Flight, mode: int) -> None:
    answer = flying.pilot.enter_mode(mode, flying.body.now)
    assert answer.result == mavlink.MAV_RESULT_DENIED and answer.text
    assert flying.pilot.mode == px4.MODE_OFFBOARD


def test_hover_thrust_is_learned_in_flight(flying: Flight) -> None:
    assert flying.pilot.state.land.hover_thrust == pytest.approx(flying.body.mass * AIRFRAME.g, rel=0.04)


# Failsafes


def fly_forward(flight: Flight, speed: float) -> None:
    flight.target = setpoint(tuple(quaternion_from_euler(0.0, -0.2, 0.0)), flight.hover / math.cos(0.2))
    while flight.body.velocity[0] < speed:
        flight.run(0.05)
    flight.target = setpoint(thrust=flight.hover)
    flight.run(0.5)


def test_setpoint_loss_starts_braking_within_half_a_second_then_hold(flying: Flight) -> None:
    fly_forward(flying, 2.0)
    flying.run(0.05 - flying.body.now % 0.05)
    altitude, speed, start = flying.body.position[2], flying.body.velocity[0], flying.body.position[0]
    flying.ground_is_there = False
    flying.run(0.40)
    assert not flying.pilot.failsafe
    flying.run(0.10)
    assert flying.pilot.failsafe and flying.pilot.mode == px4.MODE_HOLD
    assert flying.pilot.armed
    flying.run(4.4)
    assert abs(flying.body.velocity[0]) < 0.15 * speed
    assert start < flying.body.position[0] < start + speed * 3.5
    assert flying.body.position[2] == pytest.approx(altitude, abs=0.25)
    assert flying.pilot.mode == px4.MODE_HOLD


def test_setpoint_loss_ends_in_gentle_descent_and_disarming(flying: Flight) -> None:
    flying.ground_is_there = False
    fastest = 0.0
    while flying.pilot.armed:
        flying.run(0.02)
        fastest = max(fastest, flying.body.velocity[2])
        assert flying.body.now < 60.0
        if flying.pilot.mode == px4.MODE_LAND:
            assert flying.pilot.landed_state == mavlink.MAV_LANDED_STATE_LANDING
    assert flying.body.position[2] == 0.0
    assert 0.4 < fastest < 0.65
    assert not flying.pilot.failsafe and not flying.pilot.state.land.in_air


def test_hold_and_landing_complete_with_noise() -> None:
    flight = Flight(noise=SensorNoise(0.02, math.radians(0.2), 0.02, 0.005))
    flight.take_off()
    flight.ground_is_there = False
    flight.run(5.0)
    low, high = flight.body.position - 0.3, flight.body.position + 0.3
    height = flight.body.position[2]
    assert np.all(flight.body.position > low) and np.all(flight.body.position < high)
    assert abs(euler_from_quaternion(flight.body.attitude)[:2]).max() < math.radians(5)
    flight.run(-height / 0.5 + 5.0)
    assert not flight.pilot.armed and flight.body.position[2] == 0.0


def test_resumed_setpoints_end_the_failsafe(flying: Flight) -> None:
    flying.ground_is_there = False
    flying.run(1.0)
    assert flying.pilot.failsafe
    flying.pilot.follow(flying.target, flying.body.now)
    flying.run(0.01)
    assert flying.pilot.failsafe  # one set-point is no stream
    flying.ground_is_there = True
    flying.run(0.2)
    assert not flying.pilot.failsafe and flying.pilot.mode == px4.MODE_OFFBOARD


def test_setpoint_loss_on_the_ground_disarms() -> None:
    flight = Flight()
    flight.run(0.02)
    flight.pilot.enter_offboard(flight.target, 0.0, flight.body.now)
    flight.target = setpoint(thrust=0.1)
    assert flight.pilot.arm(flight.body.now).text == ""
    flight.run(0.3)
    assert flight.pilot.armed
    flight.ground_is_there = False
    flight.run(0.6)
    assert not flight.pilot.armed


def test_setpoint_loss_of_vehicle_supported_by_its_link_holds_before_disarming() -> None:
    flight = Flight()
    flight.run(0.02)
    flight.pilot.enter_offboard(flight.target, 0.0, flight.body.now)
    flight.target = setpoint(thrust=0.8 * flight.hover)  # more than its own weight, too little to lift the load
    assert flight.pilot.arm(flight.body.now).text == ""
    flight.run(1.0)
    flight.ground_is_there = False
    flight.run(1.0)
    assert flight.pilot.armed and flight.pilot.failsafe
    assert flight.pilot.state.actuation.target[2] == pytest.approx(0.8 * flight.hover, rel=0.1)
    flight.run(4.0)
    assert flight.pilot.armed
    flight.run(2.0 + HoldSettings.unload_time)  # it would sink, and cannot: found out as after any descent
    assert not flight.pilot.armed and not flight.pilot.state.land.in_air


def test_hold_commanded_during_lift_off_keeps_thrust() -> None:
    flight = Flight()
    flight.run(0.02)
    flight.pilot.enter_offboard(flight.target, 0.0, flight.body.now)
    flight.target = setpoint(thrust=0.8 * flight.hover)
    assert flight.pilot.arm(flight.body.now).text == ""
    flight.run(1.0)
    assert not flight.pilot.state.land.in_air
    assert flight.pilot.enter_mode(px4.MODE_HOLD, flight.body.now).text == ""
    flight.run(0.1)
    assert flight.pilot.armed
    assert flight.pilot.state.actuation.target[2] == pytest.approx(0.8 * flight.hover, rel=0.1)


def test_failure_of_one_sensor_leaves_others_valid(flying: Flight) -> None:
    measure, known = flying.body.measure, flying.body.position[0]
    flying.body.measure = lambda: measure()._replace(position=(math.nan, 0.0, 0.0))
    flying.target = setpoint(tuple(quaternion_from_euler(0.1, 0.0, 0.0)), thrust=flying.hover)
    flying.run(2.0)
    seen = flying.pilot.state.navigation.estimate
    assert seen is not None and seen.position[0] == pytest.approx(known, abs=0.1)
    assert euler_from_quaternion(np.array(seen.attitude))[0] == pytest.approx(0.1, abs=0.02)
    assert not flying.pilot.state.navigation.is_valid(flying.body.now)


def test_attitude_is_integrated_from_rates_when_lost_on_board(flying: Flight) -> None:
    measure = flying.body.measure
    flying.body.measure = lambda: measure()._replace(attitude=(math.nan,) * 4)
    for roll in (0.1, -0.1, 0.05):
        flying.target = setpoint(tuple(quaternion_from_euler(roll, 0.0, 0.0)), thrust=flying.hover)
        flying.run(1.0)
        assert euler_from_quaternion(flying.body.attitude)[0] == pytest.approx(roll, abs=0.03)


def test_commanded_hold_lasts_while_ground_is_connected_then_lands(flying: Flight) -> None:
    assert flying.pilot.enter_mode(px4.MODE_HOLD, flying.body.now).text == ""
    flying.run(12.0)
    assert flying.pilot.mode == px4.MODE_HOLD and not flying.pilot.failsafe
    flying.ground_is_there = False
    flying.run(10.5)
    assert flying.pilot.mode == px4.MODE_LAND and flying.pilot.failsafe


def test_hold_commanded_in_failsafe_does_not_descend(flying: Flight) -> None:
    flying.ground_is_there = False
    flying.run(2.0)
    flying.pilot.enter_mode(px4.MODE_HOLD, flying.body.now)
    assert not flying.pilot.failsafe
    height = flying.body.position[2]
    flying.run(7.0)
    assert flying.body.position[2] == pytest.approx(height, abs=0.1)


def test_landing_by_setpoints_is_detected(flying: Flight) -> None:
    flying.target = setpoint(thrust=flying.hover * 0.99)
    while flying.body.position[2] < 0.0:
        flying.run(0.1)
    assert flying.pilot.state.land.in_air
    flying.target = setpoint(thrust=0.05)
    flying.run(1.0)
    assert not flying.pilot.state.land.in_air and flying.pilot.armed
    assert flying.pilot.disarm().result == mavlink.MAV_RESULT_ACCEPTED


# Plans and sensors


def test_arming_is_refused_in_offboard_when_setpoints_have_stopped() -> None:
    flight = Flight()
    flight.run(0.02)
    assert flight.pilot.enter_offboard(flight.target, flight.body.now, flight.body.now).text == ""
    flight.ground_is_there = False
    flight.run(0.4)
    assert "OFFBOARD without set-points" in flight.pilot.arm(flight.body.now + 0.1).text
    assert not flight.pilot.armed
