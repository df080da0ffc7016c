"""The set-point that a vehicle flies, also in a gap of them."""

import math
from collections import deque

from gcs.config.vehicle_settings import SetpointSettings
from idc_controller.rotations_float import mean_attitude
from vehicle_sim.autopilot.position_setpoints import PositionSetpoint
from vehicle_sim.autopilot.setpoints import AttitudeSetpoint

Setpoint = AttitudeSetpoint | PositionSetpoint


class SetpointStream:
    """The set-points of the ground in control. Times in s.

    A ground that corrects an error with every set-point means each for a moment only: held through a gap, the last of
    them would go on correcting an error that is over. So the mean of the last ones is flown in a gap.

    ``last_time`` of the last one; -inf: there is none.
    """

    def __init__(self, settings: SetpointSettings) -> None:
        self._settings = settings
        self._recent: deque[tuple[float, Setpoint]] = deque()
        self._mean: Setpoint | None = None
        self.last_time = -math.inf

    def add(self, setpoint: Setpoint, now: float) -> None:
        """Take a set-point."""
        recent = self._recent
        recent.append((now, setpoint))
        self.last_time = now
        while now - recent[0][0] > self._settings.mean_over:
            recent.popleft()
        self._mean = None

    def at(self, now: float) -> Setpoint | None:
        """Return the set-point to fly; None: none has come."""
        if not self._recent:
            return None
        time, last = self._recent[-1]
        if now - time <= self._settings.hold:
            return last
        if self._mean is None:
            self._mean = _mean([setpoint for _, setpoint in self._recent])
        return self._mean

    @property
    def held_until(self) -> float:
        """Time until which the last one is flown (s)."""
        return self.last_time + self._settings.hold

    def clear(self) -> None:
        """Forget all."""
        self._recent.clear()
        self.last_time = -math.inf
        self._mean = None


def _mean(recent: list[Setpoint]) -> Setpoint:
    """Mean of set-points of attitudes; else the last one."""
    last = recent[-1]
    setpoints = [setpoint for setpoint in recent if isinstance(setpoint, AttitudeSetpoint)]
    if not isinstance(last, AttitudeSetpoint) or len(setpoints) < len(recent):
        return last
    attitudes = [s.attitude for s in setpoints if s.attitude is not None]
    thrusts = [s.thrust for s in setpoints if s.thrust is not None]
    if last.attitude is None or len(attitudes) < len(setpoints) or len(thrusts) < len(setpoints):
        return last
    n = len(setpoints)
    rates = [sum(s.rates[axis] for s in setpoints) / n for axis in range(3)]
    attitude = mean_attitude(attitudes)
    return AttitudeSetpoint(attitude, (rates[0], rates[1], rates[2]), sum(thrusts) / n, last.time_boot_ms)
