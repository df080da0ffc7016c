"""Schedule of faults: times, vehicles, and the order of several."""

import itertools
import math

import pytest
from fault_injection import SYSTEM, TAKE_OFF, codec_frames, fault, injected, position, reported, sent

from gcs.faults import KINDS
from vehicle_sim.faults.active import Schedule
from vehicle_sim.faults.fault_injector import FaultInjector, faults_record

RANDOM = (
    "packet_loss", "burst_loss", "jitter", "reordering", "duplication", "corruption", "bad_checksum", "truncation",
)  # fmt: skip


def test_fault_is_inactive_before_take_off_and_outside_its_times():
    disturbed = FaultInjector([fault("partition", 1.0, 0.5, every=2.0, times=2)], 1, SYSTEM)
    assert disturbed.from_vehicle(1, [(b"x", "a")], 100.0) == [(b"x", "a")]
    disturbed.took_off(TAKE_OFF)
    lost = sorted({round(i * 0.02, 2) for i in range(400)} - {round(s, 2) for _, s, _, _ in sent(disturbed, 400)})
    expected = [round(i * 0.02, 2) for i in range(400) if 50 <= i < 75 or 150 <= i < 175]
    assert lost == expected
    record = faults_record(disturbed, TAKE_OFF + 3.2)["faults"][0]
    assert (record["occurrences"], record["activations"]) == (2, [(1.0, 1.5), (3.0, None)])
    assert (record["seen"], record["disturbed"]) == (50, 50)
    assert faults_record(disturbed, TAKE_OFF + 0.9)["faults"][0]["occurrences"] == 0


def test_fault_disturbs_its_vehicles_in_its_direction_only():
    disturbed = injected(fault("partition", vehicles=(2, 3), direction="command"))
    for vehicle, direction in itertools.product((1, 2, 3, 4), ("telemetry", "command")):
        arrived = sent(disturbed, 5, vehicle=vehicle, direction=direction)
        assert len(arrived) == (0 if direction == "command" and vehicle in (2, 3) else 5)
    assert not sent(injected(fault("partition")), 5, vehicle=4, direction="telemetry")
    assert (
        len(sent(injected(fault("low_rate")), 5, direction="command", message=lambda i: codec_frames(position(i)))) == 5
    )


@pytest.mark.parametrize("kind", [k.name for k in KINDS.values() if k.family in ("link", "timing")])
def test_every_fault_of_datagrams_repeats_and_depends_on_seed_number_vehicle_and_direction(kind):
    def run(seed=1, before=0, vehicle=1, direction="telemetry"):
        disturbed = injected(*[fault("jitter", 1e6)] * before, fault(kind, duration=5.0), seed=seed)
        return sent(disturbed, 300, vehicle=vehicle, direction=direction, message=lambda i: codec_frames(position(i)))

    assert run() == run()
    random = kind in RANDOM
    others = [run(seed=2), run(before=1), run(vehicle=2), run(direction="command")]
    if random:
        assert all(other != run() for other in others)
        assert len({str(other) for other in others}) == 4
    else:
        assert others[0] == run()


def test_faults_act_in_sequence_in_order_of_mission():
    bias, scale = (fault(kind, channel="velocity", axes=["x"]) for kind in ("bias", "scale"))
    assert reported(injected(bias, scale), 1.0).position.velocity[0] == pytest.approx((0.1 + 0.5) * 1.1)
    assert reported(injected(scale, bias), 1.0).position.velocity[0] == pytest.approx(0.1 * 1.1 + 0.5)
    delayed = sent(injected(fault("latency", delay=0.1), fault("partition", 1.0, 0.5)), 100)
    assert set(range(100)) - {n for n, *_ in delayed} == set(range(45, 70))  # lost when they come to it


def test_combined_faults_stay_within_32_bit_floats():
    huge = [fault("scale", channel="position", factor=1e3) for _ in range(30)]
    assert max(map(abs, reported(injected(*huge), 1.0).position.position)) <= 1e30


@pytest.mark.parametrize(
    ("duration", "every", "times"), [(None, None, None), (0.7, None, None), (0.7, 2.0, None), (0.7, 2.0, 3)]
)
def test_active_time_and_occurrences_are_those_of_the_active_moments(duration, every, times):
    schedule, step = Schedule(1.5, duration, every, times), 0.01
    assert schedule.active_time(9.0) == 0.0 and schedule.at(9.0) is None and schedule.occurrences(9.0, 5) == (0, [])
    schedule.origin = 4.0
    active, seen = 0, set()
    for k in range(1200):
        now = step * (k + 0.5)
        assert schedule.active_time(now) == pytest.approx(active * step, abs=1.1 * step)
        moment = schedule.at(now)
        if moment is not None:
            active += 1
            seen.add(moment.occurrence)
            assert moment.elapsed == pytest.approx(now - 5.5 - moment.occurrence * (every or 0.0))
            end = 5.5 + moment.occurrence * (every or 0.0) + (duration or math.inf)
            assert schedule.end_after(now) == pytest.approx(end)
        else:
            assert schedule.end_after(now) == math.inf
        count, spans = schedule.occurrences(now, 2)
        assert count == len(seen) and len(spans) == min(count, 2)
        for j, (begin, end) in enumerate(spans):
            assert begin == pytest.approx(1.5 + j * (every or 0.0))
            over = duration is not None and begin + duration <= now - 4.0
            assert end == (pytest.approx(begin + duration) if over else None)
