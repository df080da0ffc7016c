"""Region that an obstacle has visited of late, and when it stands for the obstacle's prediction."""

import numpy as np
import pytest
from moving_scene import BEGIN, SHAPES, watch
from obstacle_scene import moving_tracks

from idc_controller.geometry.obstacles import Bodies
from idc_controller.geometry.shapes import Sphere
from idc_controller.perception.manoeuvre import VisitedRegion

BALL = Sphere(0.5)


def region_of(places):
    region = VisitedRegion()
    for time, place in enumerate(places):
        region.add(float(time), np.array(place))
    return region


def inside(shape, centre, points):
    return Bodies([shape]).distance(np.atleast_2d(points), centre[None])[0]


@pytest.mark.parametrize("seed", range(5))
def test_region_holds_the_body_at_all_its_places(seed):
    rng = np.random.default_rng(seed)
    places = rng.normal(0.0, 3.0, (12, 3)) * [1.0, 0.3, 0.2] + [5.0, -3.0, -8.0]
    shape, centre = region_of(places).box(BALL, 0.0)
    directions = rng.standard_normal((50, 3))
    surface = 0.5 * directions / np.linalg.norm(directions, axis=1)[:, None]
    for place in places:
        assert inside(shape, centre, place + surface).max() < 1e-9


def to_and_fro(t):
    """Position of what goes 3 m to and fro in 2.5 s each, at up to 1.9 m/s and 2.4 m/s2, and rests 1 s at both ends."""
    phase = t % 7.0
    share = np.clip((phase - 1.0) / 2.5, 0.0, 1.0) - np.clip((phase - 4.5) / 2.5, 0.0, 1.0)
    return np.array([6.0, -1.5 * np.cos(np.pi * share), -6.0])


def test_what_stops_and_goes_stays_within_its_region_and_keeps_it_at_rest():
    alone, ends = [], []

    def each(t, m):
        if t < 9.0:
            return
        predicted = m.predict(BEGIN + t + np.array([0.0, 2.0]))
        moving = [o for o in predicted if not o.name.startswith("piece")]
        alone.append([o.name.endswith("region") for o in moving] == [True])
        if alone[-1]:
            [o] = moving
            ends.extend(inside(o.shape, o.positions[0], to_and_fro(t + ahead))[0] for ahead in (0.0, 1.0, 2.0))

    m = watch(to_and_fro, SHAPES["sphere"], 0, 20.0, each).obstacle_map
    assert len(moving_tracks(m)) == 1
    assert np.mean(alone) > 0.8
    assert max(ends) < 0.0
