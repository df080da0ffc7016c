"""The vehicles of the swarm with their sensors and rotors, stepped together."""

import math
from collections.abc import Sequence

import numpy as np

from gcs.config import SystemConfig
from gcs.config.tables import SensorsConfig
from idc_controller.arrays import Array
from idc_controller.rotations_float import Vector, into_body
from vehicle_sim.autopilot.onboard_arrays import OnboardArrays
from vehicle_sim.autopilot.onboard_loop import step_together
from vehicle_sim.faults.disturbances import Disturbances
from vehicle_sim.mavlink.vehicle import Vehicle
from vehicle_sim.world.obstacle_bodies import ObstacleBodies
from vehicle_sim.world.range_sensor import RangeSensor
from vehicle_sim.world.rotors import Rotors, Wrenches
from vehicle_sim.world.sensors import PAYLOAD_UNIT, Measurement, NavigationSensors, SensorNoise, vehicle_noise
from vehicle_sim.world.world_state import FreeState, WorldState


class Team:
    """N vehicles (``vehicles``, of the system ids 1 .. N, in this order) and the payload's unit, which they relay.

    Free vehicles have none; the states of all are then those of the vehicles alone.
    """

    def __init__(
        self,
        vehicles: Sequence[Vehicle],
        arrays: OnboardArrays,
        rotors: Rotors,
        config: SystemConfig,
        seed: int,
        faults: Disturbances,
        *,
        free: bool = False,
    ) -> None:
        """``arrays`` of these vehicles, each of which has its row; ``free``: they have no payload."""
        self.vehicles = tuple(vehicles)
        self._autopilots = [vehicle.autopilot for vehicle in vehicles]
        self._arrays = arrays
        self._rotors = rotors
        ids = [vehicle.system_id for vehicle in vehicles]
        self._has_payload = not free
        self._sensors = _navigation_sensors(config.sensors, seed, ids, payload=not free)
        self._range_sensors = [RangeSensor(config.range_sensor, seed, i) for i in ids]
        self._faults = faults
        self._disturbed = [vehicle for vehicle in vehicles if faults.disturbs_samples(vehicle.system_id)]
        self._undisturbed = [vehicle for vehicle in vehicles if vehicle not in self._disturbed]
        self._samples = self._sensors.samples[-len(ids) :]
        self._times = np.empty(len(ids))
        self._measured_at = math.nan
        self._felt: tuple[float, Array] | None = None
        """Time (s), attitudes and velocities (N, 7) of the last step."""

    def wrenches(self) -> Wrenches:
        """Return the wrenches of the rotors for the physics steps up to the next step of the onboard loops."""
        return self._rotors.advance(self._arrays.speeds)

    def step(self, states: Array, now: float) -> bool:
        """Measure the true ``states``, and let every autopilot take a step; return True if a HEARTBEAT changes."""
        self._sensors.measure(states)
        self._measured_at = now
        self._times.fill(now)
        if self._has_payload and self._disturbed:
            self._accelerate(states, now)
        missing = self._disturb() if self._disturbed else ()
        changed = step_together(self._autopilots, self._arrays, self._samples, self._times, now, missing)
        for i in changed:
            self.vehicles[i].send_changes()
        for vehicle in self._disturbed:
            reported = vehicle.autopilot.state.navigation.reported
            vehicle.report(self._faults.reported_sample(vehicle.system_id, reported))
        return bool(changed)

    def _accelerate(self, states: Array, now: float) -> None:
        """Let the vehicles whose samples faults disturb measure their specific force; the others do not fly by it."""
        before, self._felt = self._felt, (now, states[-len(self.vehicles) :, 3:10].copy())
        if before is None or now <= before[0]:
            return
        changes = (self._felt[1][:, 4:] - before[1][:, 4:]) / (now - before[0])
        for vehicle in self._disturbed:
            w, q_x, q_y, q_z = self._felt[1][vehicle.system_id - 1, :4].tolist()
            x, y, z = changes[vehicle.system_id - 1].tolist()
            force = into_body((w, q_x, q_y, q_z), (x, y, z - vehicle.autopilot.state.airframe.g))
            vehicle.autopilot.state.navigation.specific_force = force

    def feel(self, forces: Sequence[Vector], now: float) -> None:
        """Let the autopilots take the specific forces (N) (body frames, m/s2) of the time since the last step."""
        for autopilot, force in zip(self._autopilots, forces, strict=True):
            autopilot.feel(force, now)

    def clipped(self, exceeded: Sequence[int]) -> None:
        """Count, with all who report it, whose accelerometer clipped: 0 the payload's, 1 .. N the vehicles'."""
        for i, vehicle in enumerate(self.vehicles, start=1):
            vehicle.count_clipping(own=i in exceeded, payload=0 in exceeded)

    def relay(self) -> None:
        """Let the vehicles relay the payload's newest sample; those that a fault disturbs get every one at once."""
        if not self._has_payload:
            return
        sample = self._payload_sample()
        for vehicle in self._undisturbed:
            vehicle.relay(sample)

    def _payload_sample(self) -> Measurement:
        """Return the newest sample of the payload's unit."""
        return Measurement.of_row(self._measured_at, self._sensors.samples[0].tolist())

    def _disturb(self) -> list[int]:
        """Let the faults act on the vehicles' samples (N, 13), their times (N,), and what they relay.

        Return the vehicles (from 0) to which no sample comes.
        """
        missing = []
        samples, times, time = self._samples, self._times, self._measured_at
        payload_sample = self._payload_sample() if self._has_payload else None
        for vehicle in self._disturbed:
            number = vehicle.system_id
            if payload_sample is not None:
                vehicle.relay(self._faults.payload_sample(number, payload_sample))
            before = Measurement.of_row(time, samples[number - 1].tolist())
            sample = self._faults.own_sample(number, before)
            if sample is None:
                missing.append(number - 1)
            elif sample is not before:
                samples[number - 1], times[number - 1] = sample.as_row(), sample.time
        return missing

    def scan(self, state: WorldState | FreeState, obstacles: ObstacleBodies) -> None:
        """Let every vehicle scan for the obstacles."""
        bodies = obstacles.ray_bodies
        for vehicle, sensor, uav in zip(self.vehicles, self._range_sensors, state.uavs, strict=True):
            stamp = vehicle.telemetry.time_boot_ms(state.time)
            own = vehicle.autopilot.state.navigation.estimate
            scan = sensor.scan(state.time, stamp, uav.position_in_world, uav.quaternion, own, bodies)
            vehicle.take_scan(self._faults.range_sample(vehicle.system_id, scan))


def _navigation_sensors(noise: SensorsConfig, seed: int, vehicles: Sequence[int], payload: bool) -> NavigationSensors:
    """Return the sensors of the ``vehicles`` (system ids), and before them of the payload's unit, if there is one."""
    if not payload:
        return NavigationSensors([vehicle_noise(noise)] * len(vehicles), seed, vehicles)
    attitude = math.radians(noise.attitude_deg)
    payload_noise = SensorNoise(noise.position, attitude, noise.payload_velocity, noise.payload_rates)
    noises = [payload_noise, *[vehicle_noise(noise)] * len(vehicles)]
    return NavigationSensors(noises, seed, [PAYLOAD_UNIT, *vehicles])
