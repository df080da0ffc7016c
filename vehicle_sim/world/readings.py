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
        self._system, self._client = system, client
        self._correction = VelocityCorrection(system, parameters, physics_step)
        self.update()
        self.restart()

    def restart(self) -> None:
        """Take the velocities as the engine has them: no step has led here, or one with contact.

        An impact is no acceleration by which velocities could be brought forward.
        """
        self._correction.restart(pybullet.getLinkStates(self._system.body, self._system.links, 1, 1, self._client))

    def update(self) -> None:
        """Read the state after a step.

        Forward kinematics is requested: without it links are one step behind the payload, and so are the frames in
        which the engine takes the next forces. Hence after every step, whether the state is read or not.
        """
        body, client = self._system.body, self._client
        self.uavs: Uavs = pybullet.getLinkStates(body, self._system.uavs, 1, 1, client)
        self.payload: Pose = pybullet.getBasePositionAndOrientation(body, client)
        self._correction.take(self.payload, pybullet.getBaseVelocity(body, client), self.uavs)

    def velocity_changes(self) -> list[list[float]]:
        """Return by how much the velocities of payload and UAVs (N + 1) changed in the last step (m/s, z up)."""
        return self._correction.velocity_changes()

    def link_tensions(self, thrusts: Sequence[float], external: Sequence[Sequence[float]] | None) -> list[float]:
        """Return the tension of each link in the last step (N) (N): see :class:`VelocityCorrection`."""
        return self._correction.link_tensions(thrusts, external)

    def states(self) -> Array:
        """Return the true states of payload and UAVs now, (N + 1, 13) as in :mod:`.state_kernels`, to be read only."""
        return self._correction.states

    def loads(self) -> Array:
        """Return the loads on payload and UAVs that the next step lacks, (N + 1, 6) as in :mod:`.state_kernels`.

        They hold while nothing but the links acts on a part by contact; to be used at once.
        """
        return self._correction.loads

    def set_payload_moments(self, moments: Sequence[float]) -> None:
        """Set the payload's principal moments of inertia (3,) (kg m2), from the next reading on."""
        self._correction.set_payload_moments(moments)
