"""The swarm: the world, and the vehicles in it, as one object without a socket or a clock."""

import math
from collections.abc import Sequence
from functools import partial
from typing import NamedTuple, Self

import numpy as np

from gcs.config import SystemConfig
from gcs.mavlink import px4
from gcs.mavlink.address import Address
from gcs.mission.model import DEFAULT_HOME, Home, Obstacle
from vehicle_sim.autopilot.airframe import Airframe
from vehicle_sim.faults.fault_injector import FaultInjector
from vehicle_sim.mavlink.vehicle import Vehicle
from vehicle_sim.world.obstacle_bodies import MovingObstacles
from vehicle_sim.world.obstacle_bodies import Obstacle as ObstacleBody
from vehicle_sim.world.range_sensor import RangeSensor
from vehicle_sim.world.rotors import IDLE, Four, Rotors
from vehicle_sim.world.sensors import PAYLOAD_UNIT, Measurement, NavigationSensor, SensorNoise
from vehicle_sim.world.truth_log import TruthLog
from vehicle_sim.world.world import World
from vehicle_sim.world.world_state import UavState, WorldState

TRUTH_RATE = 50  # Hz, at least
REST_SPEED = 0.1  # m/s
REST_THRUST = 0.1  # N
_TIME_TOLERANCE = 1e-6  # s: sums of steps are not exact


class _Periods(NamedTuple):
    """Physics steps between onboard steps, rows of the truth, and scans of the range sensors."""

    onboard: int
    row: int
    scan: int


class _Uav:
    """One vehicle with its rotors and sensors."""

    def __init__(self, vehicle: Vehicle, airframe: Airframe, config: SystemConfig, seed: int) -> None:
        noise = config.sensors
        uav_noise = SensorNoise(
            noise.position, math.radians(noise.attitude_deg), noise.uav_velocity, noise.uav_rates
        )  # fmt: skip
        self.vehicle = vehicle
        self._rotors = Rotors(airframe.rotors, airframe.motor_time_constant, 1.0 / config.rates.physics)
        self._sensor = NavigationSensor(uav_noise, seed, vehicle.system_id)
        self.range_sensor = RangeSensor(config.range_sensor, seed, vehicle.system_id)
        self._command: Four = IDLE

    def wrench(self) -> Four:
        """Return thrust and torques of the rotors over the next physics step."""
        return self._rotors.advance(self._command)

    def step(self, state: UavState, payload_sample: Measurement, faults: FaultInjector, now: float) -> None:
        """Measure, relay the payload's sample, and let the autopilot take a step."""
        vehicle, number = self.vehicle, self.vehicle.system_id
        sample = self._sensor.measure(
            now, state.quaternion, state.rates_in_body, state.position_in_world, state.velocity_in_world
        )
        vehicle.relay(faults.payload_sample(number, payload_sample))
        self._command = vehicle.step(faults.own_sample(number, sample), now)
        vehicle.report(faults.reported_sample(number, vehicle.autopilot.state.navigation.reported))

    def scan(self, state: UavState, obstacles: Sequence[ObstacleBody], faults: FaultInjector, now: float) -> None:
        """Scan for obstacles."""
        scan = self.range_sensor.scan(now, state.position_in_world, state.quaternion, obstacles)
        self.vehicle.take_scan(faults.range_sample(self.vehicle.system_id, scan))


class Swarm:
    """The world, N vehicles with their sensors and rotors, the obstacles, and the record of the true state.

    A driver lets time go on with :meth:`advance_to`, hands over what arrives with :meth:`receive`, and sends what
    :meth:`datagrams_to_send` gives, after each of both and whenever :meth:`next_timer` is due. Equal calls give equal
    results to the last bit on one machine.

    Public state, to be read only: ``vehicles`` (of the system ids 1 .. N, in this order), ``world``, ``failsafe`` (the
    team's settings), ``take_off_time`` (s; first release from a cradle, None before).
    """

    def __init__(
        self,
        config: SystemConfig,
        *,
        seed: int,
        home: Home | None = None,
        obstacles: Sequence[Obstacle] = (),
        ground_address: Address | None = None,
        faults: FaultInjector | None = None,
        gui: bool = False,
    ) -> None:
        """``ground_address`` is where the vehicles offer themselves. Raises :class:`SimulationError`."""
        system, rates, noise = config.true_parameters(), config.rates, config.sensors
        self.world = World(system, rates.physics, gui, config.world)
        try:
            self._obstacles = MovingObstacles(self.world.obstacles, obstacles)
        except BaseException:
            self.world.close()
            raise
        self.failsafe = config.flight.failsafe
        self.take_off_time: float | None = None
        self._faults = faults or FaultInjector()
        self._truth: TruthLog | None = None
        self._periods = _Periods(
            rates.physics // rates.onboard, rates.physics // TRUTH_RATE, rates.physics // config.range_sensor.rate
        )
        self._steps = 0
        self._contacts = 0
        self._uavs = []
        for i in range(1, system.number_of_uavs + 1):
            airframe = Airframe.of_system(system, i - 1, config.uav)
            vehicle = Vehicle(
                i, airframe, onboard_rate=rates.onboard, telemetry_rate=rates.telemetry, home=home or DEFAULT_HOME,
                ground_address=ground_address, clock=partial(self._faults.clock, i), autopilot=config.onboard(),
                link=config.vehicle_link,
            )  # fmt: skip
            self._uavs.append(_Uav(vehicle, airframe, config, seed))
        self.vehicles = tuple(uav.vehicle for uav in self._uavs)
        payload_noise = SensorNoise(
            noise.position, math.radians(noise.attitude_deg), noise.payload_velocity, noise.payload_rates
        )
        self._payload_sensor = NavigationSensor(payload_noise, seed, PAYLOAD_UNIT)
        state = self.world.state()
        self._onboard(state)
        self._scan(state)

    @property
    def time(self) -> float:
        """Time of the last physics step (s)."""
        return self.world.time

    def advance_to(self, now: float) -> None:
        """Let the world go on to ``now`` (s): ends with the last physics step before it, measured if it is due."""
        last = math.floor((now + _TIME_TOLERANCE) * self.world.physics_hz)
        while self._steps < last:
            self._step()

    def record(self, truth: TruthLog) -> None:
        """Record the true state from here on, 50 times a second or more. The log is closed with the swarm."""
        self._truth = truth
        truth.write(self.world.state(), self.world.contacts().pairs, self.world.obstacles.all())

    def close(self) -> None:
        """End the world and the record; harmless when they have ended."""
        if self._truth is not None:
            self._truth.close()
        self.world.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def at_rest(self) -> bool:
        """Return True if all vehicles are disarmed, their rotors have run down, and nothing moves any more."""
        if any(vehicle.autopilot.armed for vehicle in self.vehicles):
            return False
        state = self.world.state()
        if any(uav.thrust > REST_THRUST for uav in state.uavs):
            return False
        velocities = [state.payload_velocity_in_world, *(uav.velocity_in_world for uav in state.uavs)]
        return max(math.hypot(*velocity) for velocity in velocities) < REST_SPEED

    # The wire

    def receive(self, vehicle: int, datagram: bytes, sender: Address, now: float) -> None:
        """Take a datagram that came to a vehicle's endpoint; ``vehicle`` is its system id."""
        for arrived, source in self._faults.to_vehicle(vehicle, [(datagram, sender)], now):
            self.vehicles[vehicle - 1].receive(arrived, source, now)

    def datagrams_to_send(self, now: float) -> list[tuple[int, bytes, Address]]:
        """Return all that is due at ``now`` (s): the system id of the vehicle that sends, bytes, address."""
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
        """Return when :meth:`datagrams_to_send` has something to do (s; in the past: at once), None: never."""
        timers = [vehicle.next_timer() for vehicle in self.vehicles]
        timers.append(self._faults.next_timer())
        return min((timer for timer in timers if timer is not None), default=None)

    # Inside

    def _step(self) -> None:
        """Take one physics step."""
        world = self.world
        if self.take_off_time is not None:
            self._obstacles.move((self._steps + 1) / world.physics_hz - self.take_off_time)
        wrenches = [uav.wrench() for uav in self._uavs]
        forces = self._faults.disturb(world, world.time)
        world.step([wrench[0] for wrench in wrenches], [wrench[1:] for wrench in wrenches], *(forces or ()))
        self._steps += 1
        if self._truth is not None:
            self._contacts = max(self._contacts, world.contacts().pairs)
        measures = self._steps % self._periods.onboard == 0
        records = self._steps % self._periods.row == 0 and self._truth is not None
        scans = self._steps % self._periods.scan == 0
        if not (measures or records or scans or self.take_off_time is None):
            return
        state = world.state()
        if self.take_off_time is None and not all(uav.cradled for uav in state.uavs):
            self.take_off_time = state.time
            self._faults.took_off(state.time)
        if measures:
            self._onboard(state)
        if scans:
            self._scan(state)
        if records and self._truth is not None:
            self._truth.write(state, self._contacts, world.obstacles.all())
            self._contacts = 0

    def _onboard(self, state: WorldState) -> None:
        """Measure, and let every autopilot take a step."""
        payload_sample = self._payload_sensor.measure(
            state.time, state.payload_quaternion, state.payload_rates_in_payload, state.payload_position_in_world,
            state.payload_velocity_in_world,
        )  # fmt: skip
        for uav, uav_state in zip(self._uavs, state.uavs, strict=True):
            uav.step(uav_state, payload_sample, self._faults, state.time)
            if self._truth is not None:
                autopilot = uav.vehicle.autopilot
                mode = px4.mode_name(autopilot.mode)
                self._truth.write_mode(
                    state.time, uav.vehicle.system_id, mode, autopilot.armed, autopilot.failsafe
                )  # fmt: skip

    def _scan(self, state: WorldState) -> None:
        """Let every vehicle scan, in a world with obstacles."""
        if self.world.obstacles.all():
            places = np.array([uav_state.position_in_world for uav_state in state.uavs])
            near = self.world.obstacles.near(places, self._uavs[0].range_sensor.reach)
            for uav, uav_state, obstacles in zip(self._uavs, state.uavs, near, strict=True):
                uav.scan(uav_state, obstacles, self._faults, state.time)
