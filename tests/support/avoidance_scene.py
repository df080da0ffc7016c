"""The safety filter flown without a plant: the payload is where the filter's trajectory says, at every step."""

from dataclasses import dataclass, field

import coal
import numpy as np
from paper_system import system
from plain_flatness import flat_forces
from scipy.spatial import ConvexHull

from gcs.planning.flight import IdealTracking
from idc_controller.estimation.measurements import Estimate
from idc_controller.geometry.obstacles import PredictedObstacle
from idc_controller.geometry.shapes import Pole, Sphere, Wall
from idc_controller.guidance.navigator import Navigator
from idc_controller.guidance.progress import AdaptiveGuidance
from idc_controller.guidance.settings import NavigatorSettings, ProgressSettings
from idc_controller.model.linear import LinearModel
from idc_controller.safety.safety_filter import AvoidanceFilter
from idc_controller.safety.settings import PlannerSettings
from idc_controller.trajectory.flatness import Load
from idc_controller.trajectory.paths import Leg
from idc_controller.trajectory.settings import Limits
from idc_controller.trajectory.waypoints import WaypointTrajectory

STEP = 0.05  # s


def hull_of(parameters, derivatives, rim=16):
    """Exact points of the formation (K, P, 3) for payload ``derivatives`` (5, K, 3), by flatness; discs as polygons."""
    forces = flat_forces(parameters, derivatives, Load(parameters.m_0, np.zeros(3)))
    position = derivatives[0]
    parts = [position[:, None] + parameters.payload.vertices]
    angles = np.linspace(0.0, 2.0 * np.pi, rim, endpoint=False)
    for i in range(parameters.number_of_uavs):
        centre = position + parameters.p[i] - parameters.l[i] * forces.q
        axis = forces.force[:, i] / np.linalg.norm(forces.force[:, i], axis=1, keepdims=True)
        first = np.cross(axis, [0.0, 1.0, 0.0])
        first /= np.linalg.norm(first, axis=1, keepdims=True)
        second = np.cross(axis, first)
        ring = np.cos(angles)[None, :, None] * first[:, None] + np.sin(angles)[None, :, None] * second[:, None]
        parts.append(centre[:, None] + parameters.disc_radius * ring)
    return np.concatenate(parts, axis=1)


def clearance_of(points, shape, position):
    """True distance of the convex hull of ``points`` (P, 3) to a body at ``position``; not above zero: they meet."""
    hull = ConvexHull(points)
    number = {vertex: k for k, vertex in enumerate(hull.vertices)}
    vertices, facets = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    vertices.extend(list(points[hull.vertices]))
    for simplex in hull.simplices:
        facets.append(coal.Triangle(*(number[k] for k in simplex)))
    result = coal.DistanceResult()
    return coal.distance(
        coal.Convex(vertices, facets), coal.Transform3s.Identity(),
        shape.geometry(), coal.Transform3s(shape.rotation, np.asarray(position, dtype=float)),
        coal.DistanceRequest(), result,
    )  # fmt: skip


def sphere(name, position, velocity=(0.0, 0.0, 0.0), radius=0.5, growth=0.0):
    place, velocity = np.array(position, dtype=float), np.array(velocity, dtype=float)
    return name, Sphere(radius), lambda t: place + np.outer(t, velocity), growth


def swinging(name, position, amplitude, frequency=1.0, phase=0.0, radius=0.5):
    place, swing = np.array(position, dtype=float), np.array(amplitude, dtype=float)
    return name, Sphere(radius), lambda t: place + np.outer(np.sin(frequency * t + phase), swing), 0.0


def pole(name, north, east, radius=0.3, height=15.0):
    place = np.array([north, east, -height / 2.0])
    return name, Pole(radius, height), lambda t: np.tile(place, (len(t), 1)), 0.0


def wall(name, north, east, size, yaw=0.0):
    """A wall that stands on the ground."""
    place = np.array([north, east, -size[2] / 2.0])
    return name, Wall(size=tuple(size), yaw=yaw), lambda t: np.tile(place, (len(t), 1)), 0.0


class Scene:
    """Obstacles whose motion is known exactly."""

    def __init__(self, obstacles):
        self.obstacles = list(obstacles)

    def predict(self, times, region=None):
        times = np.asarray(times, dtype=float)
        return [
            PredictedObstacle(name, shape, motion(times), np.full(len(times), growth))
            for name, shape, motion, growth in self.obstacles
        ]


def estimate_at(time, position, size=56):
    x = np.zeros(size)
    x[:3] = position
    return Estimate(time, x, np.zeros(3), np.zeros((4, 3)), 0.0, np.zeros((3, 3)), lambda: np.zeros((size + 12,) * 2))


def straight(length, speed=1.5, altitude=5.0, start=0.0):
    """A path north, from rest to rest."""
    legs = [Leg(np.array([length, 0.0, -altitude]), speed)]
    return WaypointTrajectory([0.0, 0.0, -altitude], legs, Limits(speed, 1.5, 2.0, 6.0), start=start)


def avoidance(obstacles, n=4, margin=0.5, speed=1.5, by_sight=None, area=None, **settings):
    parameters, scene = system(n), Scene(obstacles)
    safety = AvoidanceFilter(parameters, PlannerSettings(margin=margin, **settings), scene)
    stages = safety.settings.chain.times
    navigation = NavigatorSettings(limits=Limits(speed, 1.5, 2.0, 6.0), margin=margin)
    navigator = Navigator(parameters, navigation, scene, stages, area)
    guidance = AdaptiveGuidance(navigator, ProgressSettings(), stages, parameters.m_0 * parameters.g, by_sight)
    return IdealTracking(LinearModel(parameters), safety, guidance)


@dataclass
class Flown:
    """Result of a flight."""

    avoidance: IdealTracking
    mission: WaypointTrajectory
    times: list = field(default_factory=list)
    derivatives: list = field(default_factory=list)
    reports: list = field(default_factory=list)
    rates: list = field(default_factory=list)
    """Progress rates."""
    seams: list = field(default_factory=list)
    """Largest step of position to snap where one plan follows another (5,)."""
    ends_at: float = np.nan
    """Time at which the mission's end was reached (s)."""

    @property
    def path(self):
        """(5, K, 3)"""
        return np.stack(self.derivatives, axis=1)

    @property
    def slack(self):
        return max(report.slack for report in self.reports)

    def clearance(self, every=2):
        """Least true distance of every obstacle to the exact hull, {name: m}."""
        points = hull_of(system(self.avoidance.safety.formation.hover_offsets.shape[0]), self.path)
        least = {}
        for name, shape, motion, _ in self.avoidance.safety.obstacles.obstacles:
            places = motion(np.array(self.times))
            reach = shape.reach + 6.0
            lateral = np.linalg.norm((places - self.path[0])[:, :2], axis=1)
            near = [k for k in range(0, len(places), every) if lateral[k] < reach]
            least[name] = min((clearance_of(points[k], shape, places[k]) for k in near), default=np.inf)
        return least


def fly(avoidance, mission, duration, on_step=lambda flown, time: None, until_end=True, time=0.0):
    """Fly ``mission``; stops a second after its end is reached."""
    flown = Flown(avoidance, mission)
    before = None
    while time < duration:
        trajectory = avoidance.step(time, mission)
        now = trajectory.derivatives(np.array([time, time + STEP]))
        if before is not None:
            flown.seams.append(np.abs(now[:, 0] - before.derivatives(np.array([time]))[:, 0]).max(axis=1))
        flown.times.append(time)
        flown.derivatives.append(now[:, 0])
        flown.reports.append(avoidance.safety.report)
        flown.rates.append(avoidance.guidance.rate)
        before = trajectory
        time = round(time + STEP, 6)
        on_step(flown, time)
        if np.isnan(flown.ends_at) and np.isfinite(mission.end) and avoidance.guidance.progress(time) >= mission.end:
            flown.ends_at = time
        if until_end and time > flown.ends_at + 4.0:
            break
    return flown
