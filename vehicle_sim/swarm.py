"""The swarm: the world, and the vehicles in it, as one object without a socket or a clock."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial

from gcs.config import SystemConfig
from gcs.mavlink import px4
from gcs.mavlink.address import Address
from gcs.mission.model import Home as MissionHome
from gcs.mission.model import Obstacle
from vehicle_sim.autopilot.airframe import Airframe
from vehicle_sim.autopilot.settings import AutopilotSettings, FailsafeSettings
from vehicle_sim.faults.interface import FaultInterface
from vehicle_sim.mavlink.geodesy import Home
from vehicle_sim.mavlink.vehicle import Vehicle
from vehicle_sim.world.obstacle_bodies import MovingObstacles
from vehicle_sim.world.range_sensor import RangeSensor
from vehicle_sim.world.rotors import IDLE, Four, Rotors
from vehicle_sim.world.sensors import PAYLOAD_UNIT, NavigationSensor, SensorNoise
from vehicle_sim.world.truth_log import TruthLog
from vehicle_sim.world.world import World
from vehicle_sim.world.world_state import WorldState

TRUTH_RATE = 50  # Hz, at least
REST_SPEED = 0.1  # m/s
REST_THRUST = 0.1  # N
_TIME_TOLERANCE = 1e-6  # s: sums of steps are not exact


class Swarm:
    """The world, N vehicles with their sensors and rotors, the obstacles, and the record of what really happens.

    A driver lets time go on with :meth:`advance_to`, hands over what arrives with :meth:`receive`, and sends what
    :meth:`datagrams_to_send` gives, after each of both and whenever :meth:`next_timer` is due. Equal calls give equal
    results to the last bit on one machine.

    Public state, to be read only: ``time`` of the last physics step (s), ``vehicles`` (of the system ids 1 .. N, in
    this order), ``world``, ``take_off_time`` (s; first release from a cradle, None before).
    """

    def __init__(
        self,
        config: SystemConfig,
        *,
        seed: int,
        home: MissionHome | None = None,
        obstacles: Sequence[Obstacle] = (),
        ground_address: Address | None = None,
        faults: FaultInterface | None = None,
        gui: bool = False,
    ) -> None:
        """``ground_address`` is where the vehicles offer themselves. Raises :class:`SimulationError`."""
        system = config.true_parameters()
        rates = config.rates
        self.world = World(system, rates.physics, gui)
        try:
            self._obstacles = MovingObstacles(self.world.obstacles, obstacles)
        except BaseException:
            self.world.close()
            raise
        self.time = 0.0
        self.take_off_time: float | None = None
        self._faults = faults or FaultInterface()
        self._truth: TruthLog | None = None
        self._physics_rate = rates.physics
        self._steps_per_onboard = rates.physics // rates.onboard
        self._steps_per_row = rates.physics // TRUTH_RATE
        self._steps_per_scan = rates.physics // config.range_sensor.rate
        self._steps = 0
        self._contacts = 0

        airframes = [
            Airframe.of_system(
                system,
                i,
                arm_length=config.uav.arm_length,
                torque_to_thrust=config.uav.torque_to_thrust,
                rotor_speed_max=config.uav.rotor_speed_max,
            )
            for i in range(system.number_of_uavs)
        ]
        where = Home() if home is None else Home(home.latitude, home.longitude, home.altitude)
        settings = AutopilotSettings(failsafe=FailsafeSettings(setpoint_loss=config.flight.failsafe.telemetry_timeout))
        self.vehicles = tuple(
            Vehicle(
                i, airframe, onboard_rate=rates.onboard, telemetry_rate=rates.telemetry, home=where,
                ground_address=ground_address, clock=partial(self._faults.clock, i),
                autopilot_settings=settings,
            )
            for i, airframe in enumerate(airframes, start=1)
        )  # fmt: skip
        self._rotors = [
            Rotors(airframe.rotors, airframe.motor_time_constant, 1.0 / rates.physics) for airframe in airframes
        ]
        self._changes = [0 for _ in self.vehicles]
        self._modes = [("", False, False) for _ in self.vehicles]
        self._commands: list[Four] = [IDLE for _ in self.vehicles]
        noise = config.sensors
        attitude = math.radians(noise.attitude_deg)
        uav_noise = SensorNoise(noise.position, attitude, noise.uav_velocity, noise.uav_rates)
        payload_noise = SensorNoise(noise.position, attitude, noise.payload_velocity, noise.payload_rates)
        self._sensors = [NavigationSensor(uav_noise, seed, vehicle.system_id) for vehicle in self.vehicles]
        self._payload_sensor = NavigationSensor(payload_noise, seed, PAYLOAD_UNIT)
        ranging = config.range_sensor
        self._range_sensors = [
            RangeSensor(ranging.range, ranging.noise, seed, vehicle.system_id) for vehicle in self.vehicles
        ]
        self._scans_at_all = bool(obstacles)
        state = self.world.state()
        self._onboard(state)
        self._scan(state)

    # Time

    def advance_to(self, now: float) -> None:
        """Let the world go on to ``now`` (s): ends with the last physics step before it, measured if it is due."""
        last = math.floor((now + _TIME_TOLERANCE) * self._physics_rate)
        while self._steps < last:
            self._step()

    def record(self, truth: TruthLog) -> None:
        """Write down what happens from here on, 50 times a second or more. The log is closed with the swarm."""
        self._truth = truth
        truth.write(self.world.state(), self.world.contacts().pairs, self.world.obstacles.all())

    def close(self) -> None:
        """End the world and the record; harmless when they have ended."""
        if self._truth is not None:
            self._truth.close()
        self.world.close()

    def __enter__(self) -> Swarm:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def at_rest(self) -> bool:
        """Whether all vehicles are disarmed, their rotors have run down, and nothing moves any more."""
        if any(vehicle.autopilot.armed for vehicle in self.vehicles):
            return False
        state = self.world.state()
        if any(uav.thrust > REST_THRUST for uav in state.uavs):
            return False
        velocities = [state.payload_velocity_in_world, *(uav.velocity_in_world for uav in state.uavs)]
        return max(math.hypot(*velocity) for velocity in velocities) < REST_SPEED

    # The wire

    def receive(self, vehicle: int, datagram: bytes, sender: Address, now: float) -> None:
        """A datagram that came to a vehicle's endpoint; ``vehicle`` is its system id."""
        for arrived, source in self._faults.to_vehicle(vehicle, [(datagram, sender)], now):
            self.vehicles[vehicle - 1].receive(arrived, source, now)

    def datagrams_to_send(self, now: float) -> list[tuple[int, bytes, Address]]:
        """All that is due at ``now`` (s): the system id of the vehicle that sends, bytes, address."""
        faults = self._faults
        out: list[tuple[int, bytes, Address]] = []
        for vehicle in self.vehicles:
            i = vehicle.system_id
            for arrived, source in faults.to_vehicle(i, (), now):
                vehicle.receive(arrived, source, now)
            leaving = faults.from_vehicle(i, vehicle.datagrams_to_send(now), now)
            out += [(i, datagram, address) for datagram, address in leaving]
        return out

    def next_timer(self) -> float | None:
        """When :meth:`datagrams_to_send` has something to do (s; in the past: at once). None: never as things are."""
        timers = [vehicle.next_timer() for vehicle in self.vehicles]
        timers.append(self._faults.next_timer())
        return min((timer for timer in timers if timer is not None), default=None)

    # Inside

    def _step(self) -> None:
        """One physics step."""
        world = self.world
        next_time = (self._steps + 1) / self._physics_rate
        if self.take_off_time is not None:
            self._obstacles.move(next_time - self.take_off_time)
        thrusts, torques = [], []
        for rotors, command in zip(self._rotors, self._commands, strict=True):
            thrust, tau_x, tau_y, tau_z = rotors.advance(command)
            thrusts.append(thrust)
            torques.append((tau_x, tau_y, tau_z))
        forces = self._faults.disturb(world, self.time)
        world.step(thrusts, torques, *(forces or ()))
        self._steps += 1
        self.time = next_time
        if self._truth is not None:
            self._contacts = max(self._contacts, world.contacts().pairs)
        measures = self._steps % self._steps_per_onboard == 0
        records = self._steps % self._steps_per_row == 0 and self._truth is not None
        scans = self._scans_at_all and self._steps % self._steps_per_scan == 0
        if not (measures or records or scans or self.take_off_time is None):
            return
        state = world.state()
        if self.take_off_time is None and not all(uav.cradled for uav in state.uavs):
            self.take_off_time = next_time
            self._faults.took_off(next_time)
        if measures:
            self._onboard(state)
        if scans:
            self._scan(state)
        if records and self._truth is not None:
            self._truth.write(state, self._contacts, world.obstacles.all())
            self._contacts = 0

    def _onboard(self, state: WorldState) -> None:
        """Measure, and let every autopilot make a step."""
        now = state.time
        faults = self._faults
        payload_sample = self._payload_sensor.measure(
            now, state.payload_quaternion, state.payload_rates_in_payload, state.payload_position_in_world,
            state.payload_velocity_in_world,
        )  # fmt: skip
        for i, (vehicle, uav) in enumerate(zip(self.vehicles, state.uavs, strict=True)):
            sample = self._sensors[i].measure(
                now, uav.quaternion, uav.rates_in_body, uav.position_in_world, uav.velocity_in_world
            )
            vehicle.relay(faults.payload_sample(vehicle.system_id, payload_sample))
            self._commands[i] = vehicle.step(faults.own_sample(vehicle.system_id, sample), now)
            vehicle.report(faults.reported_sample(vehicle.system_id, vehicle.autopilot.reported_measurement))
            if self._truth is not None and vehicle.autopilot.changes != self._changes[i]:
                self._record_mode(i, now)

    def _record_mode(self, index: int, now: float) -> None:
        """Write down what a vehicle flies, if that is something else than before."""
        autopilot = self.vehicles[index].autopilot
        self._changes[index] = autopilot.changes
        mode = px4.mode_name(autopilot.mode), autopilot.armed, autopilot.failsafe
        if self._truth is not None and mode != self._modes[index]:
            self._modes[index] = mode
            self._truth.write_mode(now, index + 1, *mode)

    def _scan(self, state: WorldState) -> None:
        """Let every vehicle look around."""
        if not self._scans_at_all:
            return
        obstacles = self.world.obstacles.all()
        for sensor, vehicle, uav in zip(self._range_sensors, self.vehicles, state.uavs, strict=True):
            scan = sensor.scan(state.time, uav.position_in_world, uav.quaternion, obstacles)
            vehicle.take_scan(self._faults.range_sample(vehicle.system_id, scan))
