"""The MAVLink frames of a datagram, as far as faults have to know them."""

from collections.abc import Iterator
from typing import NamedTuple

from gcs.mavlink.frames import V2, spans


class Frame(NamedTuple):
    """A frame, from ``start`` to ``end`` in the datagram; ``checksum``: offset of its checksum.

    ``stamp``: the first four bytes of the payload, which in all streamed measurements and set-points are a time.
    """

    start: int
    end: int
    checksum: int
    system: int
    component: int
    message_id: int
    stamp: bytes


def frames(datagram: bytes) -> Iterator[Frame]:
    """Yield the frames in order; bytes before, between and behind them are skipped."""
    for start, end in spans(datagram):
        if datagram[start] == V2:
            system, component, body = datagram[start + 5], datagram[start + 6], start + 10
            number = int.from_bytes(datagram[start + 7 : body], "little")
        else:
            system, component, number = datagram[start + 3 : start + 6]
            body = start + 6
        length = datagram[start + 1]
        yield Frame(start, end, body + length, system, component, number, datagram[body : body + min(length, 4)])
