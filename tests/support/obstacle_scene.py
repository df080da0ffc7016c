"""Obstacles seen by range sensors, for tests of perception: the sensors' rays, first hits and noise, no MAVLink."""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from gcs.config import RangeSensorConfig
from gcs.flight.stack import known_obstacles, sensor_rays
from idc_controller.estimation.measurements import Attitude, Position, VehicleStates
from idc_controller.geometry.obstacles import Bodies
from idc_controller.geometry.shapes import Box, Pole, Sphere, Wall
from idc_controller.perception.obstacle_map import ObstacleMap
from idc_controller.perception.range_sensors import SensorModel
from idc_controller.perception.scan_placement import Returns, ScanEnd
from idc_controller.perception.surfaces.points import SurfacePoints, joined
from idc_controller.rotations import quaternion_from_euler, rotation_from_quaternion
from vehicle_sim.world.obstacle_bodies import Obstacle
from vehicle_sim.world.range_sensor import RangeSample, RangeSensor, RayBodies
from vehicle_sim.world.sensors import Measurement

REACH, NOISE = 10.0, 0.05
POSITION_NOISE, ATTITUDE_NOISE = 0.02, math.radians(0.2)
#: Of four UAVs about the formation's centre, at the height at which they fly above the payload.
FORMATION = np.array([[0.5, 0.5, 0.0], [0.5, -0.5, 0.0], [-0.5, -0.5, 0.0], [-0.5, 0.5, 0.0]])
#: A quarter of the default rays: fewer returns, and less time.
CONFIG = RangeSensorConfig(range=REACH, noise=NOISE, rays=500)
RAYS = sensor_rays(CONFIG)
#: A lidar that looks everywhere and that no telemetry link limits, for fits to points of one obstacle.
DENSE = replace(CONFIG, rays=6000, elevation_min_deg=-89.0, elevation_max_deg=89.0)
SENSORS = SensorModel(NOISE, POSITION_NOISE, ATTITUDE_NOISE)
HERE = np.array([0.0, 0.0, -6.0])


def sphere(position, radius=0.5, name="sphere"):
    return Obstacle(name, Sphere(radius), tuple(position))


def pole(position, radius=0.2, height=15.0, name="pole"):
    return Obstacle(name, Pole(radius, height), (position[0], position[1], -height / 2.0))


def wall(position, size=(0.3, 5.0, 6.0), yaw=0.3, name="wall"):
    return Obstacle(name, Wall(tuple(size), yaw), tuple(position))


def box(position, size=(1.0, 1.0, 1.0), yaw=0.0, name="box"):
    return Obstacle(name, Box(tuple(size), yaw=yaw), tuple(position))


class Look(NamedTuple):
    """One scan of UAV ``uav`` (0 .. N-1), its measured pose, and the true points that its returns hit (n, 3)."""

    uav: int
    position: np.ndarray
    quaternion: np.ndarray
    sample: RangeSample
    hits: np.ndarray

    @property
    def sigmas(self):
        """Standard deviation of each return by all errors together (n,) (m)."""
        away = np.linalg.norm(self.sample.points, axis=1)
        return np.sqrt(NOISE**2 + POSITION_NOISE**2 + (ATTITUDE_NOISE * away) ** 2)


class Scene:
    """Four UAVs that look around. Poses on the ground's side have the noise of the default navigation."""

    def __init__(self, seed=0, uavs=4, noise=NOISE, reach=REACH, loss=0.0, sensor=CONFIG):
        self.rng = np.random.default_rng([seed, 7])
        self.reach, self.noise, self.loss = reach, noise, loss
        config = replace(sensor, noise=noise, range=reach)
        self._sensors = [RangeSensor(config, seed, i) for i in range(1, uavs + 1)]
        # The same draws of missed returns.
        self._exact = [RangeSensor(replace(config, noise=0.0), seed, i) for i in range(1, uavs + 1)]

    def look(self, time, centre, obstacles):
        """Return the scans at ``time``, the formation at ``centre`` (3,)."""
        found, bodies = [], RayBodies.of([(o.shape, o.position_in_world) for o in obstacles])
        for i, sensor in enumerate(self._sensors):
            position = np.asarray(centre) + FORMATION[i]
            angles = self.rng.normal(0.0, 0.05, 3)
            attitude = tuple(quaternion_from_euler(*angles).tolist())
            own = Measurement(time, attitude, (0.0,) * 3, tuple(position), (0.0,) * 3)
            arguments = time, round(time * 1e3), tuple(position), attitude, own, bodies
            sample, exact = sensor.scan(*arguments), self._exact[i].scan(*arguments)
            measured = position + self.rng.normal(0.0, POSITION_NOISE, 3)
            errors = self.rng.normal(0.0, ATTITUDE_NOISE, 3)
            if self.rng.uniform() >= self.loss:
                hits = position + exact.points @ rotation_from_quaternion(np.array(attitude)).T
                found.append(Look(i, measured, quaternion_from_euler(*(angles + errors)), sample, hits))
        return found

    def parts(self, time, centre, obstacle):
        """Return [(uav, SurfacePoints)] on one obstacle at ``time`` with the formation at ``centre`` (3,)."""
        found = []
        for i, measured, quaternion, sample, _ in self.look(time, centre, [obstacle]):
            if not len(sample.points):
                continue
            distance = np.linalg.norm(sample.points, axis=1)
            found.append((i, SurfacePoints(
                time, measured + sample.points @ rotation_from_quaternion(quaternion).T,
                np.tile(measured, (len(distance), 1)), distance > self.reach - 4.0 * self.noise, self.noise,
                POSITION_NOISE**2 + (ATTITUDE_NOISE * distance) ** 2,
            )))  # fmt: skip
        return found

    def frame(self, time, centre, obstacle):
        """All points on one obstacle; None if no vehicle detects it."""
        parts = [points for _, points in self.parts(time, centre, obstacle)]
        return joined(parts) if parts else None

    def feed(self, obstacle_map, time, centre, obstacles, off=None):
        """Hand a map what it would get from telemetry at ``time``, and return the scans.

        ``off`` (3,): error of the reported positions (m), of which the ground has estimates.
        """
        seen, states = self.look(time, centre, obstacles), np.zeros((len(self._sensors), 13))
        for i, position, quaternion, *_ in seen:
            states[i, 0:3], states[i, 6:10] = position, quaternion
        if off is not None:
            obstacle_map.placement.poses.add_estimated(VehicleStates(time, states))
        for found in seen:
            reported = found.position if off is None else found.position + off
            hand_over(obstacle_map.placement, time, found.uav, (reported, found.quaternion), found.sample.points)
        return seen


def hand_over(placement, time, uav, pose, points, rate=0.0):
    """Give a placement the pose (None: none) and the complete scan of one vehicle, its ``points`` in the body frame."""
    if pose is not None:
        placement.poses.add_measured(Attitude(time, uav, np.asarray(pose[1]), np.full(3, rate)))
        placement.poses.add_measured(Position(time, uav, np.asarray(pose[0]), np.full(3, rate)))
    stamp = round(time * 1e3)
    placement.add(Returns(stamp, np.ascontiguousarray(points), np.full(len(points), REACH)), uav, time, time)
    placement.end(ScanEnd(stamp, REACH, True), uav, time, time)


MOTIONS = {
    "standing": lambda t: np.zeros(3),
    "linear": lambda t: np.array([1.2 * t - 5.0, 1.6 * t - 6.0, 0.0]),
    "harmonic": lambda t: np.array([2.0 * math.sin(t), 0.0, 0.0]),
    "fast harmonic": lambda t: np.array([0.0, 1.0 * math.sin(2.0 * t + 0.4), 0.0]),
    "circle": lambda t: np.array([1.6 * math.cos(1.25 * t), 1.6 * math.sin(1.25 * t), 0.0]),
}


def random_motion(seed, duration=12.0, speed=2.0, acceleration=2.0):
    """A motion with accelerations drawn anew every 0.7 s or so, speed limited: in no model of the estimator."""
    rng = np.random.default_rng([seed, 11])
    dt = 0.01
    v, p = rng.normal(0.0, 0.7, 3), np.zeros(3)
    a, left = np.zeros(3), 0.0
    trajectory = []
    for _ in range(int(duration / dt) + 200):
        if left <= 0.0:
            a, left = rng.normal(0.0, acceleration, 3) - 0.15 * p, rng.exponential(0.7)
        v = v + a * dt
        v *= min(1.0, speed / np.linalg.norm(v))
        p = p + v * dt
        left -= dt
        trajectory.append(p)
    trajectory = np.array(trajectory)
    return lambda t: trajectory[min(max(round(t / dt), 0), len(trajectory) - 1)]


def stop_and_go(t):
    """2 m/s for 1.5 s, standing for 1.5 s, and back."""
    phase, cycle = t % 6.0, 3.0
    going = min(phase, 1.5) if phase < cycle else 1.5 - min(phase - cycle, 1.5)
    return np.array([2.0 * going, 0.0, 0.0])


def map_of(*known, rays=RAYS):
    return ObstacleMap(known_obstacles(known), SENSORS, REACH, rays)


def run(obstacle_map, obstacles, until, begin=0.0, scene=None, centre=lambda t: HERE, each=lambda t: None):
    """Scans at 10 Hz and control steps at 20 Hz; ``obstacles(t)`` are the true ones. Return all scans."""
    scene, seen = scene or Scene(0), []
    for k in range(round(begin * 20), round(until * 20)):
        t = k / 20
        if k % 2 == 0:
            seen += scene.feed(obstacle_map, t, centre(t), obstacles(t))
        obstacle_map.update(t)
        each(t)
    return seen


def moving_tracks(obstacle_map):
    """Names of the tracks that count as obstacles."""
    return [track.name for track in obstacle_map.tracks if track.is_obstacle]


def nearest(obstacle_map, time, place):
    """Name and error of the track next to a place."""
    found = {track.name: track.position for track in obstacle_map.confirmed_tracks(time)}
    name = min(found, key=lambda n: np.linalg.norm(found[n] - place))
    return name, float(np.linalg.norm(found[name] - place))


def outside(obstacle_map, time, points, names=""):
    """Signed distance (n,) of points from all that is predicted now whose names begin with ``names``; inf if none."""
    found = [o for o in obstacle_map.predict(np.array([time])) if o.name.startswith(names)]
    if not found:
        return np.full(len(points), math.inf)
    distance = Bodies([o.shape for o in found]).distance(points, np.array([o.positions[0] for o in found]))
    return (distance - np.array([o.growth[0] for o in found])[:, None]).min(axis=0)
