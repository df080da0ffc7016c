"""The one splitter of datagrams into MAVLink frames, by their length fields: checksums are not verified."""

import re

import numpy as np
from numpy.typing import NDArray

V1, V2 = 0xFE, 0xFD
"""First byte of a frame of MAVLink 1 and 2."""
SIGNED = 0x01
"""Incompatibility flag of a frame with a signature."""
SIGNATURE = 13
"""Bytes of a signature, at the end of a frame."""

HEADER = 10
"""Bytes of a MAVLink 2 frame before the payload."""
CHECKSUM = 2
"""Bytes of the checksum behind the payload."""
AROUND = HEADER + CHECKSUM
"""Bytes of a MAVLink 2 frame without signature beside the payload."""
_MARKER = re.compile(b"[%c%c]" % (V2, V1))


def end_of_frame(datagram: bytes | NDArray[np.uint8], start: int, size: int) -> int:
    """Return the end of the frame that begins at ``start`` of ``datagram[:size]``; 0: no whole frame begins there.

    The kernels of :mod:`gcs.mavlink.frame_kernels` call it compiled, on an array of bytes.
    """
    end = 0
    if datagram[start] == V2 and start + 2 < size:
        end = start + datagram[start + 1] + (AROUND + SIGNATURE if datagram[start + 2] & SIGNED else AROUND)
    elif datagram[start] == V1 and start + 1 < size:
        end = start + datagram[start + 1] + 8
    return end if end <= size else 0


def spans(datagram: bytes) -> list[tuple[int, int]]:
    """Return start and end of every frame in order; bytes before, between and behind them are skipped."""
    found = []
    at, size = 0, len(datagram)
    while at < size:
        if end := end_of_frame(datagram, at, size):
            found.append((at, end))
            at = end
        else:
            marker = _MARKER.search(datagram, at + 1)
            at = size if marker is None else marker.start()
    return found
