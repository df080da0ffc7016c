"""The PyBullet world against the constrained dynamics, and its pad, cradles, ground, contacts and obstacles."""

import math
from dataclasses import replace

import numpy as np
import pytest

from idc_controller.model.nonlinear import (
    Inputs,
    accelerations,
    hover_inputs,
    hover_state,
    rk4_step,
    thrust_forces,
    uav_positions,
    uav_velocities,
)
from idc_controller.parameters import SystemParameters, polygon_attachments
from idc_controller.rotations import quaternion_from_euler, quaternion_product, rotation_from_quaternion
from vehicle_sim.errors import SimulationError, UnsupportedWorld
from vehicle_sim.multibody import MAX_VEHICLES
from vehicle_sim.world import World

STANDING_ON_PAD = -0.30
STANDING_ON_GROUND = -0.25


def table(n=4):
    """Table I of the paper, for any number of UAVs."""
    return SystemParameters(
        m_0=3.1, J_0=np.diag([0.29, 0.29, 0.55]), payload_size=np.array([1.0, 1.0, 0.5]), m=np.full(n, 0.7),
        J=np.tile(0.01 * np.eye(3), (n, 1, 1)), p=polygon_attachments(n, 1.0, -0.25), l=np.full(n, 3.2),
        disc_radius=0.3, thrust_max=30.0, motor_time_constant=0.05, attitude_kp=100.0, attitude_kd=16.0,
    )  # fmt: skip


def unequal():
    """Three different UAVs, links and attachment points, unequal moments of inertia."""
    return replace(
        table(3), m=np.array([0.7, 0.9, 0.6]), l=np.array([3.2, 2.8, 3.0]), J_0=np.diag([0.2, 0.35, 0.5]),
        p=np.array([[0.5, 0.1, -0.25], [-0.4, 0.45, -0.2], [-0.3, -0.6, -0.25]]),
        J=np.array([np.diag(d) for d in ([0.01, 0.012, 0.02], [0.01, 0.01, 0.01], [0.015, 0.01, 0.02])]),
    )  # fmt: skip


def uav_array(state, field):
    return np.array([getattr(uav, field) for uav in state.uavs])


def angle_between(a, b):
    """Angle of the rotation between two w-first quaternions (deg)."""
    difference = quaternion_product(np.multiply(a, [1, -1, -1, -1]), b)
    return np.degrees(2 * np.arctan2(np.linalg.norm(difference[1:]), abs(difference[0])))


def link_lengths(parameters, state):
    R_0 = rotation_from_quaternion(state.payload_quaternion)
    attachments = state.payload_position_in_world + parameters.p @ R_0.T
    return np.linalg.norm(uav_array(state, "position_in_world") - attachments, axis=1)


def run(world, seconds, thrusts, torques=None):
    torques = torques or [(0.0, 0.0, 0.0)] * world.number_of_uavs
    for _ in range(round(seconds * world.physics_hz)):
        world.step(thrusts, torques)
    return world.state()


# --- the dynamics -----------------------------------------------------------------------------------------------


def displaced(parameters, y, altitude=20.0):
    """State at rest beside hover: y = position, small rotation vector, tilts of the links in the world (2 each)."""
    tilt = y[6:].reshape(-1, 2)
    q_world = np.column_stack([tilt, np.sqrt(1 - np.sum(tilt**2, axis=1))])
    angle = np.linalg.norm(y[3:6])
    axis = y[3:6] / angle if angle > 0 else np.zeros(3)
    quaternion_0 = np.append(math.cos(angle / 2), math.sin(angle / 2) * axis)
    hover = hover_state(parameters)
    R_0 = rotation_from_quaternion(quaternion_0)
    return replace(hover, r_0=y[:3] - [0, 0, altitude], quaternion_0=quaternion_0, q=q_world @ R_0)


def displacement(parameters, state, altitude=20.0):
    """The y of :func:`displaced`, of a world's state."""
    w, *xyz = state.payload_quaternion
    R_0 = rotation_from_quaternion(state.payload_quaternion)
    link = state.payload_position_in_world + parameters.p @ R_0.T - uav_array(state, "position_in_world")
    tilt = (link / parameters.l[:, None])[:, :2]
    position = np.add(state.payload_position_in_world, [0, 0, altitude])
    return np.concatenate([position, 2 * np.array(xyz) / w, tilt.ravel()])


def hover_modes(parameters):
    """Frequencies (rad/s), shapes and left eigenvectors of the oscillations about hover, by finite differences."""
    size, h = 6 + 2 * parameters.number_of_uavs, 1e-6
    inputs = hover_inputs(parameters)

    def second_derivative(y):
        state = displaced(parameters, y)
        acceleration = accelerations(parameters, state, inputs)
        q_ddot = np.cross(acceleration.Omega_dot, state.q) @ state.R_0.T  # at rest, in the world
        return np.concatenate([acceleration.r_0_ddot, acceleration.omega_0_dot, q_ddot[:, :2].ravel()])

    columns = [(second_derivative(h * e) - second_derivative(-h * e)) / (2 * h) for e in np.eye(size)]
    values, shapes = np.linalg.eig(-np.array(columns).T)
    np.testing.assert_allclose(values.imag, 0.0, atol=1e-6)
    left = np.linalg.pinv(shapes)
    moving = values.real > 0.1
    return np.sqrt(values.real[moving]), shapes.real.T[moving], left.real[moving]


@pytest.mark.parametrize("n", [3, 4, 6])
def test_hover_modes(n):
    parameters = table(n)
    frequencies, shapes, left = hover_modes(parameters)
    # Of 6 + 2N coordinates, position and yaw of the whole cost no energy.
    assert len(frequencies) == 2 + 2 * n
    lift = [(0.0, 0.0, -float(f)) for f in parameters.hover_thrust]
    zeros, no_torque = [0.0] * n, [(0.0, 0.0, 0.0)] * n
    chosen = np.unique(np.round(frequencies, 4), return_index=True)[1]
    assert len(chosen) >= 3
    with World(parameters, physics_hz=500) as world:
        for mode in chosen:
            omega, shape, projection = frequencies[mode], shapes[mode], left[mode]
            world.place(displaced(parameters, 0.01 * shape / np.abs(shape).max()))
            start = world.time
            times, values = [], []
            while world.time - start < 3.3 * 2 * np.pi / omega:
                world.step(zeros, no_torque, uav_forces=lift)
                times.append(world.time)
                values.append(projection @ displacement(parameters, world.state()))
            t, y = np.array(times), np.array(values)
            before = np.flatnonzero(y[:-1] * y[1:] < 0)
            crossings = t[before] - y[before] * (t[before + 1] - t[before]) / (y[before + 1] - y[before])
            assert len(crossings) >= 6
            measured = np.pi * (len(crossings) - 1) / (crossings[-1] - crossings[0])
            assert measured == pytest.approx(omega, rel=1e-3)


def forced(parameters, hz, seconds, law):
    """World and Runge-Kutta side by side under ``law(time) -> (world forces on UAVs, thrusts, torques)``.

    Runge-Kutta takes the law as it is; the world takes it at the beginning of each step, as any controller would.
    Yields pairs every 0.1 s.
    """
    state = hover_state(parameters, (0, 0, -20.0))
    h, tenth = 0.01, round(0.1 * hz)

    def inputs(time):
        def at(since, s):
            F, f, tau = law(time + since)
            return Inputs(F=F + thrust_forces(s.quaternion, f), tau=tau)

        return at

    with World(parameters, physics_hz=hz) as world:
        world.place(state)
        for k in range(round(10 * seconds)):
            for j in range(tenth):
                F, f, tau = law((k * tenth + j) / hz)
                world.step(f.tolist(), tau.tolist(), uav_forces=F.tolist())
                assert world.contacts() == 0
            for j in range(10):
                state = rk4_step(parameters, state, inputs(0.1 * k + h * j), h)
            yield world.state(), state


def world_force_law(parameters, seed=0):
    """Everybody pushed to and fro sideways, each a little differently; thrust off, torques on."""
    n = parameters.number_of_uavs
    rng = np.random.default_rng(seed)
    rate, sign = rng.uniform(1.0, 4.0, (n, 3)), rng.choice([-1.0, 1.0], (n, 3))
    lift = np.outer(parameters.hover_thrust, [0, 0, -1.0])
    together = np.outer(parameters.hover_thrust / parameters.hover_thrust.mean(), [1.2, 0.8, 0.3]) * 4 / n
    apart = np.array([0.15, 0.15, 0.1])

    def law(t):
        F = lift + together * np.sin(np.array([2.0, 1.5, 2.5]) * t) + apart * sign * np.sin(rate * t)
        return F, np.zeros(n), 0.005 * sign * np.sin(rate * t)

    return law


@pytest.mark.parametrize("parameters", [table(3), table(4), table(6), unequal()], ids=["3", "4", "6", "unequal"])
def test_forced_motion_agrees_with_an_independent_integration(parameters):
    pairs = list(forced(parameters, 1000, 5.0, world_force_law(parameters)))
    path = np.array([world.payload_position_in_world for world, _ in pairs])
    assert np.linalg.norm(path[-1] - path[0]) > 1.0  # it really travelled
    payload = [np.linalg.norm(world.payload_position_in_world - state.r_0) for world, state in pairs]
    attitude = [angle_between(world.payload_quaternion, state.quaternion_0) for world, state in pairs]
    uavs = [
        np.linalg.norm(uav_array(world, "position_in_world") - uav_positions(parameters, state), axis=1).max()
        for world, state in pairs
    ]
    uav_attitude = [
        max(angle_between(a, b) for a, b in zip(uav_array(world, "quaternion"), state.quaternion, strict=True))
        for world, state in pairs
    ]
    assert max(payload) < 1e-3
    assert max(attitude) < 0.1
    assert max(uavs) < 3e-3
    assert max(uav_attitude) < 0.1
    for world, _ in pairs:
        np.testing.assert_allclose(link_lengths(parameters, world), parameters.l, atol=1e-9)


def test_thrust_and_torque_act_in_the_uavs_frames():
    parameters = table(4)

    def law(t):
        f = parameters.hover_thrust * (1 + np.array([0.03, 0.05, 0.04, 0.02]) * np.sin(3 * t))
        tau = 0.004 * np.sin(2 * t) * np.array([[1.0, 0.5, 2.0]] * 4)
        return np.zeros((4, 3)), f, tau

    for world, state in forced(parameters, 1000, 2.0, law):
        assert np.linalg.norm(world.payload_position_in_world - state.r_0) < 1e-3
        np.testing.assert_allclose(uav_array(world, "position_in_world"), uav_positions(parameters, state), atol=3e-3)
        np.testing.assert_allclose(uav_array(world, "velocity_in_world"), uav_velocities(parameters, state), atol=0.01)
        np.testing.assert_allclose(uav_array(world, "rates_in_body"), state.omega, atol=0.01)
        np.testing.assert_allclose(world.payload_rates_in_payload, state.omega_0, atol=0.01)
    assert np.abs(state.omega).max() > 0.1


def random_state(n, seed):
    rng = np.random.default_rng(seed)
    q = rng.normal(size=(n, 3))
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    Omega = np.cross(q, rng.normal(size=(n, 3)))
    quaternions = np.array([quaternion_from_euler(*rng.uniform(-1.5, 1.5, 3)) for _ in range(n + 1)])
    return replace(
        hover_state(table(n)), r_0=np.array([1.0, 2.0, -20.0]), r_0_dot=rng.normal(size=3), quaternion_0=quaternions[0],
        omega_0=rng.normal(size=3), q=q, Omega=Omega, quaternion=quaternions[1:], omega=rng.normal(size=(n, 3)),
    )  # fmt: skip


@pytest.mark.parametrize("n", [3, 4, 8, MAX_VEHICLES])
def test_any_state_is_placed_read_and_moved_on_rightly(n):
    parameters, state = table(n), random_state(n, n)
    rng = np.random.default_rng(100 + n)
    f, tau, F, F_0 = rng.uniform(5, 10, n), rng.normal(size=(n, 3)), rng.normal(size=(n, 3)), rng.normal(size=3)
    hz = 100_000
    with World(parameters, physics_hz=hz) as world:
        world.place(state)
        now = world.state()
        np.testing.assert_allclose(now.payload_position_in_world, state.r_0, atol=1e-12)
        np.testing.assert_allclose(now.payload_velocity_in_world, state.r_0_dot, atol=1e-12)
        np.testing.assert_allclose(now.payload_rates_in_payload, state.omega_0, atol=1e-12)
        np.testing.assert_allclose(uav_array(now, "position_in_world"), uav_positions(parameters, state), atol=1e-12)
        np.testing.assert_allclose(uav_array(now, "velocity_in_world"), uav_velocities(parameters, state), atol=1e-12)
        np.testing.assert_allclose(uav_array(now, "rates_in_body"), state.omega, atol=1e-12)
        for measured, given in zip(uav_array(now, "quaternion"), state.quaternion, strict=True):
            assert angle_between(measured, given) < 1e-5
        world.step(f.tolist(), tau.tolist(), F_0.tolist(), F.tolist())
        after = world.state()
    inputs = Inputs(F=F + thrust_forces(state.quaternion, f), tau=tau, F_0=F_0)
    expected = rk4_step(parameters, state, inputs, 1.5 / hz)  # what is placed belongs to half a step earlier
    tolerance = 0.01 / hz  # of velocities: 0.01 m/s2 of accelerations of some 10 m/s2
    np.testing.assert_allclose(after.payload_velocity_in_world, expected.r_0_dot, atol=tolerance)
    np.testing.assert_allclose(after.payload_rates_in_payload, expected.omega_0, atol=tolerance)
    np.testing.assert_allclose(
        uav_array(after, "velocity_in_world"), uav_velocities(parameters, expected), atol=tolerance
    )
    np.testing.assert_allclose(uav_array(after, "rates_in_body"), expected.omega, atol=10 * tolerance)
    assert uav_array(after, "thrust").tolist() == f.tolist()


def test_a_world_that_the_engine_computes_wrongly_is_refused():
    assert MAX_VEHICLES >= 8
    with pytest.raises(UnsupportedWorld, match=f"{MAX_VEHICLES + 1} vehicles"):
        World(table(MAX_VEHICLES + 1))
    oblique = np.diag([0.29, 0.29, 0.55])
    oblique[0, 1] = oblique[1, 0] = 0.05
    with pytest.raises(UnsupportedWorld, match="J_0"):
        World(replace(table(), J_0=oblique))
    with pytest.raises(UnsupportedWorld, match="J_0"):
        World(replace(table(), J_0=np.diag([0.1, 0.1, 0.55])))


def test_a_body_thrown_in_the_air_keeps_its_velocity_and_every_rate():
    """No damping, no joint motor, no limit: without forces nothing changes but by gravity."""
    parameters = table(4)
    spin = np.array([0.0, 0.0, 150.0])
    hover = hover_state(parameters, (0, 0, -500.0))
    start = replace(hover, r_0_dot=np.array([150.0, 0, 0]), omega=np.tile(spin, (4, 1)))
    with World(parameters) as world:
        world.place(start)
        state = run(world, 0.5, [0.0] * 4)
        assert state.payload_velocity_in_world == pytest.approx((150.0, 0.0, 9.81 * 0.501), abs=1e-6)
        np.testing.assert_allclose(uav_array(state, "rates_in_body"), np.tile(spin, (4, 1)), atol=1e-6)


# --- ground, pad and cradles ------------------------------------------------------------------------------------


@pytest.mark.parametrize("parameters", [table(3), table(4), table(8), unequal()], ids=["3", "4", "8", "unequal"])
def test_standing_on_the_pad_nothing_moves(parameters):
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
        assert world.contacts() == 0


def test_at_the_start_links_are_upright_on_the_attachment_points():
    parameters = table(4)
    with World(parameters) as world:
        expected = uav_positions(parameters, hover_state(parameters, (0, 0, STANDING_ON_PAD)))
        np.testing.assert_allclose(uav_array(world.state(), "position_in_world"), expected, atol=1e-12)


def test_each_cradle_lets_go_when_its_uav_lifts_more_than_itself():
    parameters = table(4)
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


def land(world, offset=0.0):
    """Set the system down from 0.1 m above its stand at ``offset`` m north, sinking at 0.2 m/s; then motors off."""
    parameters = world.parameters
    height = STANDING_ON_PAD if offset == 0.0 else STANDING_ON_GROUND
    start = hover_state(parameters, (offset, 0.0, height - 0.1))
    world.place(replace(start, r_0_dot=np.array([0.0, 0.0, 0.2])))
    hover = parameters.hover_thrust.tolist()
    assert not uav_array(world.state(), "cradled").any()
    while not world.touching_ground():
        assert world.time < 2.0
        world.step(hover, [(0.0, 0.0, 0.0)] * 4)
    for factor in np.linspace(1.0, 0.0, 1000):
        world.step([factor * f for f in hover], [(0.0, 0.0, 0.0)] * 4)
    return run(world, 2.0, [0.0] * 4)


def test_landed_uavs_are_caught_where_they_stand_and_can_take_off_again():
    parameters = table(4)
    with World(parameters) as world:
        state = land(world)
        assert uav_array(state, "cradled").all()
        assert state.payload_position_in_world == pytest.approx((0, 0, STANDING_ON_PAD), abs=2e-3)
        expected = uav_positions(parameters, hover_state(parameters, (0, 0, STANDING_ON_PAD)))
        np.testing.assert_allclose(uav_array(state, "position_in_world"), expected, atol=0.03)
        assert np.abs(uav_array(state, "velocity_in_world")).max() < 1e-3
        assert world.contacts() == 0
        state = run(world, 1.0, (1.03 * parameters.hover_thrust).tolist())
        assert not uav_array(state, "cradled").any()
        assert state.payload_position_in_world[2] < STANDING_ON_PAD - 0.05
        assert not world.touching_ground()


def test_landing_beside_the_pad_stands_on_the_ground():
    with World(table(4)) as world:
        state = land(world, offset=5.0)
        assert state.payload_position_in_world == pytest.approx((5.0, 0, STANDING_ON_GROUND), abs=2e-3)
        assert uav_array(state, "cradled").all()
        assert world.touching_ground()
        assert world.contacts() == 0


def test_a_payload_that_hangs_on_some_cradles_stands_for_the_others():
    with World(table()) as world:
        world._cradles.release(3)
        world.touching_ground = lambda: False
        run(world, 0.01, [0.0] * 4)
        assert uav_array(world.state(), "cradled").all()


def test_no_cradle_catches_in_the_air():
    with World(table(4)) as world:
        world.place(hover_state(table(4), (0, 0, -1.5)))
        state = run(world, 0.05, [0.0] * 4)
        assert not uav_array(state, "cradled").any()
        assert state.payload_velocity_in_world[2] == pytest.approx(9.81 * 0.051, rel=1e-6)


# --- contacts and obstacles ---------------------------------------------------------------------------------------


def test_uav_driven_into_a_sphere_counts_as_contact():
    parameters = table(4)
    with World(parameters) as world:
        world.place(hover_state(parameters, (0, 0, -10.0)))
        front_right = uav_positions(parameters, hover_state(parameters, (0, 0, -10.0)))[0]
        world.add_obstacle("ball", "sphere", front_right + np.array([1.0, 0, 0]), radius=0.5)
        assert world.closest_distance("ball") == pytest.approx(0.2, abs=1e-3)
        seen = []
        lift = parameters.hover_thrust.tolist()
        for _ in range(1000):
            world.step(lift, [(0.0, 0.0, 0.0)] * 4, uav_forces=[(1.0, 0.0, 0.0)] * 4)
            seen.append(world.contacts())
        assert seen[0] == 0
        assert max(seen) >= 1
        assert not world.touching_ground()


def test_a_link_meets_a_pole_and_a_wall_stops_the_payload():
    parameters = table(4)
    with World(parameters) as world:
        world.place(hover_state(parameters, (0, 0, -6.0)))
        world.add_obstacle("pole", "pole", (0.6, 0.5), radius=0.05, size=(0, 0, 8.0))
        assert world.closest_distance("pole") == pytest.approx(0.04, abs=2e-3)
        world.move_obstacle("pole", (0.55, 0.5, -4.0))
        world.add_obstacle("wall", "wall", (-2.5, 0, -6.0), size=(1.0, 4.0, 0.2))
        # Payload to wall: 2.5 - 0.5 - 0.5; turned by 90 degrees the wall is 2 m long towards it, and they touch.
        assert world.closest_distance("wall") == pytest.approx(1.5, abs=3e-3)
        world.move_obstacle("wall", (-2.5, 0, -6.0), yaw=math.pi / 2)
        assert world.closest_distance("wall") == pytest.approx(0.0, abs=3e-3)
        world.move_obstacle("wall", (-20.0, 0, -6.0))
        world.step([14.0] * 4, [(0.0, 0.0, 0.0)] * 4)
        assert world.contacts() == 1  # link 1 and the pole
        world.move_obstacle("pole", (0.0, 0.0, -4.0))
        world.move_obstacle("wall", (-0.99, 0, -6.0))
        world.place(hover_state(parameters, (0, 0, -6.0)))
        world.step([14.0] * 4, [(0.0, 0.0, 0.0)] * 4)
        assert world.contacts() == 2  # the payload with the pole and with the wall
        assert world.closest_distance("pole") < 0
        world.move_obstacle("pole", (50.0, 50.0, -4.0))
        assert world.closest_distance("pole", within=10.0) == math.inf
        assert [(o.name, o.shape) for o in world.obstacles()] == [("pole", "pole"), ("wall", "wall")]
        assert world.obstacles()[0].position_in_world == (50.0, 50.0, -4.0)


def test_wall_yaw_turns_clockwise_seen_from_above():
    with World(table(4)) as world:
        world.place(hover_state(table(4), (0, 0, -10.0)))
        # A long wall to the north-east, lying towards the payload only when yaw is +45 degrees (north to east).
        world.add_obstacle("wall", "wall", (3.0, 3.0, -10.0), size=(4.0, 0.1, 0.4), yaw=math.pi / 4)
        towards = world.closest_distance("wall")
        world.move_obstacle("wall", (3.0, 3.0, -10.0), yaw=-math.pi / 4)
        assert towards < world.closest_distance("wall") - 1.0


def test_discs_that_meet_count():
    parameters = table(4)
    with World(parameters) as world:
        hover = hover_state(parameters, (0, 0, -10.0))
        tilt = np.array([0.0, 0.21 / 3.2, 0.0])
        q = hover.q + np.array([tilt, -tilt, 0 * tilt, 0 * tilt])
        world.place(replace(hover, q=q / np.linalg.norm(q, axis=1, keepdims=True)))
        world.step([14.0] * 4, [(0.0, 0.0, 0.0)] * 4)
        assert world.contacts() == 1


def test_toppled_system_on_the_ground_counts():
    parameters = table(4)
    with World(parameters) as world:
        # Links on their way down when the payload reaches the ground: too fast for the cradles.
        state = hover_state(parameters, (5, 0, -0.26))
        world.place(replace(state, Omega=np.tile([0.0, 0.5, 0.0], (4, 1))))
        counts, speeds = [], []
        for _ in range(2500):
            world.step([0.0] * 4, [(0.0, 0.0, 0.0)] * 4)
            counts.append(world.contacts())
            speeds.append(np.abs(uav_array(world.state(), "velocity_in_world")).max())
        assert counts[0] == 0
        assert max(counts) >= 2  # discs or links on the ground
        # The wreck lies still instead of flying apart; free fall from 4 m ends at 9 m/s.
        assert max(speeds) < 12.0
        assert speeds[-1] < 0.5
        assert uav_array(world.state(), "position_in_world")[:, 2].min() > -0.8


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("a", "cube", (0, 0, 0), 1.0), "shape"),
        (("a", "sphere", (0, 0, 0)), "radius"),
        (("a", "sphere", (0, math.nan, 0), 1.0), "finite"),
        (("a", "sphere", (0, 0), 1.0), "three numbers"),
        (("a", "pole", (0, 0), 1.0), "height"),
        (("a", "wall", (0, 0, 0), 0.0, (1, 0, 1)), "size"),
        (("taken", "sphere", (0, 0, 0), 1.0), "taken"),
    ],
)
def test_obstacles_without_a_meaning_are_refused(arguments, reason):
    with World(table(4)) as world:
        world.add_obstacle("taken", "sphere", (9, 9, -9), radius=1.0)
        with pytest.raises(SimulationError, match=reason):
            world.add_obstacle(*arguments)
        with pytest.raises(SimulationError, match="nobody"):
            world.move_obstacle("nobody", (0, 0, 0))
        with pytest.raises(SimulationError, match="nobody"):
            world.closest_distance("nobody")


# --- repeatability ------------------------------------------------------------------------------------------------


def scenario(world, look):
    """Take-off, a bump against a sphere, fall to the ground; ``look`` at the state on the way or only at the end."""
    hover = world.parameters.hover_thrust
    world.add_obstacle("ball", "sphere", (0.6, 0.5, -5.0), radius=0.5)
    for k in range(2000):
        factor = 1.2 if k < 1000 else 0.5
        sway = 0.01 * math.sin(0.05 * k)
        world.step((factor * hover).tolist(), [(sway, -sway, 0.0)] * 4, (0.1, 0.0, 0.0))
        if look:
            world.state()
            world.contacts()
            world.closest_distance("ball")
    return world.state()


def test_repeats_to_the_last_bit_whoever_looks_and_whatever_runs_beside_it():
    with World(table(4)) as first:
        one = scenario(first, look=False)
    with World(table(4)) as second, World(table(3)) as other:
        run(other, 0.1, [8.0] * 3)
        assert scenario(second, look=True) == one
        assert other.time == pytest.approx(0.1)


def test_closing_twice_is_harmless():
    world = World(table(4))
    world.close()
    world.close()
