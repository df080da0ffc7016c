"""How a flight ended: the one vocabulary of ``summary.json``, of campaigns and of tests."""

from enum import StrEnum


class Outcome(StrEnum):
    """How a flight ended; each is a value of ``outcome``. From good to bad."""

    COMPLETED = "completed"
    """Every waypoint and the landing were reached, and the payload was set down."""
    INTERRUPTED = "interrupted"
    """The user ended it; the payload was set down."""
    ABORTED = "aborted"
    """A failsafe ended it; the payload was set down, or had not lifted off."""
    FAILED = "failed"
    """Anything else: a waypoint or the landing was missed, or the payload was not set down safely."""
    LOST = "lost"
    """The records end without the vehicles being known to be on the ground."""
    COLLIDED = "collided"
    """Parts touched each other, an obstacle or the ground."""
