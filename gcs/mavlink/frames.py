"""The one splitter of datagrams into MAVLink frames, by their length fields: checksums are not verified."""

import re

V1, V2 = 0xFE, 0xFD
"""First byte of a frame of MAVLink 1 and 2."""
SIGNED = 0x01
"""Incompatibility flag of a frame with a signature."""
SIGNATURE = 13
"""Bytes of a signature, at the end of a frame."""

_MARKER = re.compile(b"[%c%c]" % (V2, V1))


def end_of_frame(datagram: bytes, start: int) -> int:
    """Return the end of the frame that begins at ``start``; 0: no whole frame begins there.

    Args:
        datagram: Frames of MAVLink 1 and 2, signed or not, and whatever else.
        start: Position of a byte of it.
    """
    size = len(datagram)
    if datagram[start] == V2 and start + 2 < size:
        end = start + datagram[start + 1] + (12 + SIGNATURE if datagram[start + 2] & SIGNED else 12)
    elif datagram[start] == V1 and start + 1 < size:
        end = start + datagram[start + 1] + 8
    else:
        return 0
    return end if end <= size else 0


def next_marker(datagram: bytes, start: int) -> int:
    """Return the first position from ``start`` on at which a frame may begin, the end if there is none."""
    found = _MARKER.search(datagram, start)
    return len(datagram) if found is None else found.start()


def spans(datagram: bytes) -> list[tuple[int, int]]:
    """Return start and end of every frame in order; bytes before, between and behind them are skipped."""
    found = []
    at, size = 0, len(datagram)
    while at < size:
        if end := end_of_frame(datagram, at):
            found.append((at, end))
            at = end
        else:
            at = next_marker(datagram, at + 1)
    return found
