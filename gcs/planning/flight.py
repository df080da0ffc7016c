"""A flight on the planning level: perception, guidance and safety filter on ideal tracking.

The payload and its UAVs are, at every control step, where the trajectory in force has them; the vehicles' sensors are
the simulator's. There is no physics, no MAVLink, no estimator, and nothing on disk.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from gcs.flight import stack
from gcs.flight.mission_trajectory import MissionTrajectory
from gcs.mission.model import Limits, Mission, Obstacle
from gcs.mission.targets import targets_of
from gcs.planning.scanned_map import ScannedMap, TeamSensors
from gcs.planning.schedule import LONGEST, PAD_OFFSET
from gcs.record.clearance import ObstacleTrack
from gcs.record.landing import onsets
from gcs.record.reader import without_rows
from gcs.record.run_data import RunData
from gcs.record.run_folder import to_json
from gcs.record.summary import summarise
from gcs.record.tables import COLUMNS
from gcs.record.verdict import GroundReport, verdict
from idc_controller.arrays import Array
from idc_controller.control.controller import plan
from idc_controller.estimation.measurement_model import MeasurementModel
from idc_controller.estimation.measurements import Estimate, MeasurementNoise, VehicleStates
from idc_controller.estimation.settings import MeasurementModelSettings
from idc_controller.guidance.progress import Guidance
from idc_controller.model.linear import LinearModel
from idc_controller.safety.filter_protocol import SafetyFilter
from idc_controller.trajectory.flatness import Load, PayloadTrajectory, Reference
from idc_controller.trajectory.trajectory import Trajectory

BEFORE = 1.0
"""Time (s) for which the vehicles scan on the pad before their rotors start."""
ROWS = 2
"""Rows on record in a control step."""


class IdealTracking:
    """Guidance and safety filter, and a payload that is where their trajectory has it."""

    def __init__(self, model: LinearModel, safety: SafetyFilter, guidance: Guidance) -> None:
        self.model, self.safety, self.guidance = model, safety, guidance
        self.followed: PayloadTrajectory | None = None
        """None before the first plan."""
        self._load = Load(model.parameters.m_0, np.zeros(3))

    def states(self, times: Array, mission: Trajectory) -> Array:
        """Return the states (K, 12 + 11 N) at ``times`` (K,) (s), before the first plan those along ``mission``."""
        return Reference(self.model.parameters, self.followed or mission, self._load).at(times).x

    def step(self, time: float, mission: Trajectory) -> PayloadTrajectory:
        """Plan along ``mission`` at ``time`` (s), and return what is followed from then on."""
        state = self.states(np.array([time]), mission)[0]
        n, size = self.model.layout.number_of_uavs, self.model.layout.size
        none = np.zeros((3, 3))
        return self.plan(
            Estimate(time, state, none[0], np.zeros((n, 3)), 0.0, none, lambda: np.zeros((size, size))), mission
        )

    def plan(self, estimate: Estimate, mission: Trajectory) -> PayloadTrajectory:
        """Plan from an ``estimate``, which may be off the trajectory, and return what is followed from then on."""
        self.followed = plan(self.safety, self.guidance, estimate, mission)
        return self.followed


class PlanningFlight:
    """One mission, step by step. Times in s from the first scan on.

    Public state, to be read only: ``tracking``, ``reason`` for which it was broken off (empty: it was not) and its time
    ``broken_off``, ``climb``, the time at which the climb begins, ``slack``, the largest violation of the margin by a
    plan (m), and the rows on record: ``times``, ``motion_times`` (since the obstacles have begun to move), ``states``.
    """

    def __init__(self, mission: Mission, start: float, sensors: TeamSensors | None = None) -> None:
        """``start``: of the climb, in the obstacles' time (s). ``sensors``: None: those that are installed."""
        config = mission.system
        model = stack.linear_model(config)
        self.mission, self._scanned = mission, ScannedMap(mission, sensors)
        self.climb = BEFORE + config.flight.takeoff_landing.spool_up_time
        self._motion_start = self.climb - start
        pad = np.array([PAD_OFFSET, -PAD_OFFSET, -config.resting_altitude])
        self._trajectory = MissionTrajectory(mission, pad, self.climb)
        self.tracking = IdealTracking(
            model,
            stack.avoidance(config, model, self._scanned.map),
            stack.guidance(config, model, self._scanned.map, self._scanned.map, mission.area),
        )
        self._vehicles = MeasurementModel(model, MeasurementNoise(), MeasurementModelSettings()).vehicles
        self.reason, self.broken_off, self.slack = "", math.nan, 0.0
        self._rows: list[tuple[Array, Array]] = []
        """Times (ROWS,) and states (ROWS, 12 + 11 N) of each step."""

    @property
    def time(self) -> float:
        """Time of the next step (s)."""
        return len(self._rows) / self.mission.system.rates.control

    @property
    def ended(self) -> bool:
        """True if the payload is at the end of its descent."""
        return self.tracking.guidance.progress(self.time) >= self._trajectory.trajectory.end

    @property
    def times(self) -> Array:
        """Times (T,) (s)."""
        return np.concatenate([times for times, _ in self._rows])

    @property
    def states(self) -> Array:
        """States (T, 12 + 11 N), as the linear model orders them."""
        return np.concatenate([states for _, states in self._rows])

    @property
    def motion_times(self) -> Array:
        """Times (T,) (s) since the obstacles have begun to move; 0 before."""
        return np.maximum(self.times - self._motion_start, 0.0)

    def vehicles(self, time: float, state: Array) -> VehicleStates:
        """Return the vehicles in a ``state`` (12 + 11 N,)."""
        return self._vehicles(time, state)

    def fly(self) -> None:
        """Fly to the end of the descent."""
        while not self.ended:
            if self.time > LONGEST and not self.reason:
                self._break_off(f"the mission lasts longer than {LONGEST:g} s")
            self.step()

    def step(self) -> None:
        """Take one control step."""
        time, tracking, mission = self.time, self.tracking, self._trajectory
        state = tracking.states(np.array([time]), mission.trajectory)[0]
        self._scanned.step(len(self._rows), time - self._motion_start, self.vehicles(time, state))
        if time >= self.climb:
            if not self.reason and (reason := tracking.guidance.blocked(time)):
                self._break_off(reason)
            tracking.step(time, mission.trajectory)
            self.slack = max(self.slack, tracking.safety.report.slack)
        times: Array = time + np.arange(ROWS, dtype=float) / (ROWS * self.mission.system.rates.control)
        self._rows.append((times, tracking.states(times, mission.trajectory)))

    def _break_off(self, reason: str) -> None:
        """Come to rest and land, as the ground does."""
        self.reason, self.broken_off, guidance = reason, self.time, self.tracking.guidance
        followed, progress = guidance.stopping_trajectory(self.time, self._trajectory.trajectory)
        self._trajectory.brake_and_land(followed, progress)
        guidance.restart(self.time, progress)


LEVEL = np.array([1.0, 0.0, 0.0, 0.0])


def planned(flight: PlanningFlight) -> RunData:
    """Return the record of a flight that has ended, with its summary; a contact is a clearance of zero."""
    run = _record(flight)
    mission, reason = flight.mission, flight.reason
    limits = mission.limits or Limits()
    ground = GroundReport(True, not reason, True, False, reason, flight.broken_off)
    ended = verdict(run, ground, None if reason else targets_of(mission), limits.arrival)
    summary: dict[str, Any] = summarise(run, ended, duration_s=float(run.time[-1]), real_time_factor=None)
    summary["contacts"] = onsets((run.clearance <= 0.0).astype(float))
    summary["safety"] = {"slack_max_m": round(flight.slack, 6)}
    return run.with_summary(summary)


def _record(flight: PlanningFlight) -> RunData:
    """Return what would be on record of the truth."""
    mission, states = flight.mission, flight.states
    layout = flight.tracking.model.layout
    uavs = np.array([flight.vehicles(0.0, state).values for state in states])
    times, motion_times = flight.times, flight.motion_times
    thrust = flight.tracking.model.parameters.hover_thrust + states[:, layout.f]
    thrust[times < flight.climb - mission.system.flight.takeoff_landing.spool_up_time] = 0.0
    return RunData(
        folder=Path(),
        source="truth",
        time=times,
        payload_position=states[:, layout.r_0],
        payload_quaternion=np.tile(LEVEL, (len(states), 1)),
        payload_velocity=states[:, layout.v_0],
        uav_position=np.ascontiguousarray(uavs[:, :, 0:3]),
        uav_quaternion=np.ascontiguousarray(uavs[:, :, 6:10]),
        thrust=thrust,
        contacts=None,
        obstacles=tuple(
            ObstacleTrack(obstacle.name, obstacle.shape, _places(obstacle, motion_times))
            for obstacle in mission.obstacles
        ),
        tables={name: without_rows(columns) for name, columns in COLUMNS.items()},
        manifest={"mission": to_json(mission), "system": to_json(mission.system)},
        summary={},
    )


def _places(obstacle: Obstacle, times: Array) -> Array:
    """Return the positions (T, 3) at ``times`` (T,) (s) since it began to move."""
    if obstacle.motion is None:
        return np.tile(np.array(obstacle.position), (len(times), 1))
    moved: Array = np.array(obstacle.position) + np.array([*map(obstacle.motion.mover(), times.tolist())])
    return moved
