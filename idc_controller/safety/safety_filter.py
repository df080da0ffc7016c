"""The safety filter: from the mission's trajectory to one that keeps the hull clear, step by step."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from idc_controller.estimation.estimate import Estimate
from idc_controller.geometry.formation import Formation
from idc_controller.geometry.free_space import Formation as StackedFormation
from idc_controller.geometry.shapes import ObstacleSource, PredictedObstacle
from idc_controller.guidance.navigator import Navigator, NavigatorSettings
from idc_controller.model.drag import Air
from idc_controller.parameters import SystemParameters
from idc_controller.safety.filter_protocol import SafetyReport
from idc_controller.safety.planner import Plan, Planner
from idc_controller.safety.separation import Separation, separations
from idc_controller.safety.settings import PlannerSettings
from idc_controller.trajectory.flatness import PayloadTrajectory
from idc_controller.trajectory.integrator_chain import Chain
from idc_controller.trajectory.trajectory import RestTrajectory, Trajectory

Array = NDArray[np.float64]

MEMORY = 2.5
"""How long plans of the past are kept (s): late measurements ask for them."""
WATCH = 2.5
"""Obstacles that come closer to the hull than this take part (m)."""
DETOUR_TILT = float(np.radians(5.0))
"""Link tilt for which a detour leaves room."""
BRAKING_TIME = 2.0
"""In which the payload is brought to rest when a bent trajectory is broken off (s)."""
RECOVERY = 1.5
"""Time constant with which the tracker brings the payload back onto the plan (s)."""
EXCESS_MAX = 1.0
"""More than this off the plan is not reckoned with (m)."""
BEARABLE_DRAG = 0.45
"""Drag on the payload, over its weight, above which the mission is flown more slowly."""
SLOWEST_IN_WIND = 0.6
"""Rate of the mission's clock that it is not slowed beyond for this: slower, it counts as held up."""
SAME_STAGE = 0.7
"""Of a stage: until then the plan stays. Planned more often, its stages would fall between those of the plan before,
where that one asks for nothing, and the two would disagree by turns."""
NEGLIGIBLE = 1e-5
"""A deviation below this, in all derivatives, is none."""


@dataclass(frozen=True, eq=False)
class _Piece:
    """What was planned at ``start``: mission time and rate, and the deviation from the mission (None: none)."""

    start: float
    mission: PayloadTrajectory
    mission_time: float
    rate: float
    deviation: Array | None


class SafeTrajectory:
    """The trajectory to track: pieces of plans, each in force until the next."""

    def __init__(self, pieces: list[_Piece], chain: Chain) -> None:
        self._pieces = pieces
        self._chain = chain
        self._starts = np.array([piece.start for piece in pieces[1:]])

    def derivatives(self, times: Array, order: int = 4) -> Array:
        """Position to the derivative ``order`` (order + 1, K, 3), NED, SI."""
        times = np.asarray(times, dtype=float)
        found, which = np.unique(np.searchsorted(self._starts, times, side="right"), return_inverse=True)
        return _evaluate([self._pieces[i] for i in found], which, self._chain, times)[: order + 1]


def evaluate(piece: _Piece, chain: Chain, times: Array) -> Array:
    """Position to snap (5, K, 3) of one piece."""
    return _evaluate([piece], np.zeros(len(times), dtype=int), chain, times)


def _evaluate(pieces: list[_Piece], which: NDArray[np.int_], chain: Chain, times: Array) -> Array:
    """Position to snap (5, K, 3): each of ``times`` on the piece whose number is in ``which`` (K,)."""
    start, clock, rate = np.array([(p.start, p.mission_time, p.rate) for p in pieces])[which].T
    elapsed = times - start
    clock = clock + rate * elapsed
    result = np.empty((5, len(times), 3))
    # Each trajectory is asked once: it costs much the same for one time and for many.
    for mission in {id(p.mission): p.mission for p in pieces}.values():
        follows = np.array([p.mission is mission for p in pieces])[which]
        result[:, follows] = mission.derivatives(clock[follows], 4)
    if np.any(rate != 1.0):
        result *= (rate ** np.arange(5)[:, None])[..., None]
    deviations = [p.deviation for p in pieces if p.deviation is not None]
    if deviations:
        bent = np.array([p.deviation is not None for p in pieces])
        row = (chain.stages + 1) * (np.cumsum(bent) - 1)
        at = np.flatnonzero(bent[which])
        states = np.concatenate(deviations)
        result[:, at] += chain.evaluate(states, np.maximum(elapsed[at], 0.0), row[which[at]])
    return result


class AvoidanceFilter:
    """Keeps every obstacle out of the hull; see :class:`~idc_controller.safety.filter_protocol.SafetyFilter`."""

    def __init__(
        self,
        parameters: SystemParameters,
        settings: PlannerSettings,
        obstacles: ObstacleSource,
        navigation: NavigatorSettings,
    ) -> None:
        self.settings, self.obstacles = settings, obstacles
        self.navigator = Navigator(StackedFormation.of(parameters, DETOUR_TILT), navigation)
        self.formation = Formation(parameters)
        self.planner = Planner(self.formation, settings)
        self._pieces: deque[_Piece] = deque()
        self._plan: Plan | None = None
        self._plan_time = 0.0
        self._rate = 1.0
        self._turn = 0
        self._weight = parameters.m_0 * parameters.g
        self._taken_up: tuple[float, float] | None = None
        """When a new mission was given, and its clock then; until the next step."""
        self.report = SafetyReport()

    def correct(self, time: float, u: Array, estimate: Estimate) -> Array:
        """``u`` itself: this filter acts on the trajectory."""
        return u

    def mission_time(self, time: float) -> float:
        """The mission's clock at ``time`` (s)."""
        return self.navigator.mission_time(self._clock(time))

    def followed(self, time: float, mission: Trajectory) -> tuple[Trajectory, float]:
        """What is followed at ``time``, the mission or a detour, and its clock (s).

        While the filter bends it, or holds it up, that is no place to stop at: then it is a rest near where the payload
        is.
        """
        piece = self._pieces[-1] if self._pieces else None
        if piece is None or (piece.deviation is None and piece.rate == 1.0):
            return self.navigator.followed(mission), self._clock(time)
        position, velocity = evaluate(piece, self.settings.chain, np.array([time]))[:2, 0]
        return RestTrajectory(position + 0.5 * BRAKING_TIME * velocity, time), time

    def blocked(self, time: float) -> str:
        """Why the mission cannot go on; empty: it can."""
        return self.navigator.blocked(time)

    def replaced(self, time: float, clock: float) -> None:
        """The mission is replaced by another one, whose clock is at ``clock`` at ``time`` (s)."""
        self.navigator.forget()
        if clock != self._clock(time):
            self._rate = 1.0
        self._taken_up = time, clock

    def filter(self, time: float, mission: Trajectory, estimate: Estimate, air: Air | None = None) -> SafeTrajectory:
        """The trajectory to track from ``time`` on, and what was tracked before."""
        chain = self.settings.chain
        if self._taken_up is None and self._pieces and time < self._pieces[-1].start + SAME_STAGE * chain.period:
            return SafeTrajectory(list(self._pieces), chain)
        stages = chain.period * np.arange(chain.stages + 1, dtype=np.float64)
        obstacles = list(self.obstacles.predict(time + stages))
        clock = self.navigator.advance(self._clock(time))
        now = None
        if self._pieces:
            now = evaluate(self._pieces[-1], chain, np.array([time]))[:, 0]
            clock = self.navigator.watch(time, clock, self._rate, mission, now[0], obstacles)
        followed = self.navigator.followed(mission)
        ahead = followed.derivatives(clock + self._rate * stages, 4)
        if self._rate != 1.0:
            ahead = ahead * (self._rate ** np.arange(5))[:, None, None]
        start = np.zeros((5, 3)) if now is None else now - ahead[:, 0]
        if np.abs(start).max() < NEGLIGIBLE:
            start[:] = 0.0
        if now is not None:
            obstacles = self._grown(obstacles, float(np.linalg.norm(estimate.x[0:3] - now[0])), stages)
        lag = _lag(start, ahead)
        plan, nearest, infeasible, programmes = self._decide(time, start, ahead, obstacles)
        still = plan is None or bool(np.abs(plan.deviation).max() < NEGLIGIBLE)
        deviation = None if still or plan is None else plan.deviation
        self._pieces.append(_Piece(time, followed, clock, self._rate, deviation))
        self._taken_up = None
        self._plan, self._plan_time = (None if deviation is None else plan), time
        while len(self._pieces) > 2 and self._pieces[1].start < time - MEMORY:
            self._pieces.popleft()
        slack = plan.slack if plan is not None else 0.0
        self.report = SafetyReport(
            active=deviation is not None,
            slack=slack,
            infeasible=infeasible,
            programmes=programmes,
            nearest=nearest,
            lag=lag,
            clock_rate=self._rate,
            detours=self.navigator.detours,
            payload_bound=self.settings.tracking,
            uav_bound=self.settings.tracking + self.settings.uav_tracking,
        )
        bearable = None
        if air is not None:
            bent = 0.0 if deviation is None else deviation[:, 1]
            bearable = self._bearable_rate(air, ahead[1] / max(self._rate, SLOWEST_IN_WIND), bent)
        self._rate = _clock_rate(self._rate, lag, bearable)
        return SafeTrajectory(list(self._pieces), chain)

    def _clock(self, time: float) -> float:
        """The followed trajectory's clock at ``time`` (s)."""
        if self._taken_up is not None:
            begin, clock = self._taken_up
            return clock + self._rate * (time - begin)
        if not self._pieces:
            return time
        piece = self._pieces[-1]
        return piece.mission_time + piece.rate * (time - piece.start)

    def _bearable_rate(self, air: Air, mission: Array, bent: Array | float) -> float:
        """Largest rate of the clock at which drag stays bearable.

        Velocities over the stages (K + 1, 3) (m/s): of the ``mission`` at rate 1, and by which it is ``bent``.
        """
        rates = np.linspace(1.0, SLOWEST_IN_WIND, 8)
        drag = np.linalg.norm(air.on_payload(rates[:, None, None] * mission + bent), axis=2).max(axis=1)
        bearable = np.flatnonzero(drag <= BEARABLE_DRAG * self._weight)
        return float(rates[bearable[0]] if len(bearable) else SLOWEST_IN_WIND)

    def _grown(
        self, obstacles: list[PredictedObstacle], error: float, stages: NDArray[np.float64]
    ) -> list[PredictedObstacle]:
        """The obstacles, larger by what the payload is off the plan (m) beyond the bound, while it comes back."""
        excess = min(error - self.settings.tracking, EXCESS_MAX)
        if excess <= 0.0:
            return obstacles
        growth = excess * np.exp(-stages / RECOVERY)
        return [replace(obstacle, growth=obstacle.growth + growth) for obstacle in obstacles]

    def _decide(
        self, time: float, start: Array, ahead: Array, obstacles: list[PredictedObstacle]
    ) -> tuple[Plan | None, str, bool, int]:
        planner = self.planner
        free = planner.free(start) if start.any() else None
        if free is not None and not planner.is_within_limits(free, ahead):
            # Far from the mission the way back must be no wilder than the way off it.
            free = planner.solve(start, ahead, [], ahead[2]) or free
        position, acceleration = _absolute(ahead, free)
        near = self._near(position, acceleration, obstacles)
        if not near:
            return free, "", False, 0
        nearest = min(near, key=lambda s: s.room)
        if planner.barrier.is_kept(near, position, acceleration):
            return free, nearest.obstacle.name, False, 0
        # The plan in force, shifted to now; then one other way round.
        programmes = 0
        best: Plan | None = None
        if self._plan is not None:
            elapsed = (
                time
                - self._plan_time
                + self.settings.chain.period * np.arange(self.settings.chain.stages + 1, dtype=np.float64)
            )
            before = self.settings.chain.evaluate(self._plan.deviation, elapsed)
            best, count = self._refine(start, ahead, ahead[0] + before[0], ahead[2] + before[2], obstacles, 2)
            programmes += count
        ways = self._ways(near, position, acceleration, ahead)
        tries = range(len(ways)) if best is None else (self._turn % len(ways),)
        self._turn += 1
        for i in tries:
            first = planner.solve(start, ahead, ways[i], acceleration)
            programmes += 1
            if first is None:
                continue
            other, count = self._refine(start, ahead, *_absolute(ahead, first), obstacles, 1)
            programmes += count
            if other is not None and (best is None or other.cost < 0.9 * best.cost - 1e-6):
                best = other
        if best is None:
            kept = self._kept(time)
            return kept if kept is not None else free, nearest.obstacle.name, True, programmes
        return best, nearest.obstacle.name, False, programmes

    def _refine(
        self, start: Array, ahead: Array, position: Array, acceleration: Array,
        obstacles: list[PredictedObstacle], passes: int,
    ) -> tuple[Plan | None, int]:  # fmt: skip
        plan = None
        for count in range(1, passes + 1):
            near = self._near(position, acceleration, obstacles)
            plan = self.planner.solve(start, ahead, near, acceleration)
            if plan is None:
                return None, count
            position, acceleration = _absolute(ahead, plan)
        return plan, passes

    def _near(self, position: Array, acceleration: Array, obstacles: list[PredictedObstacle]) -> list[Separation]:
        return separations(self.formation, position, acceleration, obstacles, WATCH)

    def _ways(
        self, near: list[Separation], position: Array, acceleration: Array, ahead: Array
    ) -> list[list[Separation]]:
        """Sets of planes that lead above, left, right of the first obstacle in the way, or to a stop before it."""
        rooms = [self.planner.barrier.values(s, position, acceleration).min(axis=0) for s in near]
        first = min(range(len(near)), key=lambda i: int(np.argmax(rooms[i] < 0.0)) if (rooms[i] < 0.0).any() else 999)
        conflict = np.flatnonzero(rooms[first] < 0.0)
        if len(conflict) == 0:
            conflict = np.array([int(np.argmin(rooms[first]))])
        at = conflict[len(conflict) // 2]
        relative = ahead[1, at] - _rate_of(near[first].obstacle, at, self.settings.chain.period)
        course = relative[:2] if np.linalg.norm(relative[:2]) > 0.05 else near[first].normals[at, :2]
        course = course / max(float(np.linalg.norm(course)), 1e-9)
        left = np.array([course[1], -course[0], 0.0])
        ways = []
        for direction in (np.array([0.0, 0.0, -1.0]), left, -left, None):
            normals = near[first].normals.copy()
            if direction is None:
                normals[conflict[0] :] = [course[0], course[1], 0.0]
            else:
                normals[conflict[0] : conflict[-1] + 1] = -direction
            replaced = Separation(near[first].obstacle, near[first].distance, normals)
            ways.append([replaced if i == first else s for i, s in enumerate(near)])
        return ways

    def _kept(self, time: float) -> Plan | None:
        if self._plan is None:
            return None
        chain = self.settings.chain
        elapsed = time - self._plan_time + chain.period * np.arange(chain.stages + 1, dtype=np.float64)
        states = chain.evaluate(self._plan.deviation, elapsed).transpose(1, 0, 2)
        return Plan(self._plan.knots, states, self._plan.cost, self._plan.slack)


def _absolute(ahead: Array, plan: Plan | None) -> tuple[Array, Array]:
    """Position and acceleration (K + 1, 3) of a plan about the mission."""
    if plan is None:
        return ahead[0], ahead[2]
    return ahead[0] + plan.deviation[:, 0], ahead[2] + plan.deviation[:, 2]


def _lag(start: Array, ahead: Array) -> float:
    """How far the trajectory in force is behind the mission along its way (m)."""
    velocity = ahead[1, 0]
    speed = float(np.linalg.norm(velocity))
    return max(0.0, float(-start[0] @ velocity) / speed) if speed > 0.05 else float(np.linalg.norm(start[0, :2]))


def _clock_rate(rate: float, lag: float, bearable: float | None) -> float:
    """The mission's clock slows from 1.2 m of lag and stands from 2.4 m, and goes no faster than is ``bearable``."""
    wanted, step = float(np.clip((2.4 - lag) / 1.2, 0.0, 1.0)), 0.05
    if bearable is not None and bearable <= wanted:
        wanted, step = bearable, 0.01  # seen long before: no haste, that would only be another disturbance
    changed = rate + float(np.clip(wanted - rate, -step, step))
    return 1.0 if changed > 0.999 else changed


def _rate_of(obstacle: PredictedObstacle, at: int, period: float) -> Array:
    after = min(at + 1, len(obstacle.positions) - 1)
    before = max(after - 1, 0)
    return (obstacle.positions[after] - obstacle.positions[before]) / period
