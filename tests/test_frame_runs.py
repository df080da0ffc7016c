"""Runs of OBSTACLE_DISTANCE_3D, packed and read at once, against pymavlink's frames and messages one by one."""

import random

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from frames_read_plainly import messages_read
from hypothesis import given, settings
from hypothesis import strategies as st

from gcs.mavlink.codec import Codec, gather
from gcs.mavlink.frame_kernels import RUN_LIMIT, framed_run, stamped_frames
from gcs.mavlink.frames import SIGNED, spans
from gcs.mavlink.layout import LAYOUTS, PackedRun
from gcs.mavlink.link_statistics import LinkStatistics
from gcs.mavlink.telemetry import scan_returns

POINT = LAYOUTS[mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D]
LENGTH = POINT.dtype.itemsize


def crc(data):
    return mavlink.x25crc(data).crc


def points(count, seed=1, stamp=5000):
    """A run as a vehicle packs it."""
    rng = np.random.default_rng(seed)
    values = np.zeros(count, POINT.dtype)
    values["time_boot_ms"] = stamp
    for name in ("x", "y", "z"):
        values[name] = rng.normal(0.0, 4.0, count)
    values["x"][::3] = 0.0
    values["min_distance"], values["max_distance"] = 0.05, 10.0
    values["obstacle_id"] = np.sort(rng.integers(0, 5, count))
    values["frame"] = mavlink.MAV_FRAME_BODY_FRD
    return PackedRun(POINT, values)


def plain_frames(run, sequence=0, system=3, signed=False):
    """The same by pymavlink, message by message."""
    sender = mavlink.MAVLink(None, system, 1)
    sender.seq = sequence
    if signed:
        sender.signing.sign_outgoing, sender.signing.secret_key = True, bytes(32)
    frames = []
    for value in run.values:
        fields = dict(zip(POINT.dtype.names, value.tolist(), strict=True))
        frames.append(mavlink.MAVLink_obstacle_distance_3d_message(**fields).pack(sender))
        sender.seq = (sender.seq + 1) % 256
    return frames


def plain_messages(datagram):
    """All OBSTACLE_DISTANCE_3D of a datagram by pymavlink's own parser, as (sequence, system, fields)."""
    parser = mavlink.MAVLink(None)
    parser.robust_parsing = True
    found = [parser.parse_char(datagram[at : at + 1]) for at in range(len(datagram))]
    return [
        (m.get_seq(), m.get_srcSystem(), m.to_dict()) for m in found if m is not None and m.get_type() != "BAD_DATA"
    ]


def messages(received):
    return [(r.sequence, r.system, r.message.to_dict()) for r in received]


def arrays(received):
    """What the ground reads of runs and single messages together."""
    found = [scan_returns(r) for r in received]
    return [np.concatenate(parts).tolist() for parts in zip(*(d[1:] for d in found), strict=True)]


@pytest.mark.parametrize("count", [1, 2, 30, 255, 256, 257, 600])
def test_frames_of_a_run_equal_those_of_pymavlink(count):
    codec, run = Codec(3, 1), points(count)
    for _ in range(254):
        codec.encode(mavlink.MAVLink_ping_message(0, 0, 0, 0))
    assert codec.frames(run) == plain_frames(run, sequence=254)
    # The numbers go on behind the run.
    assert codec.encode(mavlink.MAVLink_ping_message(0, 0, 0, 0))[4] == (254 + count) % 256


@pytest.mark.parametrize("count", [1, 2, 30, 256, 257, 600])
def test_a_run_is_read_at_once_and_equals_its_messages(count):
    run = points(count)
    datagram = b"".join(plain_frames(run, sequence=200))
    whole, single = Codec(255, 190).read(datagram), Codec(255, 190).decode(datagram)
    assert [r.run for r in whole] == [RUN_LIMIT] * (count // RUN_LIMIT) + [count % RUN_LIMIT] * (count % RUN_LIMIT > 0)
    assert messages(single) == plain_messages(datagram)
    assert arrays(whole) == arrays(single)
    np.testing.assert_array_equal(np.array(arrays(whole)[0])[:, 0], run.values["x"])


def test_a_run_ends_where_sender_scan_or_number_changes():
    codec = Codec(255, 190)
    first, later = plain_frames(points(4), 10), plain_frames(points(3, stamp=5100), 14)
    other = plain_frames(points(2), 17, system=4)
    gap = plain_frames(points(2), 20, system=4)
    whole = codec.read(b"".join([*first, *later, *other, *gap]))
    assert [(r.system, r.sequence, r.run, r.time_boot_ms) for r in whole] == [
        (3, 10, 4, 5000), (3, 14, 3, 5100), (4, 17, 2, 5000), (4, 20, 2, 5000),
    ]  # fmt: skip
    assert codec.unread == 0


@pytest.mark.parametrize("seed", range(60))
def test_damaged_runs_are_read_as_pymavlink_reads_their_frames(seed):
    """Frames of several kinds, some signed, cut short, of other senders, or with a wrong byte."""
    rng = random.Random(seed)
    attitude = mavlink.MAVLink_attitude_message(1, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0)
    frames = []
    for k in range(rng.randint(1, 5)):
        run = points(rng.randint(1, 8), seed=10 * seed + k, stamp=rng.choice((5000, 5100)))
        frames += plain_frames(run, rng.randrange(256), rng.choice((3, 4)), signed=rng.random() < 0.2)
        if rng.random() < 0.5:
            frames.append(Codec(3, 1).encode(attitude))
    whole = [(frame, True) for frame in frames]
    for _ in range(rng.randint(0, 3)):
        at = rng.randrange(len(whole))
        frame = bytearray(whole[at][0])
        frame[rng.randrange(10, len(frame) - (13 if frame[2] else 0))] ^= rng.randint(1, 255)
        whole[at] = bytes(frame), False
    if rng.random() < 0.3:
        whole[-1] = whole[-1][0][: rng.randrange(1, len(whole[-1][0]))], False
    datagram = b"".join(frame for frame, _ in whole)
    codec = Codec(255, 190)
    decoded = codec.decode(datagram)
    # pymavlink's parser loses its place behind a broken frame; each good frame for itself it reads.
    assert messages(decoded) == [m for frame, good in whole if good for m in plain_messages(frame)]
    ours = [r for r in codec.read(datagram) if r.layout is POINT]
    assert not ours or arrays(ours) == arrays([r for r in decoded if r.layout is POINT])


def assert_read_plainly(datagram):
    codec = Codec(255, 190)
    read = codec.decode(datagram)
    assert (read, codec.bad_frames, codec.skipped_bytes) == messages_read(crc, datagram)


@settings(deadline=None, derandomize=True)
@given(st.binary(max_size=300), st.integers(0, 4), st.integers(1, 6))
def test_whatever_surrounds_a_run_it_is_read_as_frame_by_frame(noise, at, count):
    frames = plain_frames(points(count))
    frames.insert(min(at, count), noise)
    assert_read_plainly(b"".join(frames))


@pytest.mark.parametrize("seed", range(30))
def test_frames_of_all_kinds_and_damages_are_read_as_one_by_one(seed):
    """Every kind of message, MAVLink 1 and 2, signed, cut short or longer, of unknown kind, with wrong bytes."""
    rng = random.Random(seed)
    for _ in range(40):
        parts = []
        for _ in range(rng.randint(1, 8)):
            frame = bytearray(any_frame(rng))
            while rng.random() < 0.2:
                frame[rng.randrange(len(frame))] = rng.choice((0xFD, 0xFE, 0, 1, rng.randrange(256)))
            parts.append(bytes(frame[: rng.randrange(len(frame))] if rng.random() < 0.05 else frame))
            if rng.random() < 0.1:
                parts.append(b"".join(plain_frames(points(rng.randint(1, 4)), rng.randrange(256))))
        assert_read_plainly(b"".join(parts))


def any_frame(rng):
    number = rng.choice([*LAYOUTS, *range(1, 30), 9999])
    extra = LAYOUTS[number].crc_extra if number in LAYOUTS else b"x"
    length = rng.choice([0, 1, rng.randrange(256), LAYOUTS[number].kind.unpacker.size if number in LAYOUTS else 9])
    rest = bytes([rng.randrange(256), rng.randrange(256), rng.choice((1, 190))])
    flags = bytes([rng.choice((0, 0, 0, SIGNED, 2)), 0])
    first = rng.random() < 0.3 and number < 256
    head = rest + number.to_bytes(1, "little") if first else flags + rest + number.to_bytes(3, "little")
    body = bytes([length]) + head + rng.randbytes(length)
    frame = (b"\xfe" if first else b"\xfd") + body + crc(body + extra).to_bytes(2, "little")
    return frame + rng.randbytes(13) if not first and flags[0] & SIGNED else frame


def test_a_datagram_of_nothing_but_bad_frames_is_given_up():
    bad = bytearray(plain_frames(points(1))[0])
    bad[-1] ^= 1
    for count in (31, 32, 33):
        assert_read_plainly(bytes(bad) * count + plain_frames(points(1))[0])


def test_truncated_payload_is_a_single_message():
    """Another sender may leave the frame at 0: its zeros are cut off."""
    run = points(3)
    run.values["frame"][1] = run.values["sensor_type"][1] = 0
    frames = plain_frames(run)
    assert len(frames[1]) < len(frames[0])
    whole = Codec(255, 190).read(b"".join(frames))
    assert [r.run for r in whole] == [1, 1, 1]
    assert messages(whole) == plain_messages(b"".join(frames))
    assert np.isnan(arrays(whole)[0][1]).all() and np.isfinite(arrays(whole)[0][2]).all()


@settings(deadline=None, derandomize=True)
@given(
    st.lists(
        st.one_of(
            st.binary(max_size=12),
            st.integers(1, 4).map(lambda count: b"".join(plain_frames(points(count)))),
            st.integers(1, 2).map(lambda count: b"".join(plain_frames(points(count), signed=True))),
            st.sampled_from([b"\xfe\x02\x00\x01\x01\x00ab\x00\x00", b"\xfe\x00", b"\xfd\x00\x00", b"\xfd\x05"]),
        ),
        max_size=6,
    ),
    st.lists(st.integers(0, 400), max_size=3),
)
def test_records_are_those_of_the_splitter(parts, cuts):
    data = b"".join(parts)
    ends = sorted(min(cut, len(data)) for cut in (*cuts, len(data)))
    datagrams = [data[start:end] for start, end in zip([0, *ends], ends, strict=False)]
    stamps = [0x0102030405060708 + (k << 40) for k in range(len(datagrams))]
    found = stamped_frames(np.frombuffer(bytearray(data), np.uint8), np.array(ends), np.array(stamps))
    expected = [
        stamp.to_bytes(8, "big") + d[start:end]
        for stamp, d in zip(stamps, datagrams, strict=True)
        for start, end in spans(d)
    ]
    assert found.tobytes() == b"".join(expected)


def test_frames_of_a_run_are_read_as_far_as_they_are_whole():
    run, layout = points(20), POINT
    header = np.array(bytearray(plain_frames(run, 250)[0][:10]))
    payloads = run.values.view(np.uint8).reshape(-1, LENGTH)
    frames = framed_run(header, payloads, layout.crc_extra[0])
    assert frames.tobytes() == b"".join(plain_frames(run, 250))
    for cut in (0, 1, 400, 759):
        read = Codec(255, 190).read(frames.tobytes()[: 800 - cut])
        assert [r.run for r in read] == [(800 - cut) // 40]


@settings(deadline=None, derandomize=True)
@given(st.lists(st.tuples(st.integers(0, 255), st.integers(1, 40), st.floats(0.0, 2.0)), max_size=30))
def test_statistics_of_runs_equal_those_of_their_messages(runs):
    together, apart = LinkStatistics(), LinkStatistics()
    now, expected = 0.0, 0
    for jump, length, pause in runs:
        now += pause
        first = (expected + (jump if jump < 60 or jump > 200 else 0)) % 256
        expected = (first + length) % 256
        together.run(first, length, now)
        for k in range(length):
            apart.message((first + k) % 256, now)
        assert (together.lost, together.reordered, together.duplicated) == (
            apart.lost, apart.reordered, apart.duplicated,
        )  # fmt: skip
    together.settle(now + 10.0)
    apart.settle(now + 10.0)
    assert vars(together) | {"scans": None} == vars(apart) | {"scans": None}
    assert vars(together.scans) == vars(apart.scans)


def test_datagrams_of_a_run_are_as_full_as_those_of_its_messages():
    frames = Codec(3, 1).frames(points(100))
    assert [len(datagram) for datagram in gather(frames)] == [1200, 1200, 1200, 400]
