"""The world: payload, links and UAVs in PyBullet, with ground, pad, cradles and obstacles.

All that crosses this boundary is SI, north-east-down, forward-right-down, quaternions w first.
"""

import math
from collections.abc import Sequence

import pybullet

from gcs.config.tables import PAYLOAD_MASS_MIN, WorldConfig
from idc_controller.arrays import Array
from idc_controller.parameters import SystemParameters
from idc_controller.rotations_float import Quaternion, Vector
from vehicle_sim.world.engine import EngineWorld
from vehicle_sim.world.ground import NO_CONTACTS, ContactDetector, Contacts, Cradles, Ground
from vehicle_sim.world.multibody import check_supported, load_multibody
from vehicle_sim.world.obstacle_bodies import ObstacleBodies
from vehicle_sim.world.readings import Readings
from vehicle_sim.world.world_state import UavState, WorldState, flipped

_ORIGIN = (0.0, 0.0, 0.0)
_LINK_FRAME, _WORLD_FRAME = pybullet.LINK_FRAME, pybullet.WORLD_FRAME
_apply_force, _apply_torque = pybullet.applyExternalForce, pybullet.applyExternalTorque
_step_simulation = pybullet.stepSimulation


class World(EngineWorld):
    """One simulated world; several may live in one process. Use it as a context manager or call :meth:`close`.

    At the start the payload stands on a pad at the origin, level, links upright, each UAV on top of its link in a
    cradle. A cradle releases its UAV when the thrust lifts more than the UAV's own weight, and latches again, where
    the UAV is then, once the payload stands on pad or ground, or hangs low on the links of UAVs that are held, and the
    UAV is slow and no longer lifts its weight.

    ``physics_hz`` steps a second, ``steps`` so far; ``obstacles`` may be added and moved. Equal calls give equal
    results to the last bit on one machine.
    Raises :class:`~vehicle_sim.world.errors.UnsupportedWorld` for a system that the engine would compute wrongly.
    """

    def __init__(
        self,
        parameters: SystemParameters,
        physics_hz: int = 500,
        gui: bool = False,
        settings: WorldConfig = WorldConfig(),
    ) -> None:
        check_supported(parameters)
        super().__init__(physics_hz, parameters.g, gui)
        self.parameters = parameters
        self.payload_mass = parameters.m_0
        """Mass of the payload now (kg)."""
        self._added_masses: dict[str, float] = {}
        self._rest = settings.rest
        try:
            self._build(settings)
        except BaseException:
            self.close()
            raise

    def _build(self, settings: WorldConfig) -> None:
        parameters, client = self.parameters, self._client
        self._ground = Ground(client, parameters.payload, settings.pad)
        place = (0.0, 0.0, settings.pad.thickness + parameters.payload.below)
        self._system = load_multibody(client, parameters, place, settings.bodies)
        self.obstacles = ObstacleBodies(client)
        weights = [float(m_i) * parameters.g for m_i in parameters.m]
        self._cradles = Cradles(client, self._system.body, self._system.uavs, weights, settings.cradles)
        self._readings = Readings(client, self._system, parameters, 1.0 / self.physics_hz)
        self.thrusts = (0.0,) * parameters.number_of_uavs
        """The UAVs' thrusts of the last step (N)."""
        self._uav_forces: Sequence[Sequence[float]] | None = None
        """External forces of the last step on the UAVs."""
        self._contacts = ContactDetector(
            parameters, settings, self._system, self._ground, self.obstacles, self._readings
        )
        for i, uav in enumerate(self._readings.uavs):
            self._cradles.latch(i, uav[0], uav[1])

    @property
    def at_rest(self) -> bool:
        """Return True if the rotors have run down and nothing moves any more."""
        if not self.rotors_stopped:
            return False
        state = self.state()
        velocities = [state.payload_velocity_in_world, *(uav.velocity_in_world for uav in state.uavs)]
        return max(math.hypot(*velocity) for velocity in velocities) < self._rest.speed

    @property
    def rotors_stopped(self) -> bool:
        """Return True if the rotors have run down."""
        return max(self.thrusts) <= self._rest.thrust

    def step(
        self,
        thrusts: Sequence[float],
        torques: Sequence[Sequence[float]],
        payload_force: Sequence[float] | None = None,
        uav_forces: Sequence[Sequence[float]] | None = None,
    ) -> None:
        """Advance by one physics step, everything held over it.

        ``thrusts`` N numbers (N) along -z of the UAVs; ``torques`` N triples in the UAVs' frames (N m);
        ``payload_force`` (3,) and ``uav_forces`` N triples: external forces at the centres of mass, NED (N); without
        effect while all UAVs are in their cradles. Plain floats are faster than arrays.

        Inputs sampled at the beginning of a step give a motion of second order in the step: the engine integrates as
        a leapfrog, with velocities at the middles of the steps, which :meth:`state` brings forward. What it computes
        with velocities half a step old is corrected while nothing touches and no cradle holds.
        """
        client, body, uavs = self._client, self._system.body, self._system.uavs
        if not len(uavs) == len(thrusts) == len(torques):
            raise ValueError(f"{len(thrusts)} thrusts and {len(torques)} torques for {len(uavs)} UAVs")
        # The height of a UAV, which is at hand, says mostly that no cradle has anything to do.
        if self._cradles.number_held or self._readings.uavs[0][0][2] <= self._ground.standing_height + self._system.arm:
            self._update_cradles(thrusts)
        (_, _, _, *torque), *loads = self._readings.loads.tolist()
        _apply_torque(body, -1, torque, _LINK_FRAME, client)
        for uav, thrust, (x, y, z), (f_x, f_y, f_z, t_x, t_y, t_z) in zip(uavs, thrusts, torques, loads, strict=True):
            _apply_force(body, uav, (f_x, f_y, thrust + f_z), _ORIGIN, _LINK_FRAME, client)
            _apply_torque(body, uav, (t_x + x, t_y - y, t_z - z), _LINK_FRAME, client)
        if (payload_force is not None or uav_forces is not None) and not self.all_cradled:
            # A payload between held links hangs as much as it stands: wind would swing what the ground should hold.
            self._push(payload_force, uav_forces)
        _step_simulation(client)
        self.steps += 1
        self.thrusts, self._uav_forces = tuple(thrusts), uav_forces
        self._readings.update()
        if self._cradles.number_held or self.contacts() is not NO_CONTACTS:
            self._readings.restart()

    def _push(self, payload_force: Sequence[float] | None, uav_forces: Sequence[Sequence[float]] | None) -> None:
        """Let external forces act over the next step."""
        client, body, readings = self._client, self._system.body, self._readings
        if uav_forces is not None:
            for uav, force, state in zip(self._system.uavs, uav_forces, readings.uavs, strict=True):
                pybullet.applyExternalForce(body, uav, flipped(force), state[0], _WORLD_FRAME, client)
        if payload_force is not None:
            place = readings.payload[0]
            pybullet.applyExternalForce(body, -1, flipped(payload_force), place, _WORLD_FRAME, client)

    def add_payload_mass(self, source: str, mass: float) -> None:
        """Add ``mass`` (kg, may be negative) to the payload's, in place of what ``source`` added before.

        From the next step on; a payload is never lighter than :data:`.PAYLOAD_MASS_MIN`.
        """
        self._added_masses[source] = mass
        self.set_payload_mass(max(self.parameters.m_0 + sum(self._added_masses.values()), PAYLOAD_MASS_MIN))

    def set_payload_mass(self, mass: float) -> None:
        """Make the payload weigh ``mass`` (kg) from the next step on; its inertia changes in proportion."""
        parameters, client, body = self.parameters, self._client, self._system.body
        self.payload_mass = mass
        share = mass / parameters.m_0
        pybullet.changeDynamics(body, -1, mass=mass, physicsClientId=client)
        # After the mass: with that alone the engine takes the inertia of the collision shape's box.
        inertia = tuple(share * moment for moment in self._system.payload_moments)
        pybullet.changeDynamics(body, -1, localInertiaDiagonal=inertia, physicsClientId=client)
        self._readings.set_payload_moments(inertia)

    def states(self) -> Array:
        """Return the true states of payload and UAVs after the last step, (N + 1, 13) as in :mod:`.state_kernels`."""
        return self._readings.states

    def link_tensions(self) -> list[float]:
        """Return the tension of each link over the last step (N) (N); negative: compression.

        By Newton's law on its UAV. nan where that is not known: a cradle holds the UAV, or anything touches but the
        payload the ground.
        """
        if self.contacts().pairs:
            return [math.nan] * len(self.thrusts)
        tensions, cradles = self._readings.link_tensions(self.thrusts, self._uav_forces), self._cradles
        if not cradles.number_held:
            return tensions
        return [math.nan if cradles.held(i) else tension for i, tension in enumerate(tensions)]

    def state(self, states: Array | None = None) -> WorldState:
        """Return the true state after the last step: velocities, too, to second order.

        ``states`` as :meth:`states` gave them after this step, where they are at hand.
        """
        rows = self.states() if states is None else states
        (position, quaternion, velocity, rates), *uavs = map(_parts, rows.tolist())
        held = self._cradles.held
        return WorldState(
            self.steps / self.physics_hz, position, quaternion, velocity, rates,
            tuple(UavState(*parts, self.thrusts[i], held(i)) for i, parts in enumerate(uavs)),
        )  # fmt: skip

    @property
    def all_cradled(self) -> bool:
        """Return True if every UAV is held by its cradle."""
        return self._cradles.all_held

    @property
    def any_lifted(self) -> bool:
        """Return True if a UAV has left its cradle."""
        return not self.all_cradled

    def contacts(self) -> Contacts:
        """Return what touches after the last step, computed once a step."""
        return self._contacts.after(self.steps, self.physics_hz)

    def clipped(self) -> Sequence[int]:
        """Return whose accelerometer exceeded its range in the last step: 0 the payload's, 1 .. N the UAVs'.

        Without contact, thrust and links accelerate nothing by so much.
        """
        if self.contacts() is NO_CONTACTS:
            return ()
        return self._readings.clipped()

    def touching_ground(self) -> bool:
        """Return True if the payload stands on pad or ground."""
        return self._is_low and (self._cradles.payload_held or self.contacts().standing)

    @property
    def _is_low(self) -> bool:
        """Return True if the payload is low enough to stand on pad or ground."""
        return self._readings.payload[0][2] <= self._ground.standing_height

    def _update_cradles(self, thrusts: Sequence[float]) -> None:
        """Release and latch."""
        cradles, uavs = self._cradles, self._readings.uavs
        for i in cradles.due(thrusts, uavs):
            if cradles.held(i):
                cradles.release(i)
            # A payload that has been caught by some hangs on their links as well.
            elif self._is_low and (cradles.number_held > 0 or self.touching_ground()):
                cradles.latch(i, uavs[i][0], uavs[i][1])
        if cradles.all_held and not cradles.payload_held and self.touching_ground() and self._payload_rests:
            cradles.latch_payload(*self._readings.payload)

    @property
    def _payload_rests(self) -> bool:
        """Return True if no point of the payload is faster than what a cradle catches."""
        *velocity, p, q, r = self._readings.states[0, 7:].tolist()
        return self._cradles.catches(math.hypot(*velocity) + self.parameters.payload.reach * math.hypot(p, q, r))


def _parts(row: list[float]) -> tuple[Vector, Quaternion, Vector, Vector]:
    """Return position, attitude, velocity and rates of a row of a state."""
    x, y, z, q_w, q_x, q_y, q_z, v_x, v_y, v_z, p, q, r = row
    return (x, y, z), (q_w, q_x, q_y, q_z), (v_x, v_y, v_z), (p, q, r)
