"""Points of a body that were seen in the last frames: how far they lie outside of a shape."""

import numpy as np
import pytest

from idc_controller.geometry.sphere import Sphere
from idc_controller.perception.seen_points import SeenPoints

SPHERE, HERE = Sphere(0.5), np.array([0.0, 0.0, -1.0])


def outside(distances):
    """Return points so far outside of the sphere (n, 3)."""
    return HERE + np.array([[0.5 + distance, 0.0, 0.0] for distance in distances])


def seen(distances, noise=0.0, time=0.0, into=None):
    points = into or SeenPoints(2.0)
    points.add(time, outside(distances), np.full(len(distances), noise))
    return points


def test_outermost_point_counts_beyond_its_noise():
    assert seen([-0.1, 0.3, 0.2]).outermost(SPHERE, HERE, 0.0) == pytest.approx(0.3)
    assert seen([-0.1, 0.3, 0.2], noise=0.1).outermost(SPHERE, HERE, 0.0) == pytest.approx(0.2)
    assert seen([-0.3, 0.05], noise=0.1).outermost(SPHERE, HERE, 0.0) == 0.0


def test_points_are_remembered_for_a_time_only():
    points = seen([0.3])
    assert seen([0.1], time=1.9, into=points).outermost(SPHERE, HERE, 0.0) == pytest.approx(0.3)
    assert seen([0.1], time=2.1, into=points).outermost(SPHERE, HERE, 0.0) == pytest.approx(0.1)


def test_as_many_points_as_are_false_are_left_out():
    points = seen([0.3, 0.2, *[0.1] * 98])
    assert points.outermost(SPHERE, HERE, 0.01) == pytest.approx(0.2)
    assert points.outermost(SPHERE, HERE, 0.02) == pytest.approx(0.1)
    assert seen([0.3]).outermost(SPHERE, HERE, 0.01) == 0.0


def test_points_follow_another_reference_point():
    points = seen([0.3])
    points.shift(np.array([-0.2, 0.0, 0.0]))
    assert points.outermost(SPHERE, HERE, 0.0) == pytest.approx(0.1)
