"""Ground controller while thrust spools up or down: stability with delay, tilts that hold links, bounds."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import expm

from gcs.config import read_system
from idc_controller.control.ground_controller import GroundController, pendulum_dynamics
from idc_controller.control.settings import GroundControlSettings
from idc_controller.estimation.grounded_links import OFF, LinkStates, S
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
@pytest.mark.parametrize("late", [0, 1, 2])
def test_ground_controller_is_stable_with_more_delay_than_was_predicted(share, late):
    assert slowest(GAINS[0], share, late) < 0.985


def set_point(links, lean=0.0):
    """Tilt (2,) of the first UAV over a payload on the ground, to bring its link to a ``lean`` north."""
    x = np.zeros((1, MODEL.layout.size))
    x[0, MODEL.layout.s.start] = lean
    u = GroundController(MODEL, PERIOD).setpoints(links, SimpleNamespace(x=x, u=np.zeros((1, MODEL.layout.inputs))))
    return u[MODEL.layout.n_setpoint][:2]


def links(lean=0.0, off=0.0, drag=0.0, share=0.6):
    """States of links that all ``lean`` north, at a ``share`` of the hover thrust."""
    x = np.zeros((6, 4, 2))
    x[S, :, 0], x[OFF, :, 0] = lean, off
    return LinkStates(x, share * MODEL.parameters.hover_thrust, np.array([drag, 0.0]))


def test_tilt_of_an_upright_link_compensates_wrong_attitude_and_drag():
    thrust = 0.6 * MODEL.parameters.hover_thrust[0]
    holding = -0.1 - 0.8 / thrust
    # The UAV does not tilt yet: the regulator adds what brings it there.
    expected = holding * (1.0 + GAINS[0, 2])
    tilt = max(expected + 0.1, -GroundControlSettings().tilt_max)
    assert set_point(links(off=0.1, drag=0.8)) == pytest.approx([tilt - 0.1, 0.0])


def test_tilt_of_the_thrust_is_bounded_and_zero_for_an_upright_link():
    largest = GroundControlSettings().tilt_max
    for off in (0.0, 0.2, -0.2):
        assert np.linalg.norm(np.add(set_point(links(lean=2.0, off=off)), [off, 0.0])) == pytest.approx(largest)
    compensated = GroundControlSettings().attitude_error_max
    assert np.linalg.norm(set_point(links(off=0.8))) <= largest + compensated
    assert set_point(links(off=0.5))[0] < -largest
    assert set_point(links()) == pytest.approx([0.0, 0.0])
