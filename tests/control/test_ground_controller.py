"""Ground controller while thrust spools up or down: stability with loop delay."""

import numpy as np
import pytest
from scipy.linalg import expm

from gcs.config import read_system
from idc_controller.control.ground_controller import GroundController, pendulum_dynamics
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
