"""The sensors of a team without physics: the entry point ``pybullet`` of ``cooplift.sensors``."""

import numpy as np

from gcs.mission.model import Mission
from idc_controller.arrays import Array
from vehicle_sim.world.range_sensor import RangeSensor, RayBodies
from vehicle_sim.world.sensors import Measurement, NavigationSensors, vehicle_noise

_ROW = [0, 1, 2, 6, 7, 8, 9, 3, 4, 5, 10, 11, 12]
"""Columns of a state as the sensors take it (`vehicle_sim.world.state_kernels`), and back."""
_BACK = np.argsort(_ROW)


class TeamSensors:
    """Navigation and range sensors of vehicles whose true states are given, among the obstacles of a mission."""

    def __init__(self, mission: Mission) -> None:
        config, ids = mission.system, range(1, mission.system.team.vehicles + 1)
        self._navigation = NavigationSensors([vehicle_noise(config.sensors)] * len(ids), mission.seed, ids)
        self._range = [RangeSensor(config.range_sensor, mission.seed, i) for i in ids]
        self._places = np.array([obstacle.position for obstacle in mission.obstacles]).reshape(-1, 3)
        self._movers = [
            (row, obstacle.motion.mover())
            for row, obstacle in enumerate(mission.obstacles)
            if obstacle.motion is not None
        ]
        self._bodies = RayBodies.of((obstacle.shape, obstacle.position) for obstacle in mission.obstacles)

    def scan(self, time: float, motion_time: float, states: Array) -> list[tuple[Array, Array]]:
        """Return the measured state (13,) of each vehicle, and the returns of its scan in its body frame (n, 3) (m).

        Args:
            time: by the vehicles' clocks (s), which says which rays there are.
            motion_time: since the obstacles have begun to move (s).
            states: true position, velocity, quaternion (body to world, w first), body rates (N, 13), NED, SI.
        """
        for row, mover in self._movers:
            self._bodies.centres[row] = self._places[row] + mover(max(motion_time, 0.0))
        rows = np.ascontiguousarray(states[:, _ROW])
        measured = self._navigation.measure(rows)[:, _BACK]
        found = []
        for sensor, row, sample in zip(self._range, rows.tolist(), measured, strict=True):
            own = Measurement.of_row(time, row)
            scan = sensor.scan(time, round(time * 1e3), own.position, own.attitude, own, self._bodies)
            found.append((sample, scan.points))
        return found
