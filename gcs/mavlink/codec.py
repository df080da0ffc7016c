"""Bytes to MAVLink messages and back, robust against whatever a datagram may hold. No socket, no clock."""

import struct
from collections.abc import Iterable

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.messages import Message, Received, classify

#: Frames are gathered into datagrams up to this size, which every usual path carries unfragmented (bytes).
DATAGRAM_LIMIT = 1200

#: Frames of one datagram that may be broken; more make it no datagram of MAVLink, and the rest is not looked at.
BAD_FRAMES_MAX = 32

_V1, _V2 = mavlink.PROTOCOL_MARKER_V1, mavlink.PROTOCOL_MARKER_V2
_SIGNED = mavlink.MAVLINK_IFLAG_SIGNED
_SIGNATURE_LENGTH = mavlink.MAVLINK_SIGNATURE_BLOCK_LEN
_KNOWN = mavlink.mavlink_map


class Codec:
    """Encodes as one (system, component), decodes ArduPilot's dialect, which holds the common one; MAVLink 1 and 2.

    Nothing a peer sends raises, and no datagram changes how the next is read. Signatures are not verified (there is
    no key): a signed frame counts as an unsigned one.

    Counters: ``bad_frames`` with a wrong checksum, flags or contents; ``skipped_bytes`` outside any frame. Messages
    with an id outside the dialect are skipped.
    """

    def __init__(self, system_id: int, component_id: int) -> None:
        self._mavlink = mavlink.MAVLink(None, system_id, component_id)
        self.bad_frames = 0
        self.skipped_bytes = 0

    @property
    def unread(self) -> int:
        """Number of bad frames and skipped bytes: grows with every datagram that cannot be read in full."""
        return self.bad_frames + self.skipped_bytes

    @property
    def system_id(self) -> int:
        """The sender's system id in every encoded frame."""
        return self._mavlink.srcSystem

    def encode(self, message: Message) -> bytes:
        """Return a MAVLink 2 frame. The sequence number rises by one with every call.

        Raises ``struct.error`` or ``OverflowError`` when a field does not fit its type on the wire.
        """
        frame = message.pack(self._mavlink)
        self._mavlink.seq = (self._mavlink.seq + 1) & 0xFF
        return frame

    def decode(self, datagram: bytes) -> list[Received]:
        """Return all messages of one datagram, in order. Frames never reach across datagrams."""
        messages: list[Received] = []
        end = len(datagram)
        position = 0
        give_up = self.bad_frames + BAD_FRAMES_MAX
        while position < end:
            marker = datagram[position]
            length = 0
            if marker == _V2 and position + 12 <= end:
                flags = datagram[position + 2]
                length = datagram[position + 1] + (12 + _SIGNATURE_LENGTH if flags & _SIGNED else 12)
                number = int.from_bytes(datagram[position + 7 : position + 10], "little")
            elif marker == _V1 and position + 8 <= end:
                flags = 0
                length = datagram[position + 1] + 8
                number = datagram[position + 5]
            following = position + length
            if not length or following > end:  # no marker, or a frame that is cut short
                position += 1
                self.skipped_bytes += 1
                continue
            if number not in _KNOWN:
                # Its checksum cannot be verified. Accept its length only if that leads to a frame or the end.
                if following == end or datagram[following] in (_V1, _V2):
                    position = following
                else:
                    self.skipped_bytes += 1
                    position += 1
                continue
            message = None if flags & ~_SIGNED else self._decode_frame(datagram[position:following])
            if message is None:
                self.bad_frames += 1
                if self.bad_frames >= give_up:
                    self.skipped_bytes += end - position
                    break
                position += 1  # its length may be what is wrong
                continue
            messages.append(classify(message))
            position = following
        return messages

    def _decode_frame(self, frame: bytes) -> Message | None:
        try:
            return self._mavlink.decode(bytearray(frame))
        except (mavlink.MAVError, struct.error, ValueError, TypeError, IndexError):
            return None


def gather(frames: Iterable[bytes], limit: int = DATAGRAM_LIMIT) -> list[bytes]:
    """Return frames in order, joined into as few datagrams as possible of at most ``limit`` bytes each."""
    datagrams: list[bytes] = []
    group: list[bytes] = []
    size = 0
    for frame in frames:
        if group and size + len(frame) > limit:
            datagrams.append(b"".join(group))
            group, size = [], 0
        group.append(frame)
        size += len(frame)
    if group:
        datagrams.append(b"".join(group))
    return datagrams
