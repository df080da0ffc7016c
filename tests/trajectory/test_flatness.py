"""The flat reference satisfies the nonlinear dynamics, not only their linearisation."""

from dataclasses import replace

import numpy as np
import pytest
from flights import MISSIONS
from hypothesis import given, settings
from hypothesis import strategies as st
from paper_system import UNSYMMETRIC
from plain_flatness import Wave
from plain_flatness import flat_reference as plain_reference

from gcs.config import read_system
from idc_controller.model.drag import Air
from idc_controller.model.linear import StateLayout
from idc_controller.model.nonlinear import Inputs, SystemState, accelerations
from idc_controller.trajectory.flatness import Load, flat_reference

CONFIG = read_system(MISSIONS / "system.toml")
TIMES = np.linspace(0.3, 12.0, 14)


def systems():
    for n in (3, 4, 6):
        yield pytest.param(CONFIG.with_vehicles(n).parameters(), id=str(n))
    yield pytest.param(replace(CONFIG.parameters(), p=UNSYMMETRIC), id="unsymmetric")
    yield pytest.param(read_system(MISSIONS / "l_payload.toml").parameters(), id="mesh")
    yield pytest.param(replace(CONFIG.parameters(), l=np.array([3.2, 2.0, 2.6, 3.8])), id="links")


@pytest.mark.parametrize("p", list(systems()))
@pytest.mark.parametrize("load", [Load(3.1, np.zeros(3)), Load(2.7, np.array([1.0, -2.0, 0.5]))], ids=["plain", "load"])
@pytest.mark.parametrize("per_vehicle", [False, True], ids=["", "per-vehicle forces"])
def test_reference_solves_the_nonlinear_dynamics_exactly(p, load, per_vehicle):
    on_uavs = per_vehicle * np.linspace([-0.8, 0.5, 0.0], [0.7, 0.2, 0.0], p.number_of_uavs)
    load = replace(load, uav_force=on_uavs)
    flat = flat_reference(p, Wave(), TIMES, load)
    true = p.with_payload_mass(load.mass)
    N = p.number_of_uavs
    for k in range(len(TIMES)):
        q, q_dot, q_ddot = (getattr(flat.links, name)[k] for name in ("q", "q_dot", "q_ddot"))
        state = SystemState(
            r_0=flat.payload[0, k], r_0_dot=flat.payload[1, k], quaternion_0=np.array([1.0, 0, 0, 0]),
            omega_0=np.zeros(3), q=np.tile(q, (N, 1)), Omega=np.tile(np.cross(q, q_dot), (N, 1)),
            quaternion=np.tile([1.0, 0, 0, 0], (N, 1)), omega=np.zeros((N, 3)),
        )  # fmt: skip
        inputs = Inputs(F=flat.links.force[k] + on_uavs, tau=np.zeros((N, 3)), F_0=load.force)
        second = accelerations(true, state, inputs)
        assert np.allclose(second.r_0_ddot, flat.payload[2, k], atol=1e-9)
        assert np.allclose(second.omega_0_dot, 0.0, atol=1e-9)  # the payload stays level
        assert np.allclose(second.Omega_dot, np.cross(q, q_ddot), atol=1e-9)


def test_links_and_uavs_move_by_their_derivatives():
    p, layout, h = CONFIG.parameters(), StateLayout(4), 1e-4
    load = Load(p.m_0, np.zeros(3))
    before, flat, after = (flat_reference(p, Wave(), TIMES + d, load) for d in (-h, 0.0, h))
    links = (before.links, flat.links, after.links)
    assert np.allclose((links[2].q - links[0].q) / (2 * h), links[1].q_dot, atol=1e-7)
    assert np.allclose((links[2].q_dot - links[0].q_dot) / (2 * h), links[1].q_ddot, atol=1e-7)
    slope = (after.x - before.x) / (2 * h)
    assert np.allclose(slope[:, layout.r_0], flat.x[:, layout.v_0], atol=1e-6)
    assert np.allclose(slope[:, layout.s], flat.x[:, layout.s_dot], atol=1e-6)
    # These come from a stencil of 20 ms: exact to its order only.
    assert np.allclose(slope[:, layout.n], flat.x[:, layout.n_dot], atol=2e-4)
    assert np.allclose(slope[:, layout.n_dot], flat.x[:, layout.n_acc], atol=2e-3)


def test_set_points_invert_the_attitude_loop_and_the_motor_lag():
    p, layout, h = CONFIG.parameters(), StateLayout(4), 1e-3
    load = Load(p.m_0, np.zeros(3))
    before, flat, after = (flat_reference(p, Wave(), TIMES + d, load) for d in (-h, 0.0, h))
    n, n_dot, n_acc = (flat.x[:, part] for part in (layout.n, layout.n_dot, layout.n_acc))
    n_jerk = (after.x[:, layout.n_acc] - before.x[:, layout.n_acc]) / (2 * h)
    # T_m n''' + n'' + kd n' + kp n = kp n_setpoint
    left = p.motor_time_constant * n_jerk + n_acc + p.attitude_kd * n_dot + p.attitude_kp * n
    assert np.allclose(left, p.attitude_kp * flat.u[:, layout.n_setpoint], atol=0.02)
    f_dot = (after.x[:, layout.f] - before.x[:, layout.f]) / (2 * h)
    assert np.allclose(flat.x[:, layout.f] + p.motor_time_constant * f_dot, flat.u[:, layout.f_setpoint], atol=1e-3)


def vectors(limit):
    return st.tuples(*3 * [st.floats(-limit, limit)]).map(np.array)


@settings(max_examples=60)
@given(
    vehicles=st.sampled_from([3, 4, 6]),
    times=st.lists(st.floats(0.0, 20.0), min_size=1, max_size=8),
    on_grid=st.booleans(),
    force=vectors(4.0),
    uav_force=vectors(1.0),
    air=st.none() | st.builds(Air, vectors(6.0), vectors(0.5).map(np.abs), st.floats(0.0, 0.1), st.floats(5.0, 40.0)),
)
def test_compiled_flat_map_equals_plain_one(vehicles, times, on_grid, force, uav_force, air):
    p = CONFIG.with_vehicles(vehicles).parameters()
    times = 0.05 * np.round(20.0 * np.array(times)) if on_grid else np.array(times)
    load = Load(0.9 * p.m_0, force, uav_force * np.arange(vehicles)[:, None], air)
    compiled, plain = (of(p, Wave(), times, load) for of in (flat_reference, plain_reference))
    assert (compiled.payload == plain.payload).all()
    # Set-points hold the third derivative of a unit vector over the stencil: its rounding is 1e-16 / h^3 T_m / kp.
    assert compiled.x == pytest.approx(plain.x, rel=1e-12, abs=1e-12)
    assert compiled.u == pytest.approx(plain.u, rel=1e-12, abs=1e-12)
    for name in plain.links._fields:
        assert getattr(compiled.links, name) == pytest.approx(getattr(plain.links, name), rel=1e-12, abs=1e-12), name
