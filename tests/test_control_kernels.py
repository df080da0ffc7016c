"""The kernels of set-points and stop plan against plain numpy."""

import numpy as np
import pytest
from paper_system import system

from idc_controller.control import force_kernels
from idc_controller.control.load_kernels import followed_forces
from idc_controller.model.linear import StateLayout
from idc_controller.trajectory.stop_plan_kernels import motion

LEAST_LIFT = 0.05


def cosine(n):
    return np.sqrt(np.maximum(1.0 - np.sum(n**2, axis=-1), 1e-3))


def states_plainly(x, layout, hover):
    converted, N = x.copy(), layout.number_of_uavs
    f, n = x[..., layout.f], x[..., layout.n].reshape(*x.shape[:-1], N, 2)
    for part in (layout.n, layout.n_dot, layout.n_acc):
        converted[..., part] *= np.repeat(f / hover, 2, axis=-1)
    converted[..., layout.f] = f * cosine(n)
    return converted


def inputs_plainly(u, layout, hover):
    n = u[..., layout.n_setpoint].reshape(*u.shape[:-1], layout.number_of_uavs, 2)
    f = u[..., layout.f_setpoint]
    lateral = n * (f / hover)[..., None]
    return np.concatenate([lateral.reshape(*u.shape[:-1], -1), f * cosine(n)], axis=-1)


def setpoints_plainly(delta, u, layout, hover):
    n, f = u[layout.n_setpoint].reshape(-1, 2), u[layout.f_setpoint]
    lateral = f[:, None] * n + hover[:, None] * delta[layout.n_setpoint].reshape(-1, 2)
    upward = np.maximum(f * cosine(n) + delta[layout.f_setpoint], LEAST_LIFT * hover)
    thrust = np.sqrt(np.sum(lateral**2, axis=-1) + upward**2)
    return np.concatenate([(lateral / thrust[:, None]).ravel(), thrust])


@pytest.mark.parametrize("n", [3, 4, 8])
@pytest.mark.parametrize("tilt", [0.1, 0.8], ids=["level", "steep"])
def test_force_components_are_those_of_whole_arrays(n, tilt):
    rng, layout, hover = np.random.default_rng(n), StateLayout(n), system(n).hover_thrust
    for _ in range(20):
        x = rng.normal(size=(3, layout.size)) * tilt
        u = rng.normal(size=(5, layout.inputs)) * tilt
        u[:, layout.f_setpoint] += hover
        x[:, layout.f] += hover
        delta = rng.normal(size=layout.inputs) * np.repeat([0.3, 20.0], [2 * n, n])
        np.testing.assert_allclose(
            force_kernels.states(x, hover, layout.n.start), states_plainly(x, layout, hover), rtol=1e-14
        )
        stages, limits = np.array([2, 0, 1]), np.sort(rng.normal(size=(2, layout.inputs)), axis=0)
        bounds = np.stack([limits[1] - inputs_plainly(u[stages], layout, hover),
                           inputs_plainly(u[stages], layout, hover) - limits[0]], axis=1)  # fmt: skip
        found = np.full(bounds.size + 2, 7.0)
        force_kernels.fill_input_bounds(found, u, stages, hover, *limits)
        np.testing.assert_allclose(found, np.append(bounds, [7.0, 7.0]), rtol=1e-13, atol=1e-13)
        for limit in (0.5, 50.0):
            found = force_kernels.tracking_error(x[0].copy(), x[1:], hover, layout.n.start, limit, 2.0 * limit)
            error = np.subtract(*states_plainly(x[:2], layout, hover))
            error[layout.r_0] = shortened(error[layout.r_0], limit)
            error[layout.v_0] = shortened(error[layout.v_0], 2.0 * limit)
            np.testing.assert_allclose(found, error, rtol=1e-13, atol=1e-13)
        found = force_kernels.setpoints(delta, u[0], hover, LEAST_LIFT)
        np.testing.assert_allclose(found, setpoints_plainly(delta, u[0], layout, hover), rtol=1e-13)
        directions = force_kernels.directions(found)
        np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1.0)
        np.testing.assert_array_equal(directions[:, :2].ravel(), found[layout.n_setpoint])
        assert np.all(directions[:, 2] < 0.0)


@pytest.mark.parametrize("n", [3, 4, 8])
def test_motion_of_uavs_and_payload_is_that_of_whole_arrays(n):
    rng, layout, parameters = np.random.default_rng(n), StateLayout(n), system(n)
    payload, error = rng.normal(size=(3, 3)), rng.normal(size=layout.size)
    q, q_dot, q_ddot = rng.normal(size=(3, 3))
    found = motion(
        payload, error, q, q_dot, q_ddot, parameters.p, parameters.l, layout.s.start, layout.s_dot.start
    )  # fmt: skip
    l = parameters.l[:, None]
    off = np.array([error[layout.r_0], error[layout.v_0], np.zeros(3)])
    for row, tilt in zip(off, (layout.s, layout.s_dot), strict=False):
        row[:2] -= np.mean(l * error[tilt].reshape(-1, 2), axis=0)
    position, velocity, acceleration = payload + off
    uavs = np.stack([position + parameters.p - l * q, velocity - l * q_dot, acceleration - l * q_ddot], axis=1)
    np.testing.assert_allclose(found[:-1], uavs, atol=1e-14)
    below = uavs.mean(axis=0)
    below[0] -= parameters.p.mean(axis=0) - [0.0, 0.0, parameters.l.mean()]
    np.testing.assert_allclose(found[-1], below, atol=1e-14)


def shortened(vectors, limit):
    norms = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors * np.minimum(1.0, limit / norms)


@pytest.mark.parametrize("limit", [0.5, 2.0, 10.0])
@pytest.mark.parametrize("number", [3, 8])
def test_forces_that_follow_the_estimated_ones_equal_plain_ones(number, limit):
    rng, share = np.random.default_rng(number), 0.1
    force, estimated, before, uav_before, drag, uav_drag = rng.normal(size=(6, 3))
    uav_force, uav_estimated = rng.normal(size=(2, number, 3))
    found, on_uavs = followed_forces(
        force, uav_force, estimated, uav_estimated, before, uav_before, drag, uav_drag, share, limit, 0.5 * limit
    )
    rest, uav_rest = force + before - drag, uav_force + uav_before - uav_drag
    assert found == pytest.approx(rest + share * (shortened(estimated, limit) - drag - rest), abs=1e-14)
    expected = uav_rest + share * (shortened(uav_estimated, 0.5 * limit) - uav_drag - uav_rest)
    assert on_uavs == pytest.approx(expected, abs=1e-14)
