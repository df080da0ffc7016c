"""Preflight check of a mission, the same for ``gcs check`` and ``gcs fly``: can it be flown as it is written?"""

from gcs.config.validate import UnusableFile
from gcs.flight.feasibility import Feasibility, check_curve, feasibility
from gcs.mission.model import Mission
from gcs.mission.plausibility import implausible
from gcs.mission.route_clearance import is_clear, standing_obstacles


def preflight(mission: Mission) -> Feasibility:
    """Return what is in the way of ``mission``. Raises :class:`UnusableInput` if it cannot be flown."""
    check_curve(mission)
    notes = implausible(mission)
    standing = standing_obstacles(mission)
    found = Feasibility() if is_clear(mission, standing) else feasibility(mission, standing)
    if found.problems:
        raise UnusableFile([f"{mission.path}: {problem}" for problem in found.problems])
    found.notes += notes
    return found
