"""The chain's roll-out against numerical integration, and its smoothness."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from idc_controller.safety.settings import PlannerSettings
from idc_controller.trajectory.integrator_chain import Chain
from idc_controller.trajectory.trajectory_kernels import chain as deviation_after

DEFAULT = PlannerSettings().chain
CHAINS = [DEFAULT, Chain(0.05, (1, 2, 3)), Chain(0.2, (1,)), Chain(0.1, (4, 1, 4))]


def evaluated_at(chain, states, times):
    return deviation_after(states, chain.period, times)


def integrated(chain, start, knots, times):
    """(r, v, a, j) at ``times`` (M,), one axis, by a general integrator: (M, 4)."""
    at = np.concatenate([[0.0], np.cumsum(chain.blocks)]) * chain.period
    snaps = np.concatenate([[start[4]], knots])

    def slope(t, y):
        return [y[1], y[2], y[3], np.interp(t, at, snaps)]

    y, now, found = np.array(start[:4]), 0.0, []
    for time in times:
        # No step across a corner of the snap.
        for stop in [*at[(at > now) & (at < time)], time]:
            y = solve_ivp(slope, (now, stop), y, rtol=1e-10, atol=1e-12).y[:, -1]
            now = stop
        found.append(y)
    return np.array(found)


@pytest.mark.parametrize("chain", CHAINS)
def test_roll_out_and_evaluation_equal_integral_of_snap(chain):
    rng = np.random.default_rng(chain.stages)
    start, knots = rng.normal(size=(5, 3)), rng.normal(size=(chain.knots, 3)) * 3.0
    states = chain.roll_out(start, knots)
    stages = chain.period * np.arange(1, chain.stages + 1)
    between = np.sort(rng.uniform(0.0, stages[-1], 12))
    evaluated = evaluated_at(chain, states, between)
    for axis in range(3):
        np.testing.assert_allclose(
            states[1:, :4, axis], integrated(chain, start[:, axis], knots[:, axis], stages), rtol=1e-7, atol=1e-8
        )
        np.testing.assert_allclose(
            evaluated[:4, :, axis].T, integrated(chain, start[:, axis], knots[:, axis], between), rtol=1e-7, atol=1e-8
        )


@pytest.mark.parametrize("chain", CHAINS)
def test_snap_is_piecewise_linear_through_knots(chain):
    rng = np.random.default_rng(1)
    start, knots = rng.normal(size=(5, 3)), rng.normal(size=(chain.knots, 3))
    states = chain.roll_out(start, knots)
    np.testing.assert_allclose(states[np.cumsum(chain.blocks), 4], knots, atol=1e-12)
    np.testing.assert_allclose(states[0], start, atol=1e-15)
    bends = np.diff(states[:, 4], 2, axis=0)
    inner = np.setdiff1d(np.arange(1, chain.stages), np.cumsum(chain.blocks))
    np.testing.assert_allclose(bends[inner - 1], 0.0, atol=1e-12)
    first, others = chain.snap_of_stage
    np.testing.assert_allclose(first + others.sum(axis=1), 1.0)


def test_chain_has_constant_velocity_beyond_last_stage():
    chain = DEFAULT
    states = chain.roll_out(np.ones((5, 3)), np.zeros((chain.knots, 3)))
    end = chain.stages * chain.period
    evaluated = evaluated_at(chain, states, np.array([end, end + 2.0]))
    np.testing.assert_allclose(evaluated[0, 1], states[-1, 0] + 2.0 * states[-1, 1])
    np.testing.assert_allclose(evaluated[1, 1], states[-1, 1])
    np.testing.assert_array_equal(evaluated[2:, 1], 0.0)
