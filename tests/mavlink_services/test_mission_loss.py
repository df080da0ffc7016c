"""Transfers over a link that loses, repeats and reorders: each ends with an answer, and with one plan or the other."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as m
from hypothesis import given, settings
from hypothesis import strategies as st
from mission_ground import ACCEPTED, RETRY, TRIES, Downloader, MissionBench, Uploader, same, waypoint
from vehicle_bench import GROUND, STRANGER

from gcs.config.vehicle_settings import VehicleLinkSettings
from gcs.mavlink.codec import Codec
from gcs.mavlink.services.mission_item import PlanType

OLD = [waypoint(10 + i) for i in range(3)]
NEW = [waypoint(20 + i) for i in range(4)]
STEP = 0.05  # s
TIMEOUT = VehicleLinkSettings().missions.timeout
LIMIT = (TRIES + 1) * RETRY * (len(NEW) + 2)  # s; a ground repeats each message so often before it gives up

# What becomes of the datagrams one after the other: the delays (s) of its copies; none: it is lost.
FATES = st.lists(
    st.one_of(
        st.just([0.0]), st.just([]), st.lists(st.floats(0.0, 2.0), min_size=1, max_size=3),
    ),
    max_size=60,
)  # fmt: skip


class LossyLink:
    """A free vehicle and the datagrams on their way to and from it; when the fates are used up all arrive."""

    def __init__(self, fates: list[list[float]]) -> None:
        self.bench = MissionBench()
        self.fates = iter(fates)
        self.to_vehicle: list[tuple[float, bytes, Any]] = []
        self.to_ground: list[tuple[float, bytes, Any]] = []
        self.codec = Codec(255, 190)
        self.reader = Codec(254, 1)
        self.time = 0.0

    def send(self, messages: list[Any], sender: Any = GROUND) -> None:
        for message in messages:
            for delay in next(self.fates, [0.0]):
                self.to_vehicle.append((self.time + delay, self.codec.encode(message), sender))

    def step(self) -> list[tuple[Any, Any]]:
        """One step in time; what of the protocol arrives at the grounds, with its address."""
        self.time += STEP
        vehicle = self.bench.vehicle
        for datagram, sender in self._due(self.to_vehicle):
            vehicle.receive(datagram, sender, self.time)
        for datagram, address in vehicle.datagrams_to_send(self.time):
            found = [r.message for r in self.reader.decode(datagram)]
            if any(message.get_type().startswith("MISSION_") and message.id != 42 for message in found):
                for delay in next(self.fates, [0.0]):
                    self.to_ground.append((self.time + delay, datagram, address))
        return [(r.message, a) for datagram, a in self._due(self.to_ground) for r in self.reader.decode(datagram)]

    def transfer(self, ground: Uploader | Downloader, check: Callable[[], bool] = lambda: True) -> None:
        """Let time pass until a ground is done; ``check`` holds after every step."""
        began = self.time
        self.send(ground.start(self.time))
        while not ground.is_done:
            for message, _ in self.step():
                self.send(ground.take(message, self.time))
            self.send(ground.run(self.time))
            assert check()
            assert self.time < began + LIMIT

    def _due(self, queue: list[tuple[float, bytes, Any]]) -> list[tuple[bytes, Any]]:
        due = sorted((entry for entry in queue if entry[0] <= self.time), key=lambda entry: entry[0])
        queue[:] = [entry for entry in queue if entry[0] > self.time]
        return [(datagram, address) for _, datagram, address in due]


@settings(max_examples=60, deadline=None)
@given(FATES)
def test_upload_ends_with_an_answer_and_the_new_plan_or_the_old_one(fates: list[list[float]]) -> None:
    link = LossyLink(fates)
    plans = link.bench.plans
    plans.accept(PlanType.MISSION, tuple(OLD), 0)
    ground = Uploader(NEW)
    link.transfer(ground, lambda: same(plans.items, OLD) or same(plans.items, NEW))  # never a part
    if ground.result == ACCEPTED:
        assert same(plans.items, NEW)
    # Afterwards, over a good link: the vehicle is ready for anybody within the timeout, and both agree.
    link.fates = iter(())
    for _ in range(round((TIMEOUT + 2.0) / STEP)):
        link.step()
    again = Uploader(NEW)
    link.transfer(again)
    assert again.result == ACCEPTED and same(plans.items, NEW)


@settings(max_examples=40, deadline=None)
@given(FATES)
def test_downloaded_plan_is_the_vehicles_or_none(fates: list[list[float]]) -> None:
    link = LossyLink(fates)
    link.bench.plans.accept(PlanType.MISSION, tuple(NEW), 0)
    ground = Downloader()
    link.transfer(ground)
    assert ground.gave_up or same(ground.items, NEW)


@settings(max_examples=40, deadline=None)
@given(FATES, st.floats(0.0, 3.0))
def test_two_grounds_that_upload_at_once_get_an_answer_each(fates: list[list[float]], later: float) -> None:
    """One plan or the other is in effect, whole, and it is one of a ground that was not refused."""
    link = LossyLink(fates)
    plans = link.bench.plans
    grounds = {GROUND: Uploader(NEW), STRANGER: Uploader(OLD)}
    link.send(grounds[GROUND].start(0.0))
    started = False
    while not all(ground.result is not None for ground in grounds.values()):
        if not started and link.time >= later:
            started = True
            link.send(grounds[STRANGER].start(link.time), STRANGER)
        for message, address in link.step():
            link.send(grounds[address].take(message, link.time), address)
        for address, ground in grounds.items():
            if address == GROUND or started:
                link.send(ground.run(link.time), address)
        assert plans.items == () or same(plans.items, OLD) or same(plans.items, NEW)
        assert link.time < 2 * LIMIT
    accepted = [ground for ground in grounds.values() if ground.result == ACCEPTED]
    if plans.items == ():
        assert not accepted
    for ground in accepted:
        other = [g for g in grounds.values() if g is not ground]
        assert same(plans.items, ground.items) or same(plans.items, other[0].items)


RANDOM = st.builds(
    lambda kind, numbers: kind(1, 1, *numbers),
    st.sampled_from([m.MAVLink_mission_count_message, m.MAVLink_mission_request_int_message]),
    st.tuples(st.integers(0, 65535), st.sampled_from([0, 1, 2, 3, 255])),
)


@settings(max_examples=40, deadline=None)
@given(st.lists(st.tuples(RANDOM, st.integers(1, 3), st.floats(0.0, 1.0)), max_size=40))
def test_any_sequence_of_requests_is_answered_and_leaves_the_plan(messages: list[tuple[Any, int, float]]) -> None:
    bench = MissionBench()
    bench.plans.accept(PlanType.MISSION, tuple(OLD), 0)
    for message, component, wait in messages:
        if message.get_type() == "MISSION_COUNT" and message.count == 0:
            continue
        assert bench.answers(message, component=component)
        bench.wait(wait)
    assert same(bench.plans.items, OLD)
