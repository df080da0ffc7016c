"""Packing and reading of every kind of message, byte for byte and field for field as pymavlink does it."""

import math
import random
import struct
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as mavlink
import pymavlink.dialects.v20.development as development
import pytest

from gcs.mavlink.codec import Codec
from gcs.mavlink.layout import LAYOUTS
from gcs.mavlink.messages import BROADCAST, Message
from gcs.mavlink.newer_messages import AVAILABLE_MODES, COMMAND_CANCEL, NEWER, PROTOCOL_VERSION

KINDS = list(mavlink.mavlink_map.values())
SYSTEM, COMPONENT, SAMPLES = 7, 25, 12
_FLOATS = (0.0, -0.0, 1.0, -1.5, math.nan, math.inf, -math.inf, 3.4028234e38, 1e-45)


def random_fields(kind: type[Message], rng: random.Random) -> list[Any]:
    """Values of all fields of a message, in the order of its constructor: zero, extreme, or any."""
    fields = {}
    codes = kind.native_format.decode().lstrip("<")
    for name, code, length in zip(kind.ordered_fieldnames, codes, kind.array_lengths, strict=True):
        if code == "c":
            text = rng.choice((b"", b"text", rng.randbytes(length), b"a\0b", b"Az" * length))
            fields[name] = text[:length]
        else:
            values = [random_number(code, rng) for _ in range(length or 1)]
            fields[name] = values if length else values[0]
    return [fields[name] for name in kind.fieldnames]


def random_number(code: str, rng: random.Random) -> float:
    if code in "fd":
        return rng.choice((*_FLOATS, struct.unpack("<f", struct.pack("<f", rng.gauss(0.0, 1e3)))[0]))
    bits = 8 * struct.calcsize("<" + code)
    least, most = (0, 2**bits - 1) if code.isupper() else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    return rng.choice((0, 0, least, most, 1, rng.randint(least, most)))


def fields_of(message: Message) -> dict[str, str]:
    """All fields as text, in which nan is nan; an array is a list or a tuple."""
    values = {name: getattr(message, name) for name in message.fieldnames}
    return {name: repr(list(v) if isinstance(v, list | tuple) else v) for name, v in values.items()}


def test_all_kinds_of_the_dialect_and_newer_ones_have_a_layout() -> None:
    assert len(KINDS) > 250 and all(number not in mavlink.mavlink_map for number in NEWER)
    assert [layout.kind for layout in LAYOUTS.values()] == [*KINDS, *NEWER.values()]


def test_newer_messages_have_the_layout_of_the_definitions() -> None:
    """That of the dialect under development where it has them; the checksums of the others stand in common.xml."""
    known = {NEWER[COMMAND_CANCEL].crc_extra: 14, NEWER[PROTOCOL_VERSION].crc_extra: 217}
    assert all(number == expected for number, expected in known.items())
    compared = 0
    for number, kind in NEWER.items():
        other = development.mavlink_map.get(number)
        if other is None:
            continue
        compared += 1
        for name in ("msgname", "fieldnames", "ordered_fieldnames", "orders", "array_lengths", "crc_extra"):
            assert getattr(kind, name) == getattr(other, name)
        assert kind.unpacker.format == other.unpacker.format and kind.native_format == other.native_format
    assert compared == 3


def test_newer_message_is_encoded_and_decoded() -> None:
    frame = Codec(SYSTEM, COMPONENT).encode(NEWER[AVAILABLE_MODES](4, 2, 6, 7, 1, b"Mission"))
    [message] = [received.message for received in Codec(1, 1).decode(frame)]
    fields = [getattr(message, name) for name in message.fieldnames]
    assert fields == [4, 2, 6, 7, 1, "Mission"] and message.get_type() == "AVAILABLE_MODES"


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.msgname)
def test_message_is_encoded_and_decoded_as_pymavlink_does(kind: type[Message]) -> None:
    rng = random.Random(kind.id)
    codec, reader = Codec(SYSTEM, COMPONENT), Codec(1, 1)
    writer = mavlink.MAVLink(None, SYSTEM, COMPONENT)
    samples = [random_fields(kind, rng) for _ in range(SAMPLES)]
    samples.append([([0] * len(v) if isinstance(v, list) else type(v)()) for v in samples[0]])  # nothing but zeros
    for fields in samples:
        message = kind(*fields)
        expected = message.pack(writer)
        writer.seq = (writer.seq + 1) % 256
        assert codec.encode(message) == expected
        check_decoded(reader, expected, kind)
        if kind.id < 256:
            check_decoded(reader, message.pack(writer, force_mavlink1=True), kind)
        # A later version of the message, with fields behind the known ones, and none of the zeros left out.
        longer = kind.unpacker.pack(*kind.unpacker.unpack(expected[10:-2].ljust(kind.unpacker.size, b"\0"))) + b"\1\2"
        if len(longer) <= 255:
            header = struct.pack("<BBBBBB", len(longer), 0, 0, 9, SYSTEM, COMPONENT) + kind.id.to_bytes(3, "little")
            checksum = mavlink.x25crc(header + longer + bytes([kind.crc_extra])).crc
            check_decoded(reader, b"\xfd" + header + longer + struct.pack("<H", checksum), kind)
    assert reader.unread == 0


def check_decoded(reader: Codec, frame: bytes, kind: type[Message]) -> None:
    truth = mavlink.MAVLink(None, 1, 1).decode(bytearray(frame))
    [received] = reader.decode(frame)
    message = received.message
    assert type(message) is type(truth) is kind
    assert fields_of(message) == fields_of(truth)
    sender = (truth.get_srcSystem(), truth.get_srcComponent(), truth.get_seq())
    assert (received.system, received.component, received.sequence) == sender
    assert (message.get_srcSystem(), message.get_srcComponent(), message.get_seq()) == sender
    assert received.target_system == getattr(truth, "target_system", BROADCAST)
    assert received.target_component == getattr(truth, "target_component", BROADCAST)


@pytest.mark.parametrize("value", [-1, 2**32, 1.5])
def test_fields_that_do_not_fit_are_refused_as_by_pymavlink(value: float) -> None:
    message = mavlink.MAVLink_attitude_message(value, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    with pytest.raises(struct.error):
        message.pack(mavlink.MAVLink(None, 1, 1))
    with pytest.raises(struct.error):
        Codec(1, 1).encode(message)
    with pytest.raises(OverflowError):
        Codec(1, 1).encode(mavlink.MAVLink_attitude_message(0, 1e39, 0.0, 0.0, 0.0, 0.0, 0.0))
