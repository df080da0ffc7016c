"""What the engine says after each step, and the true states that follow from it."""

from collections.abc import Sequence

import pybullet

from idc_controller.arrays import Array
from idc_controller.parameters import SystemParameters
from vehicle_sim.world.ground import Pose
from vehicle_sim.world.multibody import Multibody
from vehicle_sim.world.velocity_correction import Uavs, VelocityCorrection


class Readings:
    """What the engine gives after a step, in its own frames.

    Attributes:
        payload: pose of the payload's principal axes.
        uavs: states of the UAVs.
    """

    def __init__(self, client: int, system: Multibody, parameters: SystemParameters, physics_step: float) -> None:
        """Read the state now; ``physics_step`` in s."""
        self._body, self._links, self._client = system.body, system.uavs, client
        self._physics_step = physics_step
        self._correction = VelocityCorrection(system, parameters)
        self.restart()

    def restart(self) -> None:
        """Read a state to which no step has led: what accelerates it is unknown, its velocities are as the engine's."""
        self.update()
        self.update()
        self._step = 0.0

    def update(self) -> None:
        """Read the state after a step.

        Forward kinematics is requested: without it links are one step behind the payload, and so are the frames in
        which the engine takes the next forces. Hence after every step, whether the state is read or not.
        """
        body, client = self._body, self._client
        self.uavs: Uavs = pybullet.getLinkStates(body, self._links, 1, 1, client)
        self.payload: Pose = pybullet.getBasePositionAndOrientation(body, client)
        self._correction.take(self.payload, pybullet.getBaseVelocity(body, client), self.uavs)
        self._states: Array | None = None
        self._step = self._physics_step

    def velocity_changes(self) -> list[list[float]]:
        """Return by how much the velocities of payload and UAVs (N + 1) changed in the last step (m/s, z up)."""
        return self._correction.velocity_changes()

    def states(self) -> Array:
        """Return the true states of payload and UAVs now, (N + 1, 13) as in :mod:`.state_kernels`, to be read only."""
        if self._states is None:
            self._states = self._correction.evaluate(self._step)
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
