"""What every kind of fault does, on the passage itself: samples and datagrams in, samples and datagrams out."""

import itertools
import math

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest

from gcs.config import read_system
from gcs.faults import KINDS
from gcs.mission import Fault
from gcs.wire.codec import Codec
from vehicle_sim.faults import FaultPassage
from vehicle_sim.faults.record import faults_record
from vehicle_sim.range_sensor import Detection, RangeSample
from vehicle_sim.sensors import Measurement

SYSTEM = read_system()
TAKE_OFF = 3.0
STILL = Measurement(0.0, (1.0, 0.0, 0.0, 0.0), (0.01, 0.02, 0.03), (1.0, 2.0, -5.0), (0.1, 0.2, 0.3))
# What every kind needs in order to be.
NEEDED = {
    "packet_loss": {"probability": 0.3}, "latency": {"delay": 0.1}, "jitter": {"spread": 0.1},
    "reordering": {"probability": 0.3}, "duplication": {"probability": 0.3}, "corruption": {"probability": 0.5},
    "bad_checksum": {"probability": 0.5}, "truncation": {"probability": 0.5}, "bandwidth_cap": {"rate": 1000.0},
    "burst_loss": {"burst": 0.3, "gap": 0.6}, "flapping": {"down": 0.2, "up": 0.3},
    "clock_skew": {"rate": 0.01}, "clock_step": {"step": 0.5},
    "stale_stamps": {"age": 0.3}, "swapped_vehicles": {"other": 2}, "position_glitch": {"size": 2.0},
    "position_drift": {"velocity": [0.1, 0.0, 0.0]}, "wind": {"velocity": [3.0, 0.0, 0.0]},
    "payload_mass": {"change": 0.5}, "bias": {"amount": 0.5}, "drift": {"rate": 0.1}, "scale": {"factor": 1.1},
    "spikes": {"probability": 0.2, "amount": 1.0}, "quantisation": {"step": 0.5}, "noise": {"factor": 5.0},
}  # fmt: skip


def passage(*faults, seed=1):
    made = FaultPassage(faults, seed, SYSTEM)
    made.took_off(TAKE_OFF)
    return made


def fault(kind, start=0.0, duration=None, **more):
    outer = {key: more.pop(key) for key in ("every", "times", "vehicles", "direction") if key in more}
    return Fault(kind, start, duration, settings={**NEEDED.get(kind, {}), **more}, **outer)


def at(time):
    return STILL._replace(time=TAKE_OFF + time)


def sent(disturbed, count, gap=0.02, vehicle=1, message=lambda i: i.to_bytes(4, "little") * 10, way="telemetry"):
    """(serial, sent at, arrived at, bytes) of what arrives of ``count`` datagrams, s after take-off."""
    cross = disturbed.from_vehicle if way == "telemetry" else disturbed.to_vehicle
    serials, arrived = {}, []
    due = [TAKE_OFF + i * gap for i in range(count)]
    i = 0
    while True:
        timer = disturbed.next_timer()
        now = min([*due[i : i + 1], *([] if timer is None else [timer])], default=None)
        if now is None:
            return arrived
        batch = []
        if i < count and now == due[i]:
            data = message(i)
            serials[i] = now
            batch = [(data, i)]  # the address tells which one it is
            i += 1
        arrived += [(n, serials[n] - TAKE_OFF, now - TAKE_OFF, data) for data, n in cross(vehicle, batch, now)]


def codec_frames(*messages):
    codec = Codec(1, 1)
    return b"".join(codec.encode(message) for message in messages)


def position(stamp):
    return mavlink.MAVLink_local_position_ned_message(stamp, 1.0, 2.0, 3.0, 0.0, 0.0, 0.0)


RANDOM = (
    "packet_loss", "burst_loss", "jitter", "reordering", "duplication", "corruption", "bad_checksum", "truncation",
)  # fmt: skip


# Time


def test_nothing_happens_before_take_off_and_outside_of_the_times():
    disturbed = FaultPassage([fault("partition", 1.0, 0.5, every=2.0, times=2)], 1, SYSTEM)
    assert disturbed.from_vehicle(1, [(b"x", "a")], 100.0) == [(b"x", "a")]
    disturbed.took_off(TAKE_OFF)
    lost = sorted({round(i * 0.02, 2) for i in range(400)} - {round(s, 2) for _, s, _, _ in sent(disturbed, 400)})
    expected = [round(i * 0.02, 2) for i in range(400) if 50 <= i < 75 or 150 <= i < 175]
    assert lost == expected
    record = faults_record(disturbed, TAKE_OFF + 3.2)["faults"][0]
    assert (record["occurrences"], record["activations"]) == (2, [(1.0, 1.5), (3.0, None)])
    assert (record["seen"], record["disturbed"]) == (50, 50)
    assert faults_record(disturbed, TAKE_OFF + 0.9)["faults"][0]["occurrences"] == 0


def test_a_fault_is_of_its_vehicles_and_of_its_direction():
    disturbed = passage(fault("partition", vehicles=(2, 3), direction="command"))
    for vehicle, way in itertools.product((1, 2, 3, 4), ("telemetry", "command")):
        arrived = sent(disturbed, 5, vehicle=vehicle, way=way)
        assert len(arrived) == (0 if way == "command" and vehicle in (2, 3) else 5)
    assert not sent(passage(fault("partition")), 5, vehicle=4, way="telemetry")
    assert len(sent(passage(fault("low_rate")), 5, way="command", message=lambda i: codec_frames(position(i)))) == 5


@pytest.mark.parametrize("kind", [k.name for k in KINDS.values() if k.family in ("link", "timing")])
def test_every_fault_of_datagrams_repeats_and_depends_on_seed_number_vehicle_and_direction(kind):
    def run(seed=1, before=0, vehicle=1, way="telemetry"):
        disturbed = passage(*[fault("jitter", 1e6)] * before, fault(kind, duration=5.0), seed=seed)
        return sent(disturbed, 300, vehicle=vehicle, way=way, message=lambda i: codec_frames(position(i)))

    assert run() == run()
    random = kind in RANDOM
    others = [run(seed=2), run(before=1), run(vehicle=2), run(way="command")]
    if random:
        assert all(other != run() for other in others)
        assert len({str(other) for other in others}) == 4
    else:
        assert others[0] == run()


# Links


def test_loss_is_as_frequent_as_asked_for_and_independent():
    arrived = [n for n, *_ in sent(passage(fault("packet_loss", probability=0.3)), 10_000)]
    assert len(arrived) == pytest.approx(7000, abs=4 * math.sqrt(10_000 * 0.3 * 0.7))
    both = sum(1 for a, b in itertools.pairwise(arrived) if b - a == 1)
    assert both == pytest.approx(4900, abs=200)


def test_bursts_have_their_lengths():
    arrived = [n for n, *_ in sent(passage(fault("burst_loss", burst=0.5, gap=2.0)), 50_000, gap=0.01)]
    bursts = [b - a - 1 for a, b in itertools.pairwise(arrived) if b - a > 1]
    assert len(bursts) == pytest.approx(200, abs=50)
    assert np.mean(bursts) * 0.01 == pytest.approx(0.5, rel=0.25)
    part = sent(passage(fault("burst_loss", burst=1e3, gap=1e-3, loss_in_burst=0.4)), 5000)
    assert len(part) == pytest.approx(3000, abs=150)


def test_latency_and_jitter_delay_in_order_and_add_up():
    arrived = sent(passage(fault("latency", duration=2.0, delay=0.06), fault("jitter", spread=0.02)), 200)
    assert [n for n, *_ in arrived] == list(range(200))
    delays = np.array([arrival - begin for _, begin, arrival, _ in arrived])
    assert delays[:100].min() >= 0.06 - 1e-9 and delays[:100].max() <= 0.08 + 1e-9
    assert delays[:100].std() > 0.003
    assert np.mean(delays[:100]) == pytest.approx(0.07, abs=0.003)
    assert np.all(delays[105:] <= 0.02 + 1e-9)


def test_reordering_lets_some_be_overtaken_and_loses_none():
    arrived = sent(passage(fault("reordering", probability=0.2, delay=0.05)), 2000)
    order = [n for n, *_ in arrived]
    assert sorted(order) == list(range(2000)) and order != sorted(order)
    late = [arrival - begin for _, begin, arrival, _ in arrived if arrival > begin]
    assert len(late) == pytest.approx(400, abs=80)
    assert late == pytest.approx([0.05] * len(late))


def test_duplication_doubles_some():
    order = [n for n, *_ in sent(passage(fault("duplication", probability=0.25, delay=0.03)), 2000)]
    twice = [n for n in set(order) if order.count(n) == 2]
    assert set(order) == set(range(2000)) and len(order) == 2000 + len(twice)
    assert len(twice) == pytest.approx(500, abs=80)


def test_corruption_changes_as_many_bytes_as_asked_for():
    arrived = sent(passage(fault("corruption", probability=0.5, bytes=3)), 1000)
    pairs = [(data, n.to_bytes(4, "little") * 10) for n, _, _, data in arrived]
    changed = [sum(a != b for a, b in zip(data, sent_data, strict=True)) for data, sent_data in pairs]
    assert set(changed) == {0, 3}
    assert changed.count(3) == pytest.approx(500, abs=65)


def test_a_bad_checksum_spoils_every_frame_and_nothing_but_checksums():
    good = codec_frames(position(1), position(2))
    arrived = sent(passage(fault("bad_checksum", probability=1.0)), 50, message=lambda i: good)
    for *_, data in arrived:
        decoder = Codec(255, 1)
        assert not decoder.decode(data)
        assert decoder.bad_frames >= 2
        assert sum(a != b for a, b in zip(data, good, strict=True)) == 2


def test_truncation_cuts_off():
    arrived = sent(passage(fault("truncation", probability=0.5)), 1000)
    cut = [data for *_, data in arrived if len(data) < 40]
    assert len(arrived) == 1000 and len(cut) == pytest.approx(500, abs=65)
    assert min(map(len, cut)) < 5 and max(map(len, cut)) == 39 and all(cut)


def test_a_bandwidth_cap_queues_and_then_loses():
    arrived = sent(passage(fault("bandwidth_cap", rate=1000.0, queue=400)), 500, gap=0.02)  # 2000 bytes/s wanted
    assert [n for n, *_ in arrived] == sorted(n for n, *_ in arrived)
    assert len(arrived) * 40 == pytest.approx(10_400, abs=100)
    assert max(arrival - begin for _, begin, arrival, _ in arrived) == pytest.approx(0.4, abs=0.021)
    slow = sent(passage(fault("bandwidth_cap", rate=1000.0)), 50, gap=0.1)
    assert all(arrival - begin == pytest.approx(0.04) for _, begin, arrival, _ in slow)


def test_a_stall_holds_everything_back_and_lets_it_go_at_once_in_order():
    arrived = sent(passage(fault("stall", start=1.0, duration=1.0)), 200)
    assert [n for n, *_ in arrived] == list(range(200))
    held = [arrival for _, begin, arrival, _ in arrived if 1.0 <= round(begin, 6) < 2.0]
    assert len(held) == 50 and held == pytest.approx([2.0] * 50)
    assert all(arrival == begin for _, begin, arrival, _ in arrived if not 0.99 < begin < 1.99)


def test_flapping_goes_down_and_up():
    up = {n for n, *_ in sent(passage(fault("flapping", down=0.2, up=0.3)), 100, gap=0.05)}
    assert up == {i for i in range(100) if i % 10 >= 4}


# Timing


@pytest.mark.parametrize(("share", "kept"), [(0.5, 50), (0.25, 25), (0.3, 30), (1.0, 100)])
def test_half_rate_is_an_even_share_of_measurements_and_all_of_the_rest(share, kept):
    def message(i):
        points = [mavlink.MAVLink_obstacle_distance_3d_message(i, 0, 12, k, 1.0, 1.0, 1.0, 0.1, 9.0) for k in range(3)]
        beat = mavlink.MAVLink_heartbeat_message(2, 12, 0, 0, 0, 3)
        return codec_frames(position(i), beat, *points)

    decoder = Codec(255, 1)
    arrived = sent(passage(fault("low_rate", share=share)), 100, message=message)
    messages = [m for *_, data in arrived for m in decoder.decode(data)]
    stamps = [m.time_boot_ms for m in messages if m.get_type() == "LOCAL_POSITION_NED"]
    assert len(stamps) == kept
    assert max(np.diff(stamps)) <= math.ceil(1 / share)
    assert len([m for m in messages if m.get_type() == "OBSTACLE_DISTANCE_3D"]) == 3 * kept
    assert len([m for m in messages if m.get_type() == "HEARTBEAT"]) == 100
    assert decoder.bad_frames == 0


def test_a_hanging_ground_still_beats():
    beat = codec_frames(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3))
    disturbed = passage(fault("ground_hang", start=0.1))
    arrived = sent(disturbed, 10, way="command", message=lambda i: beat + codec_frames(position(i)))
    assert [len(Codec(1, 1).decode(data)) for *_, data in arrived] == [2] * 5 + [1] * 5
    assert all(data.startswith(beat) for *_, data in arrived)
    assert len(sent(disturbed, 10, way="telemetry")) == 10


def test_clocks_run_away_step_and_overflow():
    skew = passage(fault("clock_skew", 1.0, 2.0, rate=0.01, vehicles=(1,)))
    errors = [round(skew.clock(1, TAKE_OFF + t) - TAKE_OFF - t, 9) for t in (0.5, 1.0, 2.0, 3.0, 9.0)]
    assert errors == [0, 0, 0.01, 0.02, 0.02]
    assert skew.clock(2, 50.0) == 50.0
    step = passage(fault("clock_step", 1.0, 2.0, step=-0.5))
    assert [round(step.clock(1, TAKE_OFF + t) - TAKE_OFF - t, 9) for t in (0.5, 1.0, 2.9, 3.0)] == [0, -0.5, -0.5, 0]
    wrap = passage(fault("stamp_wrap", 1.0, lead=2.0))
    stamps = [round(wrap.clock(1, TAKE_OFF + t) * 1e3) & 0xFFFFFFFF for t in (0.9, 1.0, 2.99, 3.01)]
    assert stamps == [3900, 2**32 - 2000, 2**32 - 10, 10]


def test_stale_stamps_are_on_everything_that_is_told_but_not_on_what_is_flown_by():
    disturbed = passage(fault("stale_stamps", age=0.5, vehicles=(1,)))
    told = disturbed.told(1, at(1.0))
    assert told.attitude.time == told.position.time == TAKE_OFF + 0.5
    assert disturbed.payload_sample(1, at(1.0)).time == TAKE_OFF + 0.5
    assert disturbed.range_sample(1, RangeSample(TAKE_OFF + 1.0, 9.0, ())).time == TAKE_OFF + 0.5
    assert disturbed.own_sample(1, at(1.0)).time == TAKE_OFF + 1.0
    assert disturbed.told(2, at(1.0)).position.time == TAKE_OFF + 1.0


# Values


def told(disturbed, time, vehicle=1, **values):
    return disturbed.told(vehicle, at(time)._replace(**values))


def positions(disturbed, count=2000, vehicle=1):
    return np.array([told(disturbed, i * 0.01, vehicle).position.position for i in range(count)]) - STILL.position


def test_bias_drift_scale_sign_frame_and_quantisation():
    assert positions(passage(fault("bias", channel="position", amount=0.5, axes=["x", "z"])), 3) == pytest.approx(
        np.tile([0.5, 0.0, 0.5], (3, 1))
    )
    drift = passage(fault("drift", start=2.0, channel="position", rate=0.1, axes=["y"]))
    assert told(drift, 1.9).position.position[1] == 2.0
    assert told(drift, 7.0).position.position[1] == pytest.approx(2.5)
    assert told(passage(fault("scale", channel="velocity", factor=2.0)), 1.0).position.velocity == (0.2, 0.4, 0.6)
    assert told(passage(fault("flipped_sign", channel="rates")), 1.0).attitude.rates == (-0.01, -0.02, -0.03)
    assert told(passage(fault("swapped_frame", channel="position")), 1.0).position.position == (2.0, 1.0, 5.0)
    coarse = passage(fault("quantisation", channel="velocity", step=0.25))
    assert told(coarse, 1.0).position.velocity == (0.0, 0.25, 0.25)


def test_stuck_values_stay_and_begin_anew_each_time():
    disturbed = passage(fault("stuck", 1.0, 1.0, every=2.0, channel="velocity"))
    seen = [told(disturbed, t / 2, velocity=(t, t, t)).position.velocity[0] for t in range(10)]
    assert seen == [0, 1, 2, 2, 4, 5, 6, 6, 8, 9]


def test_spikes_are_single_samples_of_the_right_size_and_number():
    off = positions(passage(fault("spikes", channel="position", probability=0.1, amount=2.0)), 5000)
    hit = np.any(off != 0.0, axis=1)
    assert hit.sum() == pytest.approx(500, abs=90)
    assert np.abs(off[hit]) == pytest.approx(np.full((hit.sum(), 3), 2.0))
    assert (off[hit] > 0.0).mean() == pytest.approx(0.5, abs=0.08)


@pytest.mark.parametrize("value", ["nan", "inf", "-inf"])
def test_not_a_number(value):
    velocity = told(passage(fault("not_a_number", channel="velocity", value=value)), 0.0).position.velocity
    assert [repr(v) for v in velocity] == [value] * 3
    attitude = told(passage(fault("not_a_number", channel="attitude", value=value)), 0.0).attitude
    assert not any(math.isfinite(q) for q in attitude.attitude) and attitude.rates == STILL.rates
    half = passage(fault("not_a_number", channel="velocity", axes=["y"], probability=0.5))
    seen = [told(half, i * 0.01).position.velocity for i in range(1000)]
    assert sum(v[1] != v[1] for v in seen) == pytest.approx(500, abs=65)
    assert all(v[0] == 0.1 for v in seen)


def test_noise_adds_up_to_the_factor():
    off = positions(passage(fault("noise", channel="position", factor=5.0)), 5000)
    own = SYSTEM.sensors.position
    assert math.hypot(off.std(), own) == pytest.approx(5.0 * own, rel=0.03)
    assert abs(off.mean()) < 5.0 * own * 0.05
    assert not np.any(positions(passage(fault("noise", channel="position", factor=1.0)), 5))


def test_intermittent_values_stick_for_random_times():
    disturbed = passage(fault("intermittent", channel="velocity", good=1.0, stuck=0.5))
    seen = [told(disturbed, i * 0.01, velocity=(i, i, i)).position.velocity[0] for i in range(60_000)]
    stuck = np.diff(seen) == 0
    assert stuck.mean() == pytest.approx(1 / 3, abs=0.06)
    assert seen[0] == 0 and max(np.array(range(60_000)) - seen) > 50


def test_attitude_is_disturbed_as_a_rotation():
    tilted = (math.cos(0.1), math.sin(0.1), 0.0, 0.0)
    bias = passage(fault("bias", channel="attitude", amount=0.3, axes=["x"]))
    off = told(bias, 1.0, attitude=tilted).attitude.attitude
    assert off == pytest.approx((math.cos(0.25), math.sin(0.25), 0.0, 0.0))
    back = told(passage(fault("flipped_sign", channel="attitude")), 1.0, attitude=tilted).attitude.attitude
    assert back == pytest.approx((math.cos(0.1), -math.sin(0.1), 0.0, 0.0))


def test_only_what_is_told_is_wrong_unless_the_source_is():
    outside = passage(fault("bias", channel="position", amount=1.0))
    assert outside.own_sample(1, at(1.0)) == at(1.0)
    assert outside.told(1, at(1.0)).attitude == at(1.0)  # of the position alone
    inside = passage(fault("bias", channel="position", amount=1.0, at_source=True))
    assert inside.own_sample(1, at(1.0)).position == (2.0, 3.0, -4.0)
    assert inside.told(1, at(1.0)).position == at(1.0)  # is given what the autopilot has


def test_the_payload_unit_is_wrong_for_all_alike_or_for_one_relay():
    unit = passage(fault("noise", channel="payload_position", at_source=True))
    sample = at(1.0)
    relayed = {unit.payload_sample(i, sample).position for i in (1, 2, 3, 4)}
    assert len(relayed) == 1 and relayed != {STILL.position}
    relays = passage(fault("noise", channel="payload_position"))
    assert len({relays.payload_sample(i, sample).position for i in (1, 2, 3, 4)}) == 4
    one = passage(fault("bias", channel="payload_velocity", amount=1.0, vehicles=(3,)))
    assert [one.payload_sample(i, sample).velocity[0] for i in (1, 2, 3, 4)] == pytest.approx([0.1, 0.1, 1.1, 0.1])
    assert one.told(3, sample).position is sample


def test_points_of_obstacles_are_a_channel():
    def scan(time, distance):
        return RangeSample(TAKE_OFF + time, 9.0, tuple(Detection(0, (distance, float(k), 0.0)) for k in range(3)))

    far = passage(fault("scale", channel="obstacles", factor=2.0)).range_sample(1, scan(1.0, 4.0))
    assert [d.position_in_body for d in far.detections] == [(8.0, 0.0, 0.0), (8.0, 2.0, 0.0), (8.0, 4.0, 0.0)]
    stuck = passage(fault("stuck", channel="obstacles"))
    stuck.range_sample(1, scan(1.0, 4.0))
    later = stuck.range_sample(1, scan(1.1, 3.0)).detections
    assert [d.position_in_body[:2] for d in later] == [(4, 0), (4, 1), (4, 2)]


def test_two_vehicles_tell_each_others_data():
    disturbed = passage(fault("swapped_vehicles", vehicles=(1,), other=2))
    samples = {i: at(1.0)._replace(position=(float(i), 0.0, 0.0)) for i in (1, 2, 3)}
    for _ in range(2):
        seen = [disturbed.told(i, samples[i]).position.position[0] for i in (1, 2, 3)]
    assert seen == [2.0, 1.0, 3.0]


VALUE_KINDS = [k.name for k in KINDS.values() if k.family == "values" and k.name != "swapped_vehicles"]


@pytest.mark.parametrize("kind", VALUE_KINDS)
@pytest.mark.parametrize("channel", ["position", "velocity", "attitude", "rates", "payload_position", "obstacles"])
def test_every_value_fault_acts_on_every_channel_and_repeats(kind, channel):
    def run(seed=1):
        more = {"good": 0.05} if kind == "intermittent" else {}
        disturbed = passage(fault(kind, channel=channel, **more), seed=seed)
        seen = []
        for i in range(100):
            sample = at(i * 0.02)._replace(
                position=(0.3 + i, 2.0, -5.0), velocity=(0.1 + i, 0.2, 0.3), rates=(0.01 * i, 0.02, 0.03),
                attitude=(math.cos(0.01 * i), math.sin(0.01 * i), 0.0, 0.0),
            )  # fmt: skip
            scan = RangeSample(sample.time, 9.0, (Detection(0, (1.3 + 0.01 * i, 2.0, 3.0)),))
            seen += [disturbed.told(1, sample), disturbed.payload_sample(1, sample), disturbed.range_sample(1, scan)]
        assert disturbed.faults[0].disturbed > 0
        return repr(seen)

    assert run() == run()
    if kind in ("spikes", "noise", "intermittent"):
        assert run(2) != run()


# Sensors


def test_lost_sensors():
    blind = passage(fault("position_lost", 1.0))
    first = blind.own_sample(1, at(1.0))
    moved = blind.own_sample(1, at(2.0)._replace(position=(9.0, 9.0, 9.0), rates=(1.0, 1.0, 1.0)))
    assert (moved.position, moved.velocity, moved.rates) == (first.position, first.velocity, (1.0, 1.0, 1.0))
    assert blind.told(1, moved) == (moved, None)
    assert passage(fault("position_lost", onboard=False)).own_sample(1, at(1.0)) == at(1.0)

    assert passage(fault("attitude_lost")).told(1, at(1.0)) == (None, at(1.0))
    assert passage(fault("attitude_lost")).own_sample(1, at(1.0)) == at(1.0)
    dizzy = passage(fault("attitude_lost", onboard=True))
    dizzy.own_sample(1, at(1.0))
    assert dizzy.own_sample(1, at(2.0)._replace(attitude=(0.0, 1.0, 0.0, 0.0))).attitude == STILL.attitude

    rates = passage(fault("rates_lost")).told(1, at(1.0))
    assert all(math.isnan(w) for w in rates.attitude.rates) and rates.position == at(1.0)

    lost = passage(fault("payload_unit_lost", vehicles=(2,)))
    assert lost.payload_sample(2, at(1.0)) is None and lost.payload_sample(1, at(1.0)) == at(1.0)
    scan = RangeSample(TAKE_OFF + 1.0, 9.0, (Detection(0, (1.0, 1.0, 1.0)),))
    dark = passage(fault("obstacle_sensing_lost", vehicles=(2,)))
    assert dark.range_sample(2, scan).detections == () and dark.range_sample(1, scan) is scan


def test_a_glitching_and_a_drifting_position():
    glitch = passage(fault("position_glitch", size=3.0, rate=0.5, hold=0.2))
    seen = np.array([glitch.own_sample(1, at(i * 0.01)).position for i in range(20_000)]) - STILL.position
    away = np.hypot(seen[:, 0], seen[:, 1]) > 0.0
    assert np.hypot(*seen[away, :2].T) == pytest.approx(np.full(away.sum(), 3.0))
    assert not np.any(seen[:, 2])
    assert away.mean() == pytest.approx(0.2 / 2.2, abs=0.03)
    drift = passage(fault("position_drift", start=1.0, velocity=[0.1, -0.2, 0.0]))
    assert drift.own_sample(1, at(6.0)).position == pytest.approx((1.5, 1.0, -5.0))
    assert drift.own_sample(1, at(6.0)).velocity == STILL.velocity


# Together


def test_faults_act_one_after_the_other_in_the_missions_order():
    bias, scale = (fault(kind, channel="velocity", axes=["x"]) for kind in ("bias", "scale"))
    assert told(passage(bias, scale), 1.0).position.velocity[0] == pytest.approx((0.1 + 0.5) * 1.1)
    assert told(passage(scale, bias), 1.0).position.velocity[0] == pytest.approx(0.1 * 1.1 + 0.5)
    delayed = sent(passage(fault("latency", delay=0.1), fault("partition", 1.0, 0.5)), 100)
    assert set(range(100)) - {n for n, *_ in delayed} == set(range(45, 70))  # lost when they come to it


def test_whatever_is_combined_can_be_told_in_32_bits():
    huge = [fault("scale", channel="position", factor=1e3) for _ in range(30)]
    assert max(map(abs, told(passage(*huge), 1.0).position.position)) <= 1e30
