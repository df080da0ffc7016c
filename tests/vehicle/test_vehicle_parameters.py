"""The parameter protocol of a vehicle."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as wide
import pymavlink.dialects.v20.common as mavlink
import pytest
from vehicle_bench import STRANGER, Bench

from gcs.config.vehicle_settings import VehicleFailsafeSettings
from gcs.mavlink import px4
from gcs.mavlink.services.parameter_table import Parameter, ParameterRefusalError, ParameterTable


def value_of(messages: list[Any]) -> dict[str, Any]:
    values = [m for m in messages if m.get_type() == "PARAM_VALUE"]
    return {m.param_id: px4.parameter_from_wire(m.param_value, m.param_type) for m in values}


def test_parameter_list_is_complete_and_byte_wise(bench: Bench) -> None:
    bench.send(mavlink.MAVLink_param_request_list_message(1, 1))
    bench.collect()
    check, *values = bench.got("PARAM_VALUE")
    assert (check.param_id, check.param_index, check.param_count) == ("_HASH_CHECK", 0xFFFF, len(values))
    assert [m.param_index for m in values] == list(range(values[0].param_count))
    table = value_of(values)
    assert table["SYS_AUTOSTART"] == 4001 and isinstance(table["SYS_AUTOSTART"], int)
    assert table[px4.PARAM_THRUST_MAX] == 30.0 and table[px4.PARAM_ONBOARD_RATE] == 250


def test_parameters_are_read_by_name_and_by_index(bench: Bench) -> None:
    read_request = mavlink.MAVLink_param_request_read_message
    assert value_of(bench.request(read_request(1, 1, b"MIS_TAKEOFF_ALT", -1))) == {"MIS_TAKEOFF_ALT": 2.5}
    [first] = bench.request(read_request(1, 1, b"", 0))
    assert first.param_index == 0
    for name, index in ((b"NO_SUCH", -1), (b"", 999)):
        [error] = bench.request(read_request(1, 1, name, index))
        assert (error.get_type(), error.param_id, error.param_index) == ("PARAM_ERROR", name.decode(), index)
        assert error.error == wide.MAV_PARAM_ERROR_DOES_NOT_EXIST and error.target_system == 255


@pytest.mark.parametrize(
    ("name", "value", "kind", "stored"),
    [
        ("COM_OF_LOSS_T", 0.3, 9, pytest.approx(0.3)),
        ("COM_OF_LOSS_T", math.nan, 9, pytest.approx(VehicleFailsafeSettings.setpoint_loss)),
        ("COM_OF_LOSS_T", -1.0, 9, pytest.approx(VehicleFailsafeSettings.setpoint_loss)),
        ("COM_DL_LOSS_T", px4.parameter_to_wire(20, 6), 6, 20),
        ("COM_DL_LOSS_T", 20.0, 9, 10),
        ("COM_DL_LOSS_T", 20.0, 6, 10),  # a C cast: read byte-wise it is far out of range
        (px4.PARAM_THRUST_MAX, 99.0, 9, 30.0),
    ],
)
def test_parameters_are_set_or_the_kept_value_is_answered(
    bench: Bench, name: str, value: float, kind: int, stored: Any
) -> None:
    answers = bench.request(mavlink.MAVLink_param_set_message(1, 1, name.encode(), value, kind))
    assert value_of(answers) == {name: stored}
    errors = [m for m in answers if m.get_type() == "PARAM_ERROR"]
    assert len(errors) == (bench.vehicle.parameters[name] != pytest.approx(value) if kind == 9 else stored != 20)
    assert bench.vehicle.parameters[name] == stored


def test_value_that_was_set_is_told_to_all_peers_and_a_refusal_to_its_sender(bench: Bench) -> None:
    bench.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3), STRANGER)
    for value, told in ((0.3, 1), (-1.0, 1)):
        bench.request(mavlink.MAVLink_param_set_message(1, 1, b"COM_OF_LOSS_T", value, 9))
        assert len(bench.got("PARAM_VALUE", STRANGER)) == told
    assert len(bench.got("PARAM_VALUE")) == 2 and not bench.got("PARAM_ERROR", STRANGER)


def test_real_parameters_have_the_precision_of_the_wire_and_integers_are_exact() -> None:
    assert Parameter("A", 0.1).value == float(np.float32(0.1)) != 0.1
    assert Parameter("B", 2**24 + 1, type=mavlink.MAV_PARAM_TYPE_INT32).value == 2**24 + 1


@pytest.mark.parametrize(
    ("name", "value", "kind", "problem"),
    [
        ("A", 1.0, 9, None), ("A", 3.0, 9, None), ("A", 0.99, 9, "A: 0.99 is outside 1 .. 3"),
        ("A", 3.01, 9, "A: 3.01 is outside 1 .. 3"), ("A", math.nan, 9, "A: nan is outside 1 .. 3"),
        ("A", 2.0, 6, "A: sent as type 6, is of type 9"), ("B", 2.0, 9, "B: read-only"), ("C", 2.0, 9, "C: no such"),
    ],
)  # fmt: skip
def test_parameter_is_set_within_its_limits_or_kept(name: str, value: float, kind: int, problem: str | None) -> None:
    table = ParameterTable([Parameter("B", 5.0), Parameter("A", 2.5, limits=(1.0, 3.0))])
    if problem is None:
        table.set_from_wire(name, value, kind)
    else:
        with pytest.raises(ParameterRefusalError, match=f"^{problem}"):
            table.set_from_wire(name, value, kind)
    assert (table["A"], table["B"]) == (value if problem is None else 2.5, 5.0)
