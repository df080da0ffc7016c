"""Exit statuses of the commands."""

from enum import IntEnum

from gcs.record.incomplete import INCOMPLETE


class ExitStatus(IntEnum):
    """Exit status of a command."""

    DONE = 0
    """Done, and within limits."""
    OUTSIDE_LIMITS = 1
    """Flown, but outside limits, not arrived, or aborted safely."""
    UNUSABLE_INPUT = 2
    """Nothing was started; the reason is on standard error."""
    INCOMPLETE = INCOMPLETE
    """Flown, but the records are incomplete: whether it was within limits is not known."""
    INTERRUPTED = 130
    """Interrupted by Ctrl-C, SIGTERM or SIGHUP; vehicles landed, records closed."""
