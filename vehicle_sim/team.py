"""The vehicles of the swarm with their sensors and rotors, stepped together."""

import math
from collections.abc import Sequence

import numpy as np

from gcs.config import SystemConfig
from gcs.config.tables import SensorsConfig
from idc_controller.arrays import Array
from vehicle_sim.autopilot.airframe import Airframe
from vehicle_sim.faults.fault_injector import FaultInjector
from vehicle_sim.mavlink.vehicle import Vehicle
from vehicle_sim.world.obstacle_bodies import ObstacleBodies
from vehicle_sim.world.range_sensor import RangeSensor
from vehicle_sim.world.rotors import Rotors
from vehicle_sim.world.sensors import PAYLOAD_UNIT, Measurement, NavigationSensors, SensorNoise
from vehicle_sim.world.world_state import WorldState


class Team:
    """N vehicles (``vehicles``, of the system ids 1 .. N, in this order) and the payload's unit, which they relay."""

    def __init__(
        self,
        vehicles: Sequence[Vehicle],
        airframes: Sequence[Airframe],
        config: SystemConfig,
        seed: int,
        faults: FaultInjector,
    ) -> None:
        self.vehicles = tuple(vehicles)
        self._faults = faults
        ids = [vehicle.system_id for vehicle in vehicles]
        self._sensors = _navigation_sensors(config.sensors, seed, ids)
        self._range_sensors = [RangeSensor(config.range_sensor, seed, i) for i in ids]
        self._rotors = Rotors(
            [airframe.rotors for airframe in airframes],
            [airframe.motor_time_constant for airframe in airframes],
            1.0 / config.rates.physics,
        )
        self._commands = np.zeros((len(ids), 4))

    def wrenches(self) -> tuple[list[float], list[list[float]]]:
        """Return thrusts (N) and torques (N m) of the rotors over the next physics step."""
        return self._rotors.advance(self._commands)

    def step(self, states: Array, now: float) -> None:
        """Measure the true ``states``, relay the payload's sample, and let every autopilot take a step."""
        faults = self._faults
        payload_sample, *samples = [Measurement.of_row(now, row) for row in self._sensors.measure(states).tolist()]
        for i, (vehicle, sample) in enumerate(zip(self.vehicles, samples, strict=True)):
            number = vehicle.system_id
            vehicle.relay(faults.payload_sample(number, payload_sample))
            self._commands[i] = vehicle.step(faults.own_sample(number, sample), now)
            vehicle.report(faults.reported_sample(number, vehicle.autopilot.state.navigation.reported))

    def scan(self, state: WorldState, obstacles: ObstacleBodies) -> None:
        """Let every vehicle scan for obstacles, in a world with any."""
        if not obstacles.all():
            return
        places = np.array([uav.position_in_world for uav in state.uavs])
        near = obstacles.near(places, self._range_sensors[0].reach)
        for vehicle, sensor, uav, some in zip(self.vehicles, self._range_sensors, state.uavs, near, strict=True):
            scan = sensor.scan(state.time, uav.position_in_world, uav.quaternion, some)
            vehicle.take_scan(self._faults.range_sample(vehicle.system_id, scan))


def _navigation_sensors(noise: SensorsConfig, seed: int, vehicles: Sequence[int]) -> NavigationSensors:
    """Return the sensors of the payload's unit and of the ``vehicles`` (system ids)."""
    attitude = math.radians(noise.attitude_deg)
    payload_noise = SensorNoise(noise.position, attitude, noise.payload_velocity, noise.payload_rates)
    uav_noise = SensorNoise(noise.position, attitude, noise.uav_velocity, noise.uav_rates)
    return NavigationSensors([payload_noise, *[uav_noise] * len(vehicles)], seed, [PAYLOAD_UNIT, *vehicles])
