"""The systems of a run, and the names of the files that are exported for each."""

from gcs.errors import UnusableInput
from gcs.mavlink.px4 import GROUND_SYSTEM, PAYLOAD_UNIT_SYSTEM

PAYLOAD = "payload"


def file_stem(system: int) -> str:
    """Return the name, without its end, of a system's file."""
    return PAYLOAD if system == PAYLOAD_UNIT_SYSTEM else f"vehicle_{system}"


def is_of_team(system: int) -> bool:
    """Return whether a system id is that of a vehicle or of the payload unit."""
    return system not in (0, GROUND_SYSTEM)


def nothing_recorded(folder: object) -> UnusableInput:
    """Return the error of a run without anything of a vehicle or of the payload."""
    return UnusableInput(f"{folder}: there is nothing of a vehicle or of the payload to export")
