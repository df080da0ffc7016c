"""The MAVLink frames of a datagram, as far as faults have to know them."""

from collections.abc import Iterator
from typing import NamedTuple

import pymavlink.dialects.v20.ardupilotmega as mavlink

_V1, _V2 = mavlink.PROTOCOL_MARKER_V1, mavlink.PROTOCOL_MARKER_V2


class Frame(NamedTuple):
    """A frame, from ``start`` to ``end`` in the datagram; ``checksum``: offset of its checksum.

    ``stamp``: the first four bytes of the payload, which in all streamed measurements and set-points are a time.
    """

    start: int
    end: int
    checksum: int
    component: int
    message_id: int
    stamp: bytes


def frames(datagram: bytes) -> Iterator[Frame]:
    """Yield the frames in order; bytes before, between and behind them are skipped."""
    at, size = 0, len(datagram)
    while at + 8 <= size:
        length = datagram[at + 1]
        if datagram[at] == _V2 and at + 12 + length <= size:
            body = at + 10
            end = body + length + 2 + (13 if datagram[at + 2] & mavlink.MAVLINK_IFLAG_SIGNED else 0)
            component, number = datagram[at + 6], int.from_bytes(datagram[at + 7 : at + 10], "little")
        elif datagram[at] == _V1 and at + 8 + length <= size:
            body = at + 6
            end = body + length + 2
            component, number = datagram[at + 4], datagram[at + 5]
        else:
            at += 1
            continue
        stamp = datagram[body : body + min(length, 4)]
        yield Frame(at, end, body + length, component, number, stamp)
        at = end
