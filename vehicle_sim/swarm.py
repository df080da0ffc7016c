"""The swarm: the world, and the vehicles in it, as one object without a socket or a clock."""

import math
from collections.abc import Sequence
from typing import Self

from gcs.config import SystemConfig
from gcs.mavlink import px4
from gcs.mavlink.address import Address
from gcs.mission.model import DEFAULT_HOME, Home, Obstacle
from idc_controller.arrays import Array
from vehicle_sim.autopilot.airframe import Airframe
from vehicle_sim.autopilot.free.settings import free_settings
from vehicle_sim.autopilot.onboard_arrays import OnboardArrays
from vehicle_sim.faults.disturbances import Disturbances
from vehicle_sim.faults.phases import VehicleState
from vehicle_sim.mavlink.payload_unit import PayloadUnit
from vehicle_sim.mavlink.vehicle import Vehicle
from vehicle_sim.team import Team
from vehicle_sim.world.free_world import FreeWorld
from vehicle_sim.world.grippers import GripperAction, Grippers
from vehicle_sim.world.obstacle_bodies import MovingObstacles
from vehicle_sim.world.rotors import Rotors, Wrenches
from vehicle_sim.world.truth_log import TruthLog
from vehicle_sim.world.world import World

_TIME_TOLERANCE = 1e-6  # s: sums of steps are not exact


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
        sdk_address: Address | None = None,
        faults: Disturbances | None = None,
        gui: bool = False,
        free: bool = False,
    ) -> None:
        """Open the world, or raise :class:`SimulationError`.

        ``ground_address``: the port of ground stations, to which all vehicles send their streams; ``sdk_address``: the
        port of an SDK, to which vehicle 1 sends them, the others to those that follow. ``free``: the vehicles of the
        team have no payload, and fly each by itself.
        """
        rates, onboard = config.rates, config.onboard()
        self.world: World | FreeWorld
        self._faults = faults or Disturbances()
        unit = None
        if free:
            self.world = FreeWorld(config.uav, config.team.vehicles, rates.physics, gui, config.world)
            airframes = [Airframe.of_config(config.uav)] * config.team.vehicles
            onboard = free_settings(onboard)
        else:
            system = config.true_parameters()
            self.world = World(system, rates.physics, gui, config.world)
            factor = config.world.payload_mass_factor
            grippers = Grippers(config.cargo, self.world, factor, self._faults.is_stuck, self._record_cargo)
            unit = PayloadUnit(grippers, lambda: any(vehicle.autopilot.armed for vehicle in self.vehicles))
            airframes = [Airframe.of_system(system, i, config.uav) for i in range(system.number_of_uavs)]
        try:
            self._obstacles = MovingObstacles(self.world.obstacles, obstacles)
        except BaseException:
            self.world.close()
            raise
        self.failsafe = config.flight.failsafe
        self.take_off_time: float | None = None
        self._truth: TruthLog | None = None
        self._periods = [rates.physics // rate for rate in (rates.onboard, rates.truth, config.range_sensor.rate)]
        """Physics steps between onboard steps, rows of the truth, and scans of the range sensors."""
        self._contacts = 0
        noise = math.radians(config.sensors.attitude_deg)
        arrays = OnboardArrays.of(airframes, onboard.land_detector, noise, onboard.navigation)
        self.vehicles = tuple(
            Vehicle(
                i, airframe, onboard_rate=rates.onboard, telemetry_rate=rates.telemetry, home=home or DEFAULT_HOME,
                clients=_clients(i, ground_address, sdk_address), clock=self._faults.clock_of(i), autopilot=onboard,
                link=config.vehicle_link, arrays=arrays.of_vehicle(i - 1), free=free, unit=unit,
            )
            for i, airframe in enumerate(airframes, start=1)
        )  # fmt: skip
        rotors = Rotors(
            [airframe.rotors for airframe in airframes], [airframe.motor_time_constant for airframe in airframes],
            1.0 / rates.physics, self._periods[0],
        )  # fmt: skip
        self._team = Team(self.vehicles, arrays, rotors, config, seed, self._faults, free=free)
        self._modes_recorded = False
        self._wrenches: Wrenches = [], []
        """Of the physics steps between the last and the next onboard step."""
        self._onboard(self.world.states())
        self._team.relay()
        if self.world.obstacles.all():
            self._team.scan(self.world.state(), self.world.obstacles)

    @property
    def time(self) -> float:
        """Time of the last physics step (s)."""
        return self.world.time

    def advance_to(self, now: float) -> None:
        """Let the world go on to ``now`` (s): ends with the last physics step before it, measured if it is due."""
        last = math.floor((now + _TIME_TOLERANCE) * self.world.physics_hz)
        while self.world.steps < last:
            self._step()
        self._team.relay()

    def record(self, truth: TruthLog) -> None:
        """Record the true state from here on, at ``rates.truth`` or more often. The log is closed with the swarm."""
        self._truth = truth
        self._modes_recorded = False
        self._contacts = self.world.contacts().pairs
        self._write_truth(truth, self.world.states(), begins=True)

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
        return self.world.at_rest and not any(vehicle.autopilot.armed for vehicle in self.vehicles)

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
            leaving = vehicle.datagrams_to_send(now)
            # Who only listens takes nothing from the link to the ground, and has no part in its faults.
            if listeners := vehicle.listeners:
                out += [(i, *datagram) for datagram in leaving if datagram[1] in listeners]
                leaving = [datagram for datagram in leaving if datagram[1] not in listeners]
            out += [(i, *datagram) for datagram in faults.from_vehicle(i, leaving, now)]
        return out

    def next_timer(self) -> float | None:
        """Return when :meth:`datagrams_to_send` has something to do (s; in the past: at once), None: never."""
        timers = [vehicle.next_timer() for vehicle in self.vehicles]
        timers.append(self._faults.next_timer())
        return min([timer for timer in timers if timer is not None], default=None)

    # Inside

    def _step(self) -> None:
        """Take one physics step."""
        world, (onboard, row, scan) = self.world, self._periods
        if self._obstacles.any_moves and self.take_off_time is not None:
            self._obstacles.move((world.steps + 1) / world.physics_hz - self.take_off_time)
        thrusts, torques = self._wrenches
        k = world.steps % onboard
        if self._faults.of_world:
            world.step(thrusts[k], torques[k], *(self._faults.disturb(world, world.time) or ()))
        else:
            world.step(thrusts[k], torques[k])
        self._contacts = max(self._contacts, world.contacts().pairs)
        if exceeded := world.clipped():
            self._team.clipped(exceeded)
        if self.take_off_time is None and world.any_lifted:
            self.take_off_time = world.time
            self._faults.took_off(world.time)
        steps = world.steps
        measures = steps % onboard == 0
        scans = steps % scan == 0 and bool(world.obstacles.all())
        records = steps % row == 0 and self._truth is not None
        if not (measures or scans or records):
            return
        states = world.states()
        if measures:
            self._onboard(states)
        if scans:
            self._team.scan(world.state(states), world.obstacles)
        if records and self._truth is not None:
            self._write_truth(self._truth, states)

    def _write_truth(self, truth: TruthLog, states: Array, *, begins: bool = False) -> None:
        """Record the true ``states`` with the most contacts at a time since the last row; standing obstacles once."""
        obstacles = self.world.obstacles.all() if begins else self._obstacles.moving()
        truth.write(self.world.time, states, self.world.thrusts, self._contacts, obstacles)
        if isinstance(self.world, World) and self.world.any_lifted:  # cradles bear what is not known
            truth.write_tensions(self.world.time, self.world.link_tensions())
        self._contacts = 0

    def _record_cargo(self, action: GripperAction) -> None:
        if self._truth is not None:
            self._truth.write_cargo(action)

    def _onboard(self, states: Array) -> None:
        """Let all vehicles take an onboard step, and record what they fly where it changes."""
        now = self.world.time
        if isinstance(self.world, FreeWorld):
            self._team.feel(self.world.specific_forces(), now)
        changed = self._team.step(states, now)
        self._wrenches = self._team.wrenches()
        if self._faults.awaits_phase and isinstance(self.world, World):
            self._faults.observe(now, [_state_of(vehicle) for vehicle in self.vehicles], self.world)
        if self._truth is None or (self._modes_recorded and not changed):
            return
        self._modes_recorded = True
        for vehicle in self.vehicles:
            autopilot = vehicle.autopilot
            mode = px4.mode_name(autopilot.mode)
            self._truth.write_mode(now, vehicle.system_id, mode, autopilot.armed, autopilot.failsafe)


def _state_of(vehicle: Vehicle) -> VehicleState:
    """Return what of a vehicle says in which phase the flight is."""
    state = vehicle.autopilot.state
    return VehicleState(state.armed, state.actuation.thrust > 0.0, state.hold is not None)


def _clients(vehicle: int, ground: Address | None, sdk: Address | None) -> dict[Address, bool]:
    """Return the ports of clients to which a vehicle sends, and whether it sends the payload unit's messages there.

    All vehicles send to the ground stations' port: the first of them forwards the payload unit's messages, so that they
    come once.
    """
    clients: dict[Address, bool] = {}
    if sdk is not None:
        clients[sdk[0], sdk[1] + vehicle - 1] = True
    if ground is not None:
        clients[ground] = vehicle == 1
    return clients
