"""What QGroundControl and MAVROS ask when they connect: a vehicle answers each request when it is sent first."""

from __future__ import annotations

import struct
from collections import Counter
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as m
import pytest
from connecting_clients import Client, Mavros, QGroundControl
from mission_ground import PLAN, Uploader, corners, rally_point
from vehicle_bench import ACCEPTED, GROUND, Bench

from gcs.mavlink import px4
from gcs.mavlink.services.mission_item import PlanType

QGROUNDCONTROL_REQUESTS = 1 + 1 + 2 + 1
"""Of version, modes, component information (the two messages of it) and parameters."""
MAVROS_REQUESTS = 1 + 1 + 1
"""Of version, parameters and home."""
PLANS = {PlanType.MISSION: PLAN, PlanType.FENCE: corners(5001), PlanType.RALLY: [rally_point(3)]}

INSTRUMENTS = {
    "HEARTBEAT": 1, "SYS_STATUS": 1, "EXTENDED_SYS_STATE": 5, "BATTERY_STATUS": 0.5, "GPS_RAW_INT": 1, "VFR_HUD": 2,
    "ATTITUDE": 10, "ATTITUDE_QUATERNION": 50, "LOCAL_POSITION_NED": 50, "GLOBAL_POSITION_INT": 5, "ALTITUDE": 1,
    "HOME_POSITION": 0.5, "SYSTEM_TIME": 1, "CURRENT_MODE": 0.5, "MISSION_CURRENT": 1, "VIBRATION": 0.1,
    "ESTIMATOR_STATUS": 0.5, "HIGHRES_IMU": 1, "SCALED_PRESSURE": 1, "RC_CHANNELS": 1, "NAV_CONTROLLER_OUTPUT": 1,
}  # fmt: skip
"""What their displays are made of, and how often (Hz) it comes at least."""


def vehicle(free: bool) -> Bench:
    """A vehicle that sends to the port of a client, which has not said anything yet."""
    bench = Bench(free=free, clients={GROUND: False}, clients_answer=False)
    bench.run(1.1)
    return bench


def upload(client: Client) -> dict[PlanType, Any]:
    """Give a vehicle plans, as an operator does."""
    for plan_type, items in PLANS.items():
        ground = Uploader(items, plan_type)
        waiting = ground.start(client.bench.now)
        while ground.result is None:
            before = len(client.inbox)
            client.tell(waiting.pop())
            waiting = [new for found in client.inbox[before:] for new in ground.take(found, client.bench.now)]
        assert ground.result == m.MAV_MISSION_ACCEPTED
    return PLANS


def places(plans: dict[PlanType, Any]) -> Any:
    return {kind: [(item.command, item.x, item.y, item.z) for item in items] for kind, items in plans.items()}


@pytest.mark.parametrize("kind", [QGroundControl, Mavros])
@pytest.mark.parametrize("free", [False, True], ids=["coupled", "free"])
def test_each_request_of_a_connection_is_answered_at_once(free: bool, kind: type[Any]) -> None:
    bench = vehicle(free)
    client = kind(bench)
    assert client.has_heard_heartbeat()
    plans = upload(client) if free else {plan_type: [] for plan_type in PlanType}
    start = bench.now
    assert places(client.connect()) == places(plans)
    own = QGROUNDCONTROL_REQUESTS if kind is QGroundControl else MAVROS_REQUESTS
    assert len(client.requests) == own + len(PlanType) + sum(map(len, plans.values()))
    assert (client.slowest, bench.now) == (0.0, start)
    table = bench.vehicle.parameters
    assert len(client.values) == len(table) + 1
    texts = [found.text for found in client.inbox if found.get_type() == "STATUSTEXT"]
    assert not [text for text in texts if "denied" in text or "ignored" in text]


@pytest.mark.parametrize("free", [False, True], ids=["coupled", "free"])
def test_qgroundcontrol_knows_modes_and_keeps_parameters_by_their_hash(free: bool) -> None:
    bench = vehicle(free)
    client = QGroundControl(bench)
    client.connect()
    assert [mode.custom_mode for mode in client.modes] == list(bench.vehicle.aircraft.modes)
    read, before = dict(client.values), len(client.inbox)
    bench.run(0.3)  # the list is not sent twice in 0.2 s
    client.ask_parameters()
    assert client.values == read
    bench.run(0.1)
    assert not [found for found in client.inbox[before:] if found.get_type() in ("PARAM_ERROR", "STATUSTEXT")]
    wire = {found.name: px4.parameter_to_wire(found.value, found.type) for found in bench.vehicle.parameters}
    del read["_HASH_CHECK"]
    assert read == {name: struct.unpack("<f", struct.pack("<f", value))[0] for name, value in wire.items()}


@pytest.mark.parametrize("free", [False, True], ids=["coupled", "free"])
def test_displays_get_their_streams_without_a_request(free: bool) -> None:
    bench = vehicle(free)
    client, seconds = QGroundControl(bench), 10.0
    client.connect()
    before = len(client.inbox)
    bench.run(seconds)
    got = Counter(found.get_type() for found in client.inbox[before:])
    assert {kind: got[kind] for kind, rate in INSTRUMENTS.items() if got[kind] < max(1.0, rate * seconds - 1.0)} == {}


@pytest.mark.parametrize("free", [False, True], ids=["coupled", "free"])
def test_mavros_measures_the_clock_and_sets_the_rate_of_a_stream(free: bool) -> None:
    bench = vehicle(free)
    client = Mavros(bench)
    client.connect()
    before = len(client.inbox)
    client.stay(2.0)
    assert len(client.synchronised) == 20
    first, *_, last = client.synchronised
    assert last[1] - first[1] == pytest.approx(last[0] - first[0], abs=1e6)
    usual = sum(found.get_type() == "ODOMETRY" for found in client.inbox[before:])
    assert client.command(m.MAV_CMD_SET_MESSAGE_INTERVAL, m.MAVLINK_MSG_ID_ODOMETRY, 50_000) == ACCEPTED
    before = len(client.inbox)
    client.stay(2.0)
    assert usual < 39 <= sum(found.get_type() == "ODOMETRY" for found in client.inbox[before:])
