"""Surfaces of obstacles: the ends of what is detected of one, and the orientation of a wall by its points alone."""

import numpy as np
import pytest

from idc_controller.perception.settings import SurfaceSettings
from idc_controller.perception.surfaces.flat import FlatSurface
from idc_controller.perception.surfaces.points import EndOfSurface, SurfacePoints

S = SurfaceSettings()
EXTENSION = 0.7


def end_after(*frames):
    """End of a surface after frames of (coordinates of points, whether each is at the end of the sensor's range)."""
    end = EndOfSurface(EXTENSION, S)
    for along, cut in frames:
        end.update(np.array(along), np.array(cut))
    return end.outermost


DETECTED = ([1.0, 2.0], [False, False])


def test_end_within_range_is_at_the_outermost_point():
    assert end_after(DETECTED) == 2.0
    assert end_after(([2.0, 1.0], [False, True])) == 2.0


def test_surface_cut_by_the_range_is_extended_and_does_not_shrink():
    cut = ([1.0, 2.0], [False, True])
    assert end_after(cut) == 2.0 + EXTENSION
    assert end_after(cut, ([2.2], [True])) == 2.2 + EXTENSION
    assert end_after(cut, ([1.5], [True])) == 2.0 + EXTENSION
    assert end_after(DETECTED, ([1.5], [True])) == 2.0  # the end is known


def test_first_end_found_within_range_replaces_that_of_the_cut_surface():
    assert end_after(([2.0], [True]), ([2.1], [False])) == pytest.approx(2.1)


def test_end_is_smoothed_and_jumps_outwards_but_retreats_slowly():
    near, far = 0.9 * S.end_jump, 1.1 * S.end_jump
    assert end_after(DETECTED, ([2.0 + near], [False])) == pytest.approx(2.0 + S.end_smoothing * near)
    assert end_after(DETECTED, ([2.0 - near], [False])) == pytest.approx(2.0 - S.end_smoothing * near)
    assert end_after(DETECTED, ([2.0 + far], [False])) == 2.0 + far
    assert end_after(DETECTED, ([2.0 - far], [False])) == pytest.approx(2.0 - S.end_retreat * far)


def test_wall_is_oriented_by_points_far_apart():
    y = np.linspace(-2.5, 2.5, 11)
    x = 1e-4 * (-1.0) ** np.arange(11)  # two neighbours are turned by 4e-4 rad, the ends by less than 4e-5
    points = np.column_stack([4.0 + x, y, np.full(11, -3.0)])
    sensor = np.tile([0.0, 0.0, -3.0], (11, 1))
    surface = FlatSurface(None, S)
    middle = surface.guess(SurfacePoints(0.0, points, sensor, np.zeros(11, dtype=bool), 0.05, np.full(11, 1e-4)))
    assert middle == pytest.approx([4.0, 0.0, -3.0], abs=1e-3)
    with np.errstate(invalid="ignore"):  # its ends are not known yet
        assert abs(surface.shape.yaw) == pytest.approx(np.pi, abs=1e-4)  # its front looks at the sensor
