"""Effects of the link's faults on datagrams."""

import itertools
import math

import numpy as np
import pytest
from fault_injection import codec_frames, fault, injected, position, sent

from gcs.mavlink.codec import Codec


def test_packet_loss_has_its_probability_independently():
    arrived = [n for n, *_ in sent(injected(fault("packet_loss", probability=0.3)), 10_000)]
    assert len(arrived) == pytest.approx(7000, abs=4 * math.sqrt(10_000 * 0.3 * 0.7))
    both = sum(1 for a, b in itertools.pairwise(arrived) if b - a == 1)
    assert both == pytest.approx(4900, abs=200)


def test_burst_loss_has_its_mean_lengths():
    arrived = [n for n, *_ in sent(injected(fault("burst_loss", burst=0.5, gap=2.0)), 50_000, gap=0.01)]
    bursts = [b - a - 1 for a, b in itertools.pairwise(arrived) if b - a > 1]
    assert len(bursts) == pytest.approx(200, abs=50)
    assert np.mean(bursts) * 0.01 == pytest.approx(0.5, rel=0.25)
    part = sent(injected(fault("burst_loss", burst=1e3, gap=1e-3, loss_in_burst=0.4)), 5000)
    assert len(part) == pytest.approx(3000, abs=150)


def test_latency_and_jitter_delay_in_order_and_add_up():
    arrived = sent(injected(fault("latency", duration=2.0, delay=0.06), fault("jitter", spread=0.02)), 200)
    assert [n for n, *_ in arrived] == list(range(200))
    delays = np.array([arrival - begin for _, begin, arrival, _ in arrived])
    assert delays[:100].min() >= 0.06 - 1e-9 and delays[:100].max() <= 0.08 + 1e-9
    assert delays[:100].std() > 0.003
    assert np.mean(delays[:100]) == pytest.approx(0.07, abs=0.003)
    assert np.all(delays[105:] <= 0.02 + 1e-9)


def test_reordering_lets_some_be_overtaken_and_loses_none():
    arrived = sent(injected(fault("reordering", probability=0.2, delay=0.05)), 2000)
    order = [n for n, *_ in arrived]
    assert sorted(order) == list(range(2000)) and order != sorted(order)
    late = [arrival - begin for _, begin, arrival, _ in arrived if arrival > begin]
    assert len(late) == pytest.approx(400, abs=80)
    assert late == pytest.approx([0.05] * len(late))


def test_duplication_doubles_some():
    order = [n for n, *_ in sent(injected(fault("duplication", probability=0.25, delay=0.03)), 2000)]
    twice = [n for n in set(order) if order.count(n) == 2]
    assert set(order) == set(range(2000)) and len(order) == 2000 + len(twice)
    assert len(twice) == pytest.approx(500, abs=80)


def test_corruption_changes_the_given_number_of_bytes():
    arrived = sent(injected(fault("corruption", probability=0.5, bytes=3)), 1000)
    pairs = [(data, n.to_bytes(4, "little") * 10) for n, _, _, data in arrived]
    changed = [sum(a != b for a, b in zip(data, sent_data, strict=True)) for data, sent_data in pairs]
    assert set(changed) == {0, 3}
    assert changed.count(3) == pytest.approx(500, abs=65)


def test_bad_checksum_changes_every_checksum_and_nothing_else():
    good = codec_frames(position(1), position(2))
    arrived = sent(injected(fault("bad_checksum", probability=1.0)), 50, message=lambda i: good)
    for *_, data in arrived:
        decoder = Codec(255, 1)
        assert not decoder.decode(data)
        assert decoder.bad_frames >= 2
        assert sum(a != b for a, b in zip(data, good, strict=True)) == 2


def test_truncation_shortens_datagrams():
    arrived = sent(injected(fault("truncation", probability=0.5)), 1000)
    cut = [data for *_, data in arrived if len(data) < 40]
    assert len(arrived) == 1000 and len(cut) == pytest.approx(500, abs=65)
    assert min(map(len, cut)) < 5 and max(map(len, cut)) == 39 and all(cut)


def test_bandwidth_cap_queues_then_loses():
    arrived = sent(injected(fault("bandwidth_cap", rate=1000.0, queue=400)), 500, gap=0.02)  # 2000 bytes/s wanted
    assert [n for n, *_ in arrived] == sorted(n for n, *_ in arrived)
    assert len(arrived) * 40 == pytest.approx(10_400, abs=100)
    assert max(arrival - begin for _, begin, arrival, _ in arrived) == pytest.approx(0.4, abs=0.021)
    slow = sent(injected(fault("bandwidth_cap", rate=1000.0)), 50, gap=0.1)
    assert all(arrival - begin == pytest.approx(0.04) for _, begin, arrival, _ in slow)


def test_stall_delays_all_and_releases_all_in_order():
    arrived = sent(injected(fault("stall", start=1.0, duration=1.0)), 200)
    assert [n for n, *_ in arrived] == list(range(200))
    held = [arrival for _, begin, arrival, _ in arrived if 1.0 <= round(begin, 6) < 2.0]
    assert len(held) == 50 and held == pytest.approx([2.0] * 50)
    assert all(arrival == begin for _, begin, arrival, _ in arrived if not 0.99 < begin < 1.99)


def test_flapping_link_loses_while_down():
    up = {n for n, *_ in sent(injected(fault("flapping", down=0.2, up=0.3)), 100, gap=0.05)}
    assert up == {i for i in range(100) if i % 10 >= 4}


@pytest.mark.parametrize(
    ("kind", "settings"),
    [
        ("packet_loss", {"probability": 0.3}),
        ("burst_loss", {"burst": 0.1, "gap": 0.3}),
        ("latency", {"delay": 0.06}),
        ("reordering", {"probability": 0.2, "delay": 0.05}),
        ("duplication", {"probability": 0.25, "delay": 0.03}),
        ("corruption", {"probability": 0.3}),
        ("truncation", {"probability": 0.3}),
        ("partition", {}),
        ("stall", {"duration": 3.0}),
        ("flapping", {"down": 0.2, "up": 0.3}),
    ],
)
def test_disturbed_datagrams_are_counted(kind, settings):
    injector = injected(fault(kind, **settings))
    arrived = sent(injector, 150)
    intact = {
        n for n, begin, arrival, data in arrived if arrival - begin < 1e-9 and data == n.to_bytes(4, "little") * 10
    }
    twice = {n for n in intact if sum(serial == n for serial, *_ in arrived) > 1}
    [only] = injector.faults
    assert only.seen == 150
    assert only.disturbed == 150 - len(intact - twice) > 0
