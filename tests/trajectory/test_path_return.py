"""Time until the payload is back on the reference after an obstacle, on a synthetic run with known times."""

import numpy as np
import pytest
from truth_rows import write_state

from gcs.record.run_data import read_run
from gcs.record.safety import return_times
from gcs.record.tables import REFERENCE_COLUMNS, TableWriter
from idc_controller.geometry.shapes import Sphere
from vehicle_sim.world.obstacle_bodies import Obstacle
from vehicle_sim.world.truth_log import TruthLog
from vehicle_sim.world.world_state import UavState, WorldState

LEVEL, REST = (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
CORNERS = np.array([[x, y, -3.0] for x in (-0.5, 0.5) for y in (-0.5, 0.5)])


def flown(folder, back_at, until=20.0):
    """North at 1 m/s past a sphere of 0.5 m at 10 m; 2 m aside from 5 s until ``back_at``."""
    sphere = Obstacle("s", Sphere(0.5), (10.0, 0.0, -5.0))
    with TruthLog(folder, 4) as log, TableWriter(folder / "reference.csv", REFERENCE_COLUMNS) as reference:
        for time in np.arange(0.0, until + 1e-9, 0.02):
            aside = 2.0 if 5.0 <= time < back_at else 0.05
            place = np.array([time, aside, -5.0])
            uavs = tuple(UavState(tuple(place + c), LEVEL, REST, REST, 9.0, False) for c in CORNERS)
            write_state(log, WorldState(time, tuple(place), LEVEL, REST, REST, uavs), 0, [sphere])
            reference.write([time, time, 0.0, -5.0, 1.0, 0.0, 0.0])
    return read_run(folder)


def test_return_time_counts_from_the_reference_being_free_until_the_payload_is_back(tmp_path):
    ((free, after),) = return_times(flown(tmp_path / "run", back_at=14.0), clearance=0.6)
    # The discs' rim is 0.8 m behind the payload, and 0.6 m behind the sphere's far side at 10.5 m: 1.9 m past it.
    assert free == pytest.approx(10.5 + 0.6 + 0.8, abs=0.25)
    assert free + after == pytest.approx(14.0, abs=0.021)


def test_return_time_lasts_to_the_end_of_a_payload_that_never_returns(tmp_path):
    ((free, after),) = return_times(flown(tmp_path / "run", back_at=99.0), clearance=0.6)
    assert free + after == pytest.approx(20.0)


def test_return_times_are_empty_without_an_obstacle_on_the_reference(tmp_path):
    run = flown(tmp_path / "run", back_at=6.0, until=8.0)
    assert return_times(run, clearance=0.6) == []
