"""Frames in a datagram, by their length fields."""

import pymavlink.dialects.v20.ardupilotmega as mavlink
from hypothesis import given, settings
from hypothesis import strategies as st

from gcs.mavlink.frames import SIGNED, V1, V2, spans


def frame(stamp: int = 7, **options: bool) -> bytes:
    writer = mavlink.MAVLink(None, 3, 1)
    return mavlink.MAVLink_attitude_message(stamp, 0.1, -0.2, 0.3, 0.0, 0.0, 0.0).pack(writer, **options)


def signed_frame() -> bytes:
    signer = mavlink.MAVLink(None, 3, 1)
    signer.signing.secret_key = bytes(32)
    signer.signing.sign_outgoing = True
    signer.signing.timestamp = 1
    return mavlink.MAVLink_heartbeat_message(2, 12, 0, 0, 0, 3).pack(signer)


def frames_in(datagram: bytes) -> list[bytes]:
    return [datagram[start:end] for start, end in spans(datagram)]


def frames_byte_by_byte(datagram: bytes) -> list[bytes]:
    """The plain reference: look at every byte."""
    found, at, end = [], 0, len(datagram)
    while at < end:
        length = 0
        if datagram[at] == V2 and at + 3 <= end:
            length = 12 + datagram[at + 1] + (13 if datagram[at + 2] & SIGNED else 0)
        elif datagram[at] == V1 and at + 2 <= end:
            length = 8 + datagram[at + 1]
        if length and at + length <= end:
            found.append(datagram[at : at + length])
            at += length
        else:
            at += 1
    return found


def test_frames_of_both_versions_signed_or_not_are_split_whole() -> None:
    frames = [signed_frame(), frame(), frame(force_mavlink1=True), frame(8)]
    assert frames_in(b"".join(frames)) == frames


def test_bytes_outside_frames_are_skipped() -> None:
    a, b = frame(1), frame(2)
    assert frames_in(b"") == []
    assert frames_in(b"hello") == []
    assert frames_in(b"\x00\x01" + a + b"zz" + b) == [a, b]
    assert frames_in(a[:-1]) == []
    assert frames_in(signed_frame()[:-1]) == []
    assert frames_in(b"\xfd") == []
    assert frames_in(bytes(65507) + a) == [a]


PIECES = st.one_of(
    st.binary(max_size=30), st.just(frame()), st.just(signed_frame()), st.just(frame(force_mavlink1=True)),
    st.sampled_from([frame()[:-5], signed_frame()[:-3], b"\xfd\x04\x01", b"\xfe\x03", b"\xfd" * 9, b"\xfe" * 300]),
)  # fmt: skip


@given(st.lists(PIECES, max_size=8))
@settings(max_examples=300, deadline=None, derandomize=True)
def test_frames_are_those_found_byte_by_byte(pieces: list[bytes]) -> None:
    datagram = b"".join(pieces)
    assert frames_in(datagram) == frames_byte_by_byte(datagram)
