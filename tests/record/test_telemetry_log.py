"""Telemetry log: every frame of every datagram, also of a damaged file."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest
from pymavlink import mavutil
from pymavlink.dialects.v20 import common as mavlink

from gcs.record.tlog import TelemetryLog


def frames(count: int, **options) -> list[bytes]:
    sender = mavlink.MAVLink(None, srcSystem=3, srcComponent=1)
    made = []
    for i in range(count):
        message = mavlink.MAVLink_attitude_message(i * 20, 0.1, -0.2, 0.3, 0.0, 0.0, 0.0)
        made.append(message.pack(sender, **options))
        sender.seq = (sender.seq + 1) % 256
    return made


def read_back(path: Path) -> list:
    log = mavutil.mavlink_connection(str(path))
    messages = []
    while (message := log.recv_match()) is not None:
        messages.append(message)
    log.close()
    return messages


def test_pymavlink_reads_every_frame_of_every_datagram(tmp_path) -> None:
    a, b, c = frames(3)
    old = frames(1, force_mavlink1=True)[0]
    with TelemetryLog(tmp_path / "telemetry.tlog", start_epoch=1.7e9) as log:
        log.write(0.0, a + b)
        log.write(0.1, old)
        log.write(12.345678, c)
    messages = read_back(tmp_path / "telemetry.tlog")
    assert [m.get_type() for m in messages] == ["ATTITUDE"] * 4
    assert [m.time_boot_ms for m in messages] == [0, 20, 0, 40]
    assert [m.get_srcSystem() for m in messages] == [3] * 4
    stamps = [m._timestamp - 1.7e9 for m in messages]
    assert stamps == pytest.approx([0.0, 0.0, 0.1, 12.345678], abs=5e-6)


def test_bytes_are_stamp_and_frame(tmp_path) -> None:
    frame = frames(1)[0]
    for name in ("a.tlog", "b.tlog"):
        with TelemetryLog(tmp_path / name, start_epoch=100.0) as log:
            log.write(0.5, frame)
    assert (tmp_path / "a.tlog").read_bytes() == struct.pack(">Q", 100_500_000) + frame
    assert (tmp_path / "a.tlog").read_bytes() == (tmp_path / "b.tlog").read_bytes()


def test_frames_of_an_exchange_are_written_at_its_end_or_when_the_log_is_closed(tmp_path) -> None:
    path, (first, second) = tmp_path / "telemetry.tlog", frames(2)
    log = TelemetryLog(path, start_epoch=1.7e9)
    log.write(0.0, first)
    assert path.read_bytes() == b""
    log.flush()
    whole = path.read_bytes()
    assert whole.endswith(first)
    log.write(0.1, second)
    log.close()
    assert path.read_bytes().endswith(second)
    assert path.read_bytes().startswith(whole)
