"""Congestion: latencies that a queue explains, told from jitter, from a latency that changes, and from clocks."""

import numpy as np
import pytest

from gcs.config.flight_settings import DEFAULTS
from gcs.mavlink.link_queue import LinkQueue
from gcs.mavlink.settings import LinkSettings

EXPLAINED = DEFAULTS.monitor.queue_explained


def traffic(seed=0, until=6.0, scale=1.0):
    """Datagrams of a vehicle, each (sent, size): telemetry at 25 Hz, more every 0.2 s, TIMESYNC answers at 10 Hz."""
    generator = np.random.default_rng(seed)
    phase = generator.uniform(0.0, 0.1)
    telemetry = [
        (0.04 * k, 215 + (95 if k % 5 == 0 else 0) + (160 if k % 25 == 0 else 0)) for k in range(int(until / 0.04))
    ]
    answers = [(phase + 0.1 * k + 0.004 * generator.random(), 24) for k in range(int(until / 0.1))]
    return sorted((sent, round(scale * size)) for sent, size in telemetry + answers)


def capped(datagrams, rate, capacity=8192, base=0.0):
    """Arrivals (arrival, sent, size) over a link of a rate (bytes/s), whose queue holds ``capacity`` bytes."""
    free, out = 0.0, []
    for sent, size in datagrams:
        begin = max(sent, free)
        if (begin - sent) * rate + size <= capacity:
            free = begin + size / rate
            out.append((free + base, sent, size))
    return out


def delayed(datagrams, latency):
    """The same with a latency (s) of the time, in order."""
    last, out = 0.0, []
    for sent, size in datagrams:
        last = max(last, sent + latency(sent))
        out.append((last, sent, size))
    return out


def queue_of(arrivals, clock=lambda t: t):
    queue = LinkQueue(LinkSettings().clock.queue_window)
    for arrival, sent, size in arrivals:
        queue.add(size, clock(sent), arrival)
    return queue


@pytest.mark.parametrize("rate", [5000.0, 7000.0, 9000.0, 11520.0, 14400.0])
@pytest.mark.parametrize("capacity", [2048, 8192])
@pytest.mark.parametrize("base", [0.0, 0.06])
def test_link_of_limited_rate_is_found_with_its_rate(rate, capacity, base):
    for seed in range(3):
        # Before the queue there was none.
        queue = queue_of([(-5.0 + 0.01 * k + base, -5.0 + 0.01 * k, 24) for k in range(3)])
        for arrival, sent, size in capped(traffic(seed), rate, capacity, base):
            queue.add(size, sent, arrival)
        fit = queue.fit()
        assert fit.explained > EXPLAINED
        assert fit.rate == pytest.approx(rate, rel=0.05)
        assert queue.wait > 0.0125


@pytest.mark.parametrize("jitter", [0.0, 0.005])
def test_queue_is_found_beside_a_little_jitter_and_loss(jitter):
    for seed in range(5):
        generator = np.random.default_rng(seed)
        arrivals = [
            (arrival + jitter * generator.random(), sent, size)
            for arrival, sent, size in capped(traffic(seed), 11520.0)
            if generator.random() > 0.1
        ]
        looks = [queue_of(arrivals[:until]).fit().explained for until in range(60, len(arrivals), 10)]
        assert np.mean(np.array(looks) > EXPLAINED) > 0.5


@pytest.mark.parametrize("spread", [0.02, 0.03, 0.05, 0.2])
def test_jitter_is_no_queue(spread):
    for seed in range(20):
        generator = np.random.default_rng(seed + 100)
        arrivals = delayed(traffic(seed), lambda t, g=generator: spread * g.random())
        assert queue_of(arrivals).fit().explained < EXPLAINED


@pytest.mark.parametrize("at", np.arange(4.05, 6.0, 0.1))
@pytest.mark.parametrize("step", [0.06, -0.06, 0.3])
def test_step_of_the_latency_is_no_queue(at, step):
    before = max(-step, 0.0)
    arrivals = delayed(traffic(3), lambda t: before + (step if t >= at else 0.0))
    assert queue_of(arrivals).fit().explained < EXPLAINED


def test_constant_latency_is_no_queue():
    queue = queue_of(delayed(traffic(), lambda t: 0.06))
    assert queue.wait == pytest.approx(0.0, abs=1e-9)
    assert queue.fit().explained == 0.0


@pytest.mark.parametrize("stall", [0.1, 0.4, 1.0])
def test_datagrams_held_up_and_released_at_once_are_no_queue_of_the_traffic(stall):
    for seed in range(5):
        fit = queue_of(delayed(traffic(seed), lambda t: max(4.5 + stall - t, 0.0) if t >= 4.5 else 0.0)).fit()
        assert fit.explained < EXPLAINED or fit.load < DEFAULTS.monitor.queue_load * fit.rate


def test_load_is_what_has_come():
    assert queue_of(delayed(traffic(), lambda t: 0.0)).fit().load == pytest.approx(6500.0, rel=0.1)


def test_datagram_of_unknown_time_of_sending_is_left_out():
    queue = LinkQueue(LinkSettings().clock.queue_window)
    queue.add(100, float("nan"), 1.0)
    assert len(queue) == 0 and queue.wait == 0.0
