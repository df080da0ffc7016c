"""The link to one vehicle: what each message tells of it, and when it was last heard."""

import math

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest

from gcs.mavlink import px4
from gcs.mavlink.codec import Codec
from gcs.mavlink.layout import Sample
from gcs.mavlink.requests import WantedParameter
from gcs.mavlink.vehicle_link import VehicleLink
from idc_controller.settings import Setting

OWN, UNIT = px4.AUTOPILOT_COMPONENT, px4.PAYLOAD_UNIT_COMPONENT
NEVER = -math.inf
PREARM, RANGE = mavlink.MAV_SYS_STATUS_PREARM_CHECK, mavlink.MAV_SYS_STATUS_SENSOR_PROXIMITY
STAMP = 5000
THR_MAX = WantedParameter("force of thrust 1 (N)", Setting("N", "", gt=0.0))


class Linked:
    """A link, and the vehicle's components that send on it."""

    def __init__(self):
        self.link = VehicleLink(3, None)
        self.senders = {component: Codec(3, component) for component in (OWN, 77)}
        self.senders[UNIT] = Codec(px4.PAYLOAD_UNIT_SYSTEM, UNIT)

    def send(self, now, *messages, component=OWN, lost=0):
        sender = self.senders[component]
        for _ in range(lost):
            sender.encode(heartbeat())
        datagram = b"".join(sender.encode(message) for message in messages)
        self.link.handle(Codec(254, 1).decode(datagram), now)


def heartbeat(base_mode=0, custom_mode=0):
    return mavlink.MAVLink_heartbeat_message(2, 12, base_mode, custom_mode, 3, 3)


def attitude(stamp=STAMP):
    return mavlink.MAVLink_attitude_quaternion_message(stamp, 1, 0, 0, 0, 0, 0, 0)


def position(stamp=STAMP):
    return mavlink.MAVLink_local_position_ned_message(stamp, 1, 2, 3, 4, 5, 6)


def sys_status(present, health):
    return mavlink.MAVLink_sys_status_message(present, present, health, 0, 0, -1, 100, 0, 0, 0, 0, 0, 0)


@pytest.fixture
def linked():
    return Linked()


def received_at(link):
    return link.received_at, link.attitude_received_at, link.position_received_at, link.payload_received_at


@pytest.mark.parametrize(
    ("messages", "component", "expected"),
    [
        ([heartbeat()], OWN, (7.0, NEVER, NEVER, NEVER)),
        ([attitude()], OWN, (7.0, 7.0, NEVER, NEVER)),
        ([position()], OWN, (7.0, NEVER, 7.0, NEVER)),
        ([attitude(), position()], OWN, (7.0, 7.0, 7.0, NEVER)),
        ([attitude(), position()], UNIT, (NEVER, NEVER, NEVER, 7.0)),
        ([attitude()], 77, (7.0, NEVER, NEVER, NEVER)),
    ],
)
def test_each_kind_of_telemetry_has_the_time_at_which_it_came_last(linked, messages, component, expected):
    linked.send(7.0, *messages, component=component)
    assert received_at(linked.link) == expected


TARGET = mavlink.MAVLink_attitude_target_message(STAMP, 0, [1.0, 0.0, 0.0, 0.0], 0.0, 0.0, 0.0, 0.5)
RETURN = mavlink.MAVLink_obstacle_distance_3d_message(STAMP, 0, 12, 1, 1.0, 2.0, 3.0, 0.1, 9.0)
SCAN_END = mavlink.MAVLink_obstacle_distance_message(STAMP * 1000, 0, [65535] * 72, 5, 5, 900, 0.0, 0.0, 12)


@pytest.mark.parametrize(
    ("system", "component", "expected"),
    [
        (3, OWN, [Sample.ATTITUDE, Sample.POSITION, Sample.SETPOINT, Sample.RETURNS, Sample.SCAN_END]),
        (px4.PAYLOAD_UNIT_SYSTEM, UNIT, [Sample.ATTITUDE, Sample.POSITION]),
        (3, UNIT, []),
        (3, 77, []),
        (px4.PAYLOAD_UNIT_SYSTEM, 77, []),
    ],
)
def test_samples_are_those_of_the_autopilot_and_poses_and_motions_of_the_payload(linked, system, component, expected):
    sender = Codec(system, component)
    messages = attitude(), heartbeat(), position(), TARGET, RETURN, SCAN_END
    datagram = b"".join(sender.encode(message) for message in messages)
    samples = linked.link.handle(Codec(254, 1).read(datagram), 7.0)
    assert [received.layout.sample for received in samples] == expected
    assert {received.time_boot_ms for received in samples} <= {STAMP}


def test_telemetry_is_complete_with_attitude_and_position(linked):
    linked.send(7.0, attitude())
    assert (linked.link.telemetry_received_at, linked.link.complete_telemetry_received_at) == (7.0, NEVER)
    linked.send(8.0, position())
    assert (linked.link.telemetry_received_at, linked.link.complete_telemetry_received_at) == (8.0, 7.0)
    linked.send(9.0, attitude())
    assert (linked.link.telemetry_received_at, linked.link.complete_telemetry_received_at) == (9.0, 8.0)


def test_clock_is_that_of_the_stamps_of_the_vehicle_not_of_the_payload(linked):
    linked.send(7.0, attitude(9000), component=UNIT)
    assert not linked.link.clock.known
    linked.send(7.0, attitude(5000), position(5000))
    assert linked.link.clock.known and linked.link.clock.offset == pytest.approx(-2.0)
    linked.send(7.1, position(5120))
    assert linked.link.clock.offset == pytest.approx(-1.98)


def test_answer_to_a_timesync_request_gives_the_latency_and_a_request_of_the_vehicle_does_not(linked):
    sent = linked.link.clock.request(10.0)
    linked.send(10.06, mavlink.MAVLink_timesync_message(0, sent))
    assert linked.link.clock.delay == 0.0
    linked.send(10.08, mavlink.MAVLink_timesync_message(1, sent))
    assert linked.link.clock.delay == pytest.approx(0.04)


def test_companion_answers_and_reports_nothing_for_its_vehicle(linked):
    link = linked.link
    sent = link.clock.request(10.0)
    link.requests.want_parameters({"THR_MAX": THR_MAX})
    arming = link.requests.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1.0)
    messages = [
        mavlink.MAVLink_timesync_message(1, sent), sys_status(PREARM, 0), heartbeat(128, px4.MODE_OFFBOARD),
        mavlink.MAVLink_param_value_message(b"THR_MAX", 27.5, mavlink.MAV_PARAM_TYPE_REAL32, 1, 0),
        mavlink.MAVLink_command_ack_message(arming.number, mavlink.MAV_RESULT_UNSUPPORTED),
    ]  # fmt: skip
    linked.send(10.04, *messages, component=77)
    assert (link.status.prearm_ok, link.status.armed, link.status.parameters) == (None, False, {})
    assert arming.result is None
    linked.send(10.08, *messages)  # the autopilot's own
    assert link.clock.delay == pytest.approx(0.04)
    assert (link.status.prearm_ok, link.status.armed, link.status.parameters) == (False, True, {"THR_MAX": 27.5})
    assert arming.result == mavlink.MAV_RESULT_UNSUPPORTED


def test_mode_and_arming_are_those_of_the_autopilots_heartbeat(linked):
    status, armed = linked.link.status, mavlink.MAV_MODE_FLAG_SAFETY_ARMED
    linked.send(1.0, heartbeat(armed | 1, px4.MODE_OFFBOARD), component=UNIT)
    assert not status.armed and not status.offboard
    linked.send(1.0, heartbeat(armed | 1, px4.MODE_OFFBOARD))
    assert status.armed and status.offboard
    linked.send(2.0, heartbeat(1, px4.MODE_HOLD))
    assert not status.armed and not status.offboard and status.custom_mode == px4.MODE_HOLD


def test_health_counts_for_what_is_present_alone(linked):
    status = linked.link.status
    assert status.prearm_ok is None and status.obstacle_sensing_valid
    for present, health, prearm, sensing in (
        (0, PREARM, None, True), (PREARM, PREARM, True, True), (PREARM | RANGE, RANGE, False, True),
        (RANGE, PREARM, False, False), (PREARM, PREARM, True, False), (PREARM | RANGE, PREARM | RANGE, True, True),
    ):  # fmt: skip
        linked.send(1.0, sys_status(present, health))
        assert (status.prearm_ok, status.obstacle_sensing_valid) == (prearm, sensing)


def test_landed_state_and_texts_are_kept(linked):
    status = linked.link.status
    assert status.landed_state == mavlink.MAV_LANDED_STATE_UNDEFINED and status.last_text == ""
    linked.send(1.0, mavlink.MAVLink_extended_sys_state_message(0, mavlink.MAV_LANDED_STATE_IN_AIR))
    assert status.landed_state == mavlink.MAV_LANDED_STATE_IN_AIR
    for number in range(30):
        linked.send(1.0, mavlink.MAVLink_statustext_message(4, b"text %d" % number))
    assert status.last_text == " (text 29)" and list(status.texts) == [f"text {number}" for number in range(10, 30)]


def test_text_in_chunks_is_kept_as_one(linked):
    status, text = linked.link.status, "Take-off denied: " + "x" * 60
    linked.send(1.0, mavlink.MAVLink_statustext_message(4, text[:50].encode(), 9, 0))
    assert status.last_text == ""
    linked.send(1.0, mavlink.MAVLink_statustext_message(4, text[50:].encode(), 9, 1))
    assert list(status.texts) == [text]


def test_parameter_that_is_wanted_is_known_and_no_other_is_kept(linked):
    linked.link.requests.want_parameters({"THR_MAX": THR_MAX})
    for name in (b"THR_MAX", *(b"FORGED_%d" % number for number in range(500))):
        linked.send(1.0, mavlink.MAVLink_param_value_message(name, 27.5, mavlink.MAV_PARAM_TYPE_REAL32, 1, 0))
    assert linked.link.status.parameters == {"THR_MAX": 27.5}


@pytest.mark.parametrize(("component", "lost", "messages"), [(OWN, 1, (2, 4)), (UNIT, 0, (0, 0))])
def test_gaps_in_the_numbers_of_the_autopilot_alone_are_losses(linked, component, lost, messages):
    linked.send(1.0, attitude(), component=component)
    linked.send(1.1, attitude(STAMP + 20), component=component, lost=4)
    linked.link.statistics.settle(100.0)
    assert linked.link.statistics.lost == lost
    assert (linked.link.statistics.received, linked.link.statistics.missing) == messages


def test_points_of_a_scan_are_counted_one_by_one(linked):
    points = [
        mavlink.MAVLink_obstacle_distance_3d_message(STAMP, 0, 12, 1, *np.array([1.0, 2.0, 3.0 + k]), 0.1, 9.0)
        for k in range(5)
    ]
    linked.send(1.0, attitude(), *points, attitude(STAMP + 20))
    linked.link.statistics.settle(100.0)
    assert (linked.link.statistics.lost, linked.link.statistics.duplicated) == (0, 0)
    linked.send(1.1, *points, lost=1)
    linked.send(1.1, attitude(STAMP + 40))
    linked.link.statistics.settle(100.0)
    assert linked.link.statistics.lost == 1
    assert (linked.link.statistics.received, linked.link.statistics.missing) == (13, 1)
