"""Each profile of a link, measured by a receiver on a virtual clock, against what it says."""

import dataclasses
import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from links_page import renewed

from vehicle_sim.faults.impaired_link import ImpairedDirection
from vehicle_sim.faults.link_profiles import PROFILES

Z = 3.89
"""Standard errors of the bounds: a correct link is within each of them with a probability of 99.99 %."""
SEED = 7
WAYS = [(name, way) for name in PROFILES for way in ("telemetry", "command")]
SIZE = 40
"""Bytes of a probe, as of a MAVLink 2 message of 28 bytes of payload."""
SENDER = ("127.0.0.1", 14550)


def direction(profile, way, seed=SEED):
    return getattr(PROFILES[profile], way), ImpairedDirection(
        getattr(PROFILES[profile], way), [seed, way == "command"], 0.0, second=way == "command"
    )


def measured(link, times, size=SIZE):
    """(number, time of sending, time of arrival) of what arrives of datagrams sent at ``times`` (s)."""
    arrived = []
    times = list(times)
    i = 0
    while True:
        timer = link.next_timer()
        now = min([*times[i : i + 1], *([] if timer is None else [timer])], default=None)
        if now is None:
            return arrived
        if i < len(times) and now == times[i]:
            link.receive(i.to_bytes(4, "little").ljust(size, b"."), SENDER, now)
            i += 1
        arrived += [
            (n, times[n], now)
            for data in link.datagrams_to_send(now)
            if len(data) == size and (n := int.from_bytes(data[:4], "little")) >= 0
        ]


def sparse(count, least=0.5, mean=0.2, seed=3):
    """Times (s) so far apart that no datagram waits for another, at any phase of a round of transmissions."""
    return np.cumsum(least + np.random.default_rng(seed).exponential(mean, count))


def moments(settings):
    """Mean and variance of the delay (s) of a probe that waits for no other one."""
    transmission = SIZE / settings.rate
    mean, variance = settings.latency + settings.jitter / 2.0 + transmission, settings.jitter**2 / 12.0
    if turns := settings.time_division:
        closed = turns.round - turns.window
        # Sent while the windows are closed; or in one that closes during the transmission.
        wait = (closed**2 / 2.0 + closed * transmission) / turns.round
        mean += wait
        variance += (closed**3 / 3.0 + closed**2 * transmission) / turns.round - wait**2
    return mean, variance


@pytest.mark.parametrize(("profile", "way"), WAYS)
def test_profile_has_its_loss_latency_and_jitter_and_keeps_the_order(profile, way):
    settings, link = direction(profile, way)
    count = round(max(5000, 20 / settings.loss))
    arrived = measured(link, sparse(count))
    lost = 1.0 - len(arrived) / count
    assert lost == pytest.approx(settings.loss, abs=Z * math.sqrt(settings.loss * (1.0 - settings.loss) / count))
    assert link.counts.lost == count - len(arrived) and link.counts.overflowed == 0
    delays = np.array([arrival - sent for _, sent, arrival in arrived])
    mean, variance = moments(settings)
    assert delays.mean() == pytest.approx(mean, abs=Z * math.sqrt(variance / len(delays)) + 1e-9)
    fourth = np.mean((delays - delays.mean()) ** 4)
    assert delays.var() == pytest.approx(
        variance, abs=Z * math.sqrt((fourth - delays.var() ** 2) / len(delays)) + 1e-12
    )
    assert delays.min() >= settings.latency
    assert [n for n, *_ in arrived] == sorted(n for n, *_ in arrived) and link.counts.reordered == 0


@pytest.mark.parametrize(("profile", "way"), [(name, way) for name, way in WAYS if PROFILES[name].telemetry.burst])
def test_losses_of_profile_come_in_bursts_of_its_mean_length(profile, way):
    # More often than in the profile, whose rate of losses is measured above.
    settings = dataclasses.replace(getattr(PROFILES[profile], way), loss=0.05)
    link = ImpairedDirection(settings, [SEED], 0.0)
    bursts, gap = 200, settings.burst / 4.0
    numbers = [n for n, *_ in measured(link, np.arange(0.0, bursts * settings.burst / settings.loss, gap))]
    runs = [b - a - 1 for a, b in itertools.pairwise(numbers) if b - a > 1]
    # A burst that hits one probe hits the next one too with a probability that its exponential length gives.
    end = -math.expm1(-gap / settings.burst)
    assert np.mean(runs) == pytest.approx(1.0 / end, abs=Z * math.sqrt(1.0 - end) / end / math.sqrt(len(runs)))
    assert len(runs) == pytest.approx(bursts, abs=Z * math.sqrt(bursts))


@pytest.mark.parametrize(("profile", "way"), WAYS)
def test_profile_passes_its_rate_and_loses_what_the_queue_does_not_hold(profile, way):
    settings, link = direction(profile, way)
    rate = settings.rate
    if turns := settings.time_division:
        rate *= turns.window / turns.round
    size = 100 if rate < 1e5 else 1400
    duration = 3.0 * settings.queue / rate + 5.0
    arrived = measured(link, np.arange(0.0, duration, size / (2.0 * rate)), size)
    first, last = arrived[0][2], arrived[-1][2]
    passed = (len(arrived) - 1) * size / (last - first)
    bursts = duration * settings.loss / settings.burst if settings.burst else 0.0
    spread = math.sqrt(2.0 * bursts) * settings.burst / duration  # of the share of the time that is lost in bursts
    if not settings.burst:
        spread = math.sqrt(settings.loss * (1.0 - settings.loss) / len(arrived))
    edges = (settings.jitter + (turns.round if turns else 0.0)) / (last - first)
    assert passed == pytest.approx(rate * (1.0 - settings.loss), rel=Z * spread + edges + size / settings.queue)
    assert link.counts.overflowed > 0
    delays = [arrival - sent for _, sent, arrival in arrived]
    # No delay is longer than a full queue takes.
    assert max(delays) <= settings.queue / rate + settings.latency + settings.jitter + (turns.round if turns else 0.0)
    counts = link.counts
    assert counts.received == counts.forwarded + counts.lost + counts.overflowed
    assert counts.forwarded == len(arrived) and counts.late > len(arrived) / 2


@pytest.mark.parametrize("profile", PROFILES)
def test_same_seed_loses_the_same_datagrams_and_another_one_others(profile):
    times = sparse(2000)
    runs = {
        (seed, way): measured(direction(profile, way, seed)[1], times)
        for seed in (SEED, SEED + 1)
        for way in ("telemetry", "command")
    }
    assert measured(direction(profile, "telemetry")[1], times) == runs[SEED, "telemetry"]
    assert len({tuple(run) for run in runs.values()}) == len(runs)


def test_table_in_the_documentation_is_that_of_the_profiles():
    page = (Path(__file__).parents[2] / "docs" / "links.md").read_text(encoding="utf-8")
    assert page == renewed(page), "run make docs"
