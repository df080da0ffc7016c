"""Requests to a vehicle: repeated until they are answered, and not for ever."""

import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest

from gcs.mavlink import px4
from gcs.mavlink.requests import CommandState, Requests, WantedParameter
from gcs.mavlink.settings import LinkSettings
from idc_controller.settings import Setting

SETTINGS = LinkSettings()
ARM = mavlink.MAV_CMD_COMPONENT_ARM_DISARM
RETRY = SETTINGS.retry_interval
WANTED = WantedParameter("", Setting("", ""))
FIXED = WantedParameter("", Setting("N", "", gt=0.0))
SETTABLE = WantedParameter("", Setting("s", "", ge=0.0, le=60.0), is_settable=True)


@pytest.fixture
def requests():
    return Requests(3, {}, SETTINGS)


def value_of(name, value, kind=mavlink.MAV_PARAM_TYPE_REAL32):
    return mavlink.MAVLink_param_value_message(name.encode(), value, kind, 1, 0)


def test_parameter_is_requested_at_once_and_again_until_it_is_known():
    known = {"KNOWN": 1.0}
    requests = Requests(3, known, SETTINGS)
    requests.want_parameters({"KNOWN": WANTED, "WANTED": WANTED})
    [first] = requests.due(5.0)
    assert (first.param_id, first.target_system) == ("WANTED", 3)
    requests.want_parameters({"WANTED": WANTED})
    assert requests.due(5.0 + 0.9 * RETRY) == []
    assert len(requests.due(5.0 + 1.1 * RETRY)) == 1
    requests.take_value(value_of("WANTED", float("nan")))
    assert len(requests.due(5.0 + 2.2 * RETRY)) == 1
    requests.take_value(value_of("WANTED", 2.5))
    assert known["WANTED"] == 2.5
    assert requests.due(100.0) == []


@pytest.mark.parametrize("value", [0.0, -3.0, float("inf"), float("nan")])
def test_impossible_value_is_not_taken_and_requested_again(value):
    known = {}
    requests = Requests(3, known, SETTINGS)
    requests.want_parameters({px4.PARAM_THRUST_MAX: FIXED})
    requests.take_value(value_of(px4.PARAM_THRUST_MAX, value))
    assert known == {} and len(requests.due(5.0)) == 1
    requests.take_value(value_of(px4.PARAM_THRUST_MAX, 30.0))
    assert known == {px4.PARAM_THRUST_MAX: 30.0} and requests.due(100.0) == []


@pytest.mark.parametrize("value", [0.0, 0.01, 29.0, 1e30, float("nan")])
def test_value_that_cannot_be_set_is_taken_once(value):
    """What comes later has passed no check, and set-points are shares of it."""
    known = {}
    requests = Requests(3, known, SETTINGS)
    requests.want_parameters({px4.PARAM_THRUST_MAX: FIXED})
    for later in (30.0, value):
        requests.take_value(value_of(px4.PARAM_THRUST_MAX, later))
    requests.want_parameters({px4.PARAM_THRUST_MAX: FIXED})  # before another flight
    requests.take_value(value_of(px4.PARAM_THRUST_MAX, value))
    assert known == {px4.PARAM_THRUST_MAX: 30.0}


@pytest.mark.parametrize(
    ("value", "is_taken"),
    [(0.0, True), (60.0, True), (-0.1, False), (60.1, False), (3e38, False), (float("nan"), False)],
)
def test_value_that_can_be_set_is_taken_again_within_its_range(value, is_taken):
    known = {}
    requests = Requests(3, known, SETTINGS)
    requests.want_parameters({px4.PARAM_LAND_DELAY: SETTABLE})
    for later in (5.0, value):
        requests.take_value(value_of(px4.PARAM_LAND_DELAY, later))
    assert known == {px4.PARAM_LAND_DELAY: value if is_taken else 5.0}


def test_value_of_a_type_that_is_not_used_is_not_taken():
    known = {}
    requests = Requests(3, known, SETTINGS)
    requests.want_parameters({"WANTED": WANTED})
    requests.take_value(value_of("WANTED", 2.5, 77))
    assert known == {}


@pytest.mark.parametrize(
    ("number", "interval"), [(ARM, SETTINGS.retry_interval), (mavlink.MAV_CMD_DO_SET_MODE, SETTINGS.mode_interval)]
)
def test_command_is_repeated_with_its_number_of_tries_until_it_counts_as_unanswered(requests, number, interval):
    command, tries = requests.command(number, 1.0), round(SETTINGS.tries * SETTINGS.retry_interval / interval)
    sent = [message for k in range(5 * tries) for message in requests.due(0.5 * interval * k)]
    assert [message.confirmation for message in sent] == list(range(tries))
    assert {(message.target_system, message.command, message.param1, message.param7) for message in sent} == {
        (3, number, 1.0, 0.0)
    }
    assert command.state is CommandState.UNANSWERED
    requests.take_acknowledgement(mavlink.MAVLink_command_ack_message(number, mavlink.MAV_RESULT_ACCEPTED))
    assert command.state is CommandState.UNANSWERED


@pytest.mark.parametrize(
    ("result", "state"),
    [
        (mavlink.MAV_RESULT_ACCEPTED, CommandState.ACCEPTED),
        (mavlink.MAV_RESULT_DENIED, CommandState.REFUSED),
        (mavlink.MAV_RESULT_IN_PROGRESS, CommandState.PENDING),
    ],
)
def test_answer_ends_its_own_command(requests, result, state):
    other, command = requests.command(ARM + 1), requests.command(ARM, 1.0)
    requests.due(0.0)
    requests.take_acknowledgement(mavlink.MAVLink_command_ack_message(ARM, result))
    assert (command.state, other.state) == (state, CommandState.PENDING)
    assert len(requests.due(2.0 * RETRY)) == (2 if state is CommandState.PENDING else 1)
