"""Mission progress: which trajectory is the reference, how far along it the payload is meant to be, and how fast.

The progress is the path parameter of the mission's trajectory (s): its own time, as long as nothing holds the payload
up. Where the payload falls behind, or the wind would take more thrust than there is, the progress rate drops below 1.
"""

import math

import numpy as np

from idc_controller.arrays import Array
from idc_controller.guidance.navigator import Navigator
from idc_controller.guidance.settings import NavigatorSettings, ProgressSettings
from idc_controller.guidance.sight import SightLimit, SpeedBySight
from idc_controller.model.drag import Air
from idc_controller.trajectory.flatness import PayloadTrajectory
from idc_controller.trajectory.trajectory import RestTrajectory, ScaledReference, Trajectory

_SLOWEST = 0.01
"""Progress rate below which the mission is stopped as at rest, which it is within a few centimetres.

A trajectory in a slower time has as many more control points: this bounds them to about 128 times those planned.
"""


class Guidance:
    """Follows the mission at its own speed: progress is time. Where a controller does not avoid obstacles."""

    rate = 1.0
    """Progress rate in force."""
    speed_limit = math.inf
    """Speed (m/s) that is commanded in place of the mission's where that is faster."""
    sight = SightLimit()
    """Limit of the progress rate by sight."""
    detours = 0
    """Detours taken so far."""
    air: Air | None = None
    """Motion and drag of the air, as estimated last; None: no wind."""

    def reference(self, time: float, mission: Trajectory) -> ScaledReference:
        """Return the reference from ``time`` (s) on; the same object as before as long as nothing changes."""
        return ScaledReference(mission)

    def observe(
        self,
        tracked: PayloadTrajectory,
        lag: float,
        deviation: Array | None,
        air: Air | None,
        missed: float = 0.0,
    ) -> None:
        """Take note of what the safety filter made of the last reference.

        Args:
            tracked: the trajectory that is tracked.
            lag: of that trajectory behind the reference, along its path (m).
            deviation: states of its deviation from the reference at the stages (K + 1, 5, 3), SI; None: none.
            air: estimated motion and drag of the air; None: not estimated.
            missed: clearance by which it misses the margin from what stands (m).
        """

    def progress(self, time: float) -> float:
        """Return the mission's progress (s) at ``time`` (s)."""
        return time

    def stopping_trajectory(
        self, time: float, mission: Trajectory, rest: Array | None = None
    ) -> tuple[Trajectory, float]:
        """Return the trajectory to stop from at ``time``, and the progress along it (s).

        ``rest``: place (3,) (m) where a deflected payload comes to rest clear of obstacles; None: where that is free.
        """
        return mission, time

    def start(self) -> None:
        """Begin anew with the next step, from rest on the ground: a mission whose progress is time."""

    def restart(self, time: float, progress: float) -> None:
        """Follow another mission, whose progress is ``progress`` (s) at ``time`` (s), from the next step on."""

    def blocked(self, time: float) -> str:
        """Return why the mission cannot go on; empty: it can."""
        return ""


class AdaptiveGuidance(Guidance):
    """Slows the progress while the payload is held up, and leads round what holds it up for long."""

    def __init__(
        self,
        navigator: Navigator,
        settings: ProgressSettings,
        stages: Array,
        weight: float,
        by_sight: SpeedBySight | None = None,
    ) -> None:
        """Args: the planner's ``stages`` (K + 1,) (s); ``weight`` of the payload (N); ``by_sight``: None: no limit."""
        self.navigator, self.settings, self._by_sight = navigator, settings, by_sight
        self._stages, self._weight = stages, weight
        self._current: ScaledReference | None = None
        self._observed: ScaledReference | None = None
        self._next_rate = self._wanted_rate = 1.0
        self._is_commanded = False
        """Whether the speed limit that is commanded lowered the rate that is wanted last."""
        self._tracked: PayloadTrajectory | None = None
        self._deflected = False
        """Whether what is tracked deviates from the reference: by an obstacle, or a progress rate that has changed."""
        self._restart: tuple[float, float] | None = None
        """Time at which another mission was given and its progress then (s); until the next step."""

    def set_settings(self, navigator: NavigatorSettings, by_sight: SpeedBySight | None) -> None:
        """Have other settings of detours and another limit by sight, from the next step on."""
        self.navigator.set_settings(navigator)
        self._by_sight = by_sight

    def reference(self, time: float, mission: Trajectory) -> ScaledReference:
        """See :meth:`Guidance.reference`."""
        current = self._current
        if self._restart is None and current is not None and time < current.start + self._interval:
            return current
        followed = self._followed_progress(time)
        progress = self.navigator.advance(followed)
        if progress != followed:
            # A detour ends at rest: the mission is resumed from there, not at its speed.
            self._next_rate = 0.0
        if self._tracked is not None:
            progress = self.navigator.watch(time, progress, self._held_up_rate(), mission, self._tracked)
        self._restart = None
        self._current = ScaledReference(self.navigator.followed(mission), time, progress, self._next_rate)
        self.rate, self.detours = self._next_rate, self.navigator.detours
        return self._current

    def observe(
        self,
        tracked: PayloadTrajectory,
        lag: float,
        deviation: Array | None,
        air: Air | None,
        missed: float = 0.0,
    ) -> None:
        """See :meth:`Guidance.observe`."""
        self._tracked, self.air = tracked, air
        if self._current is None or self._observed is self._current:
            return
        self._observed, self._deflected = self._current, deviation is not None
        rate_in_wind = None if air is None else self._rate_in_wind(self._current, deviation, air)
        current = self._current
        if self._by_sight is not None:
            self.sight = self._by_sight.last = self._by_sight.limit(current.start, current, tracked)
        # What misses half of the margin slows the progress down, and all of it is rest: a slower plan keeps it. Before
        # what comes nearer, resting would not help.
        lag = max(lag, missed / self.navigator.settings.margin * self.settings.lag_at_rest)
        self._next_rate = self._changed_rate(current, lag, rate_in_wind)

    def progress(self, time: float) -> float:
        """See :meth:`Guidance.progress`; on a detour, where that leads back to the mission."""
        return self.navigator.mission_progress(self._followed_progress(time))

    def stopping_trajectory(
        self, time: float, mission: Trajectory, rest: Array | None = None
    ) -> tuple[Trajectory, float]:
        """See :meth:`Guidance.stopping_trajectory`.

        While the tracked trajectory is deflected, or the payload does not move, the mission is no place to stop at:
        then it is a rest near where the payload is. While the progress is slow it is what is followed, as slow; below
        a rate of 0.01 it is a rest, too.
        """
        current = self._current
        if current is None or self._tracked is None or (not self._deflected and current.rate == 1.0):
            return self.navigator.followed(mission), self._followed_progress(time)
        if not self._deflected and current.rate >= _SLOWEST:
            followed = self.navigator.followed(mission)
            return followed.scaled(self._followed_progress(time), current.rate, time), time
        if rest is not None:
            return RestTrajectory(rest, time), time
        position, velocity = self._tracked.derivatives(np.array([time]), 1)[:, 0]
        stopping = self.navigator.settings.limits.stopping_time(math.hypot(*velocity.tolist()))
        return RestTrajectory(position + 0.5 * stopping * velocity, time), time

    def start(self) -> None:
        """See :meth:`Guidance.start`."""
        self.navigator.reset()
        if self._by_sight is not None:
            self._by_sight.start()
        self._current = self._observed = self._tracked = self._restart = None
        self._next_rate = self._wanted_rate = self.rate = 1.0
        self._deflected, self.sight = False, SightLimit()

    def restart(self, time: float, progress: float) -> None:
        """See :meth:`Guidance.restart`."""
        self.navigator.reset()
        if progress != self._followed_progress(time) or (self._current is not None and self._current.rate != 1.0):
            self._next_rate = 1.0
        self._restart = time, progress

    def blocked(self, time: float) -> str:
        """See :meth:`Guidance.blocked`."""
        by_sight = self._by_sight
        if by_sight is not None and by_sight.resting(time) >= self.navigator.settings.give_up:
            return f"the way was not seen free {by_sight.last.distance:.1f} m ahead"
        return self.navigator.hold_up.blocked(time)

    def _followed_progress(self, time: float) -> float:
        """Return the progress (s) along what is followed, mission or detour."""
        if self._restart is not None:
            begin, progress = self._restart
            return progress + self._next_rate * (time - begin)
        return time if self._current is None else self._current.progress_at(time)

    def _rate_in_wind(self, reference: ScaledReference, deviation: Array | None, air: Air) -> float:
        """Return the largest progress rate at which drag on the payload stays within its limit."""
        s = self.settings
        velocity = reference.after(self._stages)[1] / max(reference.rate, s.slowest_in_wind)
        deflection = 0.0 if deviation is None else deviation[:, 1]
        rates = np.linspace(1.0, s.slowest_in_wind, 8)
        drag = np.linalg.norm(air.on_payload(rates[:, None, None] * velocity + deflection), axis=2).max(axis=1)
        within = np.flatnonzero(drag <= s.drag_limit * self._weight)
        return float(rates[within[0]] if len(within) else s.slowest_in_wind)

    def _changed_rate(self, current: ScaledReference, lag: float, rate_in_wind: float | None) -> float:
        """Return the rate of the reference after ``current``, for ``lag`` (m) and the largest ``rate_in_wind``."""
        s, rate = self.settings, current.rate
        wanted, step = min(max((s.lag_at_rest - lag) / s.slowing_lag, 0.0), 1.0), s.rate_step
        if rate_in_wind is not None and rate_in_wind <= wanted:
            wanted, step = rate_in_wind, s.rate_step_in_wind
        commanded = self._commanded_rate(current)
        self._is_commanded = commanded < wanted
        self._wanted_rate, fall = (wanted := min(wanted, commanded)), step
        if self._by_sight is not None:
            self._by_sight.compare(current.start, wanted, s.rate_step)
            if self._by_sight.is_least:
                wanted, fall = self.sight.rate, max(step, self.sight.fall * self._interval)
                step = s.rate_step_in_wind
        changed = rate + min(max(wanted - rate, -fall), step)
        return 1.0 if changed > 0.999 else changed

    def _commanded_rate(self, current: ScaledReference) -> float:
        """Return the largest rate at which the way ahead of ``current`` is flown within the speed limit."""
        if self.speed_limit == math.inf:
            return 1.0
        velocity = current.trajectory.derivatives(current.progress + self._stages, 1)[1]
        planned = float(np.linalg.norm(velocity, axis=1).max())
        return min(self.speed_limit / planned, 1.0) if planned > 0.0 else 1.0

    def _held_up_rate(self) -> float:
        """Return the rate by which the mission counts as held up.

        Not while it rises, nor while it is slow for what is unseen, or because that is commanded.
        """
        rate = max(self._next_rate, self._wanted_rate)
        if self._is_commanded or (self._by_sight is not None and self._by_sight.is_least):
            return max(rate, self.navigator.settings.held_up_rate)
        return rate

    @property
    def _interval(self) -> float:
        """Time for which a reference stays (s)."""
        return self.settings.stage_share * float(self._stages[1])
