"""Random, damaged, forged and hostile datagrams of foreign systems and damaged links, beside a flight."""

import random
import struct
from collections import deque

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.codec import Codec
from gcs.mavlink.frames import spans
from gcs.mavlink.layout import LAYOUTS
from vehicle_sim.faults.fault_injector import FaultInjector

REMEMBERED = 64  # genuine datagrams that may be imitated


def offset_of(kind, name):
    """Offset of a field in a message's payload on the wire."""
    codes = kind.native_format.decode().lstrip("<")
    before = kind.ordered_fieldnames.index(name)
    return sum(
        struct.calcsize("<" + code) * max(length, 1)
        for code, length in zip(codes[:before], kind.array_lengths[:before], strict=True)
    )


def with_random_contents(kind, contents, target_system, writer):
    """A frame of ``kind`` with these random contents, but addressed to ``target_system``."""
    payload = bytearray(contents)
    for name, value in (("target_system", target_system), ("target_component", 1)):
        if name in kind.ordered_fieldnames:
            payload[offset_of(kind, name)] = value
    contents = bytes(payload).rstrip(b"\0") or b"\0"
    header = struct.pack(
        "<BBBBBBHB", len(contents), 0, 0, writer.seq, writer.srcSystem, writer.srcComponent,
        kind.id & 0xFFFF, kind.id >> 16,
    )  # fmt: skip
    checksum = mavlink.x25crc(header + contents + bytes([kind.crc_extra])).crc
    return b"\xfd" + header + contents + struct.pack("<H", checksum)


class Traffic(FaultInjector):
    """Lets everything through, and remembers the last genuine datagrams of one vehicle in each direction."""

    def __init__(self, vehicle):
        super().__init__()
        self._vehicle = vehicle
        self.to_it = deque(maxlen=REMEMBERED)
        self.from_it = deque(maxlen=REMEMBERED)

    def to_vehicle(self, vehicle, arriving, now):
        if vehicle == self._vehicle:
            self.to_it.extend(datagram for datagram, _ in arriving)
        return arriving

    def from_vehicle(self, vehicle, leaving, now):
        if vehicle == self._vehicle:
            self.from_it.extend(datagram for datagram, _ in leaving)
        return leaving


class HostileTraffic:
    """Draws datagrams, each with the address it comes from; none of them may be obeyed.

    ``genuine``: what one sender has sent lately from ``address``, to be imitated; from there comes only what has no
    right checksum. ``foreign``: (address, system) of the systems that send the rest; several may share an address.
    ``hostile``: messages to choose from. ``target_system``: whom all that is addressed is for. ``credible``: (address,
    system) by which others speak rightly: from there no whole frame of that system comes.
    """

    def __init__(self, seed, genuine, address, foreign, hostile, target_system, credible=()):
        self._random = random.Random(seed)
        self._genuine = genuine
        self._address = address
        self._foreign = foreign
        self._elsewhere = [other for other, _ in foreign if other != address]
        self._hostile = hostile
        self._target_system = target_system
        self._credible = frozenset(credible)
        self._writers = {system: mavlink.MAVLink(None, system, 1) for _, system in foreign}
        self._reader = Codec(254, 1)
        self._kinds = tuple(mavlink.mavlink_map.values())
        self._makers = (
            self._noise, self._damaged, self._spliced, self._forged, self._hostile_message, self._any_message
        )  # fmt: skip

    def draw(self):
        """(datagram, address of the sender)."""
        return self._random.choice(self._makers)()

    def _noise(self):
        data = self._random.randbytes(self._random.randrange(300))
        if self._random.random() < 0.7:
            data = self._random.choice((b"\xfd", b"\xfe")) + data
        return self._from_anybody(data)

    def _damaged(self):
        """Flipped bytes, a wrong checksum, or cut short."""
        draw = self._random
        data = bytearray(draw.choice(self._genuine))
        what = draw.randrange(4)
        if what == 0:
            del data[draw.randrange(len(data)) :]
        elif what == 1:
            frames = _frames(data)
            for frame in frames:
                frame[-1 - draw.randrange(2)] ^= draw.randrange(1, 256)
            data = bytearray(b"".join(frames))
        else:
            for _ in range(draw.randrange(1, 12)):
                data[draw.randrange(len(data))] ^= draw.randrange(1, 256)
        return self._from_anybody(bytes(data))

    def _spliced(self):
        draw = self._random
        head, tail = draw.choice(self._genuine), draw.choice(self._genuine)
        return self._from_anybody(head[: draw.randrange(len(head))] + tail[draw.randrange(len(tail)) :])

    def _forged(self):
        """A genuine frame with other contents and a right checksum."""
        draw = self._random
        address, system = draw.choice(self._foreign)
        frame = draw.choice(_frames(draw.choice(self._genuine)))
        for _ in range(draw.randrange(9)):
            frame[draw.randrange(10, len(frame) - 2)] = draw.choice((0, 1, 0x7F, 0x80, 0xFF, draw.randrange(256)))
        frame[5] = system
        if draw.random() < 0.2:
            frame[6] = draw.randrange(256)
        kind = LAYOUTS[int.from_bytes(frame[7:10], "little")].kind
        struct.pack_into("<H", frame, len(frame) - 2, mavlink.x25crc(bytes(frame[1:-2]) + bytes([kind.crc_extra])).crc)
        return bytes(frame), address

    def _hostile_message(self):
        address, system = self._random.choice(self._foreign)
        return self._random.choice(self._hostile).pack(self._writers[system]), address

    def _any_message(self):
        address, system = self._random.choice(self._foreign)
        kind = self._random.choice(self._kinds)
        contents = self._random.randbytes(kind.unpacker.size)
        return with_random_contents(kind, contents, self._target_system, self._writers[system]), address

    def _from_anybody(self, data):
        """From the one who is imitated, as a damaged link would deliver it, unless some of it is still whole."""
        whole = {received.system for received in self._reader.decode(data)}
        if self._random.random() < 0.5 and not whole:
            return data, self._address
        return data, self._random.choice(
            [other for other in self._elsewhere if not any((other, system) in self._credible for system in whole)]
        )


def _frames(datagram):
    return [bytearray(datagram[start:end]) for start, end in spans(bytes(datagram))]
