"""One obstacle from surface points: which shape it is, how large, where, and how it moves."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from idc_controller.geometry.box import Wall
from idc_controller.geometry.shape import Shape
from idc_controller.perception.manoeuvre import AHEAD, Agility, AgilitySettings
from idc_controller.perception.motion_imm import MotionBank, MotionModels
from idc_controller.perception.surfaces.fit import Fit
from idc_controller.perception.surfaces.flat import FlatSurface
from idc_controller.perception.surfaces.known import KnownSurface
from idc_controller.perception.surfaces.points import SurfacePoints
from idc_controller.perception.surfaces.round import RoundSurface

Array = NDArray[np.float64]
Surface = RoundSurface | FlatSurface | KnownSurface

KINDS = ("sphere", "pole", "wall")
#: What a score must be better by for the less simple shape, and for a change of mind.
_COMPLEXITY = {"sphere": 0.0, "pole": 0.4, "wall": 0.8}
_HYSTERESIS = 1.0
_SMOOTHING = 0.3
_LEAST_POINTS = 5
_EVERY_FRAME_UNTIL, _THEN_EVERY = 6, 20
_SCATTER_MAX = 0.5**2  # m2
_DOUBTFUL = 2.5  # a score from which other shapes are tried at once


@dataclass(frozen=True)
class FilterSettings:
    """Of one obstacle's filter."""

    agility: AgilitySettings = field(default_factory=AgilitySettings)
    static_speed: float = 0.1
    """An obstacle whose speed is surely below this is taken to stand (m/s)."""


class ObstacleFilter:
    """One obstacle. Times in s, places NED in m.

    ``known``: its shape is known and only its motion is to be found. ``scatter`` (m2) of points, as far as others have
    shown it already.
    """

    def __init__(
        self,
        models: MotionModels,
        first: SurfacePoints,
        known: Shape | None = None,
        settings: FilterSettings | None = None,
        scatter: float = 0.0,
    ) -> None:
        self.settings = settings or FilterSettings()
        self.frames = 0
        self._known = known
        self._scores: dict[str, float] = {}
        self._scatter = scatter
        self._surface = surface_of(known.kind if known else "sphere", known)
        if known is None and scatter == 0.0 and len(first.points) >= _LEAST_POINTS:
            # Before the kind is chosen: with much scatter a wall would take in anything.
            self._learn_scatter(min(_fresh_fit(kind, first)[1].unexplained for kind in KINDS), share=1.0)
        first = replace(first, scatter=self._scatter)
        predicted = self._surface.guess(first)
        fit = self._surface.fit(first, predicted, iterations=8)
        self._bank = MotionBank(models, first.time, fit.position, fit.variance)
        self._agility = Agility(first.time, self.settings.agility)
        self.frames = 1
        if known is None:
            self._scores["sphere"] = fit.score
            self._consider_kinds(first, fit)

    @property
    def time(self) -> float:
        """Of the last frame (s)."""
        return self._bank.time

    @property
    def kind(self) -> str:
        """sphere, pole or wall."""
        return self._surface.kind

    @property
    def shape(self) -> Shape:
        """As it is believed to be."""
        return self._surface.shape

    @property
    def state(self) -> tuple[Array, Array, Array]:
        """Position of the centre, velocity and acceleration (3,) at :attr:`time`."""
        position, velocity, acceleration = self._bank.state
        return position + self._surface.offset, velocity, acceleration

    @property
    def scatter(self) -> float:
        """Variance of points beyond what their sensors should have (m2)."""
        return self._scatter

    @property
    def weights(self) -> dict[str, float]:
        """How likely each motion model is."""
        return dict(zip(self._bank.models.names, self._bank.weight.tolist(), strict=True))

    @property
    def is_static(self) -> bool:
        """Whether it surely stands."""
        _, velocity, _ = self._bank.state
        return bool(self._bank.weight[0] > 0.5 and np.linalg.norm(velocity) < self.settings.static_speed)

    def advance(self, time: float) -> None:
        """Carry the motion on to ``time``, if it is not there yet."""
        self._bank.advance(time)
        self._agility.advance(time)

    @property
    def position_sigma(self) -> float:
        """Standard deviation of the position on the axis that is known worst, at :attr:`time` (m)."""
        return float(np.sqrt(self._bank.position_variance.max()))

    def update(self, seen: SurfacePoints) -> None:
        """One frame of points on this obstacle; one that comes late is carried to the present by the motion."""
        bank = self._bank
        seen = replace(seen, scatter=self._scatter)
        if seen.time > bank.time:
            bank.advance(seen.time)
        elif seen.time < bank.time:
            late = bank.time - seen.time
            _, velocity, _ = bank.state
            seen = seen.moved(velocity * late, bank.time, (0.5 * late) ** 2)
        fit = self._surface.fit(seen, bank.state[0])
        self._agility.advance(bank.time)
        self._agility.innovation(bank.measured(fit.position, fit.variance))
        self._judge()
        self.frames += 1
        if self._known is None and len(seen.points) >= _LEAST_POINTS:
            self._note(self.kind, fit.score)
            if self.frames <= _EVERY_FRAME_UNTIL or self.frames % _THEN_EVERY == 0 or fit.score > _DOUBTFUL:
                self._consider_kinds(seen, fit)
            elif self._scatter > 0.0:
                self._learn_scatter(fit.unexplained)

    def _judge(self) -> None:
        """Compare what was foreseen a second ago with what came, and foresee anew."""
        position, velocity, _ = self._bank.state
        self._agility.judge(position, velocity)
        if self._agility.is_judged:
            mean, _ = self._bank.predict(np.array([self._bank.time + AHEAD]))
            self._agility.foresee(mean[0])

    def predict(self, times: Array) -> tuple[Array, Array]:
        """Where the centre will be at ``times`` (K,): (K, 3), and by how much to take the body larger (K,)."""
        mean, covariance = self._bank.predict(times)
        # Gershgorin's bound on the largest eigenvalue; exact where one axis, or one diagonal, dominates.
        variance = np.abs(covariance).sum(axis=-1).max(axis=-1) + self._surface.size_sigma**2 + self._scatter
        variance += self._agility.variance(np.maximum(np.asarray(times) - self._bank.time, 0.0))
        # Where points scatter it is found out late how it moves.
        limit = self._agility.growth_limit(np.sqrt(self._scatter))
        return mean + self._surface.offset, np.minimum(np.sqrt(variance), limit)

    def _note(self, kind: str, score: float) -> None:
        old = self._scores.get(kind)
        self._scores[kind] = score if old is None else old + _SMOOTHING * (score - old)

    def _consider_kinds(self, seen: SurfacePoints, own: Fit) -> None:
        """Try the other shapes on this frame alone, and change to one that is clearly better."""
        if len(seen.points) < _LEAST_POINTS:
            return
        unexplained = own.unexplained
        tried: dict[str, tuple[Surface, Array]] = {}
        for kind in KINDS:
            if kind == self.kind:
                continue
            surface, fit = _fresh_fit(kind, seen)
            self._note(kind, fit.score)
            unexplained = min(unexplained, fit.unexplained)
            tried[kind] = surface, fit.position
        self._learn_scatter(unexplained)
        cost = {kind: self._scores[kind] + _COMPLEXITY[kind] for kind in KINDS}
        best = min(KINDS, key=lambda kind: cost[kind])
        hysteresis = _HYSTERESIS if self.frames > 1 else 0.0
        if _COMPLEXITY[best] < _COMPLEXITY[self.kind]:
            # Scatter makes all shapes fit alike, and then the simplest will do.
            hysteresis *= seen.noise**2 / (seen.noise**2 + self._scatter)
        if best != self.kind and cost[best] < cost[self.kind] - hysteresis:
            old = self._bank.state[0]
            self._surface, place = tried[best]
            self._bank.shift(place - old)

    def _learn_scatter(self, unexplained: float, share: float = _SMOOTHING) -> None:
        """Points that lie on no shape are of sensors that are worse than they should be."""
        self._scatter = min(max(self._scatter + share * unexplained, 0.0), _SCATTER_MAX)


def surface_of(kind: str, known: Shape | None) -> Surface:
    """Return a surface to be fitted to points; ``known``: the shape is given and only its place is to be found."""
    if known is None:
        return FlatSurface() if kind == FlatSurface.kind else RoundSurface(kind)
    if isinstance(known, Wall):
        return FlatSurface(known)
    return RoundSurface(kind, known) if known.round_axes else KnownSurface(known)


def _fresh_fit(kind: str, seen: SurfacePoints) -> tuple[Surface, Fit]:
    """Of one frame alone."""
    surface = surface_of(kind, None)
    return surface, surface.fit(seen, surface.guess(seen), iterations=8)
