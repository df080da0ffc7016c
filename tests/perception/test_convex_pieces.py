"""Convex pieces over scans with noise: all that was hit is covered, what was seen free is not closed."""

import math

import numpy as np
import pytest
from range_scene import ATTITUDE_SIGMA, POSITION_SIGMA, RANGE_SIGMA, Box, Pole, Sensor

from idc_controller.geometry.obstacles import Bodies
from idc_controller.perception.convex_pieces import ConvexPieces
from idc_controller.perception.standing_map import StandingMap

PERIOD = 0.1
SIGMAS = 3.0


class Flight:
    """Four vehicles with range sensors about a place, their map and its pieces."""

    def __init__(self, bodies, seed=1, rays=500):
        self.bodies, self.sensor = bodies, Sensor(np.random.default_rng(seed), rays=rays, ground=0.0)
        self.standing, self.builder = StandingMap(), ConvexPieces()
        self.pieces, self.hits, self.sigmas = [], np.empty((0, 3)), np.empty(0)

    def fly(self, path, begin, end):
        for k in range(round(begin / PERIOD), round(end / PERIOD)):
            for i in (-0.8, 0.8):
                for j in (-0.8, 0.8):
                    place = np.array(path(PERIOD * k)) + np.array([i, j, 0.0])
                    scan, hit = self.sensor.scan(self.bodies, place, PERIOD * k)
                    self.standing.add(scan)
                    away = np.linalg.norm(hit - place, axis=1)
                    sigma = np.sqrt(RANGE_SIGMA**2 + POSITION_SIGMA**2 + (ATTITUDE_SIGMA * away) ** 2)
                    self.hits, self.sigmas = np.concatenate([self.hits, hit]), np.concatenate([self.sigmas, sigma])
            self.pieces = self.builder.update(self.standing)

    def distance(self, points):
        """Signed distance (n,) of points from the nearest piece."""
        bodies = Bodies([piece.shape for piece in self.pieces])
        return bodies.distance(points, np.array([piece.centre for piece in self.pieces])).min(axis=0)

    def missed(self):
        """How far true points that were hit are beyond the pieces, in standard deviations of their returns (n,)."""
        return np.maximum(self.distance(self.hits), 0.0) / self.sigmas

    def gaps(self):
        """Gaps in the pieces."""
        return sum(len(self.standing.gaps(piece.box, 10)) for piece in self.pieces)


def along(speed, y=0.0, z=-4.0, start=0.0):
    return lambda t: (start + speed * t, y, z)


SCENES = {
    "slope": ([Box((9.0, 0.0, 0.0), (10.0, 8.0, 0.4), 0.2, 0.5)], along(1.0, z=-5.0)),
    "overhang": (
        [Box((9.0, 0.0, -7.0), (4.0, 8.0, 1.0), 0.3), Box((9.0, 5.0, -4.0), (1.0, 1.0, 6.0))],
        along(1.0, z=-3.0),
    ),
}


@pytest.mark.parametrize(("bodies", "path"), SCENES.values(), ids=SCENES)
def test_all_that_was_hit_stays_covered(bodies, path):
    """At all later times, in sight or not; upright bodies: tests/perception/test_obstacle_map.py."""
    flight = Flight(bodies)
    for second in range(10):
        flight.fly(path, second, second + 1.0)
        if len(flight.pieces):
            missed = flight.missed()
            assert missed.max() < SIGMAS
            assert (missed > 1.0).mean() < 1e-3
    assert len(flight.hits) > 1000
    assert flight.gaps() == 0
    flight.fly(lambda t: (0.0, 0.0, -80.0), 10.0, 11.0)
    assert flight.missed().max() < SIGMAS


def test_large_box_seen_from_beside_stays_where_it_is():
    """A box of 4.4 x 8.7 x 17.6 m, nearer than its sides are long: its face neither moves nor shrinks."""
    box = Box((6.0, 6.2, -8.8), (17.6, 4.4, 8.7))
    flight = Flight([box])
    face = np.stack(np.meshgrid(np.arange(-2.5, 14.6, 0.5), 4.0, np.arange(-12.0, -5.0, 0.5)), axis=-1).reshape(-1, 3)
    seen = np.zeros(len(face), dtype=bool)
    for second in range(12):
        flight.fly(along(1.5, z=-8.0, start=-4.0), second, second + 1.0)
        distance = flight.distance(face)
        assert flight.missed().max() < SIGMAS
        # What was covered stays so, but for seams between pieces where nothing was hit.
        assert (distance[seen] < 0.5).all()
        seen |= distance < 0.0
    assert seen.mean() > 0.95
    front = face - np.array([0.0, 1.0, 0.0])
    assert (flight.distance(front) > 0.2).all()
    large = max(flight.pieces, key=lambda piece: len(piece.members))
    assert max(large.shape.size) > 10.0


def test_door_that_was_seen_free_is_open():
    walls = [
        Box((6.0, -4.0, -2.0), (0.2, 6.0, 4.0)), Box((6.0, 3.5, -2.0), (0.2, 5.0, 4.0)),
        Box((10.0, 0.0, -2.0), (0.2, 14.0, 4.0)), Box((8.0, -7.0, -2.0), (4.0, 0.2, 4.0)),
        Box((6.0, 0.0, -3.6), (0.2, 2.0, 0.8)),
    ]  # fmt: skip
    flight = Flight(walls)
    flight.fly(along(0.5, z=-1.6), 0.0, 8.0)
    # The door is 2 m wide and 3.2 m high.
    door = np.stack(np.meshgrid(6.0, np.arange(-0.5, 0.51, 0.1), np.arange(-2.6, -0.9, 0.1)), axis=-1).reshape(-1, 3)
    assert (flight.distance(door) > 0.0).all()
    assert flight.missed().max() < SIGMAS
    assert len(flight.pieces) < 25


@pytest.mark.parametrize("turn", [0.0, 0.6])
def test_gap_between_poles_that_was_seen_free_is_open(turn):
    middle, half = np.array([6.0, 0.0, -4.0]), 1.0 * np.array([math.sin(turn), math.cos(turn), 0.0])
    poles = [Pole(tuple(middle + side * half), 0.15, 8.0) for side in (-1, 1)]
    flight = Flight(poles)
    flight.fly(lambda t: (0.0, 1.5 * math.sin(t), -4.0), 0.0, 10.0)
    across = np.linspace(-0.5, 0.5, 11)
    gap = np.concatenate([middle + np.outer(across, half) + (0.0, 0.0, z) for z in np.arange(-1.5, 1.6, 0.5)])
    assert (flight.distance(gap) > 0.0).all()
    assert len(flight.pieces) <= 4


def test_pieces_keep_their_names_and_none_changes_when_nothing_is_new():
    flight = Flight([Pole((x, y, -4.0), 0.1, 8.0) for x in (4.0, 8.0, 12.0) for y in (-3.0, 0.5, 4.0)])
    flight.fly(along(1.0), 0.0, 6.0)
    before = {piece.number: piece.centre.copy() for piece in flight.pieces if len(piece.members) > 20}
    assert len(before) > 3
    flight.fly(along(1.0), 6.0, 9.0)
    after = {piece.number: piece.centre for piece in flight.pieces}
    kept = [name for name in before if name in after]
    assert len(kept) >= len(before) - 1
    assert all(np.abs(before[name] - after[name])[:2].max() < 0.5 for name in kept)
    assert flight.builder.update(flight.standing) == flight.pieces


def test_pieces_of_an_obstacle_taken_away_go_with_its_points():
    flight = Flight([Pole((5.0, 0.0, -4.0), 0.3, 8.0)], rays=1500)
    flight.fly(lambda t: (0.0, math.sin(t), -4.0), 0.0, 3.0)
    covered = sum(float(np.prod(2.0 * piece.box[3:6])) for piece in flight.pieces)
    flight.bodies = []
    flight.fly(lambda t: (0.0, math.sin(t), -4.0), 3.0, 12.0)
    left = sum(float(np.prod(2.0 * piece.box[3:6])) for piece in flight.pieces)
    assert left < 0.5 * covered
    assert flight.gaps() == 0


@pytest.mark.parametrize("turn", [0.4, *(pytest.param(turn, marks=pytest.mark.long) for turn in (0.0, math.pi / 4.0))])
def test_width_of_a_door_is_that_between_estimated_bodies(turn):
    width, edges = 3.0, (0.3, 4.0, 9.0)
    across = np.array([-math.sin(turn), math.cos(turn), 0.0])
    middle = np.array([6.0, 0.0, -4.5])
    walls = [Box(middle + side * (width + edges[1]) / 2.0 * across, edges, turn) for side in (-1.0, 1.0)]
    flight = Flight(walls)
    flight.fly(lambda t: (0.0, 1.5 * math.sin(t), -4.0), 0.0, 6.0)
    line = np.linspace(-width / 2.0 - 1.0, width / 2.0 + 1.0, 1000)
    # Along the faces that are seen.
    front = middle - 0.5 * edges[0] * np.array([math.cos(turn), math.sin(turn), 0.0])
    places = front + [0.0, 0.0, 0.5] + line[:, None] * across

    def open_width(bodies):
        shapes, centres = zip(*bodies, strict=True)
        free = (Bodies(shapes).distance(places, np.array(centres)) > 0.1).all(axis=0)
        return np.ptp(line[free]) + 0.2

    estimated = open_width([piece.estimate(flight.standing) for piece in flight.pieces])
    covered = open_width([(piece.shape, piece.centre) for piece in flight.pieces])
    assert covered < estimated
    assert estimated == pytest.approx(width, abs=0.3)
