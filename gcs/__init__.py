"""The ground: telemetry in, set-points out, and the mission in between.

``gcs.fly(mission)`` flies a mission with a simulated swarm in this process; it returns a ``gcs.Flight``.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gcs.app.call import fly
    from gcs.app.flown import Flight

__all__ = ["Flight", "fly"]


def __getattr__(name: str) -> Any:
    """Import what a flight needs when it is first asked for, with the numeric code that the programs choose."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from gcs.app.imports import importing
    from gcs.numerics import choose_kernels

    choose_kernels()  # before numpy is loaded, unless it is already
    with importing():
        from gcs.app import call

    return getattr(call, name)
