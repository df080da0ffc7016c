"""The sensors of a simulated team as planning needs them: those of an entry point, as there is no other simulator."""

from collections.abc import Sequence
from typing import Protocol

from gcs.extras import simulator
from gcs.mission.model import Mission
from idc_controller.arrays import Array

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
