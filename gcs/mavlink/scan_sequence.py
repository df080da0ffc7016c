"""Completeness of a vehicle's scans, by the sequence numbers of its messages."""

_REMEMBERED = 16
"""Scans of which late messages are recognised."""


class ScanSequence:
    """Detects complete scans: those of which no message can be missing.

    A scan is complete if its first message follows the one before it, of whatever kind, and each the next up to its
    end: then nothing was lost in between.
    """

    def __init__(self) -> None:
        self._begun: dict[int, int] = {}
        """Breaks before the first message of each of the last scans, by stamp."""
        self._complete: int | None = None

    def add(self, stamp: int, is_end: bool, breaks_before: int, breaks: int) -> None:
        """Take a message of a scan, or a run of them.

        Args:
            stamp: the scan's time stamp (ms).
            is_end: whether it is the scan's end; else it holds returns.
            breaks_before: :attr:`gcs.mavlink.link_statistics.LinkStatistics.breaks` before it.
            breaks: the same behind it.
        """
        if stamp not in self._begun:
            self._begun[stamp] = breaks_before
            if len(self._begun) > _REMEMBERED:
                del self._begun[next(iter(self._begun))]
        if is_end and breaks == self._begun[stamp]:
            self._complete = stamp

    def is_complete(self, stamp: int) -> bool:
        """Return whether the scan with a ``stamp`` (ms) is the last complete one."""
        return stamp == self._complete
