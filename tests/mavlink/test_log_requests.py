"""What a log has of a vehicle: requested once, lost answers again, and not for ever."""

import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest

from gcs.mavlink.log_requests import LogRequests
from gcs.mavlink.settings import LinkSettings

SETTINGS = LinkSettings()
RETRY = 1.01 * SETTINGS.retry_interval
VERSION = mavlink.MAVLink_autopilot_version_message(0, 0, 0, 0, 0, [0] * 8, [0] * 8, [0] * 8, 0, 0, 3)
LIST, READ, COMMAND = "PARAM_REQUEST_LIST", "PARAM_REQUEST_READ", "COMMAND_LONG"


def value(index, count=4):
    return mavlink.MAVLink_param_value_message(b"P%d" % index, 1.0, mavlink.MAV_PARAM_TYPE_REAL32, count, index)


@pytest.fixture
def requests():
    requests = LogRequests(3, SETTINGS)
    assert requests.due(0.0) == []
    requests.want()
    return requests


def kinds(messages):
    return [message.get_type() for message in messages]


def test_version_and_list_are_requested_once_where_all_is_answered(requests):
    version, listed = requests.due(1.0)
    assert (version.command, version.param1, version.target_system) == (512, 148.0, 3)
    assert (listed.get_type(), listed.target_system, listed.target_component) == (LIST, 3, 1)
    requests.take_value(
        mavlink.MAVLink_param_value_message(b"_HASH_CHECK", 0.0, mavlink.MAV_PARAM_TYPE_UINT32, 4, 0xFFFF)
    )
    requests.take_version(VERSION)
    for index in range(4):
        requests.take_value(value(index))
    requests.want()
    assert [requests.due(1.0 + k * RETRY) for k in range(1, 30)] == [[]] * 29


def test_what_was_lost_is_requested_again(requests):
    requests.due(1.0)
    assert kinds(requests.due(1.0 + RETRY)) == [COMMAND, LIST]
    requests.take_version(VERSION)
    for index in (0, 2):
        requests.take_value(value(index))
    assert requests.due(1.0 + 2 * RETRY) == []  # the list is on its way
    asked = requests.due(1.0 + 3 * RETRY)
    assert kinds(asked) == [READ, READ] and [message.param_index for message in asked] == [1, 3]
    requests.take_value(value(3))
    requests.take_value(value(1))
    assert [requests.due(1.0 + k * RETRY) for k in range(4, 30)] == [[]] * 26


def test_vehicle_that_does_not_answer_is_left_alone_after_some_tries(requests):
    sent = [kinds(requests.due(1.0 + k * RETRY)) for k in range(50)]
    assert sent == [[COMMAND, LIST]] * SETTINGS.tries + [[]] * (50 - SETTINGS.tries)
    requests.want()
    assert requests.due(100.0) == []


def test_forged_number_of_parameters_ends_too(requests):
    requests.take_value(value(0, 0xFFFF))
    sent = [requests.due(1.0 + k * RETRY) for k in range(50)]
    assert max(map(len, sent)) <= 21 and not any(sent[SETTINGS.tries + 1 :])
