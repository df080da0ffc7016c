"""What every flight of the safety filter must show."""

import numpy as np
from avoidance_scene import STEP

from idc_controller.safety.safety_filter import NEGLIGIBLE
from idc_controller.safety.settings import PlannerSettings

MARGIN = 0.5
TOLERANCE = 0.02
"""m: rows hold at the stages, and for a hull that shears linearly."""
SETTINGS = PlannerSettings()


def check_smooth(flown, crackle=150.0):
    """One plan follows another without a step up to snap, and nothing is wilder than the plant can follow."""
    seams = np.max(flown.seams, axis=0)
    # A deviation that has become negligible is dropped.
    assert np.all(seams < 1.01 * NEGLIGIBLE), seams
    path = flown.path
    assert np.linalg.norm(path[2, :, :2], axis=1).max() <= SETTINGS.acceleration_limit[0] + 0.3
    assert np.abs(path[2, :, 2]).max() <= SETTINGS.acceleration_limit[2] + 0.1
    assert np.abs(np.diff(path[4], axis=0)).max() < crackle * STEP
    # The derivatives agree with differences of the position.
    np.testing.assert_allclose((path[0, 2:] - path[0, :-2]) / (2 * STEP), path[1, 1:-1], atol=0.02)


def check_arrived(flown, within=0.02):
    assert np.isfinite(flown.ends_at)
    end = flown.mission.position(flown.mission.end)
    np.testing.assert_allclose(flown.path[0, -1], end, atol=within)
