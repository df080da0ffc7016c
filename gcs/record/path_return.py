"""How soon the payload is back on the reference once an obstacle has cleared it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gcs.record.run_data import RunData, position_error

Array = NDArray[np.float64]

BACK = 0.1  # m from the reference
EVERY = 5  # rows of the reference: ten times a second


def return_times(run: RunData, clearance: float) -> list[tuple[float, float]]:
    """Return when the reference became free (s), and how long after that (s) the payload was within :data:`BACK` of it.

    The reference is free while the formation on it, level and with its links upright, keeps ``clearance`` (m) to all
    obstacles. Where the payload did not come back, the time to the end.
    """
    if run.reference is None or not run.obstacles or not run.number_of_uavs or not len(run.time):
        return []
    time, place = run.reference["time_s"][::EVERY], run.reference_position[::EVERY]
    level = np.array([1.0, 0.0, 0.0, 0.0])
    upright = run.uav_position[0] - run.payload_position[0]
    planned = replace(
        run,
        time=time,
        payload_position=place,
        payload_quaternion=np.tile(level, (len(time), 1)),
        uav_position=place[:, None] + upright,
        uav_quaternion=np.tile(level, (len(time), len(upright), 1)),
        obstacles=tuple(replace(track, position=_at(time, run.time, track.position)) for track in run.obstacles),
    )
    free = np.nan_to_num(planned.clearance(), nan=np.inf).min(axis=1) >= clearance
    at, error = position_error(run)
    near = at[np.linalg.norm(error, axis=1) <= BACK]
    cleared = time[1:][free[1:] & ~free[:-1]]
    return [(float(t), float(min(near[near >= t], default=at[-1]) - t)) for t in cleared]


def _at(times: Array, known: Array, values: Array) -> Array:
    return np.column_stack([np.interp(times, known, axis) for axis in values.T])
