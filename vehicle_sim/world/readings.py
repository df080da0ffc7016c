"""What the engine says after each step, and the true states that follow from it."""

from collections.abc import Sequence

import pybullet

from idc_controller.arrays import Array
from idc_controller.parameters import SystemParameters
from idc_controller.rotations_float import Vector
from vehicle_sim.world.ground import Pose
from vehicle_sim.world.multibody import Multibody
from vehicle_sim.world.velocity_correction import Uavs, Velocity, VelocityCorrection


class Readings:
    """What the engine gives after a step, in its own frames, and its velocities of the step before."""

    def __init__(self, client: int, system: Multibody, parameters: SystemParameters, physics_step: float) -> None:
        """Read the state now; ``physics_step`` in s."""
        self._body, self._links, self._client = system.body, system.uavs, client
        self._correction = VelocityCorrection(system, parameters, physics_step)
        self.uavs: Uavs = ()
        self._velocity: Velocity = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        self._before: tuple[Velocity, Uavs] = self._velocity, self.uavs
        self._payload: Pose | None = None
        self._states: Array | None = None
        self._was_stepped = False
        self.restart()

    def restart(self) -> None:
        """Read a state to which no step has led: what accelerates it is unknown, its velocities are as the engine's."""
        self.update()
        self._before, self._was_stepped = (self._velocity, self.uavs), False

    def update(self) -> None:
        """Read the state after a step.

        Forward kinematics is requested: without it links are one step behind the payload, and so are the frames in
        which the engine takes the next forces. Hence after every step, whether the state is read or not.
        """
        self._before = self._velocity, self.uavs
        self.uavs = pybullet.getLinkStates(self._body, self._links, 1, 1, self._client)
        self._velocity = pybullet.getBaseVelocity(self._body, self._client)
        self._payload = self._states = None
        self._was_stepped = True

    @property
    def payload(self) -> Pose:
        """Pose of the payload's principal axes, read where it is needed."""
        if self._payload is None:
            self._payload = pybullet.getBasePositionAndOrientation(self._body, self._client)
        return self._payload

    def velocity_changes(self) -> list[Vector]:
        """Return by how much the velocities of payload and UAVs (N + 1) changed in the last step (m/s, z up)."""
        (velocity, _), uavs = self._before
        now: list[Sequence[float]] = [self._velocity[0], *(uav[6] for uav in self.uavs)]
        before: list[Sequence[float]] = [velocity, *(uav[6] for uav in uavs)]
        return [(a - d, b - e, c - f) for (a, b, c), (d, e, f) in zip(now, before, strict=True)]

    def states(self) -> Array:
        """Return the true states of payload and UAVs now, (N + 1, 13) as in :mod:`.state_kernels`, to be read only."""
        if self._states is None:
            self._states = self._correction.evaluate(
                self.payload, self._velocity, self.uavs, self._before, self._was_stepped
            )
        return self._states

    def loads(self) -> Array:
        """Return the loads on payload and UAVs that the next step lacks, (N + 1, 6) as in :mod:`.state_kernels`.

        They hold while nothing but the links acts on a part by contact; to be used at once.
        """
        self.states()
        return self._correction.loads

    def set_payload_moments(self, moments: Sequence[float]) -> None:
        """Set the payload's principal moments of inertia (3,) (kg m2), from the next step on."""
        self._correction.set_payload_moments(moments)
        self._states = None
