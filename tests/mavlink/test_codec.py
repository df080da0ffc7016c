import random
import struct

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as dialect
import pymavlink.dialects.v20.common as mavlink
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink import mavutil

from gcs.mavlink import px4
from gcs.mavlink.codec import BAD_FRAMES_MAX, DATAGRAM_LIMIT, Codec, gather
from gcs.mavlink.frame_kernels import RUN_LIMIT
from gcs.mavlink.layout import LAYOUTS, PackedRun
from gcs.mavlink.messages import Received
from gcs.mavlink.telemetry import scan_returns


def attitude(stamp: int = 7) -> mavlink.MAVLink_attitude_quaternion_message:
    return mavlink.MAVLink_attitude_quaternion_message(stamp, 1.0, 0.25, -0.5, 0.125, 1.5, -2.5, 3.5)


def command() -> mavlink.MAVLink_command_long_message:
    return mavlink.MAVLink_command_long_message(1, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0)


def test_round_trip_keeps_every_field_and_the_sender() -> None:
    sender, receiver = Codec(3, 25), Codec(255, 190)
    [received] = receiver.decode(sender.encode(attitude()))
    message = received.message
    assert (received.system, received.component, received.sequence) == (3, 25, 0)
    assert received.is_for(system=200, component=7)
    assert message.get_type() == "ATTITUDE_QUATERNION"
    assert (message.get_srcSystem(), message.get_srcComponent()) == (3, 25)
    assert [message.time_boot_ms, message.q1, message.q2, message.q3, message.q4] == [7, 1.0, 0.25, -0.5, 0.125]
    assert [message.rollspeed, message.pitchspeed, message.yawspeed] == [1.5, -2.5, 3.5]


def test_sequence_number_rises_and_wraps() -> None:
    codec = Codec(1, 1)
    sequence = [codec.decode(codec.encode(attitude()))[0].sequence for _ in range(258)]
    assert sequence == [*range(256), 0, 1]


def test_many_frames_in_one_datagram_keep_their_order() -> None:
    codec = Codec(1, 1)
    data = b"".join(codec.encode(attitude(stamp)) for stamp in range(20))
    assert [received.time_boot_ms for received in Codec(2, 1).decode(data)] == list(range(20))


def test_mavlink_1_frames_are_read() -> None:
    one = mavlink.MAVLink(None, 9, 1)
    frame = attitude().pack(one, force_mavlink1=True)
    assert frame[0] == 0xFE
    received, request, _ = Codec(2, 1).decode(frame + Codec(4, 1).encode(command()) + frame)
    assert received.system == 9 and received.message.q3 == -0.5
    assert request.is_for(1, 1) and not request.is_for(1, 2) and not request.is_for(2)


def test_signed_frames_are_read() -> None:
    signer = mavlink.MAVLink(None, 9, 1)
    signer.signing.secret_key = bytes(range(32))
    signer.signing.sign_outgoing = True
    frame = attitude().pack(signer)
    messages = Codec(2, 1).decode(frame + Codec(4, 1).encode(command()))
    assert [received.message.get_type() for received in messages] == ["ATTITUDE_QUATERNION", "COMMAND_LONG"]
    assert Codec(2, 1).decode(frame[:-3]) == []


def test_garbage_bad_checksums_and_cut_frames_do_not_hide_what_follows() -> None:
    good = Codec(1, 1).encode(command())
    bad = bytearray(good)
    bad[-1] ^= 0x40
    codec = Codec(2, 1)
    messages = codec.decode(b"\xfd\xfe garbage \xfd" + bytes(bad) + good + good[:-4] + good + b"\xfd\x00")
    assert len(messages) == 2 and all(received.message.get_type() == "COMMAND_LONG" for received in messages)
    assert codec.bad_frames >= 1 and codec.skipped_bytes > 0


def test_datagram_of_bad_frames_only_is_discarded() -> None:
    codec = Codec(2, 1)
    assert codec.decode(b"\xfe" * 65507) == []
    assert codec.bad_frames == BAD_FRAMES_MAX
    assert codec.bad_frames + codec.skipped_bytes >= 65507
    assert len(codec.decode(Codec(1, 1).encode(command()))) == 1


def test_truncated_datagram_does_not_affect_the_next() -> None:
    codec = Codec(2, 1)
    good = Codec(1, 1).encode(command())
    for length in range(len(good)):
        assert codec.decode(good[:length]) == []
        assert len(codec.decode(good)) == 1


def test_wrong_length_byte_does_not_hide_next_frame() -> None:
    good = Codec(1, 1).encode(command())
    wrong = bytearray(good)
    wrong[1] = 60
    assert len(Codec(2, 1).decode(bytes(wrong) + good + good)) == 2


def test_unknown_messages_are_skipped_whole() -> None:
    hidden = Codec(1, 1).encode(command())
    payload = hidden.ljust(60, b"\x01")
    unknown = struct.pack("<BBBBBBBHB", 0xFD, len(payload), 0, 0, 0, 1, 1, 0xFFF0, 0x7F) + payload + b"\x12\x34"
    codec = Codec(2, 1)
    [received] = codec.decode(unknown + Codec(1, 1).encode(attitude()))
    assert received.message.get_type() == "ATTITUDE_QUATERNION"
    assert codec.unread == 0


def test_unknown_incompatibility_flags_are_refused() -> None:
    frame = bytearray(Codec(1, 1).encode(attitude()))
    frame[2] = 0x02
    crc = mavlink.x25crc(bytes(frame[1:-2]) + bytes([mavlink.MAVLink_attitude_quaternion_message.crc_extra])).crc
    frame[-2:] = struct.pack("<H", crc)
    assert Codec(2, 1).decode(bytes(frame)) == []


@given(st.binary(max_size=400))
@settings(max_examples=300)
def test_codec_reads_a_good_frame_in_its_own_datagram_after_any_bytes(data: bytes) -> None:
    codec = Codec(2, 1)
    for received in codec.decode(data):
        assert received.message.msgname
    assert len(codec.decode(Codec(1, 1).encode(command()))) == 1


def test_every_message_of_the_dialect_with_random_payload_is_read_or_refused() -> None:
    rng = np.random.default_rng(5)
    codec = Codec(2, 1)
    read = 0
    for number, kind in mavlink.mavlink_map.items():
        for length in (0, 1, kind.unpacker.size, 255):
            body = struct.pack("<BBBBBBHB", length, 0, 0, 0, 1, 1, number & 0xFFFF, number >> 16) + rng.bytes(length)
            crc = mavlink.x25crc(body + bytes([kind.crc_extra])).crc
            [received] = codec.decode(b"\xfd" + body + struct.pack("<H", crc))
            read += received.message.msgname == kind.msgname
    assert read == 4 * len(mavlink.mavlink_map)


def scan(count: int, seed: int = 1) -> PackedRun:
    """Returns of a scan as a vehicle packs them."""
    layout, rng = LAYOUTS[dialect.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D], np.random.default_rng(seed)
    values = np.zeros(count, layout.dtype)
    values["time_boot_ms"], values["frame"] = 5000, mavlink.MAV_FRAME_BODY_FRD
    for name in ("x", "y", "z"):
        values[name] = rng.normal(0.0, 4.0, count)
    return PackedRun(layout, values)


def frames_by_pymavlink(run: PackedRun, sequence: int = 0) -> list[bytes]:
    sender = dialect.MAVLink(None, 3, 1)
    frames = []
    for k, value in enumerate(run.values):
        fields = dict(zip(run.layout.dtype.names, value.tolist(), strict=True))
        sender.seq = (sequence + k) % 256
        frames.append(dialect.MAVLink_obstacle_distance_3d_message(**fields).pack(sender))
    return frames


def returns(received: list[Received]) -> list[list[list[float]]]:
    """All returns that are read of messages and runs of messages."""
    found = [scan_returns(one) for one in received]
    return [np.concatenate(parts).tolist() for parts in zip(*(one[1:] for one in found), strict=True)]


@pytest.mark.parametrize("count", [1, 30, 257])
def test_returns_of_a_scan_are_framed_as_by_pymavlink_and_read_at_once_as_one_by_one(count: int) -> None:
    frames = Codec(3, 1).frames(scan(count))
    assert frames == frames_by_pymavlink(scan(count))
    datagram = b"".join(frames)
    whole, single = Codec(255, 190).read(datagram), Codec(255, 190).decode(datagram)
    assert len(whole) == 1 + (count > RUN_LIMIT) and len(single) == count
    assert returns(whole) == returns(single)


@pytest.mark.parametrize("seed", range(20))
def test_scan_with_damaged_frames_is_read_as_its_good_frames(seed: int) -> None:
    rng = random.Random(seed)
    frames = frames_by_pymavlink(scan(12, seed), rng.randrange(256)) + frames_by_pymavlink(scan(5, seed), 7)
    frames.insert(rng.randrange(17), Codec(3, 1).encode(attitude()))
    bad = rng.sample(range(18), 3)
    damaged = [bytearray(frame) for frame in frames]
    for at in bad:
        damaged[at][rng.randrange(10, len(frames[at]))] ^= rng.randint(1, 255)
    good = b"".join(frame for at, frame in enumerate(frames) if at not in bad)
    read, expected = (
        [one for one in Codec(255, 190).read(data) if one.layout.kind.msgname == "OBSTACLE_DISTANCE_3D"]
        for data in (b"".join(damaged), good)
    )
    assert returns(read) == returns(expected)


def test_gather_fills_datagrams_in_order_and_within_the_limit() -> None:
    frames = [bytes([i]) * (20 + 5 * i) for i in range(40)]
    datagrams = gather(frames)
    assert b"".join(datagrams) == b"".join(frames)
    assert all(len(datagram) <= DATAGRAM_LIMIT for datagram in datagrams)
    assert len(datagrams) == 5
    assert gather([]) == []


def test_custom_modes() -> None:
    assert px4.MODE_OFFBOARD == 6 << 16
    assert px4.MODE_LAND == 0x06040000
    assert px4.decode_custom_mode(px4.MODE_HOLD) == (4, 3)
    assert px4.mode_name(px4.MODE_HOLD) == "AUTO.LOITER"
    assert px4.mode_name(px4.MODE_OFFBOARD) == "OFFBOARD"
    assert px4.mode_name(99 << 16) == "mode 99.0"


def test_modes_have_the_numbers_by_which_pymavlink_tells_them() -> None:
    names = {
        **{mode.name: (int(mode), 0) for mode in px4.MainMode},
        **{mode.name: (4, int(mode)) for mode in px4.AutoMode},
    }
    other_names = {"FOLLOWME": "FOLLOW_TARGET"}
    compared = 0
    for name, (_, main, sub) in mavutil.px4_map.items():
        if (own := other_names.get(name, name)) in names:
            assert names[own] == (main, sub), name
            assert px4.encode_custom_mode(main, sub) == main << 16 | sub << 24
            compared += 1
    assert compared == 12
    # It does not know these two, which PX4 has had since.
    assert (px4.AutoMode.READY, px4.AutoMode.PRECLAND) == (1, 9)


@given(st.integers(-4_000_000, 2**31 - 1).filter(lambda i: not 0x7F800001 <= i <= 0x7FBFFFFF))
def test_integer_parameters_are_encoded_byte_wise(value: int) -> None:
    kind = mavlink.MAV_PARAM_TYPE_INT32
    codec = Codec(1, 1)
    sent = mavlink.MAVLink_param_value_message(b"X", px4.parameter_to_wire(value, kind), kind, 1, 0)
    [received] = codec.decode(codec.encode(sent))
    message = received.message
    assert px4.parameter_from_wire(message.param_value, message.param_type) == value


def test_integer_four_is_not_sent_as_the_float_four() -> None:
    wire = px4.parameter_to_wire(4, mavlink.MAV_PARAM_TYPE_INT32)
    assert struct.unpack("<I", struct.pack("<f", wire))[0] == 4
    assert px4.parameter_from_wire(4.0, mavlink.MAV_PARAM_TYPE_INT32) == 1082130432  # a C cast, as it would be read


@pytest.mark.parametrize(
    ("value", "kind"),
    [(300, mavlink.MAV_PARAM_TYPE_UINT8), (-1, mavlink.MAV_PARAM_TYPE_UINT32), (1.5, mavlink.MAV_PARAM_TYPE_INT32),
     (1, mavlink.MAV_PARAM_TYPE_REAL64), (0x7F800001, mavlink.MAV_PARAM_TYPE_INT32)],
)  # fmt: skip
def test_parameters_that_cannot_be_sent_are_refused(value: float, kind: int) -> None:
    with pytest.raises(ValueError, match=r"parameter|float"):
        px4.parameter_to_wire(value, kind)


@pytest.mark.parametrize("kind", [mavlink.MAV_PARAM_TYPE_REAL64, mavlink.MAV_PARAM_TYPE_INT64, 0, 77])
def test_parameters_of_a_type_that_is_not_used_are_not_read(kind: int) -> None:
    with pytest.raises(ValueError, match=f"parameter type {kind} is not used"):
        px4.parameter_from_wire(1.0, kind)
