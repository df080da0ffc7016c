"""Inputs that are not flown by: a text says so, now and then."""

from __future__ import annotations

from typing import Any

import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from service_bench import SYSTEM, ServiceBench

from gcs.mavlink.services.unserved_inputs import STICKS, UnservedInputs

MANUAL = mavlink.MAVLink_manual_control_message(SYSTEM, 0, 0, 500, 0, 0)
OVERRIDE = mavlink.MAVLink_rc_channels_override_message(SYSTEM, 1, *[1500] * 8)


@pytest.fixture
def bench() -> ServiceBench:
    bench = ServiceBench()
    UnservedInputs(SYSTEM, STICKS).register(bench.dispatcher)
    return bench


@pytest.mark.parametrize("message", [MANUAL, OVERRIDE])
def test_input_is_answered_by_a_text_once_in_ten_seconds(bench: ServiceBench, message: Any) -> None:
    texts = []
    for _ in range(200):
        texts += bench.request(message)
        bench.now += 0.1
    assert [m.get_type() for m in texts] == ["STATUSTEXT"] * 2 and "sticks are not read" in texts[0].text


def test_sticks_of_another_vehicle_are_not_answered(bench: ServiceBench) -> None:
    assert bench.request(mavlink.MAVLink_manual_control_message(SYSTEM + 1, 0, 0, 500, 0, 0)) == []


def test_input_that_a_service_takes_is_left_to_it() -> None:
    bench, taken = ServiceBench(), []
    bench.dispatcher.register(mavlink.MAVLink_manual_control_message, lambda message, request: taken.append(message.z))
    UnservedInputs(SYSTEM, STICKS).register(bench.dispatcher)
    assert bench.request(MANUAL) == [] and taken == [500]
    assert bench.request(OVERRIDE) != []
