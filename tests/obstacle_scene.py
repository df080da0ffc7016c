"""Obstacles detected by range sensors, for tests of the obstacle map: points with noise, no MAVLink."""

import math

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config import RangeSensorConfig
from gcs.mavlink.layout import LAYOUTS
from gcs.mavlink.messages import Received
from gcs.mavlink.telemetry import detections
from gcs.mission.known_obstacles import known_obstacles
from idc_controller.estimation.measurements import Attitude, Position, VehicleStates
from idc_controller.geometry.box import Wall
from idc_controller.geometry.pole import Pole
from idc_controller.geometry.sphere import Sphere
from idc_controller.perception.obstacle_map import ObstacleMap
from idc_controller.perception.scan_assembly import SensorModel
from idc_controller.perception.surfaces.points import SurfacePoints, joined
from idc_controller.rotations import quaternion_from_euler, rotation_from_quaternion
from vehicle_sim.world.obstacle_bodies import Obstacle, ScanTargets
from vehicle_sim.world.range_sensor import RangeSensor

REACH, NOISE = 10.0, 0.05
POSITION_NOISE, ATTITUDE_NOISE = 0.02, math.radians(0.2)
#: Of four UAVs about the formation's centre, at the height at which they fly above the payload.
FORMATION = np.array([[0.5, 0.5, 0.0], [0.5, -0.5, 0.0], [-0.5, -0.5, 0.0], [-0.5, 0.5, 0.0]])
SENSORS = SensorModel(NOISE, POSITION_NOISE, ATTITUDE_NOISE)
HERE = np.array([0.0, 0.0, -6.0])


def sphere(position, radius=0.5, name="sphere"):
    return Obstacle(name, Sphere(radius), tuple(position))


def pole(position, radius=0.2, height=15.0, name="pole"):
    return Obstacle(name, Pole(radius, height), (position[0], position[1], -height / 2.0))


def wall(position, size=(0.3, 5.0, 6.0), yaw=0.3, name="wall"):
    return Obstacle(name, Wall(tuple(size), yaw), tuple(position))


def messages_of(scan):
    """As a vehicle sends it."""
    return [
        mavlink.MAVLink_obstacle_distance_3d_message(
            round(scan.time * 1e3), mavlink.MAV_DISTANCE_SENSOR_LASER, mavlink.MAV_FRAME_BODY_FRD,
            number, *point, 0.05, scan.reach,
        )
        for number, point in zip(scan.obstacle_ids.tolist(), scan.points.tolist(), strict=True)
    ]  # fmt: skip


def detections_of(message):
    """As the ground reads it."""
    layout, payload = LAYOUTS[message.id].pack_message(message)
    return detections(Received(layout, payload, 1, 1, 1, 0, 0, 0, message.time_boot_ms))


class Scene:
    """Four UAVs that look around. Poses on the ground's side have the noise of the default navigation."""

    def __init__(self, seed=0, uavs=4, noise=NOISE, reach=REACH, loss=0.0):
        self.rng = np.random.default_rng([seed, 7])
        self.reach, self.noise, self.loss = reach, noise, loss
        self.sensors = [RangeSensor(RangeSensorConfig(range=reach, noise=noise), seed, i) for i in range(1, uavs + 1)]

    def look(self, time, centre, obstacles):
        """Return [(uav, position, attitude, RangeSample)] at ``time``, the formation at ``centre`` (3,)."""
        found, targets = [], ScanTargets.of(obstacles)
        for i, sensor in enumerate(self.sensors):
            position = np.asarray(centre) + FORMATION[i]
            angles = self.rng.normal(0.0, 0.05, 3)
            scan = sensor.scan(time, position, tuple(quaternion_from_euler(*angles)), targets)
            measured = position + self.rng.normal(0.0, POSITION_NOISE, 3)
            errors = self.rng.normal(0.0, ATTITUDE_NOISE, 3)
            if self.rng.uniform() >= self.loss:
                found.append((i, measured, quaternion_from_euler(*(angles + errors)), scan))
        return found

    def scans(self, time, centre, obstacles):
        """[(uav, id, SurfacePoints)] of the scans at ``time`` with the formation at ``centre`` (3,)."""
        found = []
        for i, measured, quaternion, scan in self.look(time, centre, obstacles):
            rotation = rotation_from_quaternion(quaternion)
            for number in sorted(set(scan.obstacle_ids.tolist())):
                body = scan.points[scan.obstacle_ids == number]
                distance = np.linalg.norm(body, axis=1)
                found.append((i, number, SurfacePoints(
                    time, measured + body @ rotation.T, np.tile(measured, (len(body), 1)),
                    distance > self.reach - 4.0 * self.noise, self.noise,
                    POSITION_NOISE**2 + (ATTITUDE_NOISE * distance) ** 2,
                )))  # fmt: skip
        return found

    def feed(self, obstacle_map, time, centre, obstacles, off=None):
        """Hand a map what it would get from telemetry at ``time``.

        ``off`` (3,): error of the reported positions (m), of which the ground has estimates.
        """
        seen, states = self.look(time, centre, obstacles), np.zeros((len(self.sensors), 13))
        for i, position, quaternion, _ in seen:
            states[i, 0:3], states[i, 6:10] = position, quaternion
        if off is not None:
            obstacle_map.scans.poses.add_estimated(VehicleStates(time, states))
        for i, position, quaternion, scan in seen:
            obstacle_map.scans.poses.add_measured(Attitude(time, i, quaternion, np.zeros(3)))
            reported = position if off is None else position + off
            obstacle_map.scans.poses.add_measured(Position(time, i, reported, np.zeros(3)))
            for message in messages_of(scan):
                obstacle_map.scans.add(detections_of(message), i, time)

    def frame(self, time, centre, obstacle):
        """All points on one obstacle; None if no vehicle detects it."""
        parts = [points for _, _, points in self.scans(time, centre, [obstacle])]
        return joined(parts) if parts else None


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


def map_of(*known):
    return ObstacleMap(known_obstacles(known), SENSORS, REACH)


def run(obstacle_map, obstacles, until, begin=0.0, scene=None, centre=lambda t: HERE, each=lambda t: None):
    """Scans at 10 Hz and control steps at 20 Hz; ``obstacles(t)`` are the true ones."""
    scene = scene or Scene(0)
    for k in range(round(begin * 20), round(until * 20)):
        t = k / 20
        if k % 2 == 0:
            scene.feed(obstacle_map, t, centre(t), obstacles(t))
        obstacle_map.update(t)
        each(t)
    return obstacle_map


def places(obstacle_map, time):
    return {b.name: b.position for b in obstacle_map.confirmed_tracks(time)}


def nearest(obstacle_map, time, place):
    """Name and error of the track next to a place."""
    found = places(obstacle_map, time)
    name = min(found, key=lambda n: np.linalg.norm(found[n] - place))
    return name, float(np.linalg.norm(found[name] - place))
