"""Ground controller while thrust spools up or down: stability with loop delay."""

import numpy as np
import pytest
from scipy.linalg import expm

from gcs.config import read_system
from idc_controller.control.ground_controller import GroundController, pendulum_dynamics
from idc_controller.control.settings import GroundControlSettings
from idc_controller.model.linear import LinearModel

PERIOD = 0.05
MODEL = LinearModel(read_system().parameters())
GAINS = GroundController(MODEL, PERIOD).gains


def slowest(gain, share, late):
    """Spectral radius of one axis at a ``share`` of the hover thrust, its set-points ``late`` periods."""
    A, B = pendulum_dynamics(MODEL, 0, share)
    block = np.zeros((6, 6))
    block[:5, :5], block[:5, 5:] = A, B
    step = expm(block * PERIOD)
    loop = np.zeros((5 + late + 1, 5 + late + 1))  # the state, and set-points in transit, the oldest first
    loop[:5, :5], loop[:5, 5:6] = step[:5, :5], step[:5, 5:]
    loop[5 + late, :5] = -gain
    for k in range(late):
        loop[5 + k, 6 + k] = 1.0
    # The newest is of the state before it: one period of lateness is there already.
    return np.abs(np.linalg.eigvals(loop)).max()


@pytest.mark.parametrize("share", [0.55, 0.7, 0.85, 1.0])
@pytest.mark.parametrize("late", [0, 1, 2, 3])
def test_ground_controller_is_stable_with_loop_delay(share, late):
    assert slowest(GAINS[0], share, late) < 0.985


@pytest.mark.parametrize("share", [0.55, 0.8, 1.0])
def test_uav_whose_attitude_is_wrong_stays_upright_over_a_payload_on_the_ground(share):
    controller, layout, wrong = GroundController(MODEL, PERIOD), MODEL.layout, 0.15  # rad, on board
    A, B = pendulum_dynamics(MODEL, 0, share)
    block = np.zeros((7, 7))  # the state of one axis, its set-point, and the wrong part of its tilt
    block[:5, :5], block[:5, 5:6], block[:5, 6] = A, B, A[:, 2]
    step, x, error, leans = expm(block * PERIOD), np.zeros(5), np.zeros(layout.size), []
    for _ in range(400):
        for part, value in zip((layout.s, layout.s_dot, layout.n, layout.n_dot, layout.n_acc), x, strict=True):
            error[part.start] = value
        tilt = controller.track(error, None).delta_u[0]
        x = step[:5, :5] @ x + step[:5, 5] * tilt + step[:5, 6] * wrong
        leans.append(abs(x[0]))
    assert max(leans) < 0.25 and max(leans[-40:]) < 0.04
    controller.release()
    assert np.all(controller.track(np.zeros(layout.size), None).delta_u == 0.0)


def test_tilt_against_a_link_that_cannot_come_upright_does_not_grow_without_end():
    controller, layout = GroundController(MODEL, PERIOD), MODEL.layout
    error = np.zeros(layout.size)
    error[layout.s.start] = 0.3
    tilts = [controller.track(error, None).delta_u[0] for _ in range(400)]
    assert tilts[20] - tilts[0] > 0.05
    assert tilts[-1] == tilts[200] == pytest.approx(GroundControlSettings().lean_tilt_max - 0.3 * GAINS[0, 0])
