"""The plain reference of what the codec reads: one frame after the other, runs apart."""

import struct

from gcs.mavlink.codec import BAD_FRAMES_MAX
from gcs.mavlink.frames import SIGNED, V1, V2, end_of_frame, next_marker
from gcs.mavlink.layout import LAYOUTS
from gcs.mavlink.messages import BROADCAST, Received


def targets(layout, payload):
    found = [payload[offset] if offset < len(payload) else 0 for offset in layout.target_offsets]
    return (*found, BROADCAST, BROADCAST)[:2]


def messages_read(checksum, datagram):
    """Messages of a datagram, number of bad frames, number of skipped bytes; ``checksum`` of bytes."""
    messages, bad, skipped, start, size = [], 0, 0, 0, len(datagram)
    while start < size:
        end = end_of_frame(datagram, start)
        if not end:  # no marker, or a frame that is cut short
            following = next_marker(datagram, start + 1)
            skipped += following - start
            start = following
            continue
        if datagram[start] == V2:
            _, length, flags, _, sequence, system, component, low, high = struct.unpack_from("<7BHB", datagram, start)
            number, body = low | high << 16, start + 10
        else:
            _, length, sequence, system, component, number = struct.unpack_from("<6B", datagram, start)
            flags, body = 0, start + 6
        layout = LAYOUTS.get(number)
        if layout is None:
            # Its checksum cannot be verified. Accept its length only if that leads to a frame or the end.
            if end == size or datagram[end] in (V1, V2):
                start = end
            else:
                skipped += 1
                start += 1
            continue
        behind = body + length
        right = checksum(datagram[start + 1 : behind] + layout.crc_extra).to_bytes(2, "little")
        if flags & ~SIGNED or right != datagram[behind : behind + 2]:
            bad += 1
            if bad >= BAD_FRAMES_MAX:
                skipped += size - start
                break
            start += 1  # its length may be what is wrong
            continue
        payload = datagram[body:behind]
        stamp = int.from_bytes(payload[:4], "little")
        messages.append(Received(layout, payload, 1, system, component, sequence, *targets(layout, payload), stamp))
        start = end
    return messages, bad, skipped
