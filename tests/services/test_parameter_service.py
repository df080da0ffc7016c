"""The parameter protocol: values, refusals, and PX4's hash."""

from __future__ import annotations

import math
import struct

import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from service_bench import SYSTEM, ServiceBench

from gcs.mavlink import px4

READ, SET = mavlink.MAVLink_param_request_read_message, mavlink.MAVLink_param_set_message
REAL, INT = mavlink.MAV_PARAM_TYPE_REAL32, mavlink.MAV_PARAM_TYPE_INT32
MISSING, RANGE = mavlink.MAV_PARAM_ERROR_DOES_NOT_EXIST, mavlink.MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE
PERMISSION, READ_ONLY, TYPE = mavlink.MAV_PARAM_ERROR_PERMISSION_DENIED, mavlink.MAV_PARAM_ERROR_READ_ONLY, 7


def crc(data: bytes, state: int = 0) -> int:
    """PX4's ``crc32part``, bit by bit."""
    for byte in data:
        state ^= byte
        for _ in range(8):
            state = state >> 1 ^ (0xEDB88320 if state & 1 else 0)
    return state


def test_list_begins_with_the_hash_of_names_and_values() -> None:
    bench = ServiceBench()
    check, *values = bench.request(mavlink.MAVLink_param_request_list_message(SYSTEM, 1))
    assert [m.param_id for m in values] == ["AA_REAL", "BB_INT", "CC_FIXED"]
    assert (check.param_id, check.param_index, check.param_count) == ("_HASH_CHECK", 0xFFFF, 3)
    state = 0
    for name, value in ((b"AA_REAL", struct.pack("<f", 2.5)), (b"BB_INT", struct.pack("<i", 3)),
                        (b"CC_FIXED", struct.pack("<f", 9.0))):  # fmt: skip
        state = crc(name + value, state)
    assert bench.parameters.checksum == state
    assert px4.parameter_from_wire(check.param_value, check.param_type) == state
    [again] = bench.request(READ(SYSTEM, 1, b"_HASH_CHECK", -1))
    assert again.param_value == check.param_value
    assert bench.request(SET(SYSTEM, 1, b"_HASH_CHECK", check.param_value, mavlink.MAV_PARAM_TYPE_UINT32)) == []
    bench.parameters.set_from_wire("AA_REAL", 1.5, REAL)
    assert bench.parameters.checksum != state


@pytest.mark.parametrize(("name", "index"), [(b"NO_SUCH", -1), (b"", 3), (b"AA_REAL", 99)])
def test_unknown_parameter_is_an_error_at_once(name: bytes, index: int) -> None:
    [error] = ServiceBench().request(READ(SYSTEM, 1, name, index))
    assert (error.get_type(), error.error, error.param_index) == ("PARAM_ERROR", MISSING, index)
    assert (error.param_id, error.target_system, error.target_component) == (name.decode(), 255, 190)


@pytest.mark.parametrize(
    ("name", "value", "kind", "error", "kept"),
    [
        (b"NO_SUCH", 1.0, REAL, MISSING, None), (b"AA_REAL", 0.5, REAL, RANGE, 2.5),
        (b"AA_REAL", math.nan, REAL, RANGE, 2.5), (b"AA_REAL", 2.0, INT, TYPE, 2.5),
        (b"BB_INT", px4.parameter_to_wire(2, INT), INT, RANGE, 3), (b"BB_INT", 0.0, REAL, TYPE, 3),
        (b"CC_FIXED", 1.0, REAL, READ_ONLY, 9.0), (b"CC_FIXED", 0.0, INT, READ_ONLY, 9.0),
    ],
)  # fmt: skip
def test_refused_value_is_an_error_before_the_value_that_is_kept(
    name: bytes, value: float, kind: int, error: int, kept: float | None
) -> None:
    bench = ServiceBench()
    text, refusal, *values = bench.request(SET(SYSTEM, 1, name, value, kind))
    assert (text.get_type(), refusal.get_type()) == ("STATUSTEXT", "PARAM_ERROR")
    assert text.text.startswith(name.decode()) and (refusal.param_id, refusal.error) == (name.decode(), error)
    found = [px4.parameter_from_wire(m.param_value, m.param_type) for m in values]
    assert found == ([] if kept is None else [kept])


def test_value_is_set_and_answered() -> None:
    bench = ServiceBench()
    [value] = bench.request(SET(SYSTEM, 1, b"BB_INT", px4.parameter_to_wire(0, INT), INT))
    assert px4.parameter_from_wire(value.param_value, value.param_type) == 0 == bench.parameters["BB_INT"]


def test_value_for_all_systems_or_of_a_stranger_is_not_permitted() -> None:
    bench = ServiceBench()
    _, refusal, value = bench.request(SET(0, 1, b"AA_REAL", 1.5, REAL))
    assert (refusal.error, value.param_value) == (PERMISSION, 2.5)
    bench.stranger = True
    _, refusal, value = bench.request(SET(SYSTEM, 1, b"AA_REAL", 1.5, REAL))
    assert (refusal.error, value.param_value) == (PERMISSION, 2.5)
