"""Completeness of scans on a MAVLink link that loses, repeats and reorders datagrams."""

import random

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gcs.mavlink.codec import Codec, gather
from gcs.mavlink.layout import LAYOUTS, PackedRun, Sample
from gcs.mavlink.telemetry import scan_end, scan_returns
from gcs.mavlink.vehicle_link import VehicleLink

POINT = LAYOUTS[Sample.RETURNS.value]
ATTITUDE = mavlink.MAVLink_attitude_quaternion_message(1, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def returns(stamp, count):
    values = np.zeros(count, POINT.dtype)
    values["time_boot_ms"], values["x"], values["y"] = stamp, 3.0, np.arange(count)
    values["obstacle_id"], values["max_distance"], values["frame"] = 65535, 10.0, mavlink.MAV_FRAME_BODY_FRD
    return PackedRun(POINT, values)


def end_of(stamp):
    return mavlink.MAVLink_obstacle_distance_message(
        stamp * 1000, mavlink.MAV_DISTANCE_SENSOR_LASER, [65535] * 72, 5, 5, 1000, 0.0, 0.0, mavlink.MAV_FRAME_BODY_FRD
    )


def datagrams_of(codec, stamp, count):
    """What a vehicle sends with a scan: attitudes before it, and its end behind it."""
    frames = [codec.encode(ATTITUDE) for _ in range(4)]
    if count:
        frames += codec.frames(returns(stamp, count))
    return gather([*frames, codec.encode(end_of(stamp))])


class Ground:
    """Reads scans as the ground does: those that ended, with the number of their returns and whether complete."""

    def __init__(self):
        self.codec, self.link = Codec(255, 190), VehicleLink(3, None)
        self.counts, self.ends = {}, []

    def receive(self, datagram, now=0.0):
        messages = self.codec.read(datagram)
        for received in self.link.handle(messages, now):
            if received.layout.sample is Sample.RETURNS:
                part = scan_returns(received)
                self.counts[part.stamp] = self.counts.get(part.stamp, 0) + len(part.points)
            elif received.layout.sample is Sample.SCAN_END:
                is_complete = self.link.statistics.scans.is_complete(received.time_boot_ms)
                self.ends.append(scan_end(received, is_complete))


@pytest.mark.parametrize("count", [0, 1, 29, 100, 256, 600])
def test_scan_of_which_all_messages_came_is_complete(count):
    ground, vehicle = Ground(), Codec(3, 1)
    for stamp in (100, 200, 2**32 - 5):
        for datagram in datagrams_of(vehicle, stamp, count):
            ground.receive(datagram)
    assert ground.counts == (dict.fromkeys((100, 200, 2**32 - 5), count) if count else {})
    assert [(end.stamp, end.max_range, end.is_complete) for end in ground.ends] == [
        (stamp, 10.0, True) for stamp in (100, 200, 2**32 - 5)
    ]


@pytest.mark.parametrize("lost", range(4))
def test_scan_of_which_a_datagram_was_lost_is_not_complete(lost):
    ground, vehicle = Ground(), Codec(3, 1)
    for datagram in datagrams_of(vehicle, 100, 100):
        ground.receive(datagram)
    sent = datagrams_of(vehicle, 200, 100)
    assert len(sent) == 4
    for k, datagram in enumerate(sent):
        if k != lost:
            ground.receive(datagram)
    for datagram in datagrams_of(vehicle, 300, 100):
        ground.receive(datagram)
    # Without its last datagram it has no end; of the next one, the gap is before its attitudes.
    assert [(end.stamp, end.is_complete) for end in ground.ends] == [
        (100, True), *([(200, False)] if lost < 3 else []), (300, True),
    ]  # fmt: skip


@settings(deadline=None, derandomize=True, max_examples=200)
@given(
    st.integers(0, 10_000), st.sampled_from((0.0, 0.05, 0.3)), st.sampled_from((0.0, 0.1)), st.sampled_from((0.0, 0.1))
)
def test_complete_scan_has_all_its_returns(seed, loss, repetition, swap):
    """Whatever the link loses, repeats or reorders; and without any of that, every scan is complete."""
    chance, vehicle, ground = random.Random(seed), Codec(3, 1), Ground()
    sent, stream = {}, []
    for k in range(12):
        sent[k] = chance.choice((0, 3, 40, 150))
        stream += datagrams_of(vehicle, k, sent[k])
    arriving = [d for d in stream if chance.random() >= loss]
    arriving = [d for d in arriving for _ in range(1 + (chance.random() < repetition))]
    for i in range(len(arriving) - 1):
        if chance.random() < swap:
            arriving[i], arriving[i + 1] = arriving[i + 1], arriving[i]
    for datagram in arriving:
        ground.receive(datagram)
        complete = [end for end in ground.ends if end.is_complete]
        assert all(ground.counts.get(end.stamp, 0) >= sent[end.stamp] for end in complete)
    if loss == repetition == swap == 0.0:
        assert [end.stamp for end in ground.ends if end.is_complete] == list(range(12))


@pytest.mark.parametrize("stamp", [0, 7, 2**32 - 1, 2**32, (2**64 - 1) // 1000])
def test_stamp_of_a_scans_end_is_in_milliseconds_modulo_32_bits(stamp):
    [received] = Codec(1, 1).decode(Codec(3, 1).encode(end_of(stamp)))
    assert received.time_boot_ms == stamp % 2**32
