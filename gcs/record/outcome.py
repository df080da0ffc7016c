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


def outcome_of(
    *, begun: bool, contacts: bool, on_ground: bool, set_down: bool, interrupted: bool, ended_early: bool, arrived: bool
) -> Outcome:
    """Return how a flight ended; of several that hold, the worst for those on the spot counts.

    Args:
        begun: take-off had begun.
        contacts: something touched.
        on_ground: vehicles and payload are known to be on the ground.
        set_down: the payload was set down safely.
        interrupted, ended_early: by the user, by him or by a failsafe.
        arrived: every waypoint and the landing were reached.
    """
    if contacts:
        return Outcome.COLLIDED
    if begun and not on_ground:
        return Outcome.LOST
    if begun and not set_down:
        return Outcome.FAILED
    if interrupted:
        return Outcome.INTERRUPTED
    if ended_early or not begun:
        return Outcome.ABORTED
    return Outcome.COMPLETED if arrived else Outcome.FAILED
