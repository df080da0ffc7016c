"""Frames of a datagram, compiled: the messages in it, runs of messages, records.

A run is of messages of one kind, sender, length and time stamp in MAVLink 2, unsigned, with consecutive sequence
numbers and right checksums, one behind the other. That is how the points of a scan are sent.
"""

import numpy as np
from numpy.typing import NDArray

from gcs.mavlink.frames import AROUND, CHECKSUM, HEADER, SIGNED, V1, V2, end_of_frame
from idc_controller.arrays import Cells1, Cells2, Indices1, Indices2
from idc_controller.compiled import inlined, kernel

Bytes = NDArray[np.uint8]
Rows = NDArray[np.int64]

RUN_LIMIT = 256
"""Largest number of messages of a run: as many as there are sequence numbers."""
_SEQUENCE, _STAMP = 4, 4
_MICROSECONDS = 8
"""Bytes of a message's stamp in microseconds."""
STAMP_BYTES = 8
"""Bytes of the stamp of a record."""
_end_of_frame = inlined(end_of_frame)


@inlined
def _checksum(data: Bytes, start: int, end: int, extra: int) -> int:
    """Return the CRC-16/MCRF4XX of ``data[start:end]`` and one byte ``extra``."""
    crc = 0xFFFF
    for i in range(start, end + 1):
        low = (data[i] if i < end else extra) ^ (crc & 0xFF)
        low ^= (low << 4) & 0xFF
        crc = (crc >> 8) ^ (low << 8) ^ (low << 3) ^ (low >> 4)
    return crc


@inlined
def _frames_in_run(datagram: Bytes, start: int, extra: int) -> int:
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


@kernel
def messages_in(datagram: Cells1, kinds: Indices2, bad_limit: int) -> tuple[Indices2, int, int]:
    """Return the messages of a datagram in order, with the numbers of bad frames and of bytes outside any frame.

    A frame with a wrong checksum or unknown flags is bad, and the next is looked for from its second byte on. One of an
    unknown kind, which cannot be verified, is skipped if that leads to a frame or to the end.

    Args:
        datagram: Bytes (n,), whatever they are.
        kinds: Of each kind of message, by rising message id: that, the last byte that the checksum covers, where the
            payload holds target system and component, -1: nowhere, the length of payloads of which a run is taken
            as one message, -1: none, and that of the stamp in front, 4 (ms) or 8 (us) bytes (k, 6).
        bad_limit: Number of bad frames behind which the rest of the datagram is passed over.

    Returns:
        A row for each message or run: row in ``kinds``; where the payload begins and ends, of a run the first begins
        and the last ends; number of messages; system, component and sequence number, of a run the first; target system
        and component; stamp (ms), modulo 2**32 (m, 10).
    """
    size = datagram.shape[0]
    found = np.empty((size // 8 + 1, 10), np.int64)
    count, bad, skipped, start = 0, 0, 0, 0
    while start < size:
        end = _end_of_frame(datagram, start, size)
        if end == 0:
            skipped += 1
            start += 1
            while start < size and datagram[start] != V1 and datagram[start] != V2:
                skipped += 1
                start += 1
            continue
        length, flags = 0 + datagram[start + 1], 0
        if datagram[start] == V2:
            flags, header, first = datagram[start + 2], start + _SEQUENCE, start + HEADER
            number = datagram[header + 3] | datagram[header + 4] << 8 | datagram[header + 5] << 16
        else:
            header, first = start + 2, start + 6
            number = 0 + datagram[header + 3]
        kind = np.searchsorted(kinds[:, 0], number)
        if kind == kinds.shape[0] or kinds[kind, 0] != number:
            if end < size and datagram[end] != V1 and datagram[end] != V2:
                skipped += 1
                end = start + 1
            start = end
            continue
        last, run = first + length, 1
        if datagram[start] == V2 and length == kinds[kind, 4]:
            frames = _frames_in_run(datagram, start, kinds[kind, 1])
            if frames > 1:
                run, end = frames, start + frames * (length + AROUND)
                last = end - CHECKSUM
        checksum = _checksum(datagram, start + 1, first + length, kinds[kind, 1])
        if flags & ~SIGNED or checksum != datagram[first + length] | datagram[first + length + 1] << 8:
            bad += 1
            if bad >= bad_limit:
                skipped += size - start
                break
            start += 1  # its length may be what is wrong
            continue
        row = found[count]
        row[0], row[1], row[2], row[3] = kind, first, last, run
        row[4], row[5], row[6] = datagram[header + 1], datagram[header + 2], datagram[header]
        for k in range(2):
            at = kinds[kind, 2 + k]
            row[7 + k] = datagram[first + at] if 0 <= at < length else 0
        stamp = np.uint64(0)
        for k in range(min(kinds[kind, 5], length)):
            stamp |= np.uint64(datagram[first + k]) << np.uint64(8 * k)
        if kinds[kind, 5] == _MICROSECONDS:
            stamp = stamp // np.uint64(1000) & np.uint64(0xFFFFFFFF)
        row[9] = np.int64(stamp)
        count += 1
        start = end
    return found[:count], bad, skipped


@kernel
def framed_run(header: Cells1, payloads: Cells2, extra: int) -> Cells2:
    """Return the frames (n, length + 12) of payloads of one length (n, length).

    ``header`` (10,) of the first frame; the sequence number rises by one from each to the next. ``extra``: last byte
    that the checksum covers.
    """
    count, length = payloads.shape
    frames = np.empty((count, length + AROUND), np.uint8)
    for i in range(count):
        frame = frames[i]
        for k in range(HEADER):
            frame[k] = header[k]
        frame[_SEQUENCE] = (header[_SEQUENCE] + i) & 0xFF
        for k in range(length):
            frame[HEADER + k] = payloads[i, k]
        checksum = _checksum(frame, 1, HEADER + length, extra)
        frame[HEADER + length], frame[HEADER + length + 1] = checksum & 0xFF, checksum >> 8
    return frames


@kernel
def stamped_frames(data: Cells1, ends: Indices1, stamps: Indices1) -> Cells1:
    """Return every frame that :func:`gcs.mavlink.frames.spans` finds in datagrams, each behind its datagram's stamp.

    Bytes that belong to no frame are left out.

    Args:
        data: The datagrams (n,), one behind the other.
        ends: Where in ``data`` each of them ends (k,).
        stamps: Of each of them (k,), written as 8 bytes, big-endian.
    """
    all_bytes = data.shape[0]
    records, count, at = np.empty(all_bytes + (all_bytes // 8 + 1) * STAMP_BYTES, np.uint8), 0, 0
    for k in range(ends.shape[0]):
        size = ends[k]
        while at < size:
            end = _end_of_frame(data, at, size)
            if end == 0:
                at += 1
                continue
            for byte in range(STAMP_BYTES):
                records[count + byte] = (stamps[k] >> 8 * (STAMP_BYTES - 1 - byte)) & 0xFF
            count += STAMP_BYTES
            for i in range(at, end):
                records[count + i - at] = data[i]
            count += end - at
            at = end
    return records[:count]


@kernel
def frames_in_log(log: Cells1) -> Indices1:
    """Return where the frames of a telemetry log begin (n,), each behind a stamp, up to the first that is not whole."""
    size = log.shape[0]
    begins, count, at = np.empty(size // (STAMP_BYTES + 8) + 1, np.int64), 0, STAMP_BYTES
    while at < size:
        end = _end_of_frame(log, at, size)
        if end == 0:
            break
        begins[count] = at
        count += 1
        at = end + STAMP_BYTES
    return begins[:count]
