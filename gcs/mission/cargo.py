"""What the grippers of the payload hold in the course of a mission, and what the payload weighs with it."""

from collections.abc import Iterable
from itertools import chain, combinations

from gcs.config import SystemConfig
from gcs.mission.commands import GripperAction
from gcs.mission.route import Gripper


class CargoState:
    """Cargo on board, as it is stated in the system file and as the grippers have been commanded."""

    def __init__(self, system: SystemConfig) -> None:
        self._masses = {cargo.gripper: cargo.mass for cargo in system.cargo}
        self.held = self._stated = frozenset(cargo.gripper for cargo in system.cargo if cargo.loaded)
        """Grippers that hold their cargo."""
        self._stated_mass = system.payload.mass

    @property
    def mass(self) -> float:
        """Mass of the payload with what is held (kg)."""
        return self._mass_with(self.held)

    def mass_of(self, leg: Gripper) -> float:
        """Return the mass of all that a ``leg`` releases or grabs now (kg)."""
        return self._mass_of(self.moved(leg))

    def moved(self, leg: Gripper) -> frozenset[int]:
        """Return the grippers that a ``leg`` opens or closes now."""
        named = frozenset(self._masses if leg.gripper == 0 else (leg.gripper,))
        return named & self.held if leg.action is GripperAction.RELEASE else named - self.held

    def carry_out(self, leg: Gripper) -> None:
        """Take it that the grippers of a ``leg`` did what was commanded."""
        self.held ^= self.moved(leg)

    def undo(self, grippers: Iterable[int]) -> None:
        """Take it that these ``grippers`` did not do what was commanded last."""
        self.held ^= frozenset(grippers)

    def failed(self, moved: Iterable[int], mass: float, bound: float) -> tuple[int, ...]:
        """Return which of the grippers that ``moved`` did not, by the payload's estimated ``mass`` (kg).

        Empty where the mass agrees with all that was commanded better than without any of it, or within its relative
        error ``bound``.
        """
        numbers = sorted(moved)

        def error(failed: tuple[int, ...]) -> float:
            return abs(mass - self._mass_with(self.held ^ frozenset(failed)))

        if error(()) <= bound * self.mass:
            return ()
        return min(chain.from_iterable(combinations(numbers, n) for n in range(len(numbers) + 1)), key=error)

    def _mass_with(self, held: frozenset[int]) -> float:
        return self._stated_mass + (self._mass_of(held - self._stated) - self._mass_of(self._stated - held))

    def _mass_of(self, grippers: Iterable[int]) -> float:
        return sum(self._masses[gripper] for gripper in sorted(grippers))
