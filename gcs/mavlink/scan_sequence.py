"""Completeness of a vehicle's scans, by the sequence numbers of its messages."""

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.messages import Received

RETURNS, SCAN_END = mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D, mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE
"""The messages of a scan: its returns, one OBSTACLE_DISTANCE_3D each, and the OBSTACLE_DISTANCE behind them."""
_STAMP_BYTES = 8
_REMEMBERED = 16
"""Scans of which late messages are recognised."""


def scan_stamp(received: Received) -> int:
    """Return the time stamp (ms) of a message of a scan, or a run of them; OBSTACLE_DISTANCE has microseconds."""
    if received.layout.message_id == SCAN_END:
        return int.from_bytes(received.payload[:_STAMP_BYTES], "little") // 1000 & 0xFFFFFFFF
    return received.time_boot_ms


class ScanSequence:
    """Tells scans of which all messages have come from those of which some may be missing.

    A scan is complete if its first message follows the one before it, of whatever kind, and each the next up to its
    end: then nothing was lost in between.
    """

    def __init__(self) -> None:
        self._begun: dict[int, int] = {}
        """Breaks before the first message of each of the last scans, by stamp."""
        self._complete: int | None = None

    def add(self, received: Received, breaks_before: int, breaks: int) -> None:
        """Take a message of a scan, or a run of them.

        Args:
            received: the message.
            breaks_before: :attr:`gcs.mavlink.link_statistics.LinkStatistics.breaks` before it.
            breaks: the same behind it.
        """
        stamp = scan_stamp(received)
        if stamp not in self._begun:
            self._begun[stamp] = breaks_before
            if len(self._begun) > _REMEMBERED:
                del self._begun[next(iter(self._begun))]
        if received.layout.message_id == SCAN_END and breaks == self._begun[stamp]:
            self._complete = stamp

    def is_complete(self, stamp: int) -> bool:
        """Return whether the scan with a ``stamp`` (ms) is the last complete one."""
        return stamp == self._complete
