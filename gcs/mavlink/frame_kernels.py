"""Frames of a datagram, compiled: runs of MAVLink 2 frames that are equal but for sequence number and values, records.

A run is of messages of one kind, sender, length and time stamp, unsigned, with consecutive sequence numbers and right
checksums, one behind the other. That is how the points of a scan are sent.
"""

import numpy as np
from numpy.typing import NDArray

from gcs.mavlink.frames import SIGNATURE, SIGNED, V1, V2
from idc_controller.compiled import inlined, kernel

Bytes = NDArray[np.uint8]

HEADER = 10
"""Bytes of a MAVLink 2 frame before the payload."""
AROUND = HEADER + 2
"""Bytes of a frame without signature beside the payload: the checksum is behind it."""
RUN_LIMIT = 256
"""Largest number of messages of a run: as many as there are sequence numbers."""
_SEQUENCE, _STAMP = 4, 4


@inlined
def _checksum(data: Bytes, start: int, end: int, extra: int) -> int:
    """Return the CRC-16/MCRF4XX of ``data[start:end]`` and one byte ``extra``."""
    crc = 0xFFFF
    for i in range(start, end + 1):
        low = (data[i] if i < end else extra) ^ (crc & 0xFF)
        low ^= (low << 4) & 0xFF
        crc = (crc >> 8) ^ (low << 8) ^ (low << 3) ^ (low >> 4)
    return crc


@kernel("int64(uint8[::1], int64, int64)")
def frames_in_run(datagram: Bytes, start: int, extra: int) -> int:
    """Return the number of frames of the run that begins at ``start``; 0: no valid unsigned frame begins there.

    Args:
        datagram: bytes (n,), whatever they are.
        start: position of the marker of a MAVLink 2 frame of at least ten bytes.
        extra: last byte that the checksum covers.
    """
    size, length = datagram.shape[0], datagram[start + 1]
    period, count = length + AROUND, 0
    while count < RUN_LIMIT:
        at = start + count * period
        end = at + period
        if end > size or datagram[at + 2] != 0:
            break
        equal = datagram[at + _SEQUENCE] == (datagram[start + _SEQUENCE] + count) & 0xFF
        for k in range(HEADER + min(_STAMP, length)):
            equal = equal and (k == _SEQUENCE or datagram[at + k] == datagram[start + k])
        if not equal:
            break
        if _checksum(datagram, at + 1, end - 2, extra) != datagram[end - 2] | datagram[end - 1] << 8:
            break
        count += 1
    return count


@kernel("uint8[:, ::1](uint8[::1], uint8[:, ::1], int64)")
def framed_run(header: Bytes, payloads: Bytes, extra: int) -> Bytes:
    """Return the frames (n, length + 12) of payloads of one length (n, length).

    ``header`` (10,) of the first frame; the sequence number rises by one from each to the next. ``extra``: last byte
    that the checksum covers.
    """
    count, length = payloads.shape
    frames = np.empty((count, length + AROUND), np.uint8)
    for i in range(count):
        frame = frames[i]
        frame[:HEADER] = header
        frame[_SEQUENCE] = (header[_SEQUENCE] + i) & 0xFF
        frame[HEADER : HEADER + length] = payloads[i]
        checksum = _checksum(frame, 1, HEADER + length, extra)
        frame[HEADER + length], frame[HEADER + length + 1] = checksum & 0xFF, checksum >> 8
    return frames


@kernel("uint8[::1](uint8[::1], int64[::1], uint8[:, ::1])")
def stamped_frames(data: Bytes, ends: NDArray[np.int64], stamps: Bytes) -> Bytes:
    """Return every frame that :func:`gcs.mavlink.frames.spans` finds in datagrams, each behind its datagram's stamp.

    Bytes that belong to no frame are left out.

    Args:
        data: The datagrams (n,), one behind the other.
        ends: Where in ``data`` each of them ends (k,).
        stamps: Of each of them (k, s).
    """
    all_bytes, width = data.shape[0], stamps.shape[1]
    records, count, at = np.empty(all_bytes + (all_bytes // 8 + 1) * width, np.uint8), 0, 0
    for k in range(ends.shape[0]):
        size = ends[k]
        while at < size:
            end = size + 1
            if data[at] == V2 and at + 2 < size:
                end = at + data[at + 1] + (AROUND + SIGNATURE if data[at + 2] & SIGNED else AROUND)
            elif data[at] == V1 and at + 1 < size:
                end = at + data[at + 1] + 8
            if end > size:
                at += 1
                continue
            records[count : count + width] = stamps[k]
            count += width
            records[count : count + end - at] = data[at:end]
            count += end - at
            at = end
    return records[:count].copy()
