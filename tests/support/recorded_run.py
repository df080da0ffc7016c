"""A synthetic run whose figures can be written down by hand."""

import numpy as np
from truth_rows import write_state

from gcs.record.tables import PLAN_COLUMNS, REFERENCE_COLUMNS, STEP_COLUMNS, TableWriter
from idc_controller.geometry.shapes import Sphere
from idc_controller.rotations import quaternion_from_euler
from vehicle_sim.world.obstacle_bodies import Obstacle
from vehicle_sim.world.truth_log import TruthLog
from vehicle_sim.world.world_state import UavState, WorldState

LEVEL, REST = (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
CORNERS = np.array([[x, y, -1.25] for x in (-0.5, 0.5) for y in (-0.5, 0.5)])
BALL = Obstacle("ball", Sphere(0.5), (14.0, 0.53, -6.21))


def world_state(time, position, quaternion, uavs, thrust):
    """A state with level UAVs at ``uavs`` (N, 3), each with its ``thrust`` (N,)."""
    states = (UavState(tuple(p), LEVEL, REST, REST, f, False) for p, f in zip(uavs, thrust, strict=True))
    return WorldState(time, tuple(position), tuple(quaternion), REST, REST, tuple(states))


def write_flight(folder, positions, thrust=14.5):
    """The level formation at ``positions`` (T, 3), ten rows a second."""
    with TruthLog(folder, 4) as log:
        for k, place in enumerate(np.asarray(positions)):
            write_state(log, world_state(k / 10.0, place, LEVEL, place + CORNERS, [thrust] * 4), 0)
    return folder


def write_truth(folder, rows=101, standing=(), moving=lambda time: ()):
    """Ten seconds at 10 Hz: the payload flies north at 1 m/s, 0.03 m east and 0.04 m below its reference."""
    with TruthLog(folder, 4) as log:
        for k in range(rows):
            time = k / 10.0
            position = np.array([time, 0.03, -4.96])
            roll, pitch, yaw = np.deg2rad([2.0 if k == 50 else 0.0, -3.0 if k == 51 else 0.0, 1.0])
            uavs = position + CORNERS
            if k == 60:
                uavs[0, 0] += 0.25  # towards its neighbour ahead
            state = world_state(time, position, quaternion_from_euler(roll, pitch, yaw), uavs, [14.5] * 4)
            contacts = {70: 1, 71: 2, 72: 2, 80: 1}.get(k, 0)
            write_state(log, state, contacts, [*(standing if k == 0 else ()), *moving(time)])


def write_reference(folder, start=0.0, end=10.0):
    """North at 1 m/s, at times that are not those of the truth."""
    with TableWriter(folder / "reference.csv", REFERENCE_COLUMNS) as table:
        for time in np.linspace(start, end, 33):
            table.write([time, time, 0.0, -5.0, 1.0, 0.0, 0.0])


def write_steps(folder):
    """Steps of 6 ms, the tracker and the perception longer with each; two of them infeasible."""
    with TableWriter(folder / "steps.csv", STEP_COLUMNS) as table:
        for k in range(101):
            rest = [2.0, k / 10.0, 0.3, 0.4, 0.6, 0.7, 0.8]
            table.write([k / 20.0, 0.1, 0.5, k / 10.0, k / 10.0 + 1.0, 7, k in (3, 4), *rest])


def write_plan(folder, slack, off):
    """A plan 0.05 s apart that the payload is ``off`` (m) beside of, with one step of ``slack`` (m) at 5 s."""
    with TableWriter(folder / "plan.csv", PLAN_COLUMNS) as table:
        for k in range(201):
            time = k / 20.0
            check = [0.5 - slack * (k == 100), int(not (slack and k == 100)), 1]
            table.write(
                [time, time, 0.03 - off, -4.96, 0, 0, 0, slack * (k == 100), 0, 1, 0, 0.1, 0.12, 1, 9, 0, *check]
            )
