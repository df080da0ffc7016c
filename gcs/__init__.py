"""The ground: telemetry in, set-points out, and the mission in between.

``gcs.fly(mission)`` flies a mission with a simulated swarm in this process; it returns a ``gcs.Flight``.
``gcs.Team`` is a team that takes orders in flight.

Public, with annotations and changed by the rules of semantic versioning only, are the names of ``__all__``, the fixture
``fly_with_faults`` with what docs/faults.md imports for it, the entry points ``cooplift.world``, the commands, and the
files. Whatever else can be imported of ``gcs``, ``vehicle_sim`` and ``idc_controller`` may change in any version.
"""

from typing import TYPE_CHECKING, Any

from gcs.errors import GcsError, OrderRefused, UnusableInput

if TYPE_CHECKING:
    from gcs.app.call import fly
    from gcs.app.flown import Flight
    from gcs.app.team import Team
    from gcs.mission.model import Fault, Limits, Mission
    from gcs.mission.read import read_mission

__all__ = [
    "Fault",
    "Flight",
    "GcsError",
    "Limits",
    "Mission",
    "OrderRefused",
    "Team",
    "UnusableInput",
    "fly",
    "read_mission",
]


def __getattr__(name: str) -> Any:
    """Import what a flight needs when it is first asked for, with the numeric code that the programs choose."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from gcs.app.imports import importing
    from gcs.numerics import choose_kernels

    choose_kernels()  # before numpy is loaded, unless it is already
    with importing():
        from gcs.app import call, team

    return getattr(team if name == "Team" else call, name)
