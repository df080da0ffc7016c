"""An autopilot on a body and the simplest ground, for tests of the onboard side."""

from __future__ import annotations

from flying import AIRFRAME, ONBOARD_EVERY, Body
from onboard import step_alone

from idc_controller.rotations_float import Quaternion
from vehicle_sim.autopilot.autopilot import Autopilot
from vehicle_sim.autopilot.setpoints import AttitudeSetpoint
from vehicle_sim.autopilot.vehicle_parameters import vehicle_parameters
from vehicle_sim.world.sensors import SensorNoise

LEVEL = (1.0, 0.0, 0.0, 0.0)


def autopilot() -> Autopilot:
    return Autopilot(AIRFRAME, vehicle_parameters(AIRFRAME, 1, 250))


def setpoint(attitude: Quaternion | None = LEVEL, thrust: float = 0.5, stamp: int = 0) -> AttitudeSetpoint:
    return AttitudeSetpoint(attitude, (0.0, 0.0, 0.0), thrust, stamp)


class Flight:
    """A body with its autopilot; a simple ground that sends set-points at 20 Hz while ``ground_is_there``."""

    def __init__(self, carried: float = 0.775, noise: SensorNoise | None = None) -> None:
        self.body = Body(carried, noise)
        self.pilot = autopilot()
        self.ground_is_there = True
        self.target = setpoint()

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / 0.002)):
            now = self.body.now
            if self.ground_is_there and self.body.tick % 25 == 0:
                self.pilot.follow(self.target, now)
                self.pilot.ground_heard(now)
            if self.body.tick % ONBOARD_EVERY == 0:
                self.body.command = step_alone(self.pilot, self.body.measure(), now)
            self.body.advance()

    @property
    def hover(self) -> float:
        return self.body.mass * AIRFRAME.g / AIRFRAME.rotors.thrust_max

    def take_off(self, height: float = 6.0) -> None:
        self.run(0.02)
        assert self.pilot.enter_offboard(self.target, self.body.now, self.body.now).text == ""
        assert self.pilot.arm(self.body.now).text == ""
        self.target = setpoint(thrust=self.hover * 1.1)
        while -self.body.position[2] < height:
            self.run(0.05)
            assert self.body.now < 20.0
        self.target = setpoint(thrust=self.hover * 0.9)
        while self.body.velocity[2] < -0.02:
            self.run(0.02)
        self.target = setpoint(thrust=self.hover)
        self.run(4.0)
