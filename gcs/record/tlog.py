"""``telemetry.tlog``: every MAVLink frame of a flight, both ways, in the form that ground stations share.

A record is a time stamp (microseconds since 1970, 8 bytes, big-endian) and one raw MAVLink frame. Tools that
log several links keep the link's number in the two lowest bits of the time stamp; they are 0 here.
"""

import struct
from collections.abc import Iterator
from pathlib import Path

from gcs.record.append_file import AppendOnlyFile

_STAMP = struct.Struct(">Q")
_MAVLINK_1, _MAVLINK_2 = 0xFE, 0xFD
_SIGNED = 0x01
_SIGNATURE_LENGTH = 13


def frames_in(datagram: bytes) -> Iterator[bytes]:
    """Yield the MAVLink 1 and 2 frames in a datagram, by their length fields: checksums are not verified.

    Bytes that belong to no frame, as a damaged datagram may hold, are left out.
    """
    at, end = 0, len(datagram)
    while at < end:
        magic = datagram[at]
        length = 0
        if magic == _MAVLINK_2 and at + 3 <= end:
            length = 12 + datagram[at + 1] + (_SIGNATURE_LENGTH if datagram[at + 2] & _SIGNED else 0)
        elif magic == _MAVLINK_1 and at + 2 <= end:
            length = 8 + datagram[at + 1]
        if length and at + length <= end:
            yield datagram[at : at + length]
            at += length
        else:
            at += 1


class TelemetryLog(AppendOnlyFile):
    """Writes a tlog; ``start_epoch`` is the wall-clock time (s since 1970, UTC) of flight time 0."""

    def __init__(self, path: Path | str, start_epoch: float) -> None:
        super().__init__(path)
        self._start_us = round(start_epoch * 1e6)

    def write(self, now: float, datagram: bytes) -> None:
        """Record a datagram that was sent or received at flight time ``now`` (s): one record a frame."""
        stamp = _STAMP.pack((self._start_us + round(now * 1e6)) & ~0x3)
        if records := b"".join(stamp + frame for frame in frames_in(datagram)):
            self.append(records)
