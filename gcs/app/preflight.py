"""Preflight check of a mission, the same for ``gcs check`` and ``gcs fly``: can it be flown as it is written?"""

from gcs.config.validate import UnusableFile
from gcs.flight.feasibility import Feasibility, feasibility
from gcs.flight.mission_trajectory import check_curve
from gcs.mission.model import Mission


def preflight(mission: Mission) -> Feasibility:
    """Return what is in the way of ``mission``. Raises :class:`UnusableInput` if it cannot be flown."""
    check_curve(mission)
    found = feasibility(mission)
    if found.problems:
        raise UnusableFile([f"{mission.path}: {problem}" for problem in found.problems])
    return found
