"""Speed by sight: how fast the formation may go, by what its range sensors have seen free ahead of it.

Unknown space is not entered: along the plan, the first place where the formation would reach into space that was not
seen free must be farther than it takes to stop. Moving obstacles may come out of what is hidden: as far as the way is
in sight there must be time to give way to one.
"""

import math
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np

from idc_controller.arrays import Array, Indices, Mask
from idc_controller.geometry.free_space import BoundingCylinder
from idc_controller.guidance.settings import SightSettings
from idc_controller.trajectory.flatness import PayloadTrajectory
from idc_controller.trajectory.trajectory import ScaledReference

SIGHT_REASONS = ("", "unseen", "blind", "hidden", "range")
"""Why sight limits the progress; the records number them."""
_HULL_SHARE = 0.8
"""Share of the margin beside the formation that its deviations and the size of a cell may take."""
_AT_REST = 1e-3
"""Speed below which there is no way ahead (m/s)."""


class Sight(Protocol):
    """What range sensors have seen."""

    @property
    def has_sight(self) -> bool:
        """Return whether there are range sensors: at least one scan has come."""
        ...

    @property
    def lowest_seen(self) -> float:
        """Return the height above the ground (m) below which nothing is seen, as a return could be of the ground."""
        ...

    def unseen(self, time: float, path: Array, body: Array) -> tuple[Indices, Array]:
        """Return the first cells of space on the way of a body at ``time`` (s) that were not seen free.

        Of each the index of the last place before it (n,), in order, and its middle (n, 3) (NED, m). Those that
        obstacles cover, or their surfaces, are none.

        Args:
            time: now (s).
            path: places of the body (P, 3), NED (m).
            body: upright cylinder: radius, extent up and down from its place, lowest height that is seen (4,) (m).
        """
        ...

    def first_hidden(self, path: Array, sensors: Array, heights: Array) -> int:
        """Return the index of the first place of ``path`` (P, 3) that what stands hides from all sensors, or P.

        From all places of ``sensors`` (N, 3); points at ``heights`` (H,) (m) above a place stand for it.
        """
        ...


class SensorView(NamedTuple):
    """What the range sensors of the vehicles can see."""

    offsets: Array
    """Their places from the payload's centre in hover (N, 3) (m)."""
    range: float
    """m"""
    elevation_min: float
    """Lower end of the field of view (rad, up)."""
    elevation_max: float
    """Upper end (rad)."""


def closing_speed(view: SensorView, formation: BoundingCylinder, reaction: float) -> float:
    """Return the speed (m/s), the formation's and a moving obstacle's together, that leaves time to give way to it.

    From the edge of the outermost range sensor's range to the ``formation``, with its links tilted, it takes the
    ``reaction`` (s): from sight of the obstacle to having given way.
    """
    beyond = formation.radius - float(np.hypot(view.offsets[:, 0], view.offsets[:, 1]).max())
    return (view.range - beyond) / reaction


class SightLimit(NamedTuple):
    """Largest progress rate by sight, and why."""

    rate: float = math.inf
    reason: str = ""
    """One of :data:`SIGHT_REASONS`.

    ``unseen``: space that was not seen free; ``blind``: such out of the field of view; ``hidden``: what may come out of
    hidden space; ``range``: what may come from beyond the range; empty: none."""
    distance: float = math.inf
    """Way to what limits it (m)."""
    fall: float = 0.0
    """Fall of the progress rate that is the deceleration of a stop (1/s)."""

    @property
    def code(self) -> int:
        """Index of the reason, 0 where the rate is none below 1."""
        return SIGHT_REASONS.index(self.reason) if self.rate < 1.0 else 0


class SpeedBySight:
    """Largest progress rate from step to step, and since when it has been none."""

    def __init__(
        self,
        sight: Sight,
        settings: SightSettings,
        formation: BoundingCylinder,
        view: SensorView,
        reaction: float,
    ) -> None:
        """``formation``: with its links tilted; ``reaction``: from sight of an obstacle to having given way (s)."""
        self._sight, self.settings, self._formation, self._view = sight, settings, formation, view
        self._elapsed = np.linspace(0.0, settings.horizon, settings.samples)
        margin = settings.margin
        self._body = np.array([formation.radius + margin, formation.above + margin, formation.below + margin, 0.0])
        self._heights = np.array([formation.above, 0.5 * (formation.above - formation.below), 0.0])
        self.slow = self.speed_within(0.5 * margin)
        """Speed from which it stops within half of its margin (m/s): beside unseen space it need not be slower."""
        self._reaction = reaction
        self.last = SightLimit()
        """Limit of the last step."""
        self.is_least = False
        """Whether nothing else limited the progress more in the last step."""
        self._since: float | None = None

    @cached_property
    def fastest(self) -> float:
        """Own speed that leaves time to give way to what comes from beyond the range (m/s)."""
        return closing_speed(self._view, self._formation, self._reaction) - self.settings.closing_speed

    def start(self) -> None:
        """Forget the steps before, at rest on the ground."""
        self.last, self.is_least, self._since = SightLimit(), False, None

    def compare(self, time: float, wanted: float, least: float) -> None:
        """Note the rate that is ``wanted`` without it at ``time`` (s); below ``least`` it counts as rest."""
        self.is_least = self.last.rate < wanted
        if not self.is_least or self.last.rate > least:
            self._since = None
        elif self._since is None:
            self._since = time

    def resting(self, time: float) -> float:
        """Return for how long (s) unseen space has kept the progress at rest."""
        return 0.0 if self._since is None else time - self._since

    def speed_within(self, distance: float) -> float:
        """Return the speed (m/s) from which the formation stops within a ``distance`` (m)."""
        return self._solved(1.0 / (2.0 * self.settings.limits.acceleration), distance)

    def limit(self, time: float, reference: ScaledReference, tracked: PayloadTrajectory) -> SightLimit:
        """Return the limit at ``time`` (s), for the ``tracked`` plan about a ``reference``."""
        if not self._sight.has_sight:
            return SightLimit()
        times = time + self._elapsed
        own, own_velocity = reference.derivatives(times, 1)
        path, velocity = tracked.derivatives(times, 1)
        rate = reference.rate
        if rate < self.settings.slowest:
            # Nearly at rest: the way ahead is that of a slow progress.
            rate = self.settings.slowest
            slow = ScaledReference(reference.trajectory, time, reference.progress_at(time), rate)
            ahead, ahead_velocity = slow.after(self._elapsed, 1)
            path, velocity = path + (ahead - own), velocity + (ahead_velocity - own_velocity)
            own_velocity = ahead_velocity
        speeds = _norms(velocity)
        if speeds.max() < _AT_REST:
            return SightLimit()
        # Giving way to an obstacle is not slower for a slower progress: that is held to the mission's own motion.
        range_limit = self._limit(rate, float(_norms(own_velocity).max()), self.fastest, "range", self._view.range)
        limits = [range_limit, self._of_hidden(rate, path, speeds)]
        self._body[3] = self._sight.lowest_seen
        before, middles = self._sight.unseen(time, path, self._body)
        if len(before):
            in_view = self._are_in_view(path[0], middles)
            at_hull = self._reach_hull(path, before, middles)
            limits.append(self._of_unseen(rate, path, speeds, before[in_view & at_hull], 0.0))
            limits.append(self._of_unseen(rate, path, speeds, before[in_view], self.slow))
            if not in_view.all():
                steep = float(np.abs(own_velocity[:, 2]).max())
                distance = _length(path[: before[~in_view][0] + 1])
                limits.append(self._limit(rate, steep, self.settings.blind_speed, "blind", distance))
        return min(limits, key=lambda limit: limit.rate)

    def _of_hidden(self, rate: float, path: Array, speeds: Array) -> SightLimit:
        """Return the limit by what may come out of hidden space on the way."""
        s = self.settings
        hidden = self._sight.first_hidden(path, path[0] + self._view.offsets, self._heights)
        if hidden == len(path):
            return SightLimit()
        distance = _length(path[: hidden + 1])
        # Until the speed has followed the progress, the way to what is hidden becomes shorter.
        since = self._reaction + s.latency + 0.5 * s.stopping_delay
        fastest = max((distance - s.closing_speed * self._reaction) / since, self.slow)
        return self._limit(rate, float(speeds[: hidden + 1].max()), fastest, "hidden", distance)

    def _of_unseen(self, rate: float, path: Array, speeds: Array, before: Indices, least: float) -> SightLimit:
        """Return the limit by unseen cells behind the places ``before`` (n,); ``least`` speed (m/s) that it leaves."""
        if not len(before):
            return SightLimit()
        last = int(before[0])
        fastest = float(speeds[: last + 2].max())
        share = self._solved(fastest / (2.0 * self.settings.limits.acceleration), float(self._elapsed[last]))
        return self._limit(rate, fastest, max(share * fastest, least), "unseen", _length(path[: last + 1]))

    def _limit(self, rate: float, speed: float, allowed: float, reason: str, distance: float) -> SightLimit:
        """Return the limit at which the ``speed`` (m/s) at a progress ``rate`` is the ``allowed`` one (m/s)."""
        if speed < _AT_REST:
            return SightLimit()
        return SightLimit(rate * allowed / speed, reason, distance, rate * self.settings.limits.acceleration / speed)

    def _solved(self, quadratic: float, available: float) -> float:
        """Return x of ``quadratic`` x^2 + (latency + half the delay of a stop) x = ``available``.

        With the time until unseen space at a speed: its share from which a stop takes no longer; with a distance: the
        speed.
        """
        linear = self.settings.latency + 0.5 * self.settings.stopping_delay
        return 2.0 * available / (linear + math.sqrt(linear * linear + 4.0 * quadratic * available))

    def _are_in_view(self, place: Array, middles: Array) -> Mask:
        """Return whether cells (n,) lie within the elevations that some vehicle's sensor sees from where it is now."""
        offset = middles[:, None] - (place + self._view.offsets)
        elevation = np.arctan2(-offset[:, :, 2], np.hypot(offset[:, :, 0], offset[:, :, 1]))
        within = (elevation >= self._view.elevation_min) & (elevation <= self._view.elevation_max)
        return np.asarray(within.any(axis=1))

    def _reach_hull(self, path: Array, before: Indices, middles: Array) -> Mask:
        """Return whether cells (n,) are where the formation itself will be, not only the margin about it."""
        f, spare = self._formation, _HULL_SHARE * self.settings.margin
        offset = middles - path[np.minimum(before + 1, len(path) - 1)]
        beside = np.hypot(offset[:, 0], offset[:, 1]) <= f.radius + spare
        return np.asarray(beside & (-offset[:, 2] <= f.above + spare) & (offset[:, 2] <= f.below + spare))


def _norms(vectors: Array) -> Array:
    """Return the lengths (n,) of vectors (n, 3)."""
    return np.asarray(np.sqrt(np.einsum("pk,pk->p", vectors, vectors)))


def _length(path: Array) -> float:
    """Return the length of a path through points (n, 3)."""
    return float(_norms(np.diff(path, axis=0)).sum())
