"""Surfaces of obstacles: the ends of what is detected of one, and the orientation of a wall by its points alone."""

from dataclasses import replace

import numpy as np
import pytest

from idc_controller.geometry.shapes import Box
from idc_controller.perception.settings import SurfaceSettings
from idc_controller.perception.surfaces.flat import FlatSurface
from idc_controller.perception.surfaces.points import EndOfSurface, KnownSurface, SurfacePoints

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
    scan = SurfacePoints(0.0, points, sensor, np.zeros(11, dtype=bool), 0.05, np.full(11, 1e-4))
    middle = surface.guess(scan)
    assert middle == pytest.approx([4.0, 0.0, -3.0], abs=1e-3)
    surface.fit(scan, middle)
    assert abs(surface.shape.yaw) == pytest.approx(np.pi, abs=1e-4)  # its front looks at the sensor


@pytest.mark.parametrize(
    ("cut", "moved", "sigma"), [(False, 0.2, S.sideways_sigma), (True, 0.0, S.unseen_sigma)], ids=["ends seen", "cut"]
)
def test_wall_is_seen_to_move_along_itself_only_where_both_of_its_ends_are_in_view(cut, moved, sigma):
    def frame(shift):
        y, z = np.meshgrid(np.linspace(-1.0, 1.0, 9) + shift, np.linspace(-1.0, 1.0, 5) - 3.0)
        points = np.column_stack([np.full(y.size, 4.0), y.ravel(), z.ravel()])
        at_end = np.isclose(points[:, 1], 1.0 + shift) if cut else np.zeros(len(points), dtype=bool)
        sensors = np.tile([0.0, 0.0, -3.0], (len(points), 1))
        return SurfacePoints(0.0, points, sensors, at_end, 0.05, np.full(len(points), 1e-4))

    surface = FlatSurface(None, S)
    place = surface.fit(frame(0.0), surface.guess(frame(0.0))).position
    fit = surface.fit(frame(0.2), place)
    assert fit.position - place == pytest.approx([0.0, moved, 0.0], abs=1e-2)
    assert np.sqrt(fit.variance[1]) == pytest.approx(sigma, rel=0.01)
    assert np.sqrt(fit.variance[2]) == pytest.approx(S.sideways_sigma)
    width = surface.shape.size[1]
    assert width == pytest.approx(2.0, abs=0.02) if not cut else width > 2.0


def points_on(box, centre, sensor, count, rng, noise=0.0):
    """Points on the sides of a box that face a sensor."""
    body = (sensor - centre) @ box.rotation
    half, parts = np.array(box.size) / 2.0, []
    for axis in range(3):
        if abs(body[axis]) > half[axis]:
            on_side = rng.uniform(-half, half, (count, 3))
            on_side[:, axis] = np.copysign(half[axis], body[axis])
            parts.append(on_side)
    points = centre + np.concatenate(parts) @ box.rotation.T
    points += noise * rng.normal(size=points.shape)
    n = len(points)
    return SurfacePoints(0.0, points, np.tile(sensor, (n, 1)), np.zeros(n, bool), max(noise, 0.01), np.full(n, 1e-6))


@pytest.mark.parametrize("seed", range(6))
def test_place_of_known_tilted_box_is_found_by_the_sides_in_view(seed):
    rng, centre = np.random.default_rng(seed), np.array([4.0, -2.0, -6.0])
    box = Box((0.8, 1.2, 2.0), roll=0.4, pitch=-0.3, yaw=0.2 + seed)
    surface = KnownSurface(box, S)
    scan = points_on(box, centre, centre + rng.normal(size=3) * 5.0 + [6.0, 0.0, 0.0], 40, rng, 0.01)
    guess = surface.guess(scan)
    assert np.linalg.norm(guess - centre) < 1.5
    fit = surface.fit(scan, centre + np.array([0.05, -0.05, 0.05]), 10)
    assert fit.position == pytest.approx(centre, abs=0.06)
    exact = surface.fit(points_on(box, centre, scan.origins[0], 40, rng), centre, 10)
    assert exact.position == pytest.approx(centre, abs=1e-3)
    assert surface.kind == "box" and surface.shape is box and (surface.offset == 0.0).all()


def test_place_of_known_box_is_less_certain_across_what_is_in_view_and_with_less_precise_poses():
    rng, centre = np.random.default_rng(1), np.array([5.0, 0.0, -6.0])
    box = Box((1.0, 1.0, 1.0), roll=1e-9)
    scan = points_on(box, centre, np.array([0.0, 0.0, -6.0]), 60, rng)
    variance = KnownSurface(box, S).fit(scan, centre).variance
    assert variance[0] < 0.05 * variance[1:].min()
    assert variance[1:] == pytest.approx([S.sideways_sigma**2] * 2, rel=0.05)
    worse = replace(scan, pose_variance=np.full(len(scan.points), 0.01))
    two = replace(worse, sensors=2)
    of_one, of_two = (KnownSurface(box, S).fit(s, centre).variance for s in (worse, two))
    assert (of_one - of_two) == pytest.approx([0.005] * 3)
    assert of_one[0] == pytest.approx(0.01 + 0.0101 / 60, rel=0.02)
