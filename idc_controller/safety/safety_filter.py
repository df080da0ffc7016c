"""The safety filter: from a reference trajectory to one that keeps the hull clear of obstacles, step by step."""

import math
from collections import deque
from dataclasses import replace

import numpy as np

from idc_controller.arrays import Array
from idc_controller.estimation.measurements import Estimate
from idc_controller.geometry.formation import Formation
from idc_controller.geometry.obstacles import ObstacleSource, PredictedObstacle
from idc_controller.parameters import SystemParameters
from idc_controller.safety.constraints.exponential_barrier import ExponentialBarrier
from idc_controller.safety.filter_protocol import SafetyReport
from idc_controller.safety.planner import STEADY, Plan, Planner
from idc_controller.safety.safe_trajectory import Piece, SafeTrajectory
from idc_controller.safety.separation import PredictedObstacles, Separation, separations
from idc_controller.safety.settings import FilterSettings, PlannerSettings
from idc_controller.trajectory.trajectory import ScaledReference
from idc_controller.trajectory.trajectory_kernels import chain as deviation_after

NEGLIGIBLE = 1e-5
"""A deviation below this, in all derivatives, is none."""
VERIFIED = 1e-3
"""m by which a plan may miss the margin, by exact distances, and count as verified: what solvers leave."""


class AvoidanceFilter:
    """Keeps every obstacle out of the hull; see :class:`~idc_controller.safety.filter_protocol.SafetyFilter`."""

    def __init__(
        self,
        parameters: SystemParameters,
        settings: PlannerSettings,
        obstacles: ObstacleSource,
        filter_settings: FilterSettings = FilterSettings(),
    ) -> None:
        self.settings, self.filter_settings, self.obstacles = settings, filter_settings, obstacles
        self.formation = Formation(parameters)
        self.planner = Planner(self.formation, settings)
        self._pieces: deque[Piece] = deque()
        self._trajectory: SafeTrajectory | None = None
        self._plan: Plan | None = None
        self._plan_time = 0.0
        self._turn = 0
        self.report = SafetyReport()

    def start(self) -> None:
        """See :class:`~idc_controller.safety.filter_protocol.SafetyFilter`."""
        self._pieces.clear()
        self._trajectory, self._plan = None, None

    def set_margin(self, margin: float) -> None:
        """Keep another clearance (m) from obstacles, from the next plan on."""
        self.settings = replace(self.settings, margin=margin)
        self.planner.settings = self.planner.barrier.settings = self.settings

    def correct(self, time: float, u: Array, estimate: Estimate) -> Array:
        """Return ``u`` itself: this filter acts on the trajectory."""
        return u

    def filter(self, time: float, reference: ScaledReference, estimate: Estimate) -> SafeTrajectory:
        """Return the trajectory to track from ``time`` (s) on; a plan stays for as long as its reference does."""
        chain = self.settings.chain
        if self._trajectory is not None and reference is self._pieces[-1].reference:
            return self._trajectory
        predicted = self.obstacles.predict(time + chain.times)
        now, crackle = self._in_force(time)
        ahead = reference.after(chain.times)
        start = np.zeros((5, 3)) if now is None else now - ahead[:, 0]
        if all(abs(value) < NEGLIGIBLE for value in start.ravel().tolist()):
            start[:] = 0.0
        planner = self.planner
        off = 0.0 if now is None else math.dist(estimate.x[0:3], now[0])
        obstacles = PredictedObstacles(predicted, self._extra_growth(off))
        plan, nearest, infeasible, qp_count = self._decide(time, start, crackle, ahead, obstacles)
        clearance = self._clearance(ahead, plan, obstacles)
        if not infeasible and (clearance < self.settings.margin - VERIFIED or (plan and plan.slack > NEGLIGIBLE)):
            plan, clearance, count = self._safer(
                plan or planner.free(start), clearance, start, crackle, ahead, obstacles
            )
            qp_count += count
        negligible = plan is None or bool(np.abs(plan.deviation).max() < NEGLIGIBLE)
        deviation = None if negligible or plan is None else plan.deviation
        self._pieces.append(Piece(reference, deviation))
        self._plan, self._plan_time = (None if deviation is None else plan), time
        while len(self._pieces) > 2 and self._pieces[1].reference.start < time - self.filter_settings.memory:
            self._pieces.popleft()
        self.report = SafetyReport(
            deviation=deviation,
            slack=plan.slack if plan is not None else 0.0,
            standing_slack=plan.standing_slack if plan is not None else 0.0,
            infeasible=infeasible,
            clearance=clearance,
            verified=clearance >= self.settings.margin - VERIFIED,
            qp_count=qp_count,
            nearest=nearest,
            lag=_lag(start, ahead),
            payload_bound=self.settings.tracking,
            uav_bound=self.settings.tracking + self.settings.uav_tracking,
        )
        self._trajectory = SafeTrajectory(self._pieces, chain)
        return self._trajectory

    def _in_force(self, time: float) -> tuple[Array | None, Array]:
        """Return position to snap (5, 3) at ``time`` (s) of the trajectory in force (None: none), and its crackle."""
        if self._trajectory is None:
            return None, STEADY
        interval = 0.5 * self.settings.chain.period
        before, now = self._trajectory.derivatives(np.array([time - interval, time])).transpose(1, 0, 2)
        return now, (now[4] - before[4]) / interval

    def _extra_growth(self, error: float) -> Array | float:
        """Growth of all obstacles (K + 1,) by what the payload is off the plan (m) beyond the bound, as it returns."""
        s = self.filter_settings
        excess = min(error - self.settings.tracking, s.excess_max)
        return excess * np.exp(-self.settings.chain.times / s.recovery) if excess > 0.0 else 0.0

    def _decide(
        self, time: float, start: Array, crackle: Array, ahead: Array, obstacles: PredictedObstacles
    ) -> tuple[Plan | None, str, bool, int]:
        """Plan (None: the reference itself), nearest obstacle, whether no QP had a solution, and QPs solved."""
        planner = self.planner
        free = planner.free(start) if start.any() else None
        if free is not None and not planner.is_within_limits(free, ahead, crackle):
            # Far from the reference the return must be no faster than the departure from it.
            free = planner.solve(start, ahead, [], ahead[2], crackle) or free
        position, acceleration = _absolute(ahead, free)
        near = self._near(position, acceleration, obstacles)
        if not near:
            return free, "", False, 0
        nearest = min(near, key=lambda s: s.clearance)
        if planner.barrier.is_kept(near, position, acceleration):
            return free, nearest.obstacle.name, False, 0
        # The plan in force, shifted to now; then one alternative.
        qp_count = 0
        best: Plan | None = None
        if self._plan is not None:
            before = self._shifted(self._plan, time)
            best, count = self._refine(start, crackle, ahead, ahead[0] + before[0], ahead[2] + before[2], obstacles, 2)
            qp_count += count
        sets = alternatives(planner.barrier, near, position, acceleration, ahead[1])
        tries = range(len(sets)) if best is None else (self._turn % len(sets),)
        self._turn += 1
        for i in tries:
            first = planner.solve(start, ahead, sets[i], acceleration, crackle)
            qp_count += 1
            if first is None:
                continue
            other, count = self._refine(start, crackle, ahead, *_absolute(ahead, first), obstacles, 1)
            qp_count += count
            share = self.filter_settings.switching_share
            if other is not None and (best is None or other.cost < share * best.cost - 1e-6):
                best = other
        if best is None:
            return self._without_solution(time, start, ahead, obstacles), nearest.obstacle.name, True, qp_count
        return best, nearest.obstacle.name, False, qp_count

    def _without_solution(self, time: float, start: Array, ahead: Array, obstacles: PredictedObstacles) -> Plan:
        """Return what is flown where no QP has a solution: of stops here and aside, and the plan in force, the safest.

        That keeps farthest from all obstacles, up to the margin. Never the bare reference, which nothing has checked.
        """
        rest, begin = self._rest(start, ahead)
        plans = [kept] if (kept := self._kept(time, ahead)) is not None else []
        ways = np.vstack([np.eye(3), -np.eye(3)])
        for aside in np.vstack([np.zeros(3), *(distance * ways for distance in self.filter_settings.stops_aside)]):
            from_rest = begin.copy()
            from_rest[0] -= aside
            stop, moved = self.planner.free(from_rest), rest - ahead
            moved[0] += aside
            plans.append(replace(stop, deviation=stop.deviation + moved.transpose(1, 0, 2)))
        return max(plans, key=lambda plan: self._clearance(ahead, plan, obstacles))

    def _rest(self, start: Array, ahead: Array) -> tuple[Array, Array]:
        """Return the rest where motion ends for the least cost (5, K + 1, 3), and the state now about it (5, 3)."""
        now = start + ahead[:, 0]
        rest = np.zeros_like(ahead)
        rest[0] = self.planner.nearest_rest(now)
        return rest, now - rest[:, 0]

    def _safer(
        self, plan: Plan, clearance: float, start: Array, crackle: Array, ahead: Array, obstacles: PredictedObstacles
    ) -> tuple[Plan, float, int]:
        """Return ``plan`` or a stop that is safer; its clearance (m); QPs solved.

        That is one that keeps more than the ``clearance`` of the plan or, where both keep the margin, less slack: a
        plan with slack does not keep the barrier, and keeps the margin up to its horizon only.
        """
        planner = self.planner
        rest, begin = self._rest(start, ahead)
        stop, count = self._refine(begin, crackle, rest, *_absolute(rest, planner.free(begin)), obstacles, 2)
        kept = -math.inf if stop is None else self._clearance(rest, stop, obstacles)
        margin_kept = min(kept, clearance) >= self.settings.margin - VERIFIED
        if stop is None or not (stop.slack < plan.slack if margin_kept else kept > clearance):
            return plan, clearance, count
        # The slack stays that of the plan: by it the progress rests.
        deviation = stop.deviation + (rest - ahead).transpose(1, 0, 2)
        return replace(plan, deviation=deviation), kept, count

    def _clearance(self, ahead: Array, plan: Plan | None, obstacles: PredictedObstacles) -> float:
        """Return the least clearance (m) of a plan, None: the reference itself, up to the margin, exactly."""
        near = self._near(*_absolute(ahead, plan), obstacles)
        return min([self.settings.margin, *(separation.clearance for separation in near)])

    def _refine(
        self, start: Array, crackle: Array, ahead: Array, position: Array, acceleration: Array,
        obstacles: PredictedObstacles, passes: int,
    ) -> tuple[Plan | None, int]:  # fmt: skip
        """Solve again with the planes of the plan before, ``passes`` times; also returns the QPs solved."""
        plan = None
        for count in range(1, passes + 1):
            near = [separation.one_sided() for separation in self._near(position, acceleration, obstacles)]
            plan = self.planner.solve(start, ahead, near, acceleration, crackle)
            if plan is None:
                return None, count
            position, acceleration = _absolute(ahead, plan)
        return plan, passes

    def _near(self, position: Array, acceleration: Array, obstacles: PredictedObstacles) -> list[Separation]:
        return separations(self.formation, position, acceleration, obstacles, self.filter_settings.watch)

    def _kept(self, time: float, ahead: Array) -> Plan | None:
        """Return the trajectory in force, as a plan about the reference ``ahead``, that may be another; None: none."""
        if self._trajectory is None:
            return None
        chain = self.settings.chain
        states = np.ascontiguousarray((self._trajectory.derivatives(time + chain.times) - ahead).transpose(1, 0, 2))
        return replace(self.planner.free(states[0]), deviation=states)

    def _shifted(self, plan: Plan, time: float) -> Array:
        """States (5, K + 1, 3) of the deviation of the plan in force at the stages from ``time`` (s) on."""
        chain = self.settings.chain
        return deviation_after(plan.deviation, chain.period, time - self._plan_time + chain.times)


def _absolute(ahead: Array, plan: Plan | None) -> tuple[Array, Array]:
    """Position and acceleration (K + 1, 3) of a plan about the reference."""
    if plan is None:
        return ahead[0], ahead[2]
    return ahead[0] + plan.deviation[:, 0], ahead[2] + plan.deviation[:, 2]


def _lag(start: Array, ahead: Array) -> float:
    """Return the lag (m) of the trajectory in force behind the reference along its path."""
    velocity, position = ahead[1, 0], start[0]
    speed = math.hypot(*velocity)
    return max(0.0, float(-position @ velocity) / speed) if speed > 0.05 else math.hypot(*position[:2])


def alternatives(
    barrier: ExponentialBarrier, near: list[Separation], position: Array, acceleration: Array, velocity: Array
) -> list[list[Separation]]:
    """Return the separations with the first conflict passed above, left or right, or stopped before.

    Args:
        barrier: which says where the margin is not kept.
        near: the separations of a trajectory with ``position`` and ``acceleration`` (K + 1, 3), NED, SI.
        velocity: of the reference (K + 1, 3) (m/s).
    """
    values = barrier.values(near, position, acceleration).min(axis=1)
    missed = values < 0.0
    first = int(np.argmin(np.where(missed.any(axis=1), missed.argmax(axis=1), values.shape[1])))
    conflict = np.flatnonzero(missed[first])
    if len(conflict) == 0:
        conflict = np.array([int(np.argmin(values[first]))])
    at = conflict[len(conflict) // 2]
    relative = velocity[at] - _velocity_of(near[first].obstacle, at, barrier.settings.chain.period)
    heading = relative[:2] if np.linalg.norm(relative[:2]) > 0.05 else near[first].normals[at, :2]
    heading = heading / max(float(np.linalg.norm(heading)), 1e-9)
    left = np.array([heading[1], -heading[0], 0.0])
    sets = []
    for direction in (np.array([0.0, 0.0, -1.0]), left, -left, None):
        normals = near[first].normals.copy()
        if direction is None:
            normals[conflict[0] :] = [heading[0], heading[1], 0.0]
        else:
            normals[conflict[0] : conflict[-1] + 1] = -direction
        turned = Separation(near[first].obstacle, near[first].distance, normals)
        sets.append([turned if i == first else s for i, s in enumerate(near)])
    return sets


def _velocity_of(obstacle: PredictedObstacle, at: int, period: float) -> Array:
    after = min(at + 1, len(obstacle.positions) - 1)
    before = max(after - 1, 0)
    return np.asarray((obstacle.positions[after] - obstacle.positions[before]) / period)
