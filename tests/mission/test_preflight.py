"""Before take-off: what a vehicle lacks is named, and where payload and vehicles stand is averaged."""

import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from autopilots_page import listing

from gcs.config.flight_settings import DEFAULTS
from gcs.flight.autopilot_requirements import PARAMETERS, REQUIREMENTS
from gcs.flight.preflight import Preflight
from gcs.mavlink import px4
from gcs.mavlink.vehicle_link import VehicleLink
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Position

NOW = 50.0
TIMEOUT = DEFAULTS.failsafe.telemetry_timeout
SETTABLE = (px4.PARAM_SETPOINT_LOSS, px4.PARAM_LAND_DELAY)
ADDRESSES = [("10.0.0.4", 14580), ("10.0.0.7", 14581)]


def complete(system_id, address):
    """A link on which everything has come."""
    link = VehicleLink(system_id, address)
    link.received_at = link.attitude_received_at = link.position_received_at = link.payload_received_at = NOW
    link.status.parameters.update(dict.fromkeys(PARAMETERS, 1.0))
    link.status.prearm_ok = False
    link.status.autopilot = mavlink.MAV_AUTOPILOT_PX4
    link.status.landed_state = mavlink.MAV_LANDED_STATE_ON_GROUND
    link.clock.add_answer(link.clock.request(NOW), NOW + 0.01)
    return link


@pytest.fixture
def links():
    return [complete(system_id, address) for system_id, address in zip((4, 7), ADDRESSES, strict=True)]


def connected(links, now=NOW):
    preflight = Preflight(SimpleNamespace(links=links))
    done = preflight.connect(now)
    assert done == (preflight.missing == "")
    return preflight.missing


def test_vehicles_that_have_sent_all_are_connected_whether_ready_or_not(links):
    assert connected(links) == ""
    links[0].status.prearm_ok = True
    assert connected(links) == ""


@pytest.mark.parametrize(
    ("field", "lacking"),
    [
        ("attitude_received_at", "ATTITUDE_QUATERNION"),
        ("position_received_at", "LOCAL_POSITION_NED"),
        ("payload_received_at", "ATTITUDE_QUATERNION and LOCAL_POSITION_NED of the payload unit"),
    ],
)
def test_telemetry_that_has_not_come_for_the_timeout_is_named_with_its_vehicle(links, field, lacking):
    setattr(links[1], field, NOW - 0.99 * TIMEOUT)
    assert connected(links) == ""
    setattr(links[1], field, NOW - 1.01 * TIMEOUT)
    assert connected(links) == f"vehicle 7 has not sent {lacking}"


def test_vehicle_of_which_nothing_has_come_is_named_with_its_address(links):
    links[1].received_at = NOW - 1.01 * TIMEOUT
    assert connected(links) == "1 of 2 vehicles connected: vehicle 7 does not answer at 10.0.0.7:14581"


def test_all_that_vehicles_lack_is_named_at_once_and_vehicles_that_lack_the_same_together(links):
    names = [row.what for row in REQUIREMENTS if row.at_connect]
    nothing = VehicleLink(7, ADDRESSES[1])
    nothing.received_at = NOW
    assert connected([links[0], nothing]) == f"vehicle 7 has not sent {', '.join(names)}"
    other = VehicleLink(4, ADDRESSES[0])
    other.received_at = NOW
    assert connected([other, nothing]) == f"vehicles 4, 7 have not sent {', '.join(names)}"
    links[0].status.prearm_ok = None
    del links[1].status.parameters[px4.PARAM_LAND_DELAY]
    assert connected(links) == (
        "vehicle 4 has not sent SYS_STATUS with MAV_SYS_STATUS_PREARM_CHECK; vehicle 7 has not sent CLFT_LAND_DELAY"
    )


def test_modes_of_another_autopilot_are_not_taken_for_those_of_px4(links):
    links[0].status.autopilot = mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA
    assert connected(links) == "vehicle 4 has not sent HEARTBEAT of MAV_AUTOPILOT_PX4"


def test_page_of_autopilots_is_made_from_the_table():
    page = (Path(__file__).parents[2] / "docs" / "autopilots.md").read_text(encoding="utf-8")
    assert page == listing()
    assert all(row.what in page for row in REQUIREMENTS)


def test_vehicle_that_is_not_heard_is_named_by_what_is_heard_in_its_place(links):
    links[0].received_at = 0.0
    links[0].conflict.other_system_id = 9
    one = "1 of 2 vehicles connected: "
    assert connected(links) == one + "vehicle 4 does not answer at 10.0.0.4:14580: vehicle 9 does"
    links[0].address = None
    assert connected(links) == one + "vehicle 4 has not called in"


def test_all_vehicles_that_are_missing_are_counted_and_named_before_what_others_lack(links):
    links[0].status.prearm_ok = None
    links[1].received_at = 0.0
    assert connected(links) == "1 of 2 vehicles connected: vehicle 7 does not answer at 10.0.0.7:14581"
    links[0].received_at = 0.0
    assert connected(links) == (
        "0 of 2 vehicles connected: vehicle 4 does not answer at 10.0.0.4:14580; "
        "vehicle 7 does not answer at 10.0.0.7:14581"
    )


def test_vehicle_that_is_heard_without_the_payload_unit_is_requested_to_forward_it(links):
    links[0].payload_received_at = 0.0
    connected(links)
    requests = [message for link in links for message in link.requests.due(NOW)]
    assert {(m.get_type(), m.target_system, m.command, m.param2) for m in requests} == {("COMMAND_LONG", 100, 511, 0.0)}
    assert {m.param1 for m in requests} == {31.0, 32.0} and len(requests) == 2
    connected(links)
    assert links[0].requests.due(NOW + 0.1) == []
    assert len(links[0].requests.due(NOW + 0.6)) == 2
    links[0].payload_received_at = NOW
    assert connected(links) == ""
    # To the vehicles themselves go the requests of what the log is to have, once.
    asked = [(m.get_type(), m.target_system) for link in links for m in link.requests.due(NOW + 2.0)]
    assert asked == [(kind, link.system_id) for link in links for kind in ("COMMAND_LONG", "PARAM_REQUEST_LIST")]


def test_parameters_are_requested_from_all_and_the_time_of_the_first_attempt_is_kept(links):
    for link in links:
        link.status.parameters.clear()
    preflight = Preflight(SimpleNamespace(links=links))
    assert np.isnan(preflight.connect_start)
    for now in (NOW, NOW + 1.0):
        preflight.connect(now)
    assert preflight.connect_start == NOW
    for link in links:
        assert sorted(m.param_id for m in link.requests.due(NOW)) == sorted(PARAMETERS)


@pytest.mark.parametrize(
    ("name", "value", "is_possible"),
    [
        *((name, value, value > 0.0) for name in PARAMETERS if name not in SETTABLE for value in (-1.0, 0.0, 0.5)),
        *((px4.PARAM_SETPOINT_LOSS, value, value == TIMEOUT) for value in (-5.0, 0.0, TIMEOUT, 61.0)),
        *((px4.PARAM_LAND_DELAY, value, 0.0 <= value <= 3600.0) for value in (-100.0, 0.0, 3600.0, 3601.0)),
        *((name, value, False) for name in PARAMETERS for value in (math.nan, math.inf)),
    ],
)
def test_values_that_a_flight_depends_on_are_possible_ones(name, value, is_possible):
    assert PARAMETERS[name].possible.allows(value) is is_possible
    assert PARAMETERS[name].is_settable is (name in SETTABLE)


def position(source, *place):
    return Position(NOW, source, np.array(place), np.zeros(3))


def test_places_are_the_means_of_the_last_samples(links):
    preflight, kept = Preflight(SimpleNamespace(links=links)), DEFAULTS.takeoff_landing.position_samples
    for source in (1, PAYLOAD, 0):
        assert not preflight.has_positions
        preflight.add(Attitude(NOW, source, np.array([1.0, 0.0, 0.0, 0.0]), np.zeros(3)))
        preflight.add(position(source, np.nan, np.nan, np.nan))
        assert not preflight.has_positions
        preflight.add(position(source, source, 2.0, -1.0))
        preflight.add(position(source, source, 4.0, -2.0))
    assert preflight.has_positions
    np.testing.assert_allclose(preflight.payload, [-1.0, 3.0, -1.5])
    np.testing.assert_allclose(preflight.vehicles, [[0.0, 3.0, -1.5], [1.0, 3.0, -1.5]])
    for k in range(kept + 5):
        preflight.add(position(0, float(k), 0.0, 0.0))
    np.testing.assert_allclose(preflight.vehicles[0], [5.0 + 0.5 * (kept - 1), 0.0, 0.0])


def test_positions_are_current_while_none_is_older_than_the_timeout_of_telemetry(links):
    preflight, timeout = Preflight(SimpleNamespace(links=links)), DEFAULTS.failsafe.telemetry_timeout
    for source, late in ((PAYLOAD, 0.0), (0, 0.5), (1, 1.0)):
        assert not preflight.is_current(NOW)
        preflight.add(Position(NOW + late, source, np.zeros(3), np.zeros(3)))
    assert preflight.positions_until == NOW
    assert preflight.is_current(NOW + 0.99 * timeout) and not preflight.is_current(NOW + 1.01 * timeout)


def test_places_are_settled_once_averaged_for_their_time(links):
    preflight = Preflight(SimpleNamespace(links=links))
    assert not preflight.is_settled(1e9)
    preflight.check_start = 20.0
    settle_time = DEFAULTS.takeoff_landing.settle_time
    assert not preflight.is_settled(20.0 + 0.99 * settle_time) and preflight.is_settled(20.0 + settle_time)


def test_interval_of_positions_is_the_shortest_of_each_source(links):
    preflight = Preflight(SimpleNamespace(links=links))
    for time in (0.0, 0.04, 0.04, 0.2, 0.16, 0.24):
        for source in (PAYLOAD, 0, 1):
            preflight.add(Position(2.0 * time if source == 1 else time, source, np.zeros(3), np.zeros(3)))
    assert preflight.slow_source(0.08) is None
    assert preflight.slow_source(0.05) == (1, pytest.approx(0.08))
    assert preflight.slow_source(0.039)[0] == 1


@pytest.mark.parametrize(("rate", "jitter", "is_wrong"), [(1.0, 0.02, False), (0.5, 0.0, True), (2.0, 0.02, True)])
def test_clock_of_a_simulation_at_another_speed_is_waited_for_and_then_named(links, rate, jitter, is_wrong):
    def stamp(now):
        for i, link in enumerate(links):
            arrival = now + jitter * abs(np.sin(40.0 * now))
            link.clock.add_stamp(100.0 + (rate if i else 1.0) * (now - NOW), arrival, in_order=True)

    preflight = Preflight(SimpleNamespace(links=links))
    stamp(NOW)
    assert preflight.connect(NOW)
    preflight.check_start = NOW
    for k in range(1, 16):
        stamp(NOW + 0.04 * k)
    assert preflight.is_settled(NOW + 0.6) is not is_wrong
    if is_wrong:
        link, found = preflight.wrong_clock
        assert link is links[1] and found == pytest.approx(rate, rel=0.05)
        assert preflight.is_settled(NOW + 1.01 * DEFAULTS.failsafe.connect_timeout)
    else:
        assert preflight.wrong_clock is None
