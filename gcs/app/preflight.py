"""Preflight check of a mission, the same for ``gcs check`` and ``gcs fly``: can it be flown as it is written?"""

from dataclasses import dataclass

from gcs.config.validate import UnusableFile
from gcs.flight.curve_limits import check_curve
from gcs.mission.model import Mission
from gcs.mission.plausibility import implausible
from gcs.mission.route_clearance import is_clear, standing_obstacles


@dataclass(frozen=True)
class PreflightNotes:
    """What there is to say of a mission that can be flown, one line each."""

    ways: tuple[str, ...] = ()
    """Legs that lead round what is on the map, with the length of the way."""
    notes: tuple[str, ...] = ()

    @property
    def lines(self) -> tuple[str, ...]:
        """All of it."""
        return (*self.ways, *self.notes)


def preflight(mission: Mission) -> PreflightNotes:
    """Return what is in the way of ``mission``. Raises :class:`UnusableInput` if it cannot be flown."""
    check_curve(mission)
    notes = implausible(mission)
    standing = standing_obstacles(mission)
    if is_clear(mission, standing):
        return PreflightNotes(notes=tuple(notes))
    from gcs.flight.feasibility import feasibility  # takes long to import, spent only where something is near

    found = feasibility(mission, standing)
    if found.problems:
        raise UnusableFile([f"{mission.path}: {problem}" for problem in found.problems])
    return PreflightNotes(tuple(map(str, found.ways)), (*found.notes, *notes))
