"""Four autopilots on one payload that lose their set-points together: they brake, hold, descend and disarm."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
import pytest
from onboard import step_alone
from world_runs import place

from gcs.config import read_system
from gcs.mavlink import px4
from idc_controller.model.nonlinear import SystemState
from idc_controller.rotations import euler_from_quaternion
from vehicle_sim.autopilot.airframe import Airframe
from vehicle_sim.autopilot.autopilot import Autopilot
from vehicle_sim.autopilot.setpoints import AttitudeSetpoint
from vehicle_sim.autopilot.vehicle_parameters import vehicle_parameters
from vehicle_sim.world.rotors import Rotors
from vehicle_sim.world.sensors import Measurement, NavigationSensors, SensorNoise
from vehicle_sim.world.world import World

NOISE = SensorNoise(position=0.02, attitude=math.radians(0.2), velocity=0.02, rates=0.005)


@pytest.mark.slow
@pytest.mark.parametrize("velocity", [(0.0, 0.0), (3.0, 2.5)])
def test_payload_is_braked_held_and_set_down(velocity: tuple[float, float]) -> None:
    config = read_system()
    system = config.true_parameters()
    n = system.number_of_uavs
    level = np.tile([1.0, 0.0, 0.0, 0.0], (n, 1))
    start = SystemState(
        np.array([0.0, 0.0, -5.0]), np.array([*velocity, -0.5]), level[0], np.zeros(3),
        np.tile([0.0, 0.0, 1.0], (n, 1)), np.zeros((n, 3)), level, np.zeros((n, 3)),
    )  # fmt: skip
    airframes = [Airframe.of_system(system, i, config.uav) for i in range(n)]
    pilots = [Autopilot(airframe, vehicle_parameters(airframe, i, 250)) for i, airframe in enumerate(airframes)]
    lags = [airframe.motor_time_constant for airframe in airframes]
    rotors = Rotors([airframe.rotors for airframe in airframes], lags, 0.002)
    sensors = NavigationSensors([NOISE] * n, 3, range(n))
    speeds = np.zeros((n, 4))
    tilts, separations, modes, sinking = [], [], set(), []
    with World(system, 500) as world:
        place(world, start)
        for tick in range(12_000):
            now, state = tick * 0.002, world.state()
            if tick % 2 == 0:
                samples = sensors.measure(world.states()[1:])
                for i, pilot in enumerate(pilots):
                    thrust = float(system.hover_thrust[i]) / system.thrust_max
                    setpoint = AttitudeSetpoint((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), thrust, tick)
                    speeds[i] = step_alone(pilot, Measurement.of_row(now, samples[i].tolist()), now)
                    if tick == 0:
                        pilot.enter_offboard(setpoint, now, now)
                        pilot.arm(now, force=True)
                        speeds[i] = rotors.speeds[i] = math.sqrt(system.hover_thrust[i] / 4 / airframes[i].rotors.k_f)
                    elif now < 0.8:
                        pilot.follow(setpoint, now)
            if tick % 50 == 0:
                tilts.append(np.abs(euler_from_quaternion(state.payload_quaternion)[:2]).max())
                places = [np.array(uav.position_in_world) for uav in state.uavs]
                separations.append(min(np.linalg.norm(a - b) for a, b in combinations(places, 2)))
                modes.add(pilots[0].mode)
                if pilots[0].mode == px4.MODE_LAND:
                    sinking.append(state.payload_velocity_in_world[2])
                if not any(pilot.armed for pilot in pilots):
                    break
            thrusts, torques = rotors.advance(speeds)
            world.step(thrusts[0], torques[0])
        assert world.touching_ground()
        # Flown to the loss (0.8 s), unnoticed (0.5 s), and half of the braking time (4 s).
        braking_distance = math.hypot(*velocity) * (0.8 + 0.5 + 2.0)
        assert math.hypot(*world.state().payload_position_in_world[:2]) < braking_distance + 0.5
    assert not any(pilot.armed for pilot in pilots)
    assert {px4.MODE_OFFBOARD, px4.MODE_HOLD, px4.MODE_LAND} <= modes
    assert math.degrees(max(tilts)) < 9.0
    assert min(separations) > 0.7
    assert max(sinking) < 0.65
