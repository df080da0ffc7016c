"""A link between two programs: its ends, its counts, and values that are given one by one."""

import dataclasses
import math

import pytest

from vehicle_sim.app.impair import counted
from vehicle_sim.faults.impaired_link import PEER_TIMEOUT, PEERS_MAX, ImpairedDirection, ImpairedLink
from vehicle_sim.faults.link_profiles import LinkDirection, LinkProfile, TimeDivision

VEHICLE, GROUND, OTHER = ("127.0.0.1", 14580), ("127.0.0.1", 14550), ("127.0.0.1", 14551)


def link(telemetry=None, command=None, **options):
    profile = LinkProfile(LinkDirection(**(telemetry or {})), LinkDirection(**(command or {})))
    return ImpairedLink(profile, [7, 1], **{"forward": GROUND, **options})


def leaving(made, now):
    return list(made.datagrams_to_send(now))


def passed(settings, times, size=40):
    """Numbers and delays of what arrives of datagrams at ``times`` (s), looked for much too late."""
    made = ImpairedDirection(settings, [7], 0.0)
    for i, time in enumerate(times):
        made.receive(bytes([i % 256]) * size, VEHICLE, time)
    return made, [data[0] for data in made.datagrams_to_send(1e6)]


def test_what_comes_at_one_end_leaves_at_the_other():
    made = link()
    made.receive("listen", b"telemetry", VEHICLE, 0.0)
    assert leaving(made, 0.0) == [("forward", b"telemetry", GROUND)]
    made.receive("forward", b"command", GROUND, 0.1)
    assert leaving(made, 0.1) == [("listen", b"command", VEHICLE)]
    assert made.counts["telemetry"].forwarded == made.counts["command"].forwarded == 1


def test_each_direction_has_the_values_of_its_end():
    for vehicle, telemetry_comes_at in (("listen", "listen"), ("forward", "forward")):
        made = link({"latency": 0.2}, {"latency": 0.05}, vehicle=vehicle)
        made.receive("listen", b"a", VEHICLE, 0.0)
        made.receive("forward", b"b", GROUND, 0.0)
        (early,), (late,) = leaving(made, 0.1), leaving(made, 0.3)
        assert late[0] != telemetry_comes_at and early[0] == telemetry_comes_at


def test_answers_go_to_all_that_sent_lately_or_else_to_the_last_one():
    made = link()
    for sender, now in ((VEHICLE, 0.0), (OTHER, 1.0)):
        made.receive("listen", b"x", sender, now)
    leaving(made, 1.0)
    made.receive("forward", b"y", GROUND, 2.0)
    assert {receiver for *_, receiver in leaving(made, 2.0)} == {VEHICLE, OTHER}
    for now in (0.5 + PEER_TIMEOUT, 2.0 + PEER_TIMEOUT):
        made.receive("forward", b"y", GROUND, now)
        assert [receiver for *_, receiver in leaving(made, now)] == [OTHER]


def test_a_flood_of_senders_keeps_the_number_of_receivers_bounded():
    made = link()
    for port in range(1, 10 * PEERS_MAX):
        made.receive("listen", b"x", ("127.0.0.1", port), 0.0)
    leaving(made, 0.0)
    made.receive("forward", b"y", GROUND, 0.1)
    assert len(leaving(made, 0.1)) == PEERS_MAX


def test_strangers_at_an_end_with_an_address_are_ignored():
    made = link()
    made.receive("listen", b"x", VEHICLE, 0.0)
    made.receive("forward", b"forged", OTHER, 0.0)
    assert [end for end, *_ in leaving(made, 0.0)] == ["forward"]
    assert made.counts["command"].received == 0


def test_what_nobody_receives_is_counted():
    made = link(forward=None)
    made.receive("listen", b"x", VEHICLE, 0.0)
    assert leaving(made, 0.0) == []
    assert counted(1, made.counts)[0].endswith("1 forwarded, 0 lost, 0 lost at the queue, 0 late, 0 reordered, "
                                               "1 without a receiver")  # fmt: skip
    made.receive("forward", b"y", OTHER, 0.1)
    made.receive("listen", b"x", VEHICLE, 0.2)
    assert [receiver for *_, receiver in leaving(made, 0.2)] == [VEHICLE, OTHER][::-1]


def test_delays_do_not_depend_on_when_the_driver_looks():
    times = [0.011 * i for i in range(2000)]
    settings = LinkDirection(rate=8000.0, loss=0.1, burst=0.05, latency=0.03, jitter=0.02, reordering=0.1)
    _, late = passed(settings, times)
    made, timely = ImpairedDirection(settings, [7], 0.0), []
    for i, time in enumerate(times):
        made.receive(bytes([i % 256]) * 40, VEHICLE, time)
        timely += [data[0] for data in made.datagrams_to_send(time)]
        while (timer := made.next_timer()) is not None and timer < time + 0.011:
            timely += [data[0] for data in made.datagrams_to_send(timer)]
    timely += [data[0] for data in made.datagrams_to_send(1e6)]
    assert late == timely


def test_reordering_has_its_probability_and_is_counted_as_rfc_4737_does():
    count, probability = 10_000, 0.1
    made, order = passed(LinkDirection(reordering=probability), [0.01 * i for i in range(count)])
    assert made.counts.forwarded == len(order) == count
    assert made.counts.reordered == made.counts.late
    spread = 3.89 * math.sqrt(probability * (1.0 - probability) / count)  # 99.99 %
    assert made.counts.reordered / count == pytest.approx(probability, abs=spread + probability**5)


def test_radio_transmits_in_its_windows_only():
    turns = TimeDivision(window=0.1, silence=0.02)
    settings = LinkDirection(rate=1000.0, time_division=turns)

    def departure(time, second=False):
        made = ImpairedDirection(settings, [7], 0.0, second=second)
        made.receive(bytes(40), VEHICLE, time)
        return made.next_timer()

    assert departure(0.0) == pytest.approx(0.04)
    assert departure(0.06) == pytest.approx(0.1)
    assert departure(0.08) == pytest.approx(turns.round + 0.02)
    assert departure(0.15) == pytest.approx(turns.round + 0.04)
    assert departure(0.0, second=True) == pytest.approx(0.12 + 0.04)
    assert departure(0.17, second=True) == pytest.approx(0.21)


def test_losses_of_all_and_of_none():
    for loss, arrives in ((0.0, 5), (1.0, 0)):
        for burst in (0.0, 0.5):
            made, order = passed(LinkDirection(loss=loss, burst=burst), range(5))
            assert len(order) == arrives and made.counts.lost == 5 - arrives


def test_every_datagram_is_counted_once():
    settings = LinkDirection(rate=2000.0, queue=400, loss=0.2, latency=0.1, jitter=0.05, reordering=0.1)
    made = ImpairedDirection(settings, [7], 0.0)
    for i in range(500):
        made.receive(bytes(40), VEHICLE, 0.015 * i)
    counts = dataclasses.replace(made.counts)
    made.datagrams_to_send(1e6)
    assert counts.received == made.counts.received == 500 and counts.forwarded < made.counts.forwarded
    assert made.counts.forwarded + made.counts.lost + made.counts.overflowed == 500
    assert made.counts.lost > 0 and made.counts.overflowed > 0
