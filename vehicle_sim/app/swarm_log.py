"""The log of a swarm: modes and failsafes of its vehicles as they change."""

import logging

from gcs.mavlink import px4
from vehicle_sim.swarm import Swarm

LOG = logging.getLogger("vehicle_sim")


class SwarmLog:
    """Compares the vehicles with what was logged of them last."""

    def __init__(self, swarm: Swarm) -> None:
        self._swarm = swarm
        self._changes = [-1 for _ in swarm.vehicles]

    def update(self) -> None:
        """Log what has changed."""
        for i, vehicle in enumerate(self._swarm.vehicles):
            autopilot = vehicle.autopilot
            if autopilot.changes == self._changes[i]:
                continue
            self._changes[i] = autopilot.changes
            mode, armed = px4.mode_name(autopilot.mode), "armed" if autopilot.armed else "disarmed"
            level = logging.WARNING if autopilot.failsafe else logging.INFO
            state = "failsafe, " if autopilot.failsafe else ""
            LOG.log(level, "%.2f s: vehicle %d: %s%s, %s", self._swarm.time, vehicle.system_id, state, mode, armed)
