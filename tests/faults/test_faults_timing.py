"""Effects of timing faults on datagrams, clocks and stamps."""

import math

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from fault_injection import TAKE_OFF, at, codec_frames, fault, injected, position, sent

from gcs.mavlink.codec import Codec
from gcs.mavlink.stop_plan import PAYLOAD_TYPE, StopPlanContent, stop_plan_message
from vehicle_sim.world.range_sensor import RangeSample


@pytest.mark.parametrize(("share", "kept"), [(0.5, 50), (0.25, 25), (0.3, 30), (1.0, 100)])
def test_half_rate_is_an_even_share_of_measurements_and_all_of_the_rest(share, kept):
    def message(i):
        points = [mavlink.MAVLink_obstacle_distance_3d_message(i, 0, 12, k, 1.0, 1.0, 1.0, 0.1, 9.0) for k in range(3)]
        beat = mavlink.MAVLink_heartbeat_message(2, 12, 0, 0, 0, 3)
        return codec_frames(position(i), beat, *points)

    decoder = Codec(255, 1)
    arrived = sent(injected(fault("low_rate", share=share)), 100, message=message)
    messages = [received.message for *_, data in arrived for received in decoder.decode(data)]
    stamps = [m.time_boot_ms for m in messages if m.get_type() == "LOCAL_POSITION_NED"]
    assert len(stamps) == kept
    assert max(np.diff(stamps)) <= math.ceil(1 / share)
    assert len([m for m in messages if m.get_type() == "OBSTACLE_DISTANCE_3D"]) == 3 * kept
    assert len([m for m in messages if m.get_type() == "HEARTBEAT"]) == 100
    assert decoder.bad_frames == 0


def test_half_rate_is_an_even_share_of_stop_plans_and_all_of_other_tunnels():
    points = [(0.0, 0.0, -1.0)] * 5

    def message(i):
        plan = stop_plan_message(1, StopPlanContent(7, i, 0.02 * i, 5.0, 4.0, 0.1, points))
        other = mavlink.MAVLink_tunnel_message(1, 1, 40000, 20, [i + 1] * 128)
        return Codec(255, 190).frame(plan) + codec_frames(other)

    decoder = Codec(1, 1)
    arrived = sent(
        injected(fault("low_rate", share=0.5, direction="command")), 100, message=message, direction="command"
    )
    messages = [received.message for *_, data in arrived for received in decoder.decode(data)]
    numbers = [bytes(m.payload)[4] for m in messages if m.payload_type == PAYLOAD_TYPE]
    assert len(numbers) == 50 and set(np.diff(numbers)) == {2}
    assert len([m for m in messages if m.payload_type == 40000]) == 100


def test_ground_hang_passes_heartbeats_only():
    beat = codec_frames(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3))
    disturbed = injected(fault("ground_hang", start=0.1))
    arrived = sent(disturbed, 10, direction="command", message=lambda i: beat + codec_frames(position(i)))
    assert [len(Codec(1, 1).decode(data)) for *_, data in arrived] == [2] * 5 + [1] * 5
    assert all(data.startswith(beat) for *_, data in arrived)
    assert len(sent(disturbed, 10, direction="telemetry")) == 10


def test_clock_faults_skew_step_and_overflow():
    skew = injected(fault("clock_skew", 1.0, 2.0, rate=0.01, vehicles=(1,)))
    errors = [round(skew.clock_of(1)(TAKE_OFF + t) - TAKE_OFF - t, 9) for t in (0.5, 1.0, 2.0, 3.0, 9.0)]
    assert errors == [0, 0, 0.01, 0.02, 0.02]
    assert skew.clock_of(2)(50.0) == 50.0
    step = injected(fault("clock_step", 1.0, 2.0, step=-0.5))
    assert [round(step.clock_of(1)(TAKE_OFF + t) - TAKE_OFF - t, 9) for t in (0.5, 1.0, 2.9, 3.0)] == [0, -0.5, -0.5, 0]
    wrap = injected(fault("stamp_wrap", 1.0, lead=2.0))
    stamps = [round(wrap.clock_of(1)(TAKE_OFF + t) * 1e3) & 0xFFFFFFFF for t in (0.9, 1.0, 2.99, 3.01)]
    assert stamps == [3900, 2**32 - 2000, 2**32 - 10, 10]


def test_stale_stamps_are_in_telemetry_but_not_on_board():
    disturbed = injected(fault("stale_stamps", age=0.5, vehicles=(1,)))
    reported = disturbed.reported_sample(1, at(1.0))
    assert reported.attitude.time == reported.position.time == TAKE_OFF + 0.5
    assert disturbed.payload_sample(1, at(1.0)).time == TAKE_OFF + 0.5
    assert disturbed.range_sample(1, RangeSample(TAKE_OFF + 1.0, 9.0, np.empty((0, 3)))).time == TAKE_OFF + 0.5
    assert disturbed.own_sample(1, at(1.0)).time == TAKE_OFF + 1.0
    assert disturbed.reported_sample(2, at(1.0)).position.time == TAKE_OFF + 1.0
