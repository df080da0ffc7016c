"""Bytes to MAVLink messages and back, robust against whatever a datagram may hold. No socket, no clock."""

import struct
from collections.abc import Callable, Sequence

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink
from numpy.typing import NDArray

from gcs.mavlink.frame_kernels import framed_run, messages_in
from gcs.mavlink.frames import AROUND, CHECKSUM, HEADER, V2
from gcs.mavlink.layout import LAYOUTS, Packed, PackedRun, Sample, packed
from gcs.mavlink.messages import Message, Received

#: Frames are gathered into datagrams up to this size, which every usual path carries unfragmented (bytes).
DATAGRAM_LIMIT = 1200

#: Frames of one datagram that may be broken; more make it no datagram of MAVLink, and the rest is not looked at.
BAD_FRAMES_MAX = 32

_MARKER = bytes([V2])
_HEADER = struct.Struct("<BHB2s3s")
"""Of MAVLink 2, behind the marker: length, flags, sequence number, sender, id of the message."""
_CHECKSUM = struct.Struct("<H")

_LAYOUTS = [LAYOUTS[number] for number in sorted(LAYOUTS)]
_KINDS = np.array(
    [
        (
            layout.message_id, layout.crc_extra[0], *(*layout.target_offsets, -1, -1)[:2],
            layout.dtype.itemsize if layout.sample is Sample.RETURNS else -1, layout.stamp_bytes,
        )
        for layout in _LAYOUTS
    ]
)  # fmt: skip
"""What is read of each kind of message, as :func:`messages_in` gets it."""

#: CRC-16/MCRF4XX: compiled where pymavlink has it compiled.
_checksum: Callable[[bytes], int] = getattr(mavlink, "mcrf4xx", None) or (lambda data: mavlink.x25crc(data).crc)


class Codec:
    """Encodes as one (system, component), decodes ArduPilot's dialect, which holds the common one; MAVLink 1 and 2.

    Nothing a peer sends raises, and no datagram changes how the next is read. Signatures are not verified (there is
    no key): a signed frame counts as an unsigned one.

    Counters: ``bad_frames`` with a wrong checksum, flags or contents; ``skipped_bytes`` outside any frame. Messages
    with an id outside the dialect are skipped.
    """

    def __init__(self, system_id: int, component_id: int) -> None:
        self.system_id = system_id
        """The sender's system id in every encoded frame."""
        self._sender = bytes([system_id, component_id])
        self._sequence = 0
        self.bad_frames = 0
        self.skipped_bytes = 0

    @property
    def unread(self) -> int:
        """Number of bad frames and skipped bytes: grows with every datagram that cannot be read in full."""
        return self.bad_frames + self.skipped_bytes

    def encode(self, message: Message) -> bytes:
        """Return a MAVLink 2 frame. The sequence number rises by one with every call.

        Raises ``struct.error`` or ``OverflowError`` when a field does not fit its type on the wire.
        """
        return self.frame(*packed(message))

    def frame(self, message: Packed) -> bytes:
        """Return a MAVLink 2 frame of a message that is packed already, as :meth:`encode` does."""
        layout, payload = message
        sequence = self._sequence
        self._sequence = (sequence + 1) & 0xFF
        body = _HEADER.pack(len(payload), 0, sequence, self._sender, layout.wire_id) + payload
        return _MARKER + body + _CHECKSUM.pack(_checksum(body + layout.crc_extra))

    def frames(self, run: PackedRun) -> list[bytes]:
        """Return the MAVLink 2 frames of a run, as :meth:`frame` does one by one."""
        layout, values = run
        length = layout.dtype.itemsize
        header = _MARKER + _HEADER.pack(length, 0, self._sequence, self._sender, layout.wire_id)
        self._sequence = (self._sequence + len(values)) & 0xFF
        payloads = values.view(np.uint8).reshape(-1, length)
        data = framed_run(np.frombuffer(bytearray(header), np.uint8), payloads, layout.crc_extra[0]).tobytes()
        return [data[at : at + length + AROUND] for at in range(0, len(data), length + AROUND)]

    def decode(self, datagram: bytes) -> list[Received]:
        """Return all messages of one datagram, in order. Frames never reach across datagrams."""
        read = self.read(datagram)
        return [message for received in read for message in ((received,) if received.run == 1 else received.split())]

    def read(self, datagram: bytes) -> list[Received]:
        """Return the same as :meth:`decode`, but OBSTACLE_DISTANCE_3D of one scan, one behind the other, as one.

        Of such a run, ``payload`` holds all payloads, each in full length, and ``sequence`` is that of the first.
        """
        data = np.frombuffer(bytearray(datagram), np.uint8)
        found, bad_frames, skipped_bytes = messages_in(data, _KINDS, BAD_FRAMES_MAX)
        self.bad_frames += bad_frames
        self.skipped_bytes += skipped_bytes
        messages: list[Received] = []
        new = tuple.__new__  # without the call of its own __new__, which takes half of the time
        for kind, first, last, run, system, component, sequence, to_system, to_component, stamp in found.tolist():
            payload = datagram[first:last] if run == 1 else _payloads(data[first - HEADER : last + CHECKSUM], run)
            messages.append(
                new(
                    Received,
                    (_LAYOUTS[kind], payload, run, system, component, sequence, to_system, to_component, stamp),
                )
            )
        return messages


def _payloads(frames: NDArray[np.uint8], run: int) -> bytes:
    """Return the payloads in the frames of a ``run``."""
    return frames.reshape(run, -1)[:, HEADER:-CHECKSUM].tobytes()


def gather(frames: Sequence[bytes]) -> list[bytes]:
    """Return frames in order, joined into as few datagrams as possible of at most :data:`DATAGRAM_LIMIT` bytes each."""
    datagrams: list[bytes] = []
    group: list[bytes] = []
    size = 0
    if sum(map(len, frames)) <= DATAGRAM_LIMIT:
        return [b"".join(frames)] if frames else []
    for frame in frames:
        if group and size + len(frame) > DATAGRAM_LIMIT:
            datagrams.append(b"".join(group))
            group, size = [], 0
        group.append(frame)
        size += len(frame)
    if group:
        datagrams.append(b"".join(group))
    return datagrams
