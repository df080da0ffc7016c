"""Stamps of what a vehicle sends: of each message they never go back, in flight, on the ground and on new requests."""

from __future__ import annotations

from collections import defaultdict

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as m
import pytest
from service_client import FRAME, HEIGHT, NAN, ServiceClient
from vehicle_bench import GROUND, HOLD, command


@pytest.mark.parametrize("free", [True, False], ids=["free", "on a payload"])
def test_stamps_never_go_back(free: bool) -> None:
    client = ServiceClient(free=free)
    client.take_off()
    if free:
        place = FRAME.geodetic(5.0, 0.0, -HEIGHT)
        assert client.accepts(m.MAV_CMD_DO_REPOSITION, -1, 1, 0, NAN, *place)
    else:
        client.ask(HOLD)
    for _, number in client.vehicle.telemetry.builders:
        client.result(command(m.MAV_CMD_REQUEST_MESSAGE, number))
        client.run(0.01)
    client.streaming.clear()
    client.accepts(m.MAV_CMD_SET_MESSAGE_INTERVAL, m.MAVLINK_MSG_ID_ODOMETRY, 2e4)
    client.run(2.0)
    client.accepts(m.MAV_CMD_SET_MESSAGE_INTERVAL, m.MAVLINK_MSG_ID_ODOMETRY, 0)
    client.accepts(m.MAV_CMD_NAV_LAND)
    client.run(6.0)
    stamps = defaultdict(list)
    for found in client.inbox[GROUND]:
        if (stamp := getattr(found, "time_boot_ms", getattr(found, "time_usec", None))) is not None:
            stamps[found.get_type(), found.get_srcSystem()].append(stamp)
    assert len(stamps) >= 18 and max(map(len, stamps.values())) > 200
    assert not [sender for sender, times in stamps.items() if np.any(np.diff(times) < 0)]
