"""Commands about the system itself, its messages and modes."""

from __future__ import annotations

import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from service_bench import ABSENT, EMPTY, NAN, ServiceBench, command

from gcs.mavlink import px4
from gcs.mavlink.newer_messages import AVAILABLE_MODES, PROTOCOL_VERSION

ACCEPTED, DENIED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_DENIED
REJECTED, UNSUPPORTED = mavlink.MAV_RESULT_TEMPORARILY_REJECTED, mavlink.MAV_RESULT_UNSUPPORTED
HEARTBEAT = mavlink.MAVLINK_MSG_ID_HEARTBEAT


def test_older_requests_send_their_message() -> None:
    bench = ServiceBench()
    result, _, [home] = bench.ask(command(410))
    assert (result, home.get_type(), home.altitude) == (ACCEPTED, "HOME_POSITION", 488000)
    result, _, [version] = bench.ask(command(519, 1))
    assert (result, version.get_type()) == (ACCEPTED, "PROTOCOL_VERSION")
    assert (version.version, version.min_version, version.max_version) == (200, 100, 200)
    assert bench.ask(command(512, PROTOCOL_VERSION))[2][0].get_type() == "PROTOCOL_VERSION"


def test_interval_of_a_message_is_told_as_it_was_set() -> None:
    bench = ServiceBench()

    def interval(number: int) -> int:
        result, _, [message] = bench.ask(command(510, number))
        assert result == ACCEPTED and message.message_id == number
        return int(message.interval_us)

    assert (interval(HEARTBEAT), interval(EMPTY), interval(9999)) == (1_000_000, -1, 0)
    for microseconds, told in ((20_000, 20_000), (-1, -1), (0, 1_000_000)):
        assert bench.ask(command(511, HEARTBEAT, microseconds))[0] == ACCEPTED
        assert interval(HEARTBEAT) == told
    assert bench.ask(command(510, NAN))[0] == DENIED


def test_accepted_interval_is_one_that_is_sent() -> None:
    bench = ServiceBench()
    result, text, _ = bench.ask(command(511, ABSENT, 100_000))
    assert (result, text) == (DENIED, "Interval denied: no such sensor")
    assert bench.ask(command(511, ABSENT, -1))[0] == ACCEPTED
    result, text, _ = bench.ask(command(511, HEARTBEAT, 100))
    assert result == DENIED and bench.wrong_parameter == 2 and "0.004" in text
    assert bench.ask(command(511, HEARTBEAT, 4000))[0] == ACCEPTED
    assert bench.ask(command(511, HEARTBEAT, 3e9))[0] == DENIED
    assert bench.ask(command(511, HEARTBEAT, 2e9))[0] == ACCEPTED
    assert bench.ask(command(510, HEARTBEAT))[2][0].interval_us == 2_000_000_000
    assert bench.ask(command(511, 9999, 100_000))[0] == UNSUPPORTED


def test_message_without_data_is_refused_with_the_reason() -> None:
    bench = ServiceBench()
    assert bench.ask(command(512, EMPTY))[:2] == (REJECTED, f"Message {EMPTY} denied: no data of it now")
    assert bench.ask(command(512, ABSENT))[:2] == (REJECTED, f"Message {ABSENT} denied: no such sensor")
    assert bench.ask(command(512, 9999))[0] == UNSUPPORTED == bench.ask(command(512, NAN))[0]


def test_modes_are_listed_all_or_one_by_one() -> None:
    bench = ServiceBench()
    result, _, listed = bench.ask(command(512, AVAILABLE_MODES))
    assert result == ACCEPTED and {m.number_modes for m in listed} == {3}
    assert [(m.mode_index, m.custom_mode, m.mode_name) for m in listed] == [
        (1, px4.MODE_HOLD, "Hold"), (2, px4.MODE_MISSION, "Mission"), (3, px4.MODE_OFFBOARD, "Offboard"),
    ]  # fmt: skip
    assert [m.standard_mode for m in listed] == [0, mavlink.MAV_STANDARD_MODE_MISSION, 0]
    assert [m.properties for m in listed] == [0, 0, 1]  # advanced
    for number in (1, 2, 3):
        _, _, [one] = bench.ask(command(512, AVAILABLE_MODES, number))
        assert (one.mode_index, one.custom_mode) == (number, bench.aircraft.modes[number - 1])
    for number in (4, -1, 1.5):
        result, text, answers = bench.ask(command(512, AVAILABLE_MODES, number))
        assert (result, answers) == (DENIED, []) and "3 modes" in text


def test_set_mode_enters_custom_modes_only() -> None:
    bench = ServiceBench()
    assert bench.request(mavlink.MAVLink_set_mode_message(7, 1, px4.MODE_HOLD)) == []
    assert bench.aircraft.calls == [("enter_mode", px4.MODE_HOLD)]
    [text] = bench.request(mavlink.MAVLink_set_mode_message(7, 4, 3))
    assert "custom modes" in text.text
    bench.stranger = True
    [text] = bench.request(mavlink.MAVLink_set_mode_message(7, 1, px4.MODE_HOLD))
    assert "another ground" in text.text and len(bench.aircraft.calls) == 1


def test_prearm_checks_say_what_is_wrong() -> None:
    bench = ServiceBench()
    assert bench.ask(command(401)) == (ACCEPTED, "Preflight OK", [])
    bench.aircraft.problem = "the vehicle moves"
    assert bench.ask(command(401)) == (ACCEPTED, "Preflight Fail: the vehicle moves", [])
    severities = []
    for problem in (None, "the vehicle moves"):
        bench.aircraft.problem = problem
        severities += [m.severity for m in bench.request(command(401)) if m.get_type() == "STATUSTEXT"]
    assert severities == [mavlink.MAV_SEVERITY_INFO, mavlink.MAV_SEVERITY_WARNING]


def test_parameters_are_saved_restored_and_reset_on_request() -> None:
    bench = ServiceBench()
    table = bench.parameters
    table.set_from_wire("AA_REAL", 1.5, 9)
    assert bench.ask(command(245, 0))[0] == ACCEPTED and table["AA_REAL"] == 2.5
    table.set_from_wire("AA_REAL", 1.5, 9)
    assert bench.ask(command(245, 1, -1))[0] == ACCEPTED
    table.set_from_wire("AA_REAL", 3.0, 9)
    assert bench.ask(command(245, -1))[0] == ACCEPTED and table["AA_REAL"] == 3.0
    assert bench.ask(command(245, 0, NAN))[0] == ACCEPTED and table["AA_REAL"] == 1.5
    assert bench.ask(command(245, 2))[0] == ACCEPTED and table["AA_REAL"] == 2.5
    assert bench.ask(command(245, 0))[0] == ACCEPTED and table["AA_REAL"] == 1.5


@pytest.mark.parametrize(
    ("number", "parameters", "parameter"),
    [(245, (7,), 1), (245, (1, 1), 2), (246, (1,), 1), (246, (2,), 1)],
)
def test_what_cannot_be_done_is_denied_with_the_reason(
    number: int, parameters: tuple[float, ...], parameter: int
) -> None:
    bench = ServiceBench()
    result, text, _ = bench.ask(command(number, *parameters))
    assert (result, bench.wrong_parameter) == (DENIED, parameter) and "denied:" in text


def test_restart_of_nothing_is_accepted() -> None:
    assert ServiceBench().ask(command(246, 0)) == (ACCEPTED, "", [])
