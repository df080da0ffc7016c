"""The obstacle map of a team whose true states are given, by the scans of its simulated sensors: an entry point."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from gcs.extras import simulator
from gcs.flight import stack
from gcs.mission.model import Mission
from idc_controller.arrays import Array
from idc_controller.estimation.measurements import Attitude, Position, VehicleStates
from idc_controller.perception.scan_placement import Returns, ScanEnd

SENSORS = "cooplift.sensors"
"""Group of entry points, each a function of a mission that returns its :class:`TeamSensors`."""


class TeamSensors(Protocol):
    """Navigation and range sensors of vehicles whose true states are given, among the obstacles of a mission."""

    def scan(self, time: float, motion_time: float, states: Array) -> Sequence[tuple[Array, Array]]:
        """Return the measured state (13,) of each vehicle, and the returns of its scan in its body frame (n, 3) (m).

        Args:
            time: by the vehicles' clocks (s), which says which rays there are.
            motion_time: since the obstacles have begun to move (s).
            states: true position, velocity, quaternion (body to world, w first), body rates (N, 13), NED, SI.
        """


def open_sensors(mission: Mission) -> TeamSensors:
    """Return the sensors that are installed, by :func:`gcs.extras.simulator`. Raises :class:`GcsError`: none."""
    sensors: TeamSensors = simulator(SENSORS, "sensors are").load()(mission)
    return sensors


class ScannedMap:
    """Obstacle map and sensors: what is scanned in one control step is on the map in the next."""

    def __init__(self, mission: Mission, sensors: TeamSensors | None = None) -> None:
        """``sensors``: None: those that are installed."""
        self.map = stack.obstacle_map(mission)
        self._sensors = (sensors or open_sensors(mission)) if mission.obstacles else None
        self._range, self._scan_rate = mission.system.range_sensor.range, mission.system.range_sensor.rate
        self._step_rate = mission.system.rates.control
        self._scanned: tuple[float, Sequence[tuple[Array, Array]]] | None = None

    def step(self, number: int, motion_time: float, vehicles: VehicleStates) -> None:
        """Update the map, and scan where that is due in control step ``number``, from the states of the ``vehicles``.

        ``motion_time``: since the obstacles have begun to move (s).
        """
        if self._sensors is None:
            return
        time = vehicles.time
        if self._scanned is not None:
            self._place(*self._scanned, time)
            self._scanned = None
        self.map.update(time)
        self.map.placement.poses.add_estimated(vehicles)
        if number * self._scan_rate % self._step_rate < self._scan_rate:
            self._scanned = time, self._sensors.scan(time, motion_time, vehicles.values)

    def _place(self, scanned: float, scans: Sequence[tuple[Array, Array]], time: float) -> None:
        """Give the map the measured poses and the ``scans`` of all vehicles at ``scanned``, which come at ``time``."""
        placement, stamp = self.map.placement, round(scanned * 1e3)
        for uav, (pose, points) in enumerate(scans):
            placement.poses.add_measured(Position(scanned, uav, pose[0:3], pose[3:6]))
            placement.poses.add_measured(Attitude(scanned, uav, pose[6:10], pose[10:13]))
            placement.add(Returns(stamp, points, np.full(len(points), self._range)), uav, scanned, time)
            placement.end(ScanEnd(stamp, self._range, True), uav, scanned, time)
