"""The errors of the ground station; the command line turns them into one line and an exit code."""


class GcsError(Exception):
    """Root of every error raised by ``gcs``."""


class UnwritableRecord(GcsError):
    """A record of what has been done cannot be written: exit code 3."""


class OrderRefused(GcsError):
    """An order to a team that cannot be carried out now; ``str(error)`` says why."""


class UnusableInput(GcsError):
    """A mission, configuration or argument that cannot be used: exit code 2.

    ``str(error)`` is one line: file, line or item, field, reason; ``reasons`` are all that were found, a line each.
    """

    reasons: tuple[str, ...]

    def __init__(self, *reasons: str) -> None:
        super().__init__(*reasons[:1])
        self.reasons = reasons
