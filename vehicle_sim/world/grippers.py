"""The payload's grippers: what each holds, and the mass of the payload that follows."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from gcs.config.tables import Cargo
from vehicle_sim.world.world import World


class GripperAction(NamedTuple):
    """What a gripper has done on command, for the record."""

    time: float
    """s"""
    gripper: int
    action: str
    """release or grab"""
    mass: float
    """Mass that was released or grabbed (kg); 0: none, it held nothing, or its cargo already, or is stuck."""
    payload_mass: float
    """Mass of the payload after it (kg)."""


class Grippers:
    """Grippers of one payload, which move its cargo; the container and its links stay."""

    def __init__(
        self,
        cargo: Sequence[Cargo],
        world: World,
        mass_factor: float = 1.0,
        is_stuck: Callable[[int, float], bool] = lambda gripper, time: False,
        record: Callable[[GripperAction], None] = lambda action: None,
    ) -> None:
        """Take over the ``world``'s payload, which weighs what it does with all ``cargo`` that is loaded.

        Args:
            cargo: of the system file.
            world: whose payload changes.
            mass_factor: true mass over that of the system file.
            is_stuck: whether a gripper is stuck at a time (s).
            record: takes every action.
        """
        self._masses = {each.gripper: mass_factor * each.mass for each in cargo}
        self._held = {each.gripper: each.loaded for each in cargo}
        self._world, self._is_stuck, self._record = world, is_stuck, record
        self._loaded_at_first = self._loaded()

    @property
    def numbers(self) -> tuple[int, ...]:
        """Numbers of the grippers, as the system file has them."""
        return tuple(self._masses)

    @property
    def is_on_ground(self) -> bool:
        """True if the payload stands on pad or ground."""
        return self._world.all_cradled or self._world.touching_ground()

    @property
    def is_still(self) -> bool:
        """True if no rotor turns."""
        return self._world.rotors_stopped

    def move(self, gripper: int, *, grab: bool) -> None:
        """Let a gripper release its cargo, or ``grab`` it; nothing happens where it has done so, or is stuck."""
        world, moved = self._world, 0.0
        if self._held[gripper] != grab and not self._is_stuck(gripper, world.time):
            self._held[gripper], moved = grab, self._masses[gripper]
            world.add_payload_mass("cargo", self._loaded() - self._loaded_at_first)
        self._record(GripperAction(world.time, gripper, "grab" if grab else "release", moved, world.payload_mass))

    def _loaded(self) -> float:
        return sum(mass for gripper, mass in self._masses.items() if self._held[gripper])
