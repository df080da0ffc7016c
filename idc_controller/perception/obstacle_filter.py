"""Shape, size, place and motion of one obstacle from its surface points."""

import math
from dataclasses import replace

import numpy as np
from scipy.special import ndtri

from idc_controller.arrays import Array
from idc_controller.estimation.health.chi_squared import length_quantile, upper_quantile
from idc_controller.geometry.shape import Shape
from idc_controller.geometry.shapes import Wall
from idc_controller.perception.manoeuvre import ManoeuvreDetector
from idc_controller.perception.motion_imm import MotionImm, MotionModels
from idc_controller.perception.seen_points_kernels import distances_outside, remembered
from idc_controller.perception.settings import ObstacleFilterSettings, SurfaceSettings
from idc_controller.perception.surfaces.flat import FlatSurface
from idc_controller.perception.surfaces.points import Fit, KnownSurface, SurfacePoints
from idc_controller.perception.surfaces.round import RoundSurface

Surface = RoundSurface | FlatSurface | KnownSurface

KINDS = ("sphere", "pole", "wall")


class ObstacleFilter:
    """Filter of one obstacle. Times in s, places NED in m."""

    def __init__(
        self,
        models: MotionModels,
        first: SurfacePoints,
        known: Shape | None = None,
        settings: ObstacleFilterSettings = ObstacleFilterSettings(),
        scatter: float = 0.0,
    ) -> None:
        """Start from one frame.

        Args:
            models: motion models.
            first: points of the frame.
            known: shape from the map; only its motion is to be found.
            settings: of the filter.
            scatter: variance of the points beyond their sensors', as known from other obstacles (m2).
        """
        self.settings = settings
        self._complexity = {"sphere": 0.0, "pole": self.settings.pole_complexity, "wall": self.settings.wall_complexity}
        self._outside_sigmas = float(-ndtri(settings.outside_share))
        self.frames = 0
        self._known = known
        self._scores: dict[str, float] = {}
        self.scatter = scatter
        """Variance of the points beyond their sensors' (m2)."""
        self._seen = np.empty((0, 5))
        """Points of the last frames, see :mod:`idc_controller.perception.seen_points_kernels`."""
        self._uncovered = 0.0
        """Distance of the outermost of these outside of the fitted shape, which is then not the obstacle's (m)."""
        self._surface = surface_of(known.kind if known else "sphere", known, self.settings.surfaces)
        if known is None and scatter == 0.0 and len(first.points) >= self.settings.points_min:
            # Before the kind is chosen: with much scatter a wall would fit anything.
            self._learn_scatter(min(self._fresh_fit(kind, first)[1].unexplained for kind in KINDS), share=1.0)
        first = replace(first, scatter=self.scatter)
        predicted = self._surface.guess(first)
        fit = self._surface.fit(first, predicted, iterations=8)
        self._imm = MotionImm(models, first.time, fit.position, fit.variance)
        self.manoeuvre = ManoeuvreDetector(first.time, self.settings.manoeuvre)
        """Whether its motion is that of the models."""
        self.frames = 1
        if known is None:
            self._scores["sphere"] = fit.score
            self._consider_kinds(first, fit)
            self._remember(first)

    @property
    def time(self) -> float:
        """Time of the last frame (s)."""
        return self._imm.time

    @property
    def kind(self) -> str:
        """sphere, pole or wall."""
        return self._surface.kind

    @property
    def shape(self) -> Shape:
        """Estimated shape."""
        return self._surface.shape

    @property
    def state(self) -> tuple[Array, Array, Array]:
        """Position of the centre (NED, m), velocity and acceleration (3,) at :attr:`time`."""
        position, velocity, acceleration = self._imm.state
        return position + self._surface.offset, velocity, acceleration

    @property
    def is_static(self) -> bool:
        """Return whether it is static."""
        s, (_, velocity, _) = self.settings, self._imm.state
        return bool(self._imm.weight[0] > s.static_weight and np.linalg.norm(velocity) < s.static_speed)

    @property
    def may_move(self) -> bool:
        """Return whether it can be an obstacle that moves.

        Its speed is within the stated one, and it is no wall: no flat face of more than ``mover_face_max`` both ways.
        """
        s = self.settings
        is_wall = self._known is None and isinstance(self.shape, Wall) and min(self.shape.size[1:]) > s.mover_face_max
        return not is_wall and float(np.linalg.norm(self._imm.state[1])) <= s.mover_speed_max

    def is_moving(self, false_alarm: float) -> bool:
        """Return whether noise explains its velocity with less than the stated probability."""
        _, velocity, _ = self._imm.state
        squared = float(np.sum(velocity**2 / self.velocity_variance))
        return not self.is_static and squared > float(upper_quantile(false_alarm, 3))

    def advance(self, time: float) -> None:
        """Predict the motion to ``time`` (s); earlier times are passed over."""
        self._imm.advance(time)
        self.manoeuvre.advance(time)

    @property
    def position_sigma(self) -> float:
        """Largest standard deviation of the position on any axis at :attr:`time` (m)."""
        return float(np.sqrt(self._imm.position_variance.max()))

    @property
    def velocity_variance(self) -> Array:
        """Variance of the velocity (3,) at :attr:`time` (m2/s2)."""
        return self._imm.velocity_variance

    def update(self, points: SurfacePoints) -> None:
        """Take one frame of points on this obstacle; a late one is moved to the present by the estimated motion."""
        imm, s = self._imm, self.settings
        points = replace(points, scatter=self.scatter)
        if points.time > imm.time:
            imm.advance(points.time)
        elif points.time < imm.time:
            late = imm.time - points.time
            _, velocity, _ = imm.state
            points = points.moved(velocity * late, imm.time, (s.late_speed * late) ** 2)
        fit = self._surface.fit(points, imm.state[0])
        self.manoeuvre.advance(imm.time)
        self.manoeuvre.add_innovation(imm.update(fit.position, fit.variance))
        self._compare_predictions()
        self.frames += 1
        if self._known is not None:
            return
        if len(points.points) >= s.points_min:
            self._note(self.kind, fit.score)
            if self.frames <= s.every_frame_until or self.frames % s.every_frames == 0 or fit.score > s.retry_score:
                self._consider_kinds(points, fit)
            elif self.scatter > 0.0:
                self._learn_scatter(fit.unexplained)
        self._remember(points)

    def _remember(self, points: SurfacePoints) -> None:
        """Remember the points of a frame, and how far the outermost of the last ones lies outside, beyond their noise.

        The body is never less than what was seen of it, however well the shape fits each frame. As many points as there
        are false ones among them are left out.
        """
        s, time = self.settings, points.time
        self._seen = remembered(
            self._seen, time - s.seen_memory, time, np.ascontiguousarray(points.points), self._imm.state[0].copy(),
            points.pose_variance, points.noise**2, points.scatter, s.outermost_sigmas,
        )  # fmt: skip
        outside = distances_outside(self._seen, self.shape.row[None], self._surface.offset)
        last = len(outside) - 1 - math.ceil(s.false_share * len(outside))
        self._uncovered = max(float(np.partition(outside, last)[last]), 0.0) if last >= 0 else 0.0

    def _compare_predictions(self) -> None:
        """Compare an earlier prediction with the state now, and predict anew."""
        position, velocity, _ = self._imm.state
        self.manoeuvre.compare(position, velocity)
        if self.manoeuvre.is_settled:
            mean, covariance = self._imm.predict(np.array([self._imm.time + self.settings.manoeuvre.horizon]))
            self.manoeuvre.add_prediction(mean[0], math.sqrt(float(covariance[0].trace())))

    def centres(self, times: Array) -> Array:
        """Return the predicted centre (K, 3) (NED, m) at ``times`` (K,) (s)."""
        return self._imm.predict(times)[0] + self._surface.offset

    def predict(self, times: Array) -> tuple[Array, Array]:
        """Return the predicted centre (K, 3) (NED, m) at ``times`` (K,) (s), and the growth of the body (K,) (m)."""
        mean, covariance = self._imm.predict(times)
        unmodelled = self.manoeuvre.variance(np.maximum(np.asarray(times) - self._imm.time, 0.0))
        position = length_quantile(self.settings.outside_share, covariance + unmodelled[:, None, None] * np.eye(3))
        # Centre and size are of the same points: their errors may add.
        extent = self._outside_sigmas * np.hypot(self._surface.size_sigma, np.sqrt(self.scatter))
        # Where points scatter, its motion is estimated late.
        limit = self.manoeuvre.growth_limit(np.sqrt(self.scatter))
        growth = np.hypot(np.minimum(position + extent, limit), self._uncovered)
        return mean + self._surface.offset, growth

    def _note(self, kind: str, score: float) -> None:
        old = self._scores.get(kind)
        self._scores[kind] = score if old is None else old + self.settings.smoothing * (score - old)

    def _consider_kinds(self, points: SurfacePoints, own: Fit) -> None:
        """Fit the other shapes to this frame alone, and change to one that is clearly better."""
        if len(points.points) < self.settings.points_min:
            return
        unexplained = own.unexplained
        tried: dict[str, tuple[Surface, Array]] = {}
        for kind in KINDS:
            if kind == self.kind:
                continue
            surface, fit = self._fresh_fit(kind, points)
            self._note(kind, fit.score)
            unexplained = min(unexplained, fit.unexplained)
            tried[kind] = surface, fit.position
        self._learn_scatter(unexplained)
        cost = {kind: self._scores[kind] + self._complexity[kind] for kind in KINDS}
        best = min(KINDS, key=lambda kind: cost[kind])
        hysteresis = self.settings.hysteresis if self.frames > 1 else 0.0
        if self._complexity[best] < self._complexity[self.kind]:
            # With scatter all shapes fit alike, and the simplest is taken.
            hysteresis *= points.noise**2 / (points.noise**2 + self.scatter)
        if best != self.kind and cost[best] < cost[self.kind] - hysteresis:
            old = self._imm.state[0]
            self._surface, place = tried[best]
            self._imm.shift(place - old)
            self._seen[:, 1:4] += old - place

    def _learn_scatter(self, unexplained: float, share: float | None = None) -> None:
        """Learn from points that lie on no shape that the sensors are worse than specified."""
        share = self.settings.smoothing if share is None else share
        self.scatter = min(max(self.scatter + share * unexplained, 0.0), self.settings.scatter_max**2)

    def _fresh_fit(self, kind: str, points: SurfacePoints) -> tuple[Surface, Fit]:
        """Fit a surface of a kind to one frame alone."""
        surface = surface_of(kind, None, self.settings.surfaces)
        return surface, surface.fit(points, surface.guess(points), iterations=8)


def surface_of(kind: str, known: Shape | None, settings: SurfaceSettings) -> Surface:
    """Return a surface to fit to points; ``known``: the shape is given and only its place is to be found."""
    if known is None:
        return FlatSurface(None, settings) if kind == FlatSurface.kind else RoundSurface(kind, None, settings)
    if isinstance(known, Wall):
        return FlatSurface(known, settings)
    return RoundSurface(kind, known, settings) if known.round_axes else KnownSurface(known, settings)
