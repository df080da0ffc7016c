"""The moving set-point and the position control of a free vehicle, by themselves."""

import math

import numpy as np
import pytest
from free_bench import FRAME
from hypothesis import given, settings
from hypothesis import strategies as st

from gcs.config.vehicle_settings import FreeFlightSettings
from vehicle_sim.autopilot.free.position_control import NAN_VECTOR, PositionController, Reference, SpeedLimits
from vehicle_sim.autopilot.free.smooth_motion import SmoothMotion
from vehicle_sim.world.sensors import Measurement

SETTINGS = FreeFlightSettings()
LIMITS = SpeedLimits(5.0, 3.0, 1.5)
STEP = SETTINGS.control_interval
G, MASS, TOP = 9.81, 0.7, 30.0
AT_REST = Measurement(0.0, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


GENERATOR = np.random.default_rng(7)
GOALS = [(GENERATOR.uniform(-60, 60, 3), GENERATOR.uniform(-3, 3, 3)) for _ in range(4)]


@pytest.mark.parametrize(
    "goal, velocity", [*GOALS, ((0.3, 0.0, 0.0), (3.0, 0.0, -2.0)), ((0.0, 0.0, -50.0), (0, 0, 0))]
)
def test_moving_set_point_comes_to_its_goal_within_all_limits(goal, velocity):
    motion = SmoothMotion(SETTINGS)
    motion.start((0.0, 0.0, 0.0), tuple(velocity), 0.0)
    path = []
    for _ in range(3000):
        motion.to(goal, LIMITS, STEP)
        path.append((*motion.position, *motion.velocity))
    path = np.array(path)
    assert path[-1] == pytest.approx((*goal, 0.0, 0.0, 0.0), abs=1e-2)
    v = path[:, 3:]
    assert np.hypot(v[:, 0], v[:, 1]).max() <= max(1.02 * LIMITS.horizontal, math.hypot(*velocity[:2]))
    assert v[:, 2].min() >= -3.1 and v[:, 2].max() <= max(1.6, velocity[2])
    accelerations = np.diff(v, axis=0) / STEP
    assert np.hypot(accelerations[:, 0], accelerations[:, 1]).max() <= 1.05 * SETTINGS.acceleration
    assert np.abs(accelerations[:, 2]).max() <= 1.001 * SETTINGS.vertical_acceleration
    assert np.abs(np.diff(accelerations, axis=0)).max() <= 1.001 * SETTINGS.jerk * STEP


def test_path_to_a_goal_is_straight():
    motion = SmoothMotion(SETTINGS)
    motion.start((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0)
    away = []
    for _ in range(1500):
        motion.to((20.0, 10.0, -6.0), LIMITS, STEP)
        away.append(motion.position[2] + 6.0 * motion.position[0] / 20.0)
    assert np.abs(away).max() < 0.8


def test_yaw_turns_the_shorter_way_with_its_rate():
    motion = SmoothMotion(SETTINGS)
    motion.start((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), math.radians(170.0))
    motion.turn_to(math.radians(-170.0), 0.1)
    assert motion.yaw == pytest.approx(math.radians(170.0) + 0.1 * SETTINGS.yaw_rate)
    for _ in range(20):
        motion.turn_to(math.radians(-170.0), 0.1)
    assert motion.yaw == pytest.approx(math.radians(-170.0))


def controller():
    return PositionController(MASS, TOP, G, SETTINGS)


def lean_of(attitude):
    _, x, y, _ = attitude
    return math.acos(1.0 - 2.0 * (x * x + y * y))


def test_hover_is_the_own_weight_upright():
    reference = Reference((0.0, 0.0, 0.0), NAN_VECTOR, NAN_VECTOR, 0.3)
    attitude, thrust = controller().command(reference, AT_REST, LIMITS, STEP)
    assert thrust == pytest.approx(MASS * G)
    assert attitude == pytest.approx((math.cos(0.15), 0.0, 0.0, math.sin(0.15)))


@settings(max_examples=20, deadline=None)
@given(
    position=st.tuples(*[st.floats(-1e4, 1e4)] * 3),
    velocity=st.tuples(*[st.floats(-30.0, 30.0)] * 3),
    acceleration=st.tuples(*[st.floats(-100.0, 100.0)] * 3),
)
def test_no_reference_leaves_the_limits_of_tilt_and_thrust(position, velocity, acceleration):
    found = controller()
    for _ in range(3):
        attitude, thrust = found.command(Reference(position, velocity, acceleration, 0.0), AT_REST, LIMITS, STEP)
        assert lean_of(attitude) <= math.radians(SETTINGS.tilt_max_deg) + 1e-9
        assert SETTINGS.thrust_min * MASS * G - 1e-9 <= thrust <= SETTINGS.thrust_share_max * TOP + 1e-9


def test_axes_that_are_not_given_are_not_controlled():
    moving = AT_REST._replace(velocity=(3.0, 0.0, 0.0), position=(50.0, 0.0, 0.0))
    reference = Reference((math.nan, math.nan, 0.0), NAN_VECTOR, NAN_VECTOR, 0.0)
    attitude, _ = controller().command(reference, moving, LIMITS, STEP)
    assert lean_of(attitude) == 0.0
    braking, _ = controller().command(reference._replace(velocity=(0.0, 0.0, math.nan)), moving, LIMITS, STEP)
    assert lean_of(braking) > 0.3


def test_speed_commanded_by_a_far_position_is_bounded():
    far = Reference((1000.0, 0.0, 0.0), NAN_VECTOR, NAN_VECTOR, 0.0)
    fast = AT_REST._replace(velocity=(LIMITS.horizontal, 0.0, 0.0))
    attitude, _ = controller().command(far, fast, LIMITS, STEP)
    assert lean_of(attitude) == pytest.approx(0.0, abs=1e-6)


@given(st.floats(-20000.0, 20000.0), st.floats(-20000.0, 20000.0), st.floats(-500.0, 100.0))
def test_local_position_is_the_inverse_of_the_geodetic_one(north, east, down):
    assert FRAME.local(*FRAME.geodetic(north, east, down)) == pytest.approx((north, east, down), abs=1e-3)
