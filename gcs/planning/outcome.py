"""How a flight on the planning level ended: its record and its summary, as those of a flight."""

from pathlib import Path
from typing import Any

import numpy as np

from gcs.mission.model import Limits, Obstacle
from gcs.mission.targets import targets_of
from gcs.planning.flight import PlanningFlight
from gcs.record.clearance import ObstacleTrack
from gcs.record.landing import onsets
from gcs.record.reader import without_rows
from gcs.record.run_data import RunData
from gcs.record.run_folder import to_json
from gcs.record.summary import summarise
from gcs.record.tables import COLUMNS
from gcs.record.verdict import GroundReport, verdict
from idc_controller.arrays import Array

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
