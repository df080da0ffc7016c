"""Motions of obstacles: where they are, how fast, and which are refused."""

import math

import numpy as np
import pytest

from gcs.config import UnusableFile
from gcs.mission.model import Obstacle
from gcs.mission.motion import CircleMotion, HarmonicMotion, LinearMotion, RandomWalkMotion, WaypointsMotion
from gcs.mission.read import read_mission
from idc_controller.geometry.shapes import Sphere
from vehicle_sim.world.obstacle_bodies import MovingObstacles

SQUARE = ((0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (2.0, 1.0, 0.0))


def at(motion, *times):
    displacement = motion.mover()
    return np.array([displacement(time) for time in times])


def test_harmonic_and_linear_motion():
    swing = HarmonicMotion((1.5, 0.0, -0.5), 2.0, 0.3)
    np.testing.assert_allclose(at(swing, 0.7)[0], np.sin(1.7) * np.array([1.5, 0.0, -0.5]))
    np.testing.assert_allclose(at(LinearMotion((0.5, -1.0, 0.0)), 0.0, 4.0), [[0, 0, 0], [2, -4, 0]])


def test_circular_motion():
    quarter = at(CircleMotion(2.0, 0.5, math.pi / 2), 0.0, math.pi)
    np.testing.assert_allclose(quarter, [[0, 2, 0], [-2, 0, 0]], atol=1e-12)
    back = at(CircleMotion(2.0, 0.5, math.pi / 2, clockwise=False), math.pi)
    np.testing.assert_allclose(back, [[2, 0, 0]], atol=1e-12)


def test_waypoints_stop_at_each_point():
    motion = WaypointsMotion(SQUARE, speed=1.0, hold=3.0)
    # 3 s at the first, 2 s to the second, 3 s there, 1 s to the third, and there for ever.
    np.testing.assert_allclose(
        at(motion, 0.0, 3.0, 4.0, 5.0, 7.9, 8.5, 9.0, 1e6),
        [[0, 0, 0], [0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 0, 0], [2, 0.5, 0], [2, 1, 0], [2, 1, 0]],
        atol=1e-12,
    )


def test_waypoints_repeat():
    motion = WaypointsMotion(SQUARE, speed=1.0, hold=3.0, repeat=True)
    period = 3 * 3.0 + 2.0 + 1.0 + math.sqrt(5.0)
    times = np.linspace(0.0, period, 50)
    np.testing.assert_allclose(at(motion, *times), at(motion, *(times + 3.0 * period)), atol=1e-9)
    np.testing.assert_allclose(at(motion, 12.0 + math.sqrt(5.0) / 2.0), [[1.0, 0.5, 0.0]], atol=1e-9)


@pytest.mark.parametrize(("speed", "acceleration"), [(1.0, 0.5), (1.0, 4.0), (3.0, 0.2)])
def test_waypoints_with_an_acceleration(speed, acceleration):
    motion = WaypointsMotion(SQUARE, speed=speed, hold=0.5, acceleration=acceleration)
    times = np.arange(0.0, 20.0, 1e-3)
    positions = at(motion, *times)
    velocity = np.diff(positions, axis=0) / 1e-3
    assert np.linalg.norm(velocity, axis=1).max() <= speed + 1e-6
    assert np.linalg.norm(np.diff(velocity, axis=0), axis=1).max() / 1e-3 <= acceleration * 1.001 + 1e-3
    np.testing.assert_allclose(positions[-1], SQUARE[-1])
    for point in SQUARE:  # at rest there for the hold
        assert np.sum(np.linalg.norm(positions - point, axis=1) < 1e-9) >= 0.49e3


def test_random_walk_is_determined_by_its_seed():
    motion = RandomWalkMotion(7, (0.8, 0.5, 0.0), 1.5)
    times = np.arange(0.0, 400.0, 0.01)
    positions = at(motion, *times)
    assert np.array_equal(positions[:10], at(motion, *times[:10]))
    assert not np.allclose(positions[:10], at(RandomWalkMotion(8, (0.8, 0.5, 0.0), 1.5), *times[:10]))
    velocity = np.diff(positions, axis=0) / 0.01
    np.testing.assert_allclose(velocity.std(axis=0), [0.8, 0.5, 0.0], rtol=0.15, atol=1e-9)
    # Nothing above the bandwidth: the acceleration's spectrum ends there.
    acceleration = np.diff(velocity[:, 0]) / 0.01 * np.hanning(len(velocity) - 1)
    spectrum = np.abs(np.fft.rfft(acceleration)) ** 2
    frequency = 2.0 * math.pi * np.fft.rfftfreq(len(acceleration), 0.01)
    assert spectrum[frequency > 1.6].sum() < 1e-3 * spectrum.sum()
    assert np.abs(positions).max() < 8.0


class _Bodies:
    def __init__(self):
        self.places = {}

    def add(self, name, shape, place):
        self.places[name] = place

    def move(self, name, place):
        self.places[name] = place


def test_obstacles_of_world_follow_their_motion():
    bodies = _Bodies()
    motions = [CircleMotion(1.0, 1.0), WaypointsMotion(SQUARE, 1.0), RandomWalkMotion(3, (1.0, 1.0, 1.0), 1.0)]
    obstacles = [Obstacle(str(i), (5.0, i, -4.0), Sphere(0.5), motion=motion) for i, motion in enumerate(motions)]
    moving = MovingObstacles(bodies, obstacles)
    for time in (0.0, 1.25):
        moving.move(time)
        for i, motion in enumerate(motions):
            np.testing.assert_allclose(bodies.places[str(i)], np.array([5.0, i, -4.0]) + motion.mover()(time))


def mission(folder, shape, motion):
    body = {
        "sphere": 'shape = "sphere"\nposition = [3.0, 0.0, -4.0]\nradius = 0.5',
        "pole": 'shape = "pole"\nposition = [3.0, 0.0]\nradius = 0.5\nheight = 9.0',
    }[shape]
    path = folder / "mission.toml"
    path.write_text(
        f'[mission]\nname = "m"\n[reference]\nkind = "waypoints"\npoints = [[9.0, 0.0, -4.0]]\n'
        f'[[obstacle]]\nname = "it"\n{body}\nmotion = {motion}\n'
    )
    return path


@pytest.mark.parametrize(
    ("motion", "expected"),
    [
        ('{ kind = "circle", radius = 2.0, angular_frequency = 0.5 }', CircleMotion(2.0, 0.5)),
        (
            '{ kind = "waypoints", points = [[0, 0, 0], [1, 0, 0]], speed = 1.0, hold = 2.0, repeat = true }',
            WaypointsMotion(((0, 0, 0), (1, 0, 0)), 1.0, 2.0, repeat=True),
        ),
        (
            '{ kind = "random_walk", seed = 4, speed = [0.5, 0.5, 0.0], bandwidth = 1.0 }',
            RandomWalkMotion(4, (0.5, 0.5, 0.0), 1.0),
        ),
    ],
)
@pytest.mark.parametrize("shape", ["sphere", "pole"])
def test_motions_are_read_from_mission(tmp_path, shape, motion, expected):
    assert read_mission(mission(tmp_path, shape, motion)).obstacles[0].motion == expected


@pytest.mark.parametrize(
    ("shape", "motion", "reason"),
    [
        ("sphere", '{ kind = "spiral" }', "motion.kind: 'spiral' is none of"),
        ("sphere", '{ kind = "circle", radius = 0.0, angular_frequency = 1.0 }', "motion.radius: "),
        ("sphere", '{ kind = "circle", radius = 1.0 }', "motion.angular_frequency: missing key"),
        ("sphere", '{ kind = "circle", radius = 1.0, angular_frequency = 1.0, sped = 1 }', "motion.sped: unknown key"),
        ("sphere", '{ kind = "waypoints", points = [[0, 0, 0]], speed = 1.0 }', "motion.points: needs at least 2"),
        ("sphere", '{ kind = "waypoints", points = [[0, 0, 0], [0, 0, 0]], speed = 1.0 }', "are the same"),
        (
            "sphere",
            '{ kind = "waypoints", points = [[0, 0, 0], [1, 0, 0], [0, 0, 0]], speed = 1.0, repeat = true }',
            "two consecutive points are the same",
        ),
        ("sphere", '{ kind = "random_walk", seed = -1, speed = [1, 1, 1], bandwidth = 1.0 }', "motion.seed: "),
        ("sphere", '{ kind = "random_walk", seed = 1, speed = [1, 1], bandwidth = 1.0 }', "motion.speed"),
        ("pole", '{ kind = "random_walk", seed = 1, speed = [1, 1, 1], bandwidth = 1.0 }', "no vertical motion"),
        ("pole", '{ kind = "waypoints", points = [[0, 0, 0], [1, 0, -1]], speed = 1.0 }', "no vertical motion"),
    ],
)
def test_invalid_motions_are_refused(tmp_path, shape, motion, reason):
    path = mission(tmp_path, shape, motion)
    with pytest.raises(UnusableFile) as refusal:
        read_mission(path)
    line = path.read_text().splitlines().index(f"motion = {motion}") + 1
    assert any(reason in r and f"line {line}: " in r for r in refusal.value.reasons), refusal.value.reasons
